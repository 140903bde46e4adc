//! Time integration. A physics together with an integrator is a scheme.

use std::marker::PhantomData;
use std::mem::{swap, take};

use nalgebra::Vector2;

use crate::{
    engine::{Engine, Update, each},
    kernel::Kernel,
    numbers::Numbers,
    particle_data::{Fault, Past},
    particles::{Evolved, Rate},
    physics::{Compose, Physics, State},
    terms::{Split, Term},
    walls::Walls,
};

/// Whether a step stayed within the bounds of its scene.
pub type Stepped = Result<(), Fault>;

/// An explicit time integration of (x, v, ρ) of the physics `P`. What the next step needs of the ones before,
/// and memory that steps use, is in [`crate::ParticleData`].
pub trait Integrator<P: Physics>: 'static {
    /// Its name in settings and reports.
    const NAME: &'static str;

    /// Advances the state by dt \[s\].
    fn step(engine: &mut Engine<P>, state: &mut State<P>, dt: f64) -> Stepped;

    /// Brings every quantity to the same time, until the next step.
    fn synchronise(_engine: &mut Engine<P>, _state: &mut State<P>) -> Stepped {
        Ok(())
    }

    /// Rates of each fluid particle in the state that was synchronised last, where dx/dt does not include v.
    /// They are computed by the same pair sweeps that a step uses.
    fn rates(engine: &Engine<P>) -> Vec<Rate<P::Extra>> {
        engine.rates_in_one_sweep()
    }
}

/// A physics with its time integration: the complete method. [`Compose`] names one in a line of types.
pub trait Scheme: Physics {
    /// Time integration.
    type Integrator: Integrator<PhysicsOf<Self>>;
}

impl<K: Kernel, F: Term<X>, D: Term<X>, W: Walls<X>, I, X: Numbers> Scheme
    for Compose<K, F, D, W, I, X>
where
    I: Integrator<Compose<K, F, D, W, (), X>>,
{
    type Integrator = I;
}

/// The physics of the scheme `S`, the same type for all schemes that differ only in their integrator.
pub type PhysicsOf<S> = Compose<
    <S as Physics>::Kernel,
    <S as Physics>::Forces,
    <S as Physics>::Drift,
    <S as Physics>::Walls,
    (),
    <S as Physics>::Extra,
>;

// What becomes of particles: compiled once for all schemes, for no closure below is one of a scheme.

/// All of them advanced by dt.
fn advance<X: Numbers>(dt: f64) -> impl Update<X> {
    move |_, evolved: &mut Evolved<X>, rate: &Rate<X>| *evolved = evolved.advanced(dt, rate)
}

/// Velocities advanced by the first of these times, and places with them by the second.
fn kick<X: Numbers>(dt: [f64; 2]) -> impl Update<X> {
    move |_, evolved: &mut Evolved<X>, rate: &Rate<X>| {
        evolved.kick(dt[0], rate);
        evolved.position += evolved.velocity * dt[1];
    }
}

/// All but velocities advanced by dt, from the middle of this time for the first so many, which move.
fn drift<X: Numbers>(dt: f64, fluid: usize) -> impl Update<X> {
    move |i, evolved: &mut Evolved<X>, rate: &Rate<X>| {
        evolved.drift(dt, rate);
        if i < fluid {
            evolved.position -= evolved.velocity * (0.5 * dt);
        }
    }
}

/// The predictor-corrector of the paper, taken to be the explicit midpoint rule (inferred; the paper does
/// not specify it): y' = yⁿ + dt/2 f(yⁿ), yⁿ⁺¹ = yⁿ + dt f(y'). Of second order in dt.
///
/// Two right-hand sides per step. Weakly unstable for undamped sound: the amplitude grows by a factor of
/// about 1 + (ω dt)⁴/8 per step.
#[derive(Debug)]
pub struct PredictorCorrector;

impl<P: Physics> Integrator<P> for PredictorCorrector {
    const NAME: &'static str = "predictor-corrector";

