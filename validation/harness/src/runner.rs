//! Steps a simulation through the times of interest: the only time loop of the program. It measures the cost,
//! shows progress, writes frames and stops at an interrupt; cases contain only their own measurements. The
//! loop accesses a run of a case only through `ObservedRun`, so it is compiled once for all cases of fluids,
//! and once for solids.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use touchstone_base::{
    lock,
    mutation::Constant,
    record::{Cost, Record, Status, digest},
};
use touchstone_solver::{Divergence, Numbers, Observer, Outcome, Stepper, Symmetric};

pub use crate::context::{Context, RunProgress};
use crate::{
    checkpoint::{self, Stage},
    clock::Reading,
    error::RunError,
    frames::{self, Frames},
    profile::{self, Profiler},
    size::{Size, Storage},
};

/// Wall time after which it is shown again how far a run is.
const SHOW_EVERY: Duration = Duration::from_millis(200);

/// Data of every record about the end of a run.
#[derive(Debug)]
pub struct Ended {
    /// How it ended.
    pub status: Status,
    /// Its cost.
    pub cost: Cost,
    /// Digest of positions, velocities, densities and stresses, in the order of the scene.
    pub state: String,
}

impl Ended {
    /// Puts it in a record.
    pub fn put(self, record: &mut Record) {
        (record.status, record.cost, record.state) = (self.status, self.cost, Some(self.state));
    }
}

/// Digest of a state.
pub(crate) fn state<X: Numbers>(simulation: &dyn Stepper<X>) -> String {
    let mut numbers = Vec::new();
    for p in simulation.particles() {
        numbers.extend([p.position.x, p.position.y, p.velocity.x, p.velocity.y, p.density]);
        numbers.extend(p.extra.stress().map(Symmetric::components).into_iter().flatten());
    }
    digest(&numbers)
}

/// How a run that diverged has ended.
pub(crate) fn diverged(Divergence { step, time, fault }: Divergence) -> Status {
    Status::Diverged {
        step,
        time,
        particle: fault.particle as usize,
        field: fault.field.into(),
        value_text: format!("{:.6e}", fault.value),
    }
}

/// A simulation and all that is observed of it.
pub(crate) trait ObservedRun<X: Numbers> {
    /// The simulation, and the observers of its steps.
    fn parts(&mut self) -> (&mut dyn Stepper<X>, &mut dyn Observations<X>);
    /// Calls the k-th of the functions that are called at times, at this one of the times.
    fn at(&mut self, k: usize, reached: usize);
    /// Restores changes of the simulation by a case that are not part of a
    /// [`Checkpoint`](touchstone_solver::Checkpoint), such as a force.
    fn resumed(&mut self);
}

/// The observations of a run.
pub(crate) trait Observations<X: Numbers> {
    /// Calls the k-th of the functions that are called after every step.
    fn after_step(&mut self, k: usize, simulation: &dyn Stepper<X>) -> ControlFlow<()>;
    /// All data that change during the run, as bytes.
    fn save(&self) -> Result<Vec<u8>, RunError>;
    /// Restores these data from bytes.
    fn restore(&mut self, bytes: &[u8]) -> Result<(), RunError>;
}

/// A run that is under way.
type RunMut<'a, X> = &'a mut dyn ObservedRun<X>;

/// Times and callbacks of a run, with their names in a profile.
pub(crate) struct Schedule<'a> {
    /// Longest step \[s\].
    pub dt: f64,
    /// Steps to each of the times at least.
    pub least: usize,
    /// Pair sweeps a step, for the estimate of the cost.
    pub sweeps: f64,
    /// Memory of a particle.
    pub storage: Storage,
    /// Times of interest, ascending, the end last \[s\].
    pub times: &'a [f64],
    /// The pressure \[Pa\] of a density \[kg/m³\], which frames show.
    pub pressure: &'a dyn Fn(f64) -> f64,
    /// After every step.
    pub after_step: Vec<&'static str>,
    /// At each of the times, and whether it reads quantities of that very time: velocities of a leapfrog lag
    /// by half a step unless a pair sweep brings them up.
    pub at: Vec<(&'static str, bool)>,
}

