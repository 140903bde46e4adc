//! Measures of a run, each one function with its formula.

pub mod norms;
pub mod profile;
