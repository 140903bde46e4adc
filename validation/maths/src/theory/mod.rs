//! Exact solutions of the *discretised* equations on a lattice: what a correct program reproduces
//! to round-off, and the part of its error that no correct program can avoid.

pub mod bending;
pub mod lagrangian;
pub mod lattice;
pub mod super_steps;
pub mod time_step;

pub use time_step::Stepping;

#[cfg(test)]
mod tests;
