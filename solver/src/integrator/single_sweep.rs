//! One pair sweep a step, with an extrapolated density.

use super::{
    Integrator, Memory, Stepped,
    leapfrog::{ForwardKick, Kick, Staggered},
};
use crate::{
    engine::{Engine, each},
    numbers::Numbers,
    parallel,
    particle_data::{Checkpoint, PreviousStep},
    particles::{Rate, State},
    physics::{Particles, Physics},
};

/// Forces a and drift D from one pair sweep at (xⁿ, vⁿ⁻½, ρ̃ⁿ):
///
/// ρⁿ = ρⁿ⁻¹ + dt Dⁿ, ρ̃ⁿ⁺¹ = ρⁿ + dt (2 Dⁿ − Dⁿ⁻¹), vⁿ⁺½ = vⁿ⁻½ + dt a, xⁿ⁺¹ = xⁿ + dt vⁿ⁺½,
///
/// and for the extra fields as for the density. The density ρ̃, on which forces depend, is extrapolated,
/// because the drift of a step is known only after the sweep of the next one. ρ̃ is replaced at the end of
/// each step, so errors of extrapolation do not accumulate.
///
/// A step costs about 0.7 of a step of [`super::Leapfrog`], which sweeps twice. The limit of viscous forces
/// is equal; the limit of sound is about a third: stable up to ω dt = 1/√2, where the leapfrog is stable up
/// to 2. Below the limit sound is damped by (ω dt)⁴/2 a step. First order in dt, because the positions of Dⁿ
/// are half a step later than its velocities.
#[derive(Debug)]
pub struct SingleSweep;

/// One entry for each particle with rates, in the order of storage; empty before the first step.
impl<X: Numbers> Memory<X> for Vec<PreviousStep<X>> {
    fn save(&self, to: &mut Checkpoint<X>) {
        to.past.clone_from(self);
    }

    fn at(from: &Checkpoint<X>) -> Result<Self, &'static str> {
        let is_whole = from.past.is_empty() == (from.lag == 0.0);
        if is_whole { Ok(from.past.clone()) } else { Err("memory of another integrator") }
    }

    fn bytes(&self) -> usize {
        self.capacity() * size_of::<PreviousStep<X>>()
    }
}

impl<P: Physics> Integrator<P> for SingleSweep {
    const NAME: &'static str = "single-sweep";
    type Memory = (Staggered, Vec<PreviousStep<P::Extra>>);

    fn step(
        engine: &mut Engine<P>,
        memory: &mut Self::Memory,
        state: &mut Particles<P>,
        dt: f64,
    ) -> Stepped {
        let (staggered, past) = memory;
        staggered.release(state, engine.parallel());
        engine.begin_with(state, past)?;
        let (half, fluid) = (0.5 * dt, engine.data.fluid_count());
        let (kick, known) = (staggered.lag + half, 2.0 * staggered.lag);
        if known == 0.0 {
            let start = |e: &State<P::Extra>| PreviousStep {
                drifted: (e.density, e.extra),
                rate: Default::default(),
            };
            past.clear();
            past.extend(state[..engine.swept()].iter().map(start));
        }
        let update = |i: usize, evolved: &mut State<_>, rate: &Rate<_>| {
            if i < fluid {
                // dx/dt beyond v: the sweep has added the velocity before the kick.
                let shift = rate.position - evolved.velocity;
                evolved.kick(kick, rate);
                evolved.position += (evolved.velocity + shift) * dt;
            }
            (evolved.density, evolved.extra) = (rate.density, rate.extra);
        };
        engine.sweep_all(state, &each(update));
        // The rate belongs to the middle of the last step and is extrapolated to the middle of this one.
        let ahead = if known > 0.0 { kick / known } else { 0.0 };
        parallel::for_each_two(state, past, engine.parallel(), &|evolved, past| {
            let rate = (evolved.density, evolved.extra);
            past.drifted = past.drifted.advanced(known, rate);
            let next = past.drifted.advanced(dt * (1.0 + ahead), rate);
            (evolved.density, evolved.extra) = next.advanced(-dt * ahead, past.rate);
            past.rate = rate;
        });
        staggered.lag = half;
        Ok(())
    }

    fn synchronise(
        engine: &mut Engine<P>,
        memory: &mut Self::Memory,
        state: &mut Particles<P>,
    ) -> Stepped {
        let (staggered, past) = memory;
        if staggered.is_behind() {
            engine.begin_with(state, past)?;
            let fluid = &state[..engine.data.fluid_count()];
            let times = staggered.hold(fluid, engine.parallel());
            ForwardKick::kick(engine, &mut (), state, times)?;
        }
        engine.begin_with(state, past)
    }
}