impl Schedule<'_> {
    /// Steps a run through the times. The cost covers the stepping, and separately the observing.
    ///
    /// # Errors
    /// If the run would exceed the limit of time or memory, the folder of frames cannot be made, or the
    /// checkpoint does not fit. A frame or a checkpoint that cannot be written is reported to
    /// [`Context::lost`].
    pub fn run<X: Numbers>(&self, run: RunMut<X>, context: &Context) -> Result<Ended, RunError> {
        let (simulation, _) = run.parts();
        let factor = context.spec.mutation.map_or(1.0, |m| m.factor_of(Constant::TimeStep));
        let (dt, least) = (self.dt * factor, self.least as f64 / factor);
        let end = self.times.last().copied().unwrap_or_default();
        let fewest = least.max(1.0) * self.times.len() as f64;
        let steps = ((end - simulation.time()) / dt).max(fewest);
        let size = Size::of(simulation, steps);
        // The receiver of particles keeps them, finally as text.
        let told = context.at_times.map_or(0.0, |_| size.particles * self.times.len() as f64);
        let size = Size { sweeps: self.sweeps, samples: told, storage: self.storage, ..size };
        let settings = "the end, the time step or the spacing";
        check_size(size, f64::INFINITY, settings, context.allow_long)?;
        if let Some(tell) = context.estimate {
            tell(&size);
        }
        let mut watch = self.watch(context)?;
        watch.go_on(run)?;
        let (simulation, _) = run.parts();
        if context.profile {
            let names = self.after_step.iter().chain(self.at.iter().map(|(name, _)| name));
            let names = names.copied().chain([profile::FRAMES, profile::CHECKPOINTS]).collect();
            let earlier = watch.cost.breakdown.take().unwrap_or_default();
            watch.profiler = Some(Profiler::new(simulation, names, earlier));
        }
        watch.show(simulation, dt);
        let ended = watch.step_through(run, dt, least);
        if let Some(at_the_end) = context.at_the_end {
            let columns = frames::columns(&run.parts().0.particles(), self.pressure);
            *lock(at_the_end) = Some(columns);
        }
        Ok(ended)
    }

    /// The watch over a run that begins.
    fn watch<'a>(&'a self, context: &'a Context<'a>) -> Result<Monitor<'a>, RunError> {
        let end = self.times.last().copied().unwrap_or_default();
        let frames = context.frames.as_ref().map(|frames| Frames::new(frames, end, self.pressure));
        Ok(Monitor {
            context,
            schedule: self,
            end,
            shown: Instant::now(),
            saved: context.now().wall,
            frames: frames.transpose()?,
            profiler: None,
            cost: Cost { threads: context.threads.max(1), ..Cost::default() },
            start: Reading::default(),
            steps: 0,
            reached: 0,
            synchronises: true,
        })
    }
}

/// Handles every step: calls the observers, writes frames and checkpoints, shows the progress, and stops at
/// an interrupt after the present step, however long steps take.
struct Monitor<'a> {
    context: &'a Context<'a>,
    schedule: &'a Schedule<'a>,
    end: f64,
    shown: Instant,
    /// Wall time of the last checkpoint \[s\].
    saved: f64,
    frames: Option<Frames<'a>>,
    profiler: Option<Profiler>,
    /// Cost up to the last of the times of interest, and of all observing.
    cost: Cost,
    /// Start of the stretch to the next time, moved by the time for observers, frames and checkpoints since.
    start: Reading,
    /// Steps before it.
    steps: u64,
    /// How many of the times of interest were reached.
    reached: usize,
    /// Whether a callback at the next time needs synchronised quantities.
    synchronises: bool,
}

