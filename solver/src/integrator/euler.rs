//! Forward Euler, for tests.

use super::{Integrator, Stepped, advance};
use crate::{
    engine::{Engine, each},
    physics::{Particles, Physics},
};

/// Forward Euler: yⁿ⁺¹ = yⁿ + dt f(yⁿ). Unstable for sound at every dt; used only in tests.
#[derive(Debug)]
pub struct Euler;

impl<P: Physics> Integrator<P> for Euler {
    const NAME: &'static str = "euler";
    type Memory = ();

    fn step(engine: &mut Engine<P>, (): &mut (), state: &mut Particles<P>, dt: f64) -> Stepped {
        engine.begin(state)?;
        engine.sweep_all(state, &each(advance(dt)));
        Ok(())
    }
}
