//! Time integration. A physics together with an integrator is a scheme.

use crate::{
    engine::Engine,
    numbers::Numbers,
    particle_data::Fault,
    particles::{Evolved, Rate},
    physics::{Compose, Physics},
};

/// An explicit time integration of (x, v, ρ). A value of the type holds what is needed from step to step.
pub trait Integrator<X: Numbers>: Default + Send + Sync + 'static {
    /// Its name in settings and reports.
    const NAME: &'static str;
    /// Order in dt for forces that do not depend on the velocity, and for forces that do.
    const ORDER: [u32; 2];

    /// Advances the state by dt \[s\].
    fn step<P: Physics<Extra = X>>(
        &mut self,
        engine: &mut Engine<P>,
        state: &mut [Evolved<X>],
        dt: f64,
    ) -> Result<(), Fault>;

    /// Brings every quantity to the same time.
    fn synchronise<P: Physics<Extra = X>>(
        &mut self,
        _engine: &mut Engine<P>,
        _state: &mut [Evolved<X>],
    ) -> Result<(), Fault> {
        Ok(())
    }

    /// Rates of each fluid particle in the state that was synchronised last, where dx/dt does not include v.
    /// They are computed by the same pair sweeps that a step uses.
    fn rates<P: Physics<Extra = X>>(engine: &Engine<P>) -> Vec<Rate<X>> {
        engine.rates_in_one_sweep()
    }

    /// The time by which the velocities lag behind the other quantities \[s\]. Nothing else is kept between
    /// steps.
    fn lag(&self) -> f64 {
        0.0
    }

    /// An integrator with this lag \[s\].
    fn with_lag(_lag: f64) -> Self {
        Self::default()
    }

    /// Memory in addition to the state \[bytes\].
    fn bytes(&self) -> usize {
        0
    }
}

/// A physics with its time integration: the complete method. [`Compose`] names one in a line of types.
pub trait Scheme: Physics {
    /// Time integration.
    type Integrator: Integrator<Self::Extra>;
}

impl<K, F, D, W, I: Integrator<X>, X: Numbers> Scheme for Compose<K, F, D, W, I, X>
where
    Self: Physics<Extra = X>,
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

impl<X: Numbers> Integrator<X> for PredictorCorrector<X> {
    const NAME: &'static str = "predictor-corrector";
    const ORDER: [u32; 2] = [2, 2];

    fn step<P: Physics<Extra = X>>(
        &mut self,
        engine: &mut Engine<P>,
        state: &mut [Evolved<X>],
        dt: f64,
    ) -> Result<(), Fault> {
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
        self.midpoint.capacity() * size_of::<Evolved<X>>()
    }
}

/// Staggered leapfrog: vⁿ⁺½ = vⁿ⁻½ + dt a(xⁿ, ρⁿ, vⁿ⁻½), then with the **new** velocities
/// xⁿ⁺¹ = xⁿ + dt vⁿ⁺½, ρⁿ⁺¹ = ρⁿ + dt D(xⁿ + dt/2 vⁿ⁺½, vⁿ⁺½).
///
/// The drift D is summed at the midpoint: with D(xⁿ, vⁿ⁺½) the density would be of first order in dt and
/// not reversible in time, because D depends on the positions. Each of the two pair sweeps evaluates only
/// its own terms, so together they make one right-hand side. Sound is neither damped nor amplified up to
/// ω dt = 2. With both sums at the old velocity the scheme would be forward Euler for sound, and unstable
/// at every dt. Forces that depend on the velocity use that of half a step earlier: first order in dt.
#[derive(Debug, Default)]
pub struct Leapfrog {
    /// The time by which the velocities lag behind the positions \[s\].
    lag: f64,
}

impl<X: Numbers> Integrator<X> for Leapfrog {
    const NAME: &'static str = "leapfrog";
    const ORDER: [u32; 2] = [2, 1];

    fn step<P: Physics<Extra = X>>(
        &mut self,
        engine: &mut Engine<P>,
        state: &mut [Evolved<X>],
        dt: f64,
    ) -> Result<(), Fault> {
        engine.begin(state)?;
        let (kick, half) = (self.lag + 0.5 * dt, 0.5 * dt);
        engine.sweep_forces(state, |_, evolved, rate| {
            evolved.kick(kick, rate);
            evolved.position += evolved.velocity * half;
        });
        engine.refresh(state)?;
        // Wall particles have a velocity too, but do not move.
        let fluid = engine.data.fluid_count();
        engine.sweep_drift(state, |i, evolved, rate| {
            evolved.drift(dt, rate);
            if i < fluid {
                evolved.position -= evolved.velocity * half;
            }
        });
        self.lag = half;
        Ok(())
    }

    fn synchronise<P: Physics<Extra = X>>(
        &mut self,
        engine: &mut Engine<P>,
        state: &mut [Evolved<X>],
    ) -> Result<(), Fault> {
        if self.lag != 0.0 {
            let kick = self.lag;
            engine.begin(state)?;
            engine.sweep_forces(state, |_, evolved, rate| evolved.kick(kick, rate));
            self.lag = 0.0;
        }
        Ok(())
    }

    fn rates<P: Physics<Extra = X>>(engine: &Engine<P>) -> Vec<Rate<X>> {
        engine.rates_in_two_sweeps()
    }

    fn lag(&self) -> f64 {
        self.lag
    }

    fn with_lag(lag: f64) -> Self {
        Self { lag }
    }
}

/// Forward Euler: yⁿ⁺¹ = yⁿ + dt f(yⁿ). Unstable for sound at every dt; used only in tests.
#[derive(Clone, Copy, Debug, Default)]
pub struct Euler;

impl<X: Numbers> Integrator<X> for Euler {
    const NAME: &'static str = "euler";
    const ORDER: [u32; 2] = [1, 1];

    fn step<P: Physics<Extra = X>>(
        &mut self,
        engine: &mut Engine<P>,
        state: &mut [Evolved<X>],
        dt: f64,
    ) -> Result<(), Fault> {
        engine.begin(state)?;
        engine.sweep_all(state, |_, evolved, rate| *evolved = evolved.advanced(dt, rate));
        Ok(())
    }
}
