//! Profile of a run: a clock read at the start of each phase of a step or observer, and samples of the
//! neighbour lists. A run that is not profiled has no part of this.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::time::Instant;

use touchstone_base::breakdown::{Breakdown, Part};
use touchstone_solver::{GROUP, Numbers, Phase, State, Stepper};

/// The pair sweep over the forces.
pub const FORCES: &str = "force sweep";
/// The pair sweep over the drift.
pub const DRIFT: &str = "drift sweep";
/// One pair sweep over forces and drift together.
pub const BOTH: &str = "force and drift sweep";
/// The pair sweep over the terms of the walls.
pub const WALLS: &str = "wall sweep";
/// Columns of particles and of images.
pub const REFRESH: &str = "refresh of columns and images";
/// Images and neighbour lists.
pub const SEARCH: &str = "neighbour search";
/// Particles in their order of storage.
pub const SORTING: &str = "sorting";
/// The remainder of a step.
pub const REST: &str = "rest of the integrator";

/// The names of the phases of a step, in the order of tables.
const PHASES: [&str; 8] = [FORCES, DRIFT, BOTH, WALLS, REFRESH, SEARCH, SORTING, REST];

/// The name of a phase.
fn name_of(phase: Phase) -> &'static str {
    match phase {
        Phase::Forces => FORCES,
        Phase::Drift => DRIFT,
        Phase::Both => BOTH,
        Phase::Walls => WALLS,
        Phase::Refresh => REFRESH,
        Phase::Search => SEARCH,
        Phase::Sorting => SORTING,
        Phase::Rest => REST,
    }
}

/// Frames for ParaView.
pub const FRAMES: &str = "frames";
/// Checkpoints.
pub const CHECKPOINTS: &str = "checkpoints";
/// Neither stepping nor observing; no part of a profile.
const PAUSE: &str = "";

/// Time steps between samples of the lists: a sample costs a fraction of a step.
const SAMPLE_EVERY: u64 = 500;

/// A clock over named parts; one part is under way. Only the thread that steps reads it: atomic, so that a
/// simulation can own a share of it, and never locked.
struct Clock {
    start: Instant,
    /// The index of the part under way.
    part: AtomicUsize,
    since: AtomicU64,
    /// All parts; the last is [`PAUSE`].
    parts: Vec<Timed>,
}

/// The time of a part, and how often it began.
struct Timed {
    name: &'static str,
    nanoseconds: AtomicU64,
    times: AtomicU64,
}

impl Clock {
    fn enter(&self, name: &str) {
        let now = u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX);
        let spent = &self.parts[self.part.load(Relaxed)].nanoseconds;
        spent.store(spent.load(Relaxed) + now - self.since.load(Relaxed), Relaxed);
        self.since.store(now, Relaxed);
        let place = self.parts.iter().position(|part| part.name == name);
        let place = place.unwrap_or(self.parts.len() - 1);
        self.part.store(place, Relaxed);
        self.parts[place].times.fetch_add(1, Relaxed);
    }
}

/// Sums over samples of neighbour lists.
#[derive(Default)]
struct ListSums {
    count: f64,
    particles: f64,
    neighbours: f64,
    inside: f64,
    column_bytes: f64,
    state_bytes: f64,
}

/// Profiles a run: phases of a step, then observers.
pub(crate) struct Profiler {
    clock: Arc<Clock>,
    /// Profile of the part of the run before a checkpoint.
    earlier: Breakdown,
    lists: ListSums,
    sampled: u64,
    steps_before: u64,
    list_builds_before: u64,
}

