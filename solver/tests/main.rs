//! Properties of the solver, as one program: a scheme that several of them use is compiled once.

mod consistent_solid;
mod lists;
mod phases;
mod super_steps;
