//! Properties of the solver, as one program: a scheme that several of them use is compiled once.

mod consistent_solid;
mod lagrangian;
mod lists;
mod phases;
#[path = "../src/random.rs"]
mod random;
mod super_steps;
