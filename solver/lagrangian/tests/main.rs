//! Properties of the total Lagrangian solid, as one program: what several of them use is compiled once.

mod common;
mod exactness;
mod lattice;
