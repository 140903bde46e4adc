//! Properties of the total Lagrangian solid.

mod common;
mod exactness;
mod lattice;
