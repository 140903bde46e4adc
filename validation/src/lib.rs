//! touchstone: how wrong a particle method is, what being less wrong costs, and how far it can be
//! pushed before it breaks.
//!
//! This crate knows every case ([`cases`]) and assembles the page; what it stands on are crates of their
//! own, each of which knows only those before it: `base`, `report`, `maths`, `harness`, then the families of
//! cases `fluids`, `waters`, `solids` and `lattice`.

pub mod bench;
pub mod cases;
pub mod page;
pub mod studies;

pub use base::{files, gate, manifest, number, random, record, reference, settings, vtk};
pub use harness::{case, runner, suite};
pub use maths::{exact, geometry, metrics, theory};
pub use report;
