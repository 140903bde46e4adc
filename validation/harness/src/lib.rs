//! The harness: the declarations of cases, and the planning, making, storing and judging of their runs.
//!
//! ```text
//! case declares ──▶ plan ──▶ make: spec → record ──▶ store ──▶ judge, study ──▶ page
//! ```
//!
//! The steps exchange plain data: [`touchstone_base::spec::RunSpec`], [`touchstone_base::record::Record`],
//! [`study::Study`]. Only the step that makes runs calls the solver.

pub mod bisect;
pub mod case;
pub mod checkpoint;
pub mod clock;
pub mod columns;
pub mod composed;
pub mod context;
pub mod convergence;
pub mod declare;
pub mod deep;
pub mod detect;
pub mod error;
pub mod frames;
pub mod horizon;
pub mod limits;
pub mod make;
pub mod medium;
pub mod method;
pub mod notes;
pub mod orders;
pub mod outline;
pub mod pictures;
pub mod plan;
pub mod playback;
pub mod problem;
pub mod profile;
pub mod quantiles;
pub mod relation;
pub mod rules;
pub mod runner;
pub mod runs;
pub mod sealed;
pub mod size;
pub mod store;
pub mod studies;
pub mod study;
pub mod suite;
pub mod symmetry;
pub mod table;
