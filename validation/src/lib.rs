//! touchstone: how wrong a particle method is, what being less wrong costs, and how far it can be
//! pushed before it breaks.
//!
//! [`cases`] are the benchmarks; [`suite`] runs and judges them; [`studies`] turn many runs into
//! statements. [`geometry`] says where particles of walls stand. [`exact`] holds solutions of the
//! equations, [`theory`] solutions of the *discretised* equations (which a correct program must
//! reproduce to round-off), [`metrics`] the distance between them and a run. [`record`],
//! [`mod@reference`] and [`mod@report`] are what goes in and comes out.

pub mod bench;
pub mod case;
pub mod cases;
pub mod exact;
pub mod files;
pub mod gate;
pub mod geometry;
pub mod manifest;
pub mod metrics;
pub mod number;
pub mod random;
pub mod record;
pub mod reference;
pub mod report;
pub mod runner;
pub mod settings;
pub mod studies;
pub mod suite;
pub mod theory;
pub mod vtk;
