//! A running simulation: stepping to a given time, observers, and the possible outcomes of a run.

use std::mem::take;
use std::ops::ControlFlow;

use crate::{
    engine::Engine,
    integrator::{Integrator, Memory, PhysicsOf, Scheme, Stepped},
    numbers::Numbers,
    particle_data::{Checkpoint, Interval, InvalidState, ParticleData, Work},
    particles::{Particle, Rate, SweptParticle},
    physics::Derived,
    terms::Term,
};

/// How stepping ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The requested time was reached.
    Reached,
    /// A particle exceeded [`Setting::limits`](crate::scene::Setting::limits); the remaining state is
    /// unusable.
    Diverged(Divergence),
    /// The observer requested a stop.
    Stopped,
}

/// When a run diverged, and at which particle.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("diverged at step {step}, t = {time:.6e} s: {} {:.3e} of particle {}",
    fault.field, fault.value, fault.particle)]
pub struct Divergence {
    /// Number of steps completed.
    pub step: u64,
    /// Simulated time \[s\].
    pub time: f64,
    /// Particle, quantity and value.
    pub fault: InvalidState,
}

/// Observes a run. `()` is an observer that does nothing.
pub trait Observer<X: Numbers> {
    /// Called after every step.
    fn after_step(&mut self, simulation: &dyn Stepper<X>) -> ControlFlow<()>;

    /// Whether [`Stepper::advance`] brings every quantity to its final time, for which a leapfrog sums the
    /// forces once more. Without, the velocities of a leapfrog lag by half a step, and pair sweeps read the
    /// columns of the last step. The steps have equal bits either way.
    fn synchronises(&self) -> bool {
        true
    }
}

