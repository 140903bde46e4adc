//! Super-time-stepping: a leapfrog whose steps are longer than the explicit limit of its stiff force.

use std::mem::swap;

use nalgebra::Vector2;

use crate::{
    engine::Engine,
    integrator::{Kick, Stepped},
    particles::{Evolved, Rate},
    physics::{Physics, State},
    terms::{Split, Term},
};

/// Makes [`crate::Leapfrog`] advance the velocities with the stiff force of [`Split`] integrated by the
/// Runge-Kutta-Legendre method of second order, RKL2 (Meyer, Balsara & Aslam 2014): vⁿ⁻½ is advanced over
/// dt by dv/dt = T(v) + E, where the other forces E are constant and the particles stay at xⁿ.
///
/// It is of second order in dt for the stiff force as well, and has no splitting error in a steady state. A
/// kick of s stages is stable up to (s² + s − 2)/4 steps of forward Euler, and no wave changes its sign
/// there. s is the least odd number, from 3 on, that allows the step (for an even s the stiffest wave would
/// not decay at the limit). So the stiff force limits no step, but costs s − 1 pair sweeps in addition to
/// the two of the leapfrog.
#[derive(Debug, Default)]
pub struct SuperSteps<X = ()> {
    /// dv/dt by all forces at the start of a kick, and v less its value there in two successive stages.
    stages: [Vec<Evolved<X>>; 3],
}

/// The number of stages of a step that is so many times as long as the explicit limit: at most 999, so that a
/// step beyond 249,749 limits is not stable instead of never ending.
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

impl<P, E, T> Kick<P> for SuperSteps<P::Extra>
where
    P: Physics<Forces = Split<E, T>>,
    E: Term<P::Extra>,
    T: Term<P::Extra>,
{
    const NAME: &'static str = "super-leapfrog";
    const ORDER: [u32; 2] = [2, 2];

    fn kick(&mut self, engine: &mut Engine<P>, state: &mut State<P>, dt: [f64; 2]) -> Stepped {
        let Split(_, stiff, limit) = engine.terms.0.clone();
        let count = stages(dt[0] / limit);
        let s = f64::from(count);
        let length = 4.0 * dt[0] / (s * s + s - 2.0);
        for stage in &mut self.stages {
            let at_rest = |e: &Evolved<_>| Evolved { velocity: Vector2::zeros(), ..*e };
            stage.clear();
            stage.extend(state.iter().map(at_rest));
        }
        let [start, older, newer] = &mut self.stages;
        engine.sweep_forces(start, |_, start, rate| start.velocity = rate.velocity);
        for (newer, start) in newer.iter_mut().zip(&*start) {
            newer.velocity = start.velocity * (weight(1) * length);
        }
        for j in 2..=count {
            let share = |back: u32| weight(j) / (weight(j - back) * f64::from(j));
            let (last, before) = (f64::from(2 * j - 1) * share(1), f64::from(j - 1) * share(2));
            engine.refresh_differences(newer)?;
            let update = |i: usize, older: &mut Evolved<_>, rate: &Rate<_>| {
                let rate = rate.velocity + start[i].velocity * weight(j - 1);
                let advanced = newer[i].velocity + rate * length;
                older.velocity = advanced * last - older.velocity * before;
            };
            engine.sweep_part(older, &stiff, |_, derived| derived.0.1, update);
            swap(older, newer);
        }
        let fluid = engine.data.fluid_count();
        for (evolved, difference) in state[..fluid].iter_mut().zip(&*newer) {
            evolved.velocity += difference.velocity;
            evolved.position += evolved.velocity * dt[1];
        }
        Ok(())
    }

    fn bytes(&self) -> usize {
        self.stages.iter().map(Vec::capacity).sum::<usize>() * size_of::<Evolved<P::Extra>>()
    }
}
