//! The harness: what a case declares, how runs are planned, made and judged.

pub mod bisect;
pub mod case;
pub mod composed;
pub mod convergence;
pub mod gate_power;
pub mod runner;
pub mod suite;
pub mod work_precision;