    fn step(engine: &mut Engine<P>, state: &mut State<P>, dt: f64) -> Stepped {
        engine.begin(state)?;
        let mut midpoint = take(&mut engine.data.stages[0]);
        midpoint.clear();
        midpoint.extend_from_slice(state);
        engine.sweep_all(&mut midpoint, &each(advance(0.5 * dt)));
        let refreshed = engine.refresh(&midpoint);
        engine.data.stages[0] = midpoint;
        refreshed?;
        engine.sweep_all(state, &each(advance(dt)));
        Ok(())
    }
}

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

/// How a [`Leapfrog`] advances velocities while positions and densities stay as they are.
pub trait Kick<P: Physics>: 'static {
    /// Name of the leapfrog that has it.
    const NAME: &'static str;

    /// Advances the velocities of fluid particles by the first of these times \[s\], and then moves the
    /// particles with them for the second.
    fn kick(engine: &mut Engine<P>, state: &mut State<P>, dt: [f64; 2]) -> Stepped;
}

/// v + dt a(v): forces that depend on the velocity use that of half a step earlier, first order in dt.
#[derive(Debug)]
pub struct ForwardKick;

impl<P: Physics> Kick<P> for ForwardKick {
    const NAME: &'static str = "leapfrog";

    fn kick(engine: &mut Engine<P>, state: &mut State<P>, dt: [f64; 2]) -> Stepped {
        engine.sweep_forces(state, &each(kick(dt)));
        Ok(())
    }
}

impl<P: Physics, K: Kick<P>> Integrator<P> for Leapfrog<K> {
    const NAME: &'static str = K::NAME;

    fn step(engine: &mut Engine<P>, state: &mut State<P>, dt: f64) -> Stepped {
        engine.data.stagger(state);
        engine.begin(state)?;
        let (lag, half) = (engine.data.lag, 0.5 * dt);
        K::kick(engine, state, [lag + half, half])?;
        engine.refresh(state)?;
        // Wall particles have a velocity too, but do not move.
        let update = drift(dt, engine.data.fluid_count());
        engine.sweep_drift(state, &each(update));
        engine.data.lag = half;
        Ok(())
    }

    fn synchronise(engine: &mut Engine<P>, state: &mut State<P>) -> Stepped {
        if engine.data.is_staggered() {
            engine.begin(state)?;
            engine.data.hold(state);
            K::kick(engine, state, [engine.data.lag, 0.0])?;
        }
        Ok(())
    }

    fn rates(engine: &Engine<P>) -> Vec<Rate<P::Extra>> {
        engine.rates_in_two_sweeps()
    }
}

/// Makes [`Leapfrog`] advance the velocities with the stiff force of [`Split`] integrated by the
/// Runge-Kutta-Legendre method of second order, RKL2 (Meyer, Balsara & Aslam 2014): vⁿ⁻½ is advanced over
/// dt by dv/dt = T(v) + E, where the other forces E are constant and the particles stay at xⁿ.
///
/// It is of second order in dt for the stiff force as well, and has no splitting error in a steady state. A
/// kick of s stages is stable up to (s² + s − 2)/4 steps of forward Euler, and no wave changes its sign
/// there. s is the least odd number, from 3 on, that allows the step (for an even s the stiffest wave would
/// not decay at the limit). So the stiff force limits no step, but costs s − 1 pair sweeps in addition to
/// the two of the leapfrog.
#[derive(Debug)]
pub struct SuperSteps;

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

impl<P: Physics<Forces = Split<E, T>>, E: Term<P::Extra>, T: Term<P::Extra>> Kick<P>
    for SuperSteps
{
    const NAME: &'static str = "super-leapfrog";

    fn kick(engine: &mut Engine<P>, state: &mut State<P>, dt: [f64; 2]) -> Stepped {
        const { assert!(!T::NORMALISES, "moments are not summed for a part") };
        let Split(_, stiff, limit) = engine.typed.terms.0.clone();
        let count = stages(dt[0] / limit);
        let s = f64::from(count);
        let length = 4.0 * dt[0] / (s * s + s - 2.0);
        let mut stages = take(&mut engine.data.stages);
        for stage in &mut stages {
            stage.clear();
            stage.extend_from_slice(state);
            stage.iter_mut().for_each(|evolved| evolved.velocity = Vector2::zeros());
        }
        // dv/dt by all forces, and v less its value at the start in two successive stages.
        let [start, older, newer] = &mut stages;
        let take = |_, start: &mut Evolved<_>, rate: &Rate<_>| start.velocity = rate.velocity;
        engine.sweep_forces(start, &each(take));
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
            engine.sweep_part(older, &stiff, |_, derived| derived.0.1, &each(update));
            swap(older, newer);
        }
        let fluid = engine.data.fluid_count();
        for (evolved, difference) in state[..fluid].iter_mut().zip(&*newer) {
            evolved.velocity += difference.velocity;
            evolved.position += evolved.velocity * dt[1];
        }
        engine.data.stages = stages;
        Ok(())
    }
}