impl<X: Numbers> Observer<X> for () {
    fn after_step(&mut self, _: &dyn Stepper<X>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// A simulation without the type of its scheme: `&dyn Stepper<X>` is any simulation of particles with the
/// extra fields `X`.
pub trait Stepper<X: Numbers> {
    /// The particles in the order of storage, and their neighbour lists.
    fn data(&self) -> &ParticleData<X>;
    /// The particles, and [`ParticleData::watch`].
    fn data_mut(&mut self) -> &mut ParticleData<X>;
    /// Simulated time \[s\].
    fn time(&self) -> f64 {
        self.data().progress.time
    }
    /// Length of the last step \[s\].
    fn dt(&self) -> f64 {
        self.data().progress.dt
    }
    /// The work done so far.
    fn work(&self) -> Work {
        self.data().progress.work
    }
    /// All particles in the order of the scene.
    fn particles(&self) -> Vec<Particle<X>> {
        self.data().particles()
    }
    /// Steps to the time `until` \[s\] with equal steps of at most `dt_max` \[s\], then synchronises every
    /// quantity to this time if the observer needs it. The next step reverts the synchronisation, so the
    /// times of observation affect a run only through the length of equal steps between them.
    ///
    /// The time is computed from the start and the number of steps, so rounding errors do not accumulate.
    /// After a stop, a call with equal `until` and `dt_max` makes the remaining steps, with the bits of a run
    /// without a stop.
    ///
    /// # Panics
    /// If `until` is earlier than the present time or not finite, or if `dt_max` is not above 0 or is so
    /// small that the number of steps is 10¹⁵ or more: the run would never end.
    fn advance(&mut self, until: f64, dt_max: f64, observer: &mut dyn Observer<X>) -> Outcome {
        advance(self.stepper(), until, dt_max, observer)
    }
    /// Makes one time step of dt \[s\]; [`Stepper::advance`] calls it.
    fn step(&mut self, dt: f64) -> Stepped;
    /// Brings every quantity to the same time, and refreshes the derived data, for [`Stepper::advance`].
    fn synchronise(&mut self) -> Stepped;
    /// The complete state: a restored simulation continues with equal bits.
    fn checkpoint(&self) -> Checkpoint<X>;
    /// Goes to a [`Stepper::checkpoint`] of a simulation of this scene: its particles replace the present
    /// ones, and later steps have the bits of that simulation.
    ///
    /// # Errors
    /// The reason, if no simulation of this scheme can have made the checkpoint; nothing has changed then.
    fn restore(&mut self, from: &Checkpoint<X>) -> Result<(), &'static str>;
    /// The kernel W(r) \[1/m²\] from r² \[m²\].
    fn weight(&self, r2: f64) -> f64;
    /// The columns of particles and of their images without derived data, after [`Stepper::advance`] reached
    /// a time. Together with [`Stepper::weight`] they interpolate a field.
    fn plain_columns(&self) -> Vec<SweptParticle>;
    /// Rates of each particle of [`ParticleData::fluid`] by all terms of the scene, after
    /// [`Stepper::advance`] reached a time: dv/dt by the forces, the other rates by the drift. dx/dt does
    /// not include v.
    fn total_rates(&self) -> Vec<Rate<X>>;
    /// Rates of each particle of [`ParticleData::walls`] by the terms of the walls, after
    /// [`Stepper::advance`] reached a time; empty for walls without terms.
    fn wall_rates(&self) -> Vec<Rate<X>> {
        Vec::new()
    }
    /// Memory that the simulation occupies \[bytes\].
    fn bytes(&self) -> usize;
    /// This simulation as a trait object.
    fn stepper(&mut self) -> &mut dyn Stepper<X>;
    /// Potential energies of the forces \[J/m\]; `None` for forces without a potential.
    fn potential(&self) -> Option<Potential> {
        None
    }
}

/// Energies that forces derive from, per unit depth \[J/m\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Potential {
    /// Stored by the change of volume.
    pub compression: f64,
    /// Stored by the change of shape.
    pub shear: f64,
    /// Energy of the resistance to hourglass modes, which deform no particle.
    pub hourglass: f64,
    /// Energy of contacts and of weight.
    pub loads: f64,
}

/// [`Stepper::advance`] by time steps.
fn advance<X: Numbers>(
    simulation: &mut dyn Stepper<X>,
    until: f64,
    dt_max: f64,
    observer: &mut dyn Observer<X>,
) -> Outcome {
    let now = &mut simulation.data_mut().progress;
    if (now.call.until, now.call.dt_max) != (until, dt_max) {
        (now.call, now.made) = (Interval { start: now.time, until, dt_max }, 0);
    }
    let (start, made) = (now.call.start, now.made);
    let (span, steps) = (until - start, count_steps(start, until, dt_max));
    now.dt = if steps > 0 { span / steps as f64 } else { now.dt };
    let dt = now.dt;
    for k in made + 1..=steps {
        if let Err(fault) = simulation.step(dt) {
            return diverged(simulation, fault);
        }
        let now = &mut simulation.data_mut().progress;
        now.time = if k == steps { until } else { start + span * (k as f64 / steps as f64) };
        (now.made, now.work.steps) = (k, now.work.steps + 1);
        if observer.after_step(simulation) == ControlFlow::Break(()) {
            return Outcome::Stopped;
        }
    }
    simulation.data_mut().progress.call = Interval::default();
    if !observer.synchronises() {
        return Outcome::Reached;
    }
    // Steps do without the sums that this takes, which do not count as their work.
    let pairs = simulation.work().pair_interactions;
    let synchronised = simulation.synchronise();
    simulation.data_mut().progress.work.pair_interactions = pairs;
    match synchronised {
        Ok(()) => Outcome::Reached,
        Err(fault) => diverged(simulation, fault),
    }
}

fn diverged<X: Numbers>(simulation: &dyn Stepper<X>, fault: InvalidState) -> Outcome {
    let (step, time) = (simulation.work().steps, simulation.time());
    Outcome::Diverged(Divergence { step, time, fault })
}

impl<S: Scheme> Stepper<S::Extra> for Simulation<S> {
    fn data(&self) -> &ParticleData<S::Extra> {
        &self.engine.data
    }
    fn data_mut(&mut self) -> &mut ParticleData<S::Extra> {
        &mut self.engine.data
    }
    fn step(&mut self, dt: f64) -> Stepped {
        let Self { engine, memory } = self;
        let mut state = take(&mut engine.data.state);
        let stepped = S::Integrator::step(engine, memory, &mut state, dt);
        engine.data.state = state;
        stepped
    }
    fn synchronise(&mut self) -> Stepped {
        let Self { engine, memory } = self;
        let mut state = take(&mut engine.data.state);
        let synchronised = S::Integrator::synchronise(engine, memory, &mut state);
        engine.sum_before_forces();
        engine.data.state = state;
        synchronised
    }
    fn stepper(&mut self) -> &mut dyn Stepper<S::Extra> {
        self
    }
    fn checkpoint(&self) -> Checkpoint<S::Extra> {
        let mut checkpoint = self.engine.data.without_memory();
        self.memory.save(&mut checkpoint);
        checkpoint
    }
    fn restore(&mut self, from: &Checkpoint<S::Extra>) -> Result<(), &'static str> {
        let memory = MemoryOf::<S>::at(from)?;
        let mut taken = self.engine.data.without_memory();
        memory.save(&mut taken);
        from.check_memory(&taken)?;
        self.engine.restore(from)?;
        self.memory = memory;
        Ok(())
    }
    fn weight(&self, r2: f64) -> f64 {
        self.engine.equations.kernel.w(r2)
    }
    fn plain_columns(&self) -> Vec<SweptParticle> {
        SweptParticle::plain(self.columns())
    }
    fn total_rates(&self) -> Vec<Rate<S::Extra>> {
        S::Integrator::rates(&self.engine)
    }
    fn wall_rates(&self) -> Vec<Rate<S::Extra>> {
        self.engine.wall_rates()
    }
    fn bytes(&self) -> usize {
        self.engine.bytes() + self.memory.bytes()
    }
}