impl Monitor<'_> {
    fn show<X: Numbers>(&mut self, simulation: &dyn Stepper<X>, dt: f64) {
        if let Some(show) = self.context.progress {
            show(RunProgress { time: simulation.time(), end: self.end, dt });
            self.shown = Instant::now();
        }
    }

    /// The cost of the run so far; the last stepping took `stepping`.
    fn cost<X: Numbers>(&self, simulation: &dyn Stepper<X>, stepping: Reading) -> Cost {
        let work = simulation.work();
        let last = if work.steps > self.steps { simulation.dt() } else { 0.0 };
        Cost {
            wall_s: self.cost.wall_s + stepping.wall,
            cpu_s: self.cost.cpu_s + stepping.cpu,
            steps: work.steps,
            largest_dt_s: self.cost.largest_dt_s.max(last),
            pair_interactions: work.pair_interactions,
            particle_rhs: work.right_hand_sides,
            particles: simulation.data().fluid_count(),
            solver_bytes: simulation.bytes() as u64,
            breakdown: self.profiler.as_ref().map(|profiler| profiler.breakdown(simulation)),
            ..self.cost.clone()
        }
    }

    /// The data of a record of a run that ends now, after its last stepping.
    fn ended<X: Numbers>(&self, simulation: &dyn Stepper<X>, status: Status) -> Ended {
        let cost = self.cost(simulation, Reading::default());
        Ended { status, cost, state: state(simulation) }
    }

    /// Writes the due frames, unless interrupted: the continued run writes them.
    fn write_frames<X: Numbers>(&mut self, simulation: &dyn Stepper<X>) {
        let Some(frames) = &mut self.frames else { return };
        self.profiler.iter().for_each(|profiler| profiler.observe(profile::FRAMES));
        while frames.is_due(simulation.time()) && !self.context.is_interrupted() {
            frames.write(simulation).unwrap_or_else(|error| self.context.lose(&error.into()));
        }
    }

    /// The observations of the case, and their files.
    fn observe<X: Numbers>(
        &mut self,
        simulation: &dyn Stepper<X>,
        seen: &mut dyn Observations<X>,
    ) -> ControlFlow<()> {
        let is_seen = !self.schedule.after_step.is_empty() || self.frames.is_some();
        if !is_seen && self.context.checkpoints.is_none() {
            return ControlFlow::Continue(());
        }
        let now = self.context.now();
        let mut flow = ControlFlow::Continue(());
        for (k, name) in self.schedule.after_step.iter().enumerate() {
            self.profiler.iter().for_each(|profiler| profiler.observe(name));
            if seen.after_step(k, simulation) == ControlFlow::Break(()) {
                flow = ControlFlow::Break(());
            }
        }
        self.write_frames(simulation);
        // A run that ends here by itself has nothing to go on with.
        if let (Some(checkpoints), ControlFlow::Continue(())) = (self.context.checkpoints, flow)
            && (now.wall - self.saved >= checkpoints.every.as_secs_f64()
                || self.context.is_interrupted())
        {
            self.profiler.iter().for_each(|profiler| profiler.observe(profile::CHECKPOINTS));
            let cost = self.cost(simulation, now - self.start);
            let frames = self.frames.as_ref().map(Frames::written);
            let stage = Stage { reached: self.reached, cost, frames };
            let saved = seen.save().and_then(|seen| checkpoint::save(simulation, stage, seen));
            let written = saved.and_then(|bytes| Ok((checkpoints.write)(&bytes)?));
            written.unwrap_or_else(|error| self.context.lose(&error));
            self.saved = self.context.now().wall;
        }
        let took = self.context.now() - now;
        self.start += took;
        self.cost.observing_s += took.wall;
        flow
    }

    /// Steps to a time; how the run ended, if it did not get there.
    fn step_to<X: Numbers>(&mut self, run: RunMut<X>, until: f64, dt: f64) -> Option<Status> {
        let (simulation, seen) = run.parts();
        (self.start, self.steps) = (self.context.now(), simulation.work().steps);
        self.profiler.iter().for_each(Profiler::step);
        let outcome = simulation.advance(until, dt, &mut MonitoredSteps { watch: self, seen });
        self.profiler.iter().for_each(Profiler::pause);
        self.cost = self.cost(simulation, self.context.now() - self.start);
        if let Some(profiler) = &mut self.profiler {
            profiler.sample(simulation);
        }
        match outcome {
            Outcome::Reached => None,
            Outcome::Diverged(divergence) => Some(diverged(divergence)),
            Outcome::Stopped => {
                let (step, time) = (simulation.work().steps, simulation.time());
                Some(Status::Interrupted { step, time })
            }
        }
    }

    /// Steps through the remaining times, with steps of at most `dt` \[s\] and at least `least` to each,
    /// observes each, and writes the last frame.
    fn step_through<X: Numbers>(&mut self, run: RunMut<X>, dt: f64, least: f64) -> Ended {
        let Schedule { times, at, .. } = self.schedule;
        while let Some(&until) = times.get(self.reached) {
            let start = self.reached.checked_sub(1).map_or(0.0, |before| times[before]);
            let dt = if until > start { dt.min((until - start) / least) } else { dt };
            let is_last = self.reached + 1 == times.len();
            let is_told = self.context.at_times.is_some();
            self.synchronises =
                is_last || is_told || at.iter().any(|(_, synchronised)| *synchronised);
            if let Some(ended) = self.step_to(run, until, dt) {
                return self.ended(run.parts().0, ended);
            }
            let start = self.context.now();
            if let Some(tell) = self.context.at_times {
                tell(until, frames::columns(&run.parts().0.particles(), self.schedule.pressure));
            }
            for (k, (name, _)) in at.iter().enumerate() {
                self.profiler.iter().for_each(|profiler| profiler.observe(name));
                run.at(k, self.reached);
            }
            self.profiler.iter().for_each(Profiler::pause);
            self.cost.observing_s += (self.context.now() - start).wall;
            self.reached += 1;
        }
        let (simulation, _) = run.parts();
        if let Some(frames) = &mut self.frames {
            frames.write(simulation).unwrap_or_else(|error| self.context.lose(&error.into()));
        }
        self.ended(simulation, Status::Completed)
    }

    /// Goes on from a checkpoint, if there is one.
    fn go_on<X: Numbers>(&mut self, run: RunMut<X>) -> Result<(), RunError> {
        let earlier = self.context.checkpoints.and_then(|of| of.earlier.as_deref());
        let Some(bytes) = earlier else { return Ok(()) };
        let (simulation, seen) = run.parts();
        let (Stage { reached, cost, frames }, earlier) = checkpoint::restore(bytes, simulation)?;
        seen.restore(&earlier)?;
        if self.schedule.times.get(reached).is_none_or(|next| simulation.time() > *next) {
            return Err(RunError::Checkpoint("times of another run"));
        }
        self.cost = Cost { threads: self.cost.threads, resumed: cost.resumed + 1, ..cost };
        self.reached = reached;
        if let (Some(all), Some(written)) = (&mut self.frames, frames) {
            all.go_on(written);
        }
        self.write_frames(simulation);
        run.resumed();
        Ok(())
    }
}

