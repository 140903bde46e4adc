//! The explicit midpoint rule.

use super::{Integrator, Stepped, advance};
use crate::{
    engine::{Engine, each},
    parallel,
    particles::State,
    physics::{Particles, Physics},
};

/// The predictor-corrector of the paper, taken to be the explicit midpoint rule (inferred; the paper does
/// not specify it): y' = yⁿ + dt/2 f(yⁿ), yⁿ⁺¹ = yⁿ + dt f(y'). Of second order in dt.
///
/// Two right-hand sides per step. Weakly unstable for undamped sound: the amplitude grows by a factor of
/// about 1 + (ω dt)⁴/8 per step.
#[derive(Debug)]
pub struct PredictorCorrector;

impl<P: Physics> Integrator<P> for PredictorCorrector {
    const NAME: &'static str = "predictor-corrector";
    /// The state in the middle of a step.
    type Memory = Vec<State<P::Extra>>;

    fn step(
        engine: &mut Engine<P>,
        midpoint: &mut Self::Memory,
        state: &mut Particles<P>,
        dt: f64,
    ) -> Stepped {
        engine.begin(state)?;
        parallel::copy(state, midpoint, engine.parallel());
        engine.sweep_all(midpoint, &each(advance(0.5 * dt)));
        engine.refresh(midpoint)?;
        engine.sweep_all(state, &each(advance(dt)));
        Ok(())
    }
}
