//! Exact solutions of the *discretised* equations on a lattice, which a correct program reproduces to
//! round-off: the part of the error that does not come from the program.

pub mod bending;
pub mod faces;
pub mod lagrangian;
pub mod lattice;
pub mod steps;
mod super_steps;
pub mod time_step;

pub use time_step::Stepping;

#[cfg(test)]
mod tests;