/// A watch with the observations of the run.
struct MonitoredSteps<'w, 'a, X: Numbers> {
    watch: &'w mut Monitor<'a>,
    seen: &'w mut dyn Observations<X>,
}

impl<X: Numbers> Observer<X> for MonitoredSteps<'_, '_, X> {
    #[inline]
    fn after_step(&mut self, simulation: &dyn Stepper<X>) -> ControlFlow<()> {
        let Self { watch, seen } = self;
        if watch.context.progress.is_some() && watch.shown.elapsed() >= SHOW_EVERY {
            watch.show(simulation, simulation.dt());
        }
        let flow = watch.observe(simulation, *seen);
        if watch.context.is_interrupted() { ControlFlow::Break(()) } else { flow }
    }

    fn synchronises(&self) -> bool {
        self.watch.synchronises
    }
}

/// The largest number of time steps, under any permission.
const MOST_STEPS: f64 = 1e10;

/// Refuses a run that takes more time or memory than a run may, unless that is allowed, and more than 10¹⁰
/// time steps in any case. The size of the steps that are made, which may be fewer than the run has.
///
/// # Errors
/// Its cost, and the settings that it depends on.
pub fn check_size(
    all: Size,
    most_steps: f64,
    settings: &'static str,
    allow_long: bool,
) -> Result<Size, RunError> {
    let (steps, samples) = (all.steps.min(most_steps), all.samples.min(most_steps));
    let size = Size { steps, samples, ..all };
    if size.is_too_much() && !allow_long {
        return Err(RunError::TooLong { size, settings });
    }
    if all.steps.is_nan() || all.steps > MOST_STEPS {
        let (what, value, most) = ("the number of time steps", all.steps, MOST_STEPS);
        return Err(RunError::TooMuch { what, value, most, setting: settings });
    }
    Ok(size)
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::sync::{
        Mutex,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    };
    use touchstone_base::functions::sin;

    use nalgebra::Vector2;
    use touchstone_solver::{
        Compose, Continuity, CubicSpline, Domain, Leapfrog, Open, Particle, Pressure, Tait, lattice,
    };

    use super::*;
    use crate::{
        checkpoint::Checkpoints,
        method::{Method, Parts},
    };

    const DT: f64 = 1e-3;

    type Sound = Compose<CubicSpline, Pressure<Tait>, Continuity, Open, Leapfrog>;

    /// A sound wave in a periodic box.
    fn wave() -> Box<dyn Stepper<()>> {
        let method = Method::<()>::of::<Sound>();
        let (n, dx) = (12, 1.0 / 12.0);
        let medium = method.properties.medium(Tait::new(1.0, 1.0), dx, 1.3 * dx);
        let speed = |x: Vector2<f64>| Vector2::new(0.01 * sin(std::f64::consts::TAU * x.x), 0.0);
        let places = lattice(Vector2::repeat(0.5 * dx), dx, n, n);
        let particles = places.map(|x| Particle::fluid(x, speed(x), 1.0, dx * dx)).collect();
        let domain = Domain::torus(1.0, 1.0);
        (method.build)(Parts::new(medium, domain, particles)).unwrap()
    }

    /// An observer of the steps of a wave, with its name.
    type Watcher<'a> = (&'static str, &'a dyn Fn(&dyn Stepper<()>));

    impl Observations<()> for &[Watcher<'_>] {
        fn after_step(&mut self, k: usize, simulation: &dyn Stepper<()>) -> ControlFlow<()> {
            self[k].1(simulation);
            ControlFlow::Continue(())
        }
        fn save(&self) -> Result<Vec<u8>, RunError> {
            Ok(Vec::new())
        }
        fn restore(&mut self, _: &[u8]) -> Result<(), RunError> {
            Ok(())
        }
    }

    /// A wave with its observers, which pauses at times that call functions.
    struct Observed<'a> {
        wave: Box<dyn Stepper<()>>,
        watchers: &'a [Watcher<'a>],
    }

    impl ObservedRun<()> for Observed<'_> {
        fn parts(&mut self) -> (&mut dyn Stepper<()>, &mut dyn Observations<()>) {
            (&mut *self.wave, &mut self.watchers)
        }
        fn at(&mut self, _: usize, _: usize) {
            std::thread::sleep(Duration::from_millis(20));
        }
        fn resumed(&mut self) {}
    }

    /// The end of a wave after steps of `dt` \[s\] through these times, and the wave.
    fn run(
        dt: f64,
        times: &[f64],
        watchers: &[Watcher],
        at: Vec<(&'static str, bool)>,
        context: &Context,
    ) -> (Ended, Box<dyn Stepper<()>>) {
        let after_step = watchers.iter().map(|(name, _)| *name).collect();
        let pressure = &|density| density - 1.0;
        let (sweeps, storage) = (2.0, Storage::LISTS);
        let schedule = Schedule { dt, least: 1, sweeps, storage, times, pressure, after_step, at };
        let mut run = Observed { wave: wave(), watchers };
        (schedule.run(&mut run, context).unwrap(), run.wave)
    }

    /// Steps of a large disk take a second: an interrupt was checked after 64 of them.
    #[test]
    fn an_interrupt_is_obeyed_after_the_next_step() {
        let flag = AtomicBool::new(false);
        let context = Context { interrupt: Some(&flag), ..Context::default() };
        let set = |wave: &dyn Stepper<()>| flag.store(wave.work().steps == 3, Ordering::Relaxed);
        let (Ended { status, cost, .. }, _) =
            run(DT, &[1000.0 * DT], &[("set", &set)], Vec::new(), &context);
        assert!(matches!(status, Status::Interrupted { .. }), "{status:?}");
        assert!(cost.steps <= 4, "{} steps", cost.steps);
    }

    /// With steps of ten times the limit.
    #[test]
    fn a_divergence_is_told_after_the_steps_that_were_completed() {
        let (Ended { status, cost, .. }, _) =
            run(1.0, &[100.0], &[], Vec::new(), &Context::default());
        let Status::Diverged { step, .. } = status else { panic!("the run is {status}") };
        assert_eq!(step, cost.steps, "completed steps, as the message and as the cost have them");
    }

    #[test]
    fn progress_is_shown_at_once_and_by_wall_time_and_changes_nothing() {
        let shown: Mutex<Vec<(Instant, f64)>> = Mutex::default();
        let show = |p: RunProgress| shown.lock().unwrap().push((Instant::now(), p.time));
        let watched = Context { progress: Some(&show), ..Context::default() };
        let mut states = Vec::new();
        for context in [Context::default(), watched] {
            let slow = |_: &dyn Stepper<()>| std::thread::sleep(Duration::from_millis(25));
            let (_, wave) =
                run(DT, &[10.0 * DT, 40.0 * DT], &[("slow", &slow)], Vec::new(), &context);
            states.push((state(&*wave), wave.work().steps));
        }
        assert_eq!(states[0], states[1]);
        let shown = shown.into_inner().unwrap();
        assert!(shown.len() >= 4, "in 40 steps of 25 ms: {shown:?}");
        assert_eq!(shown[0].1, 0.0, "before the first step, which may take long");
        assert!(shown.windows(2).all(|pair| pair[1].0 - pair[0].0 >= SHOW_EVERY), "{shown:?}");
    }

    /// Goes on by a second of wall time and half a second of processor time whenever it is read.
    #[derive(Default)]
    struct Ticking {
        now: Mutex<Reading>,
        reads: AtomicUsize,
    }

    impl Ticking {
        fn pass(&self, wall: f64, cpu: f64) {
            *self.now.lock().unwrap() += Reading { wall, cpu };
        }
        fn read(&self) -> Reading {
            self.pass(1.0, 0.5);
            self.reads.fetch_add(1, Ordering::Relaxed);
            *self.now.lock().unwrap()
        }
    }

    /// A run of ten and thirty steps to two times, with an observer after each step of this duration
    /// \[wall s, processor s\] by the clock, or without: its cost, and how often the clock was read.
    fn clocked(observer: Option<[f64; 2]>) -> (Cost, usize) {
        let clock = Ticking::default();
        let tell = |_| clock.read();
        let context = Context { clock: Some(&tell), ..Context::default() };
        let [wall, cpu] = observer.unwrap_or_default();
        let observe = |_: &dyn Stepper<()>| clock.pass(wall, cpu);
        let watchers: &[Watcher] = &[("observer", &observe)];
        let watchers = if observer.is_some() { watchers } else { &[] };
        let (Ended { status, cost, .. }, _) =
            run(DT, &[10.0 * DT, 40.0 * DT], watchers, Vec::new(), &context);
        assert_eq!((status, cost.steps), (Status::Completed, 40));
        (cost, clock.reads.into_inner())
    }

    /// Wall time of observing was taken from processor time: an observer that waited for a disk made the run
    /// look cheaper, down to nothing. Processor time of the last stretch alone passed, too.
    #[test]
    fn what_an_observer_takes_is_no_time_of_stepping_whether_it_waits_or_computes() {
        for observer in [[0.0, 0.0], [100.0, 0.0], [100.0, 100.0]] {
            let (cost, _) = clocked(Some(observer));
            // One tick before, between and after the steps of each stretch: 11 + 31.
            assert_eq!([cost.wall_s, cost.cpu_s], [42.0, 21.0], "{observer:?}");
            // One tick a step and one at each of the two times.
            assert_eq!(cost.observing_s, 40.0 * (1.0 + observer[0]) + 2.0, "{observer:?}");
        }
    }

    #[test]
    fn a_run_that_nobody_observes_reads_no_clock_after_its_steps() {
        let (cost, reads) = clocked(None);
        assert_eq!([cost.wall_s, cost.cpu_s, cost.observing_s], [2.0, 1.0, 2.0]);
        assert_eq!(reads, 9, "once at first, then around each of two stretches and two times");
    }

    /// A run of forty steps that is interrupted after this number, or continues from a checkpoint: its
    /// cost, and its last checkpoint.
    fn resumable(
        stop_at: Option<u64>,
        earlier: Option<Vec<u8>>,
        frames: Option<(PathBuf, usize)>,
    ) -> (Cost, Option<Vec<u8>>) {
        let (clock, flag, kept) = (Ticking::default(), AtomicBool::new(false), Mutex::new(None));
        let write = |state: &[u8]| {
            *kept.lock().unwrap() = Some(state.to_vec());
            clock.pass(1000.0, 1000.0);
            Ok(())
        };
        let checkpoints = Checkpoints { every: Duration::MAX, earlier, write: &write };
        let tell = |_| clock.read();
        let context = Context {
            clock: Some(&tell),
            interrupt: Some(&flag),
            checkpoints: Some(&checkpoints),
            frames,
            ..Context::default()
        };
        let stop = |wave: &dyn Stepper<()>| {
            flag.store(Some(wave.work().steps) == stop_at, Ordering::Relaxed);
        };
        let (Ended { cost, .. }, _) =
            run(DT, &[40.0 * DT], &[("stop", &stop)], Vec::new(), &context);
        (cost, kept.into_inner().unwrap())
    }

    /// The cost of a continued run includes the part before the checkpoint.
    #[test]
    fn what_a_run_took_before_a_checkpoint_is_added_once() {
        let (whole, _) = resumable(None, None, None);
        let (first, kept) = resumable(Some(10), None, None);
        let (second, _) = resumable(None, kept, None);
        assert_eq!((first.steps, second.steps, second.resumed), (10, 40, 1));
        // One tick before each step, and one after the last.
        assert_eq!([whole.wall_s, whole.cpu_s], [41.0, 20.5]);
        assert_eq!([second.wall_s, second.cpu_s], [41.0, 20.5], "{second:?}");
    }

    /// One frame or checkpoint that could not be written ended the run, and all that it had computed was
    /// lost.
    #[test]
    fn a_run_goes_on_when_a_frame_or_a_checkpoint_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let frames = folder.path().join("vtk");
        std::fs::create_dir_all(frames.join("particles_0001.vtu/in the way")).unwrap();
        let lost = Mutex::new(Vec::new());
        let lose = |error: &RunError| lost.lock().unwrap().push(error.to_string());
        let tries = AtomicUsize::new(0);
        let write = |_: &[u8]| {
            tries.fetch_add(1, Ordering::Relaxed);
            let reason = std::io::Error::other("the disk is full");
            Err(touchstone_base::files::FileError::File { path: "checkpoint".into(), reason })
        };
        let every = Duration::from_secs(30);
        let checkpoints = Checkpoints { every, earlier: None, write: &write };
        let clock = Ticking::default();
        let tell = |_| clock.read();
        let context = Context {
            frames: Some((frames.clone(), 4)),
            checkpoints: Some(&checkpoints),
            lost: Some(&lose),
            clock: Some(&tell),
            ..Context::default()
        };
        let (Ended { status, cost, .. }, _) = run(DT, &[40.0 * DT], &[], Vec::new(), &context);
        assert_eq!((status, cost.steps), (Status::Completed, 40));
        let lost = lost.into_inner().unwrap();
        let of = |name: &str| lost.iter().filter(|words| words.contains(name)).count();
        // Two ticks a step: every 30 ticks a checkpoint is tried, not after every step.
        assert_eq!((of("particles_0001"), of("disk is full"), tries.into_inner()), (1, 2, 2));
        let index = std::fs::read_to_string(frames.join("particles.pvd")).unwrap();
        let listed = [0, 1, 2, 3].map(|k| index.contains(&format!("particles_000{k}.vtu")));
        assert_eq!(listed, [true, false, true, true], "{index}");
        assert_eq!(index.matches("<DataSet ").count(), 3, "each once: {index}");
    }

    /// `--resume` listed frames that had been deleted.
    #[test]
    fn frames_that_were_removed_are_not_listed_and_the_next_keep_their_numbers() {
        let folder = tempfile::tempdir().unwrap();
        let names = || {
            let index = std::fs::read_to_string(folder.path().join("particles.pvd")).unwrap();
            [0, 1, 2, 3].map(|k| index.contains(&format!("particles_000{k}.vtu")))
        };
        let frames = Some((folder.path().to_path_buf(), 4));
        let (_, kept) = resumable(Some(25), None, frames.clone());
        assert_eq!(names(), [true, true, false, false]);
        std::fs::remove_file(folder.path().join("particles_0000.vtu")).unwrap();
        resumable(None, kept, frames);
        assert_eq!(names(), [false, true, true, true]);
    }

    /// The frame of the step after which a run is interrupted must not be missing when the run continues.
    #[test]
    fn a_frame_that_an_interrupt_left_unwritten_is_written_when_the_run_goes_on() {
        let [alone, cut] = [(), ()].map(|()| tempfile::tempdir().unwrap());
        let frames = |folder: &tempfile::TempDir| Some((folder.path().to_path_buf(), 4));
        resumable(None, None, frames(&alone));
        let (cost, kept) = resumable(Some(10), None, frames(&cut));
        let name = "particles_0000.vtu";
        assert!(cost.steps == 10 && !cut.path().join(name).exists());
        resumable(None, kept, frames(&cut));
        for name in [name, "particles_0001.vtu", "particles_0003.vtu", "particles.pvd"] {
            let [alone, cut] = [&alone, &cut].map(|folder| folder.path().join(name));
            assert!(std::fs::read(alone).unwrap() == std::fs::read(cut).expect(name), "{name}");
        }
    }

    /// 9,999 frames of two steps were written before an interrupt was checked.
    #[test]
    fn an_interrupt_is_obeyed_between_the_frames_of_one_step() {
        let folder = tempfile::tempdir().unwrap();
        let flag = AtomicBool::new(false);
        let frames = Some((folder.path().into(), 9999));
        let context = Context { frames, interrupt: Some(&flag), ..Context::default() };
        let stop = |_: &dyn Stepper<()>| flag.store(true, Ordering::Relaxed);
        let (Ended { status, .. }, _) =
            run(DT, &[2.0 * DT], &[("stop", &stop)], Vec::new(), &context);
        assert!(matches!(status, Status::Interrupted { .. }), "{status:?}");
        let count = std::fs::read_dir(folder.path()).unwrap().count();
        assert!(count <= 2, "{count} files of frames were written after the interrupt");
    }

    /// One run of 400 steps with two observers after each and one at each of two times.
    fn profiled(profile: bool) -> (String, touchstone_solver::Work, Cost, usize) {
        let slow = |_: &dyn Stepper<()>| std::thread::sleep(Duration::from_micros(200));
        let watchers: &[Watcher] = &[("slow", &slow), ("quick", &|_| ())];
        let context = Context { profile, ..Context::default() };
        let (Ended { cost, .. }, wave) =
            run(DT, &[10.0 * DT, 400.0 * DT], watchers, vec![("pause", true)], &context);
        (state(&*wave), wave.work(), cost, wave.data().column_bytes)
    }

    #[test]
    fn a_profile_adds_up_and_changes_nothing() {
        let (plain, found) = (profiled(false), profiled(true));
        assert_eq!((&plain.0, plain.1), (&found.0, found.1), "state and work");
        assert_eq!(plain.2.breakdown, None);
        let all = found.2.breakdown.as_ref().unwrap();
        // Both look at the clock, one after the other: one try in five without a pause between them.
        let adds_up = |cost: &Cost| {
            let all = cost.breakdown.as_ref().unwrap();
            let stepping = all.stepping_seconds() / cost.wall_s;
            let shares = [stepping, all.observing_seconds() / cost.observing_s];
            shares.iter().all(|share| (share - 1.0).abs() < 0.05)
        };
        assert!(adds_up(&found.2) || (0..4).any(|_| adds_up(&profiled(true).2)), "{found:?}");
        let part = |name: &str| {
            let mut parts = all.stepping.iter().chain(&all.observing);
            parts.find(|part| part.name == name).unwrap()
        };
        // At each of the two times the leapfrog brings velocities up by a sum of forces.
        let names = ["slow", "quick", "pause", profile::FORCES, profile::DRIFT];
        assert_eq!(names.map(|name| part(name).times), [400, 400, 2, 402, 400]);
        assert!(part("slow").seconds > 0.08 && part("pause").seconds > 0.04, "{all:?}");
        assert!(part("quick").seconds < 0.1 * part("slow").seconds, "{all:?}");
        let shares = [profile::FORCES, profile::DRIFT].map(|name| all.share(&[name]));
        assert!(shares.iter().all(|share| (0.05..0.8).contains(share)), "{shares:?}");
    }

    #[test]
    fn a_profile_counts_what_sweeps_go_through() {
        let (_, work, cost, column_bytes) = profiled(true);
        let all = cost.breakdown.unwrap();
        // A lattice with h/dx = 1.3: 20 neighbours in the support of 2.6 dx; 60 particles within the support
        // or the skin of any of four by two.
        assert_eq!((all.neighbours, all.inside), (59.0, 20.0 / 59.0));
        assert_eq!((all.steps, all.list_builds + 1), (400, work.list_builds));
        let (lists, states) = (144 / 8 * 60 * 4, 144 * 40);
        let a_sweep = (lists + 2 * column_bytes + 3 * states) as f64;
        assert!((all.bytes_a_step / (802.0 / 400.0 * a_sweep) - 1.0).abs() < 1e-12, "{all:?}");
    }
}