/// Forces and drift from one pair sweep at (xⁿ, vⁿ⁻½, ρ̃ⁿ): with a the forces and D the drift of it,
///
/// ρⁿ = ρⁿ⁻¹ + dt Dⁿ, ρ̃ⁿ⁺¹ = ρⁿ + dt (2 Dⁿ − Dⁿ⁻¹), vⁿ⁺½ = vⁿ⁻½ + dt a, xⁿ⁺¹ = xⁿ + dt vⁿ⁺½,
///
/// and the same for what terms integrate of their own. The density ρ̃ from which forces follow is
/// extrapolated, because the drift of a step becomes known only in the sweep of the next one. At the end of a
/// step it is replaced, so that no error of extrapolation accumulates.
///
/// A step costs about 0.7 of that of [`Leapfrog`], which sweeps twice. Viscous forces have the same
/// limit. Sound has about a third of it: stable up to ω dt = 1/√2, where the leapfrog is up to 2; below, it
/// is damped by (ω dt)⁴/2 a step. Of first order in dt, because Dⁿ has positions half a step later than its
/// velocities.
#[derive(Debug)]
pub struct SingleSweep;

impl<P: Physics> Integrator<P> for SingleSweep {
    const NAME: &'static str = "single-sweep";

    fn step(engine: &mut Engine<P>, state: &mut State<P>, dt: f64) -> Stepped {
        engine.data.stagger(state);
        engine.begin(state)?;
        let (lag, half, fluid) = (engine.data.lag, 0.5 * dt, engine.data.fluid_count());
        let (kick, known) = (lag + half, 2.0 * lag);
        if known == 0.0 {
            let start = |e: &Evolved<P::Extra>| Past {
                drifted: (e.density, e.extra),
                rate: Default::default(),
            };
            let swept = engine.swept();
            engine.data.past.clear();
            engine.data.past.extend(state[..swept].iter().map(start));
        }
        let update = |i: usize, evolved: &mut Evolved<_>, rate: &Rate<_>| {
            if i < fluid {
                // Beyond v, which the sweep has added as it was before.
                let shift = rate.position - evolved.velocity;
                evolved.kick(kick, rate);
                evolved.position += (evolved.velocity + shift) * dt;
            }
            (evolved.density, evolved.extra) = (rate.density, rate.extra);
        };
        engine.sweep_all(state, &each(update));
        // A rate is that of the middle of the last step; it is extrapolated to the middle of this one.
        let ahead = if known > 0.0 { kick / known } else { 0.0 };
        for (evolved, past) in state.iter_mut().zip(&mut engine.data.past) {
            let rate = (evolved.density, evolved.extra);
            past.drifted = past.drifted.advanced(known, rate);
            let next = past.drifted.advanced(dt * (1.0 + ahead), rate);
            (evolved.density, evolved.extra) = next.advanced(-dt * ahead, past.rate);
            past.rate = rate;
        }
        engine.data.lag = half;
        Ok(())
    }

    fn synchronise(engine: &mut Engine<P>, state: &mut State<P>) -> Stepped {
        <Leapfrog as Integrator<P>>::synchronise(engine, state)
    }
}

/// Forward Euler: yⁿ⁺¹ = yⁿ + dt f(yⁿ). Unstable for sound at every dt; used only in tests.
#[derive(Debug)]
pub struct Euler;

impl<P: Physics> Integrator<P> for Euler {
    const NAME: &'static str = "euler";

    fn step(engine: &mut Engine<P>, state: &mut State<P>, dt: f64) -> Stepped {
        engine.begin(state)?;
        engine.sweep_all(state, &each(advance(dt)));
        Ok(())
    }
}