/// A scene that advances in time.
pub struct Simulation<S: Scheme> {
    pub(crate) engine: Engine<PhysicsOf<S>>,
    pub(crate) memory: MemoryOf<S>,
}

type MemoryOf<S> = <<S as Scheme>::Integrator as Integrator<PhysicsOf<S>>>::Memory;

/// The number of equal steps of at most `dt_max` \[s\] from `start` to `until` \[s\].
fn count_steps(start: f64, until: f64, dt_max: f64) -> u64 {
    let span = until - start;
    // A rounding error of the quotient must not add a step, which would change the length of every step.
    let steps = (span / dt_max * (1.0 - 1e-12)).ceil();
    assert!(span >= 0.0 && span.is_finite(), "from {start} s a run cannot reach {until} s");
    assert!(dt_max > 0.0 && steps < 1e15, "steps of {dt_max} s never reach {until} s");
    steps as u64
}

impl<S: Scheme> Simulation<S> {
    /// The particles with their neighbour lists, for a method without a [`Scheme`] that keeps the lists at
    /// any displacement.
    pub fn into_particles(self) -> ParticleData<S::Extra> {
        let mut data = *self.engine.data;
        data.reach2 = f64::MAX;
        data
    }

    /// Forces and drift, which may be changed between two calls of [`Stepper::advance`], for example a body
    /// force that drives the flow. A checkpoint does not include them.
    pub fn terms_mut(&mut self) -> &mut (S::Forces, S::Drift) {
        &mut self.engine.equations.terms
    }

    /// Rates of each particle of [`ParticleData::fluid`] by the given terms alone, after
    /// [`Stepper::advance`] reached a time. The terms may belong to the scene or not. dx/dt does not
    /// include v. A program that never calls this function does not contain its code.
    ///
    /// Terms that depend on the largest speed use the value that [`Term::prepare`] received last.
    pub fn rates<T: Term<S::Extra>>(&self, terms: &T) -> Vec<Rate<S::Extra>> {
        self.engine.rates(terms)
    }

    /// The derived data of particles and of their images, as pair sweeps read them, after
    /// [`Stepper::advance`].
    pub fn columns(&self) -> &[SweptParticle<Derived<S>>] {
        let columns = &self.engine.equations.columns;
        &columns[..columns.len() - 1]
    }
}
