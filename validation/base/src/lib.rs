//! The types that all crates of the harness use: settings, numbers, files, gates, records, references.

pub mod bits;
pub mod breakdown;
pub mod files;
pub mod functions;
pub mod gate;
pub mod manifest;
pub mod mutation;
pub mod number;
pub mod pack;
pub mod random;
pub mod record;
pub mod reference;
pub mod settings;
pub mod spec;
pub mod submission;
pub mod text;
pub mod vtk;
