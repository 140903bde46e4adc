//! Measures of a run, each one function with its formula.

pub mod budget;
pub mod contact;
pub mod curve;
pub mod elastic;
pub mod energy;
pub mod fitted_field;
pub mod gauge;
pub mod history;
pub mod norms;
pub mod path;
pub mod spectrum;
