//! Which theory of the time step belongs to which integrator.

use solver::{Euler, Integrator, Leapfrog, Numbers, PredictorCorrector};

use super::time_step::Integrator as Theory;

/// An integrator and the theory of its time step.
pub trait Stepping<X: Numbers = ()>: Integrator<X> {
    /// Which theory.
    const THEORY: Theory;
}

impl<X: Numbers> Stepping<X> for PredictorCorrector<X> {
    const THEORY: Theory = Theory::PredictorCorrector;
}

impl<X: Numbers> Stepping<X> for Leapfrog {
    const THEORY: Theory = Theory::Leapfrog;
}

impl<X: Numbers> Stepping<X> for Euler {
    const THEORY: Theory = Theory::Euler;
}
