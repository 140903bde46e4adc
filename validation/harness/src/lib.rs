//! The harness: the studies of cases, and the planning, making, storing and judging of their runs.
//!
//! ```text
//! studies of a case ──▶ plan ──▶ make: spec → record ──▶ store ──▶ judge, evaluate ──▶ page
//! ```
//!
//! The steps exchange plain data: [`touchstone_base::spec::RunSpec`], [`touchstone_base::record::Record`],
//! [`section::Section`]. Only the step that makes runs calls the solver.

pub mod batch;
pub mod bisect;
pub mod case;
pub mod checkpoint;
pub mod clock;
pub mod columns;
pub mod composed;
pub mod context;
pub mod convergence;
pub mod detect;
pub mod error;
pub mod estimate;
pub mod facts;
pub mod foreign;
pub mod frames;
pub mod gates;
mod horizon;
pub mod jobs;
pub mod limits;
pub mod looks;
pub mod make;
pub mod medium;
pub mod method;
pub mod notes;
pub mod orders;
pub mod outline;
pub mod pictures;
pub mod plan;
pub mod prelude;
pub mod problem;
pub mod profile;
mod quantiles;
pub mod relation;
pub mod rules;
pub mod runner;
pub mod runs;
pub mod sealed;
pub mod section;
pub mod size;
pub mod snapshot;
pub mod store;
pub mod studies;
pub mod study;
pub mod suite;
pub mod symmetry;
pub mod table;
pub mod tally;
#[cfg(test)]
mod testing;
