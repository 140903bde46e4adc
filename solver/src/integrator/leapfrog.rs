//! The staggered leapfrog, whose velocities are half a step behind the rest.

use std::marker::PhantomData;

use nalgebra::Vector2;

use super::{Integrator, Memory, Stepped};
use crate::{
    engine::{Engine, each},
    numbers::Numbers,
    parallel,
    particle_data::Checkpoint,
    particles::{Rate, State},
    physics::{Particles, Physics},
};

/// Staggered leapfrog: vⁿ⁺½ = vⁿ⁻½ + dt a(xⁿ, ρⁿ, vⁿ⁻½), then with the **new** velocities
/// xⁿ⁺¹ = xⁿ + dt vⁿ⁺½, ρⁿ⁺¹ = ρⁿ + dt D(xⁿ + dt/2 vⁿ⁺½, vⁿ⁺½).
///
/// The drift D is summed at the midpoint: with D(xⁿ, vⁿ⁺½) the density would be of first order in dt and
/// not reversible in time, because D depends on the positions. Each of the two pair sweeps evaluates only
/// its own terms, so together they make one right-hand side. Sound is neither damped nor amplified up to
/// ω dt = 2. With both sums at the old velocity the scheme would be forward Euler for sound, and unstable
/// at every dt. `K` advances the velocities, by default [`ForwardKick`].
#[derive(Debug)]
pub struct Leapfrog<K = ForwardKick>(PhantomData<K>);

/// Advances the velocities of a [`Leapfrog`] at fixed positions and densities.
pub trait Kick<P: Physics>: 'static {
    /// Name of the leapfrog with this kick.
    const NAME: &'static str;
    /// Buffers in addition to the memory of the leapfrog; `()` for none.
    type Memory: Memory<P::Extra>;

    /// Advances the velocities of fluid particles, and then moves the particles with them.
    fn kick(
        engine: &mut Engine<P>,
        memory: &mut Self::Memory,
        state: &mut Particles<P>,
        times: KickTimes,
    ) -> Stepped;
}

/// The times of a [`Kick`].
#[derive(Clone, Copy, Debug)]
pub struct KickTimes {
    /// Time step of the velocities \[s\].
    pub velocity: f64,
    /// Time step of the positions, with the new velocities \[s\].
    pub position: f64,
}

/// v + dt a(v): forces that depend on the velocity use the velocity of half a step earlier; first order in
/// dt.
#[derive(Debug)]
pub struct ForwardKick;

impl<P: Physics> Kick<P> for ForwardKick {
    const NAME: &'static str = "leapfrog";
    type Memory = ();

    fn kick(
        engine: &mut Engine<P>,
        (): &mut (),
        state: &mut Particles<P>,
        times: KickTimes,
    ) -> Stepped {
        engine.sweep_forces(state, &each(kick(times)));
        Ok(())
    }
}

fn kick<X: Numbers>(times: KickTimes) -> impl Fn(usize, &mut State<X>, &Rate<X>) + Sync {
    move |_, evolved: &mut State<X>, rate: &Rate<X>| {
        evolved.kick(times.velocity, rate);
        evolved.position += evolved.velocity * times.position;
    }
}

/// Advances all but the velocity by dt; the first `fluid` particles, which move, from the middle of this
/// time.
fn drift<X: Numbers>(dt: f64, fluid: usize) -> impl Fn(usize, &mut State<X>, &Rate<X>) + Sync {
    move |i, evolved: &mut State<X>, rate: &Rate<X>| {
        evolved.drift(dt, rate);
        if i < fluid {
            evolved.position -= evolved.velocity * (0.5 * dt);
        }
    }
}

/// Velocities that are behind the other quantities.
#[derive(Default)]
pub struct Staggered {
    /// The lag \[s\]; 0 before the first step.
    pub(super) lag: f64,
    /// Velocities of the fluid before synchronisation, held until the next step \[m/s\].
    held: Vec<Vector2<f64>>,
}

impl Staggered {
    /// Gives the state back the velocities that were held, if any were.
    pub(super) fn release<X: Numbers>(&mut self, state: &mut [State<X>], parallel: bool) {
        parallel::for_each_pair(state, &self.held, parallel, &|evolved, velocity| {
            evolved.velocity = *velocity;
        });
        self.held.clear();
    }

    /// The lag of velocities that are not synchronised yet \[s\], which are held from now on.
    pub(super) fn hold<X: Numbers>(&mut self, fluid: &[State<X>], parallel: bool) -> KickTimes {
        self.held.resize(fluid.len(), Vector2::zeros());
        parallel::for_each_pair(&mut self.held, fluid, parallel, &|velocity, evolved| {
            *velocity = evolved.velocity;
        });
        KickTimes { velocity: self.lag, position: 0.0 }
    }

    /// Whether velocities are behind.
    pub(super) fn is_behind(&self) -> bool {
        self.lag != 0.0 && self.held.is_empty()
    }
}

impl<X: Numbers> Memory<X> for Staggered {
    fn save(&self, to: &mut Checkpoint<X>) {
        to.lag = self.lag;
        for ((_, particle), velocity) in to.particles.iter_mut().zip(&self.held) {
            particle.velocity = *velocity;
        }
    }

    fn at(from: &Checkpoint<X>) -> Result<Self, &'static str> {
        Ok(Self { lag: from.lag, held: Vec::new() })
    }

    fn bytes(&self) -> usize {
        self.held.capacity() * size_of::<Vector2<f64>>()
    }
}

impl<P: Physics, K: Kick<P>> Integrator<P> for Leapfrog<K> {
    const NAME: &'static str = K::NAME;
    type Memory = (Staggered, K::Memory);

    fn step(
        engine: &mut Engine<P>,
        memory: &mut Self::Memory,
        state: &mut Particles<P>,
        dt: f64,
    ) -> Stepped {
        let (staggered, kick) = memory;
        staggered.release(state, engine.parallel());
        engine.begin(state)?;
        let half = 0.5 * dt;
        K::kick(engine, kick, state, KickTimes { velocity: staggered.lag + half, position: half })?;
        engine.refresh(state)?;
        // Wall particles have a velocity too, but do not move.
        let update = drift(dt, engine.data.fluid_count());
        engine.sweep_drift(state, &each(update));
        staggered.lag = half;
        Ok(())
    }

    fn synchronise(
        engine: &mut Engine<P>,
        memory: &mut Self::Memory,
        state: &mut Particles<P>,
    ) -> Stepped {
        let (staggered, kick) = memory;
        if staggered.is_behind() {
            engine.begin(state)?;
            let fluid = &state[..engine.data.fluid_count()];
            let times = staggered.hold(fluid, engine.parallel());
            K::kick(engine, kick, state, times)?;
        }
        engine.begin(state)
    }

    fn rates(engine: &Engine<P>) -> Vec<Rate<P::Extra>> {
        engine.rates_in_two_sweeps()
    }
}
