//! A running simulation: stepping to a time, and what a run can end with.

use nalgebra::Vector2;

use crate::{
    engine::{Engine, Extent, Fault, Shows},
    integrator::Integrator,
    kernel::Smoothing,
    particles::{Column, Evolved, Fixed, Particle, Rate, Role},
    scene::Scheme,
    terms::Term,
};

/// What was done, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Time steps.
    pub steps: u64,
    /// Neighbours visited, each traversal counted, padding not.
    pub pair_interactions: u64,
    /// Right-hand sides of moving particles.
    pub right_hand_sides: u64,
    /// Times that neighbour rows were built.
    pub list_builds: u64,
}

/// How stepping ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The time asked for was reached.
    Reached,
    /// A particle left the bounds of the scene; the state is the last one and of no use.
    Diverged(Divergence),
    /// The observer asked to stop.
    Stopped,
}

/// Where a run left its bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divergence {
    /// Steps done.
    pub step: u64,
    /// Simulated time \[s\].
    pub time: f64,
    /// Particle, quantity and value.
    pub fault: Fault,
}

impl std::fmt::Display for Divergence {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Fault { particle, field, value } = self.fault;
        let Self { step, time, .. } = self;
        write!(
            f,
            "diverged at step {step}, t = {time:.6e} s: {field} {value:.3e} of particle {particle}"
        )
    }
}

/// Whether to go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// Next step.
    Continue,
    /// Stop after this step.
    Stop,
}

/// Watches a run. `()` watches nothing.
pub trait Observer<S: Scheme> {
    /// Called after every step.
    fn after_step(&mut self, simulation: &Simulation<S>) -> Flow;
}

impl<S: Scheme> Observer<S> for () {
    #[inline(always)]
    fn after_step(&mut self, _: &Simulation<S>) -> Flow {
        Flow::Continue
    }
}

impl<S: Scheme, A: Observer<S>, B: Observer<S>> Observer<S> for (A, B) {
    fn after_step(&mut self, simulation: &Simulation<S>) -> Flow {
        match (self.0.after_step(simulation), self.1.after_step(simulation)) {
            (Flow::Continue, Flow::Continue) => Flow::Continue,
            _ => Flow::Stop,
        }
    }
}

impl<S: Scheme, O: Observer<S>> Observer<S> for &mut O {
    fn after_step(&mut self, simulation: &Simulation<S>) -> Flow {
        (**self).after_step(simulation)
    }
}

/// All that decides how a run goes on, as plain data: [`crate::Scene::resume`] continues it with the
/// same bits as if it had not been interrupted.
///
/// Sums are added in the order of the rows, so the order of storage belongs to it, and the places
/// that the rows were built at.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint<X = ()> {
    /// Simulated time \[s\].
    pub time: f64,
    /// Length of the last step \[s\].
    pub dt: f64,
    /// How far the velocities are behind the rest \[s\]; 0 after [`Simulation::advance`] reached a
    /// time.
    pub lag: f64,
    /// What was done so far.
    pub work: Work,
    /// Particles as they are stored, with their numbers in the scene.
    pub particles: Vec<(u32, Particle<X>)>,
    /// Where each was when the rows were built \[m\].
    pub built_at: Vec<Vector2<f64>>,
    /// Largest displacement since then, at the start of the last step \[m\].
    pub last_displacement: f64,
    /// Whether the rows were built inside a step, for particles neither sorted nor wrapped.
    pub built_inside_a_step: bool,
}

/// A scene in time.
pub struct Simulation<S: Scheme> {
    engine: Engine<S>,
    state: Vec<Evolved<S::Extra>>,
    integrator: S::Integrator,
    time: f64,
    dt: f64,
}

impl<S: Scheme> Simulation<S> {
    pub(crate) fn new(engine: Engine<S>, state: Vec<Evolved<S::Extra>>) -> Self {
        Self { engine, state, integrator: S::Integrator::default(), time: 0.0, dt: 0.0 }
    }

    /// Goes on from the time, the lag and the work of a checkpoint.
    pub(crate) fn at(mut self, checkpoint: &Checkpoint<S::Extra>) -> Self {
        let Checkpoint { time, dt, lag, work, .. } = *checkpoint;
        self.engine.work = work;
        self.engine.last_displacement = checkpoint.last_displacement;
        self.engine.built_inside_a_step = checkpoint.built_inside_a_step;
        Self { integrator: S::Integrator::with_lag(lag), time, dt, ..self }
    }

    /// What it takes to go on from here with the same bits.
    pub fn checkpoint(&self) -> Checkpoint<S::Extra> {
        Checkpoint {
            time: self.time,
            dt: self.dt,
            lag: self.integrator.lag(),
            work: self.engine.work,
            particles: self.stored().collect(),
            built_at: self.engine.neighbours.built_at.to_vec(),
            last_displacement: self.engine.last_displacement,
            built_inside_a_step: self.engine.built_inside_a_step,
        }
    }

