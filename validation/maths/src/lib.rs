//! Exact solutions of the equations, theory of the *discretised* equations, norms between them and a
//! run, and where particles of walls stand.

pub mod exact;
pub mod geometry;
pub mod metrics;
pub mod theory;
