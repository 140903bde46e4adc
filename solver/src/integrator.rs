//! Time integration. A physics together with an integrator is a scheme.

use crate::{
    engine::Engine,
    kernel::Kernel,
    numbers::Numbers,
    particle_data::Fault,
    particles::{Evolved, Rate},
    physics::{Compose, Physics, State},
    terms::Term,
    walls::Walls,
};

/// Whether a step stayed within the bounds of its scene.
pub type Stepped = Result<(), Fault>;

/// An explicit time integration of (x, v, ρ) of the physics `P`. A value of the type holds memory that steps
/// use; what the next step needs of the ones before is in [`crate::ParticleData`].
pub trait Integrator<P: Physics>: Default + Send + Sync + 'static {
    /// Its name in settings and reports.
    const NAME: &'static str;
    /// Order in dt for forces that do not depend on the velocity, and for forces that do.
    const ORDER: [u32; 2];

    /// Advances the state by dt \[s\].
    fn step(&mut self, engine: &mut Engine<P>, state: &mut State<P>, dt: f64) -> Stepped;

    /// Brings every quantity to the same time, until the next step.
    fn synchronise(&mut self, _engine: &mut Engine<P>, _state: &mut State<P>) -> Stepped {
        Ok(())
    }

    /// Rates of each fluid particle in the state that was synchronised last, where dx/dt does not include v.
    /// They are computed by the same pair sweeps that a step uses.
    fn rates(engine: &Engine<P>) -> Vec<Rate<P::Extra>> {
        engine.rates_in_one_sweep()
    }

    /// Memory in addition to the state \[bytes\].
    fn bytes(&self) -> usize {
        0
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

/// The predictor-corrector of the paper, taken to be the explicit midpoint rule (inferred; the paper does
/// not specify it): y' = yⁿ + dt/2 f(yⁿ), yⁿ⁺¹ = yⁿ + dt f(y').
///
/// Two right-hand sides per step. Weakly unstable for undamped sound: the amplitude grows by a factor of
/// about 1 + (ω dt)⁴/8 per step.
#[derive(Debug, Default)]
pub struct PredictorCorrector<X = ()> {
    midpoint: Vec<Evolved<X>>,
}

impl<P: Physics> Integrator<P> for PredictorCorrector<P::Extra> {
    const NAME: &'static str = "predictor-corrector";
    const ORDER: [u32; 2] = [2, 2];

    fn step(&mut self, engine: &mut Engine<P>, state: &mut State<P>, dt: f64) -> Stepped {
        engine.begin(state)?;
        self.midpoint.clear();
        self.midpoint.extend_from_slice(state);
        engine.sweep_all(&mut self.midpoint, |_, half, rate| {
            *half = half.advanced(0.5 * dt, rate);
        });
        engine.refresh(&self.midpoint)?;
        engine.sweep_all(state, |_, evolved, rate| *evolved = evolved.advanced(dt, rate));
        Ok(())
    }

    fn bytes(&self) -> usize {
        self.midpoint.capacity() * size_of::<Evolved<P::Extra>>()
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
#[derive(Debug, Default)]
pub struct Leapfrog<K = ForwardKick> {
    kick: K,
}

/// How a [`Leapfrog`] advances velocities while positions and densities stay as they are.
pub trait Kick<P: Physics>: Default + Send + Sync + 'static {
    /// Name of the leapfrog that has it.
    const NAME: &'static str;
    /// Order in dt of that leapfrog, as [`Integrator::ORDER`].
    const ORDER: [u32; 2];

    /// Advances the velocities of fluid particles by the first of these times \[s\], and then moves the
    /// particles with them for the second.
    fn kick(&mut self, engine: &mut Engine<P>, state: &mut State<P>, dt: [f64; 2]) -> Stepped;

    /// Memory that it holds \[bytes\].
    fn bytes(&self) -> usize {
        0
    }
}

/// v + dt a(v): forces that depend on the velocity use that of half a step earlier, first order in dt.
#[derive(Debug, Default)]
pub struct ForwardKick;

impl<P: Physics> Kick<P> for ForwardKick {
    const NAME: &'static str = "leapfrog";
    const ORDER: [u32; 2] = [2, 1];

    fn kick(&mut self, engine: &mut Engine<P>, state: &mut State<P>, dt: [f64; 2]) -> Stepped {
        engine.sweep_forces(state, |_, evolved, rate| {
            evolved.kick(dt[0], rate);
            evolved.position += evolved.velocity * dt[1];
        });
        Ok(())
    }
}

impl<P: Physics, K: Kick<P>> Integrator<P> for Leapfrog<K> {
    const NAME: &'static str = K::NAME;
    const ORDER: [u32; 2] = K::ORDER;

    fn step(&mut self, engine: &mut Engine<P>, state: &mut State<P>, dt: f64) -> Stepped {
        engine.data.stagger(state);
        engine.begin(state)?;
        let (lag, half) = (engine.data.lag, 0.5 * dt);
        self.kick.kick(engine, state, [lag + half, half])?;
        engine.refresh(state)?;
        // Wall particles have a velocity too, but do not move.
        let fluid = engine.data.fluid_count();
        engine.sweep_drift(state, |i, evolved, rate| {
            evolved.drift(dt, rate);
            if i < fluid {
                evolved.position -= evolved.velocity * half;
            }
        });
        engine.data.lag = half;
        Ok(())
    }

    fn synchronise(&mut self, engine: &mut Engine<P>, state: &mut State<P>) -> Stepped {
        if engine.data.is_staggered() {
            engine.begin(state)?;
            engine.data.hold(state);
            self.kick.kick(engine, state, [engine.data.lag, 0.0])?;
        }
        Ok(())
    }

    fn rates(engine: &Engine<P>) -> Vec<Rate<P::Extra>> {
        engine.rates_in_two_sweeps()
    }

    fn bytes(&self) -> usize {
        self.kick.bytes()
    }
}

/// Forward Euler: yⁿ⁺¹ = yⁿ + dt f(yⁿ). Unstable for sound at every dt; used only in tests.
#[derive(Clone, Copy, Debug, Default)]
pub struct Euler;

impl<P: Physics> Integrator<P> for Euler {
    const NAME: &'static str = "euler";
    const ORDER: [u32; 2] = [1, 1];

    fn step(&mut self, engine: &mut Engine<P>, state: &mut State<P>, dt: f64) -> Stepped {
        engine.begin(state)?;
        engine.sweep_all(state, |_, evolved, rate| *evolved = evolved.advanced(dt, rate));
        Ok(())
    }
}
