//! Time integration, one file for each integrator. A physics together with an integrator is a scheme.

mod euler;
mod leapfrog;
mod predictor_corrector;
mod single_sweep;
mod super_steps;

pub use euler::Euler;
pub use leapfrog::{ForwardKick, Kick, KickTimes, Leapfrog};
pub use predictor_corrector::PredictorCorrector;
pub use single_sweep::SingleSweep;
pub use super_steps::{SuperSteps, stages};

pub use crate::particle_data::Stepped;

use crate::{
    engine::Engine,
    kernel::Kernel,
    numbers::Numbers,
    particle_data::Checkpoint,
    particles::{Rate, State},
    physics::{Compose, Particles, Physics},
    terms::Term,
    walls::Walls,
};

/// An explicit time integration of (x, v, ρ) of the physics `P`.
pub trait Integrator<P: Physics>: 'static {
    /// Name in settings and reports.
    const NAME: &'static str;
    /// Data kept from one step to the next, and reusable buffers; `()` for none.
    type Memory: Memory<P::Extra>;

    /// Advances the state by dt \[s\].
    fn step(
        engine: &mut Engine<P>,
        memory: &mut Self::Memory,
        state: &mut Particles<P>,
        dt: f64,
    ) -> Stepped;

    /// Brings every quantity to one time, until the next step, and refreshes the derived data.
    fn synchronise(
        engine: &mut Engine<P>,
        _memory: &mut Self::Memory,
        state: &mut Particles<P>,
    ) -> Stepped {
        engine.begin(state)
    }

    /// Rates of each fluid particle in the last synchronised state, from the pair sweeps of a step. dx/dt
    /// excludes v.
    fn rates(engine: &Engine<P>) -> Vec<Rate<P::Extra>> {
        engine.rates_in_one_sweep()
    }
}

/// The memory of an integrator. A checkpoint holds the part on which later steps depend.
pub trait Memory<X: Numbers>: Default + Send + Sync {
    /// Writes this part to a checkpoint, which already holds the particles at the end of a step.
    fn save(&self, _to: &mut Checkpoint<X>) {}

    /// The memory at a checkpoint.
    ///
    /// # Errors
    /// If a part is missing in the checkpoint, which then is one of another integrator.
    fn at(_from: &Checkpoint<X>) -> Result<Self, &'static str> {
        Ok(Self::default())
    }

    /// Memory held \[bytes\].
    fn bytes(&self) -> usize {
        0
    }
}

impl<X: Numbers> Memory<X> for () {}

/// Two parts of a memory.
impl<X: Numbers, A: Memory<X>, B: Memory<X>> Memory<X> for (A, B) {
    fn save(&self, to: &mut Checkpoint<X>) {
        self.0.save(to);
        self.1.save(to);
    }

    fn at(from: &Checkpoint<X>) -> Result<Self, &'static str> {
        Ok((A::at(from)?, B::at(from)?))
    }

    fn bytes(&self) -> usize {
        self.0.bytes() + self.1.bytes()
    }
}

/// States inside a step.
impl<X: Numbers> Memory<X> for Vec<State<X>> {
    fn bytes(&self) -> usize {
        self.capacity() * size_of::<State<X>>()
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

/// The physics of the scheme `S`: one type for all schemes that differ only in their integrator.
pub type PhysicsOf<S> = Compose<
    <S as Physics>::Kernel,
    <S as Physics>::Forces,
    <S as Physics>::Drift,
    <S as Physics>::Walls,
    (),
    <S as Physics>::Extra,
>;

/// Advances a particle by dt \[s\]. Like every update it does not depend on the scheme and is compiled once.
fn advance<X: Numbers>(dt: f64) -> impl Fn(usize, &mut State<X>, &Rate<X>) + Sync {
    move |_, evolved: &mut State<X>, rate: &Rate<X>| *evolved = evolved.advanced(dt, rate)
}
