//! Problems for other codes, and their results.
//!
//! ```text
//! case ──▶ problem: problem.json, README.md, particles ──▶ another code ──▶ results ──▶ measured and judged
//! ```
//!
//! [`mod@write`] puts a problem into a folder; [`mod@read`] reads particles at times from the formats of
//! other codes; [`submission`] reads a folder of results and measures it by the code that measures our own
//! runs.

pub mod challenge;
mod digits;
pub mod flaw;
pub mod library;
pub mod probe;
pub mod problem;
pub mod read;
pub mod submission;
pub mod write;
