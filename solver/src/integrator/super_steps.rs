//! A leapfrog whose stiff force limits no step.

use std::mem::swap;

use nalgebra::Vector2;

use super::{Kick, KickTimes, Memory, Stepped};
use crate::{
    engine::{Engine, each},
    numbers::Numbers,
    parallel,
    particles::{Rate, State},
    physics::{Particles, Physics},
    terms::{Split, Term},
};

/// Makes [`super::Leapfrog`] advance the velocities with the stiff force of [`Split`] integrated by the
/// Runge-Kutta-Legendre method of second order, RKL2 (Meyer, Balsara & Aslam 2014): vⁿ⁻½ is advanced over
/// dt by dv/dt = T(v) + E, where the other forces E are constant and the particles stay at xⁿ.
///
/// The order in dt is two for the stiff force as well, and a steady state has no splitting error. A
/// kick of s stages is stable up to (s² + s − 2)/4 steps of forward Euler, and no wave changes its sign
/// there. s is the least odd number, from 3 on, that allows the step (for an even s the stiffest wave would
/// not decay at the limit). So the stiff force limits no step, but costs s − 1 pair sweeps in addition to
/// the two of the leapfrog.
#[derive(Debug)]
pub struct SuperSteps;

/// The number of stages for a step of `ratio` times the explicit limit: at most 999, so that a step beyond
/// 249,749 limits is not stable instead of never ending.
pub fn stages(ratio: f64) -> u32 {
    let least = 0.5 * ((9.0 + 16.0 * ratio).sqrt() - 1.0);
    // A rounding error must not add two stages.
    (least * (1.0 - 1e-12)).ceil().clamp(3.0, 999.0) as u32 | 1
}

/// b of stage j.
fn weight(j: u32) -> f64 {
    let j = f64::from(j.max(2));
    0.5 * (j * j + j - 2.0) / (j * j + j)
}

/// States of the kick under way. Of a stage only the velocities change.
#[derive(Default)]
pub struct Stages<X> {
    /// dv/dt by all forces at the start of the kick, in the place of v.
    start: Vec<State<X>>,
    /// v minus its value at the start, in the last stage but one.
    older: Vec<State<X>>,
    /// v minus its value at the start, in the last stage.
    newer: Vec<State<X>>,
}

impl<X: Numbers> Memory<X> for Stages<X> {
    fn bytes(&self) -> usize {
        [&self.start, &self.older, &self.newer].into_iter().map(Memory::<X>::bytes).sum()
    }
}

impl<P: Physics<Forces = Split<E, T>>, E: Term<P::Extra>, T: Term<P::Extra>> Kick<P>
    for SuperSteps
{
    const NAME: &'static str = "super-leapfrog";
    type Memory = Stages<P::Extra>;

    fn kick(
        engine: &mut Engine<P>,
        stages: &mut Stages<P::Extra>,
        state: &mut Particles<P>,
        times: KickTimes,
    ) -> Stepped {
        const { assert!(!T::NORMALISES && !T::DIVERGES, "no sums are formed before a part") };
        let Split(_, stiff, limit) = engine.equations.terms.0.clone();
        let count = super::stages(times.velocity / limit);
        let s = f64::from(count);
        let length = 4.0 * times.velocity / (s * s + s - 2.0);
        let (Stages { start, older, newer }, parallel) = (stages, engine.parallel());
        for stage in [&mut *start, older, newer] {
            parallel::copy(state, stage, parallel);
            parallel::for_each_part(stage, parallel, &|_, part| {
                part.iter_mut().for_each(|evolved| evolved.velocity = Vector2::zeros());
            });
        }
        let take = |_, start: &mut State<_>, rate: &Rate<_>| start.velocity = rate.velocity;
        engine.sweep_forces(start, &each(take));
        parallel::for_each_pair(newer, start, parallel, &|newer, start| {
            newer.velocity = start.velocity * (weight(1) * length);
        });
        for j in 2..=count {
            let share = |back: u32| weight(j) / (weight(j - back) * f64::from(j));
            let (last, before) = (f64::from(2 * j - 1) * share(1), f64::from(j - 1) * share(2));
            engine.refresh_differences(newer)?;
            let update = |i: usize, older: &mut State<_>, rate: &Rate<_>| {
                let rate = rate.velocity + start[i].velocity * weight(j - 1);
                let advanced = newer[i].velocity + rate * length;
                older.velocity = advanced * last - older.velocity * before;
            };
            engine.sweep_part(older, &stiff, |((_, stiff), _)| *stiff, &each(update));
            swap(older, newer);
        }
        let fluid = &mut state[..engine.data.fluid_count()];
        parallel::for_each_pair(fluid, newer, parallel, &|evolved, difference| {
            evolved.velocity += difference.velocity;
            evolved.position += evolved.velocity * times.position;
        });
        Ok(())
    }
}