    /// Steps to the time `until` \[s\] with equal steps of at most `dt_max` \[s\], then brings every
    /// quantity to that time.
    ///
    /// The time is counted in whole steps from where it started, so that it does not drift.
    ///
    /// # Panics
    /// If `until` is not a time from now on, or `dt_max` is not above 0, or so small that steps
    /// cannot be counted: nothing sensible could be returned, and a loop would never end.
    pub fn advance(&mut self, until: f64, dt_max: f64, observer: &mut impl Observer<S>) -> Outcome {
        let (start, span) = (self.time, until - self.time);
        // A step more for the last bit of a quotient would be a step of another length.
        let steps = (span / dt_max * (1.0 - 1e-12)).ceil();
        assert!(span >= 0.0 && span.is_finite(), "from {start} s a run cannot reach {until} s");
        assert!(dt_max > 0.0 && steps < 1e15, "steps of {dt_max} s never reach {until} s");
        let steps = steps as u64;
        if steps > 0 {
            self.dt = span / steps as f64;
        }
        for k in 1..=steps {
            if let Err(fault) = self.integrator.step(&mut self.engine, &mut self.state, self.dt) {
                return self.diverged(fault);
            }
            self.time = if k == steps { until } else { start + span * (k as f64 / steps as f64) };
            self.engine.work.steps += 1;
            if observer.after_step(self) == Flow::Stop {
                return Outcome::Stopped;
            }
        }
        self.synchronise()
    }

    /// Brings every quantity to the same time, and the columns up to date.
    fn synchronise(&mut self) -> Outcome {
        let synchronised = self.integrator.synchronise(&mut self.engine, &mut self.state);
        match synchronised.and_then(|()| self.engine.begin(&mut self.state)) {
            Ok(()) => Outcome::Reached,
            Err(fault) => self.diverged(fault),
        }
    }

    fn diverged(&self, fault: Fault) -> Outcome {
        Outcome::Diverged(Divergence { step: self.engine.work.steps, time: self.time, fault })
    }

    /// Simulated time \[s\].
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Length of the last step \[s\].
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// What was done so far.
    pub fn work(&self) -> Work {
        self.engine.work
    }

    /// The kernel with its smoothing length.
    pub fn kernel(&self) -> &Smoothing<S::Kernel> {
        &self.engine.kernel
    }

    /// The terms of dv/dt, to be changed between stretches: a force that drives the flow, say. They are no
    /// part of a checkpoint.
    pub fn forces_mut(&mut self) -> &mut S::Forces {
        &mut self.engine.forces
    }

    /// Number of fluid particles.
    pub fn fluid_count(&self) -> usize {
        self.engine.counts[0]
    }

    /// Fluid particles as they are stored, without order; for observers that sum.
    pub fn fluid(&self) -> impl ExactSizeIterator<Item = (f64, &Evolved<S::Extra>)> {
        let fluid = self.engine.counts[0];
        self.engine.fixed[..fluid].iter().map(|f| f.mass).zip(&self.state[..fluid])
    }

    /// Wall particles with an evolving density, likewise.
    pub fn walls(&self) -> impl ExactSizeIterator<Item = (f64, &Evolved<S::Extra>)> {
        let [fluid, wall] = self.engine.counts;
        let range = fluid..fluid + wall;
        self.engine.fixed[range.clone()].iter().map(|f| f.mass).zip(&self.state[range])
    }

    /// What these terms by themselves do to each particle of [`Simulation::fluid`] now, after
    /// [`Simulation::advance`] reached a time: one term of the scene, or one that it does not have.
    /// dx/dt is without v. A scene that never asks has none of this in its program.
    ///
    /// Terms that depend on the largest speed take it as they were told last.
    pub fn rates<T: Term<S::Extra>>(&self, terms: &T) -> Vec<Rate<S::Extra>> {
        self.engine.rates(&self.state, terms)
    }

    /// What the walls' own terms do to each particle of [`Simulation::walls`] now, likewise; empty
    /// where walls extrapolate.
    pub fn wall_rates(&self) -> Vec<Rate<S::Extra>> {
        self.engine.wall_rates()
    }

    /// All particles as they are stored, with their numbers in the scene.
    fn stored(&self) -> impl Iterator<Item = (u32, Particle<S::Extra>)> {
        let [fluid, wall] = self.engine.counts;
        let role = move |k| match k {
            k if k < fluid => Role::Fluid,
            k if k < fluid + wall => Role::Wall,
            _ => Role::Interface,
        };
        let particles = self.engine.fixed.iter().zip(&self.state).enumerate();
        particles.map(move |(k, (&Fixed { mass, id }, e))| {
            let Evolved { position, velocity, density, extra } = *e;
            (id, Particle { role: role(k), position, velocity, density, mass, extra })
        })
    }

    /// All particles in the order of the scene.
    pub fn particles(&self) -> Vec<Particle<S::Extra>> {
        let nothing = Particle::fluid(Vector2::zeros(), Vector2::zeros(), 0.0, 0.0);
        let mut particles = vec![nothing; self.state.len()];
        for (id, particle) in self.stored() {
            particles[id as usize] = particle;
        }
        particles
    }

    /// Particles and their images as rows see them, after [`Simulation::advance`].
    pub fn columns(&self) -> &[Column<Shows<S>>] {
        let sentinel = self.engine.columns.len() - 1;
        &self.engine.columns[..sentinel]
    }

    /// Total momentum of the fluid per unit depth \[kg/s\], summed in the order of the scene.
    pub fn momentum(&self) -> Vector2<f64> {
        let fluid = self.particles().into_iter().filter(|p| p.role == Role::Fluid);
        fluid.fold(Vector2::zeros(), |sum, p| sum + p.velocity * p.mass)
    }

    /// Memory that the simulation holds \[bytes\].
    pub fn bytes(&self) -> usize {
        self.state.capacity() * size_of::<Evolved<S::Extra>>()
            + self.engine.fixed.capacity() * size_of::<Fixed>()
            + self.engine.columns.capacity() * size_of::<Column<Shows<S>>>()
            + self.engine.order.capacity() * size_of::<u32>()
            + self.engine.extents.capacity() * size_of::<Extent>()
            + self.engine.extrapolated.capacity() * size_of::<Evolved<S::Extra>>()
            + self.engine.neighbours.bytes()
            + self.integrator.bytes()
    }
}