impl Profiler {
    /// A profiler of a simulation with these observers; frames and checkpoints are the last.
    pub fn new<X: Numbers>(
        simulation: &mut dyn Stepper<X>,
        observers: Vec<&'static str>,
        earlier: Breakdown,
    ) -> Self {
        let names = [&PHASES[..], &observers, &[PAUSE]].concat().into_iter();
        let new = |name| Timed { name, nanoseconds: 0.into(), times: 0.into() };
        let parts: Vec<_> = names.map(new).collect();
        let (part, since) = (AtomicUsize::new(parts.len() - 1), AtomicU64::new(0));
        let clock = Arc::new(Clock { start: Instant::now(), part, since, parts });
        let watch = Arc::clone(&clock);
        simulation.data_mut().watch = Some(Box::new(move |phase| watch.enter(name_of(phase))));
        let work = simulation.work();
        let (steps_before, list_builds_before) = (work.steps, work.list_builds);
        let (lists, sampled) = (ListSums::default(), 0);
        Self { clock, earlier, lists, sampled, steps_before, list_builds_before }
    }

    /// Stepping begins. The time between an observer and the next phase of a step counts as observing.
    pub fn step(&self) {
        self.clock.enter(REST);
    }

    /// An observer begins.
    pub fn observe(&self, observer: &str) {
        self.clock.enter(observer);
    }

    /// Neither stepping nor observing begins.
    pub fn pause(&self) {
        self.clock.enter(PAUSE);
    }

    /// Looks at the lists of a simulation that was brought to a time, if the last look is long ago.
    pub fn sample<X: Numbers>(&mut self, simulation: &dyn Stepper<X>) {
        let steps = simulation.work().steps;
        // Before the first step nothing is derived yet that could be sampled.
        if steps == 0 || self.lists.count > 0.0 && steps < self.sampled + SAMPLE_EVERY {
            return;
        }
        self.sampled = steps;
        let (columns, lists) = (simulation.plain_columns(), &mut self.lists);
        for (own, list) in columns.iter().zip(simulation.data().lists()) {
            let (mut neighbours, mut inside) = (0, 0);
            for other in list.map(|place| &columns[place]) {
                neighbours += 1;
                let r2 = (own.position - other.position).norm_squared();
                inside += u32::from(simulation.weight(r2) > 0.0);
            }
            lists.neighbours += f64::from(neighbours);
            lists.inside += f64::from(inside);
        }
        let particles = simulation.data().fluid_count() + simulation.data().walls().len();
        lists.count += 1.0;
        lists.particles += simulation.data().fluid_count() as f64;
        lists.column_bytes += simulation.data().column_bytes as f64;
        lists.state_bytes += (particles * size_of::<State<X>>()) as f64;
    }

    /// The profile so far.
    pub fn breakdown<X: Numbers>(&self, simulation: &dyn Stepper<X>) -> Breakdown {
        let mut all = self.earlier.clone();
        for Timed { name, nanoseconds, times } in &self.clock.parts {
            let parts = match *name {
                PAUSE => continue,
                name if PHASES.contains(&name) => &mut all.stepping,
                _ => &mut all.observing,
            };
            add(parts, name, 1e-9 * nanoseconds.load(Relaxed) as f64, times.load(Relaxed));
        }
        let work = simulation.work();
        all.steps += work.steps - self.steps_before;
        all.list_builds += work.list_builds - self.list_builds_before;
        let sweeps =
            all.stepping.iter().filter(|part| [FORCES, DRIFT, BOTH].contains(&&*part.name));
        let sweeps = sweeps.map(|part| part.times).sum::<u64>() as f64;
        let ListSums { count, particles, neighbours, inside, column_bytes, state_bytes } =
            self.lists;
        all.neighbours = neighbours / particles;
        all.inside = inside / neighbours;
        // Each of a group is in the list that the group shares.
        let list_bytes = size_of::<u32>() as f64 * (neighbours + particles) / GROUP as f64;
        let bytes = list_bytes + 2.0 * column_bytes + 3.0 * state_bytes;
        all.bytes_a_step = sweeps / all.steps as f64 * bytes / count;
        all
    }
}

/// Adds to the part with this name, which its first time creates.
fn add(parts: &mut Vec<Part>, name: &str, seconds: f64, times: u64) {
    match parts.iter_mut().find(|part| part.name == name) {
        Some(part) => (part.seconds, part.times) = (part.seconds + seconds, part.times + times),
        None if times > 0 => parts.push(Part { name: name.into(), seconds, times }),
        None => {}
    }
}
