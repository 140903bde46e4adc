//! Measures of a run, each one function with its formula.

pub mod budget;
pub mod curve;
pub mod energy;
pub mod history;
pub mod norms;
pub mod spectrum;
