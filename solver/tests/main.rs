//! Properties of the solver, as one program: a scheme that several of them use is compiled once.

#![allow(clippy::unwrap_used)] // clippy allows it in tests, not in their helpers

mod consistent_solid;
mod lagrangian;
mod lists;
mod phases;
#[path = "../src/random.rs"]
mod random;
mod super_steps;
