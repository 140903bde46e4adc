//! The names that nearly every case needs: `use touchstone_harness::prelude::*;`. Other names are imported
//! one by one.

pub use touchstone_base::{
    gate::{Bound, Evidence, Gate},
    record::{ColumnKey, Record},
};
pub use touchstone_solver::{Domain, Particle, Stepper};

pub use crate::{
    case::{Recommended, Rules, RunError, Tier},
    composed::{Composed, Compositions, RunGates, Variants},
    facts::Facts,
    method::{Medium, Method, Parts},
    problem::{Brief, Calls, OptionalOutput, Problem},
    study::Studies,
};
