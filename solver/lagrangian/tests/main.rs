//! Properties of the total Lagrangian solid, in one program: shared code is compiled once.

mod common;
mod exactness;
mod lattice;
