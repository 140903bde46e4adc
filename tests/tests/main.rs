//! Properties that cross the crates, as one program: a scheme that several of them use is compiled once.

mod channel_bounds;
mod comparisons;
mod consistent;
mod cost;
mod damaged;
/// Here and not in the library of this crate, so that its schemes are compiled once, with the schemes of
/// tests.
#[path = "../src/new_case.rs"]
mod decay;
mod documents;
mod extremes;
mod foreign_solver;
mod frozen_lattice;
mod identities;
mod integration;
mod invariance;
mod layers;
mod limits;
mod new_case;
mod pairs;
mod plans;
mod restart;
mod row_matrix;
mod shifting;
mod snapshots;
mod solid;
mod symmetry;
mod threads;
mod tidy;
mod walls;
