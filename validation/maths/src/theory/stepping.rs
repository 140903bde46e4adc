//! Which theory of the time step belongs to which integrator.

use solver::{Euler, Leapfrog, PredictorCorrector, SingleSweep, SuperSteps};

use super::time_step::Integrator as Theory;

/// An integrator that has a theory of its time step.
pub trait Stepping {
    /// Which theory.
    const THEORY: Theory;
}

impl<X> Stepping for PredictorCorrector<X> {
    const THEORY: Theory = Theory::PredictorCorrector;
}

impl Stepping for Leapfrog {
    const THEORY: Theory = Theory::Leapfrog;
}

impl<X> Stepping for Leapfrog<SuperSteps<X>> {
    const THEORY: Theory = Theory::SuperLeapfrog;
}

impl Stepping for SingleSweep {
    const THEORY: Theory = Theory::SingleSweep;
}

impl Stepping for Euler {
    const THEORY: Theory = Theory::Euler;
}
