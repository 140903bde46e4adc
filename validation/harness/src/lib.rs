//! The harness: what a case declares, how its runs are planned, made, kept and judged.
//!
//! ```text
//! case declares ──▶ plan ──▶ make: spec → record ──▶ store ──▶ judge, study ──▶ page
//! ```
//!
//! Between the steps is plain data: [`base::spec::RunSpec`], [`base::record::Record`], [`study::Study`]. Only
//! making knows the solver.

pub mod bisect;
pub mod case;
pub mod columns;
pub mod composed;
pub mod context;
pub mod convergence;
pub mod declare;
pub mod error;
pub mod extremes;
pub mod frames;
pub mod gate_power;
pub mod make;
pub mod method;
pub mod plan;
pub mod planned;
pub mod rules;
pub mod runner;
pub mod runs;
pub mod simulate;
pub mod store;
pub mod studies;
pub mod study;
pub mod suite;
