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

/// The names of the phases of a step, by their numbers.
const PHASES: [&str; 8] = [FORCES, DRIFT, BOTH, WALLS, REFRESH, SEARCH, SORTING, REST];

/// Frames for ParaView.
pub const FRAMES: &str = "frames";
/// Checkpoints.
pub const CHECKPOINTS: &str = "checkpoints";

/// Time steps between samples of the lists: a sample costs a fraction of a step.
const SAMPLE_EVERY: u64 = 500;

/// A clock over numbered parts, of which one is under way. Only the thread that steps reads it: atomic, so
/// that a simulation can own a share of it, and never locked.
struct Clock {
    start: Instant,
    part: AtomicUsize,
    since: AtomicU64,
    /// Nanoseconds of each part, and how often it began.
    parts: Vec<[AtomicU64; 2]>,
}

impl Clock {
    fn enter(&self, part: usize) {
        let now = u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX);
        let [spent, _] = &self.parts[self.part.load(Relaxed)];
        spent.store(spent.load(Relaxed) + now - self.since.load(Relaxed), Relaxed);
        self.since.store(now, Relaxed);
        self.part.store(part, Relaxed);
        let [_, times] = &self.parts[part];
        times.store(times.load(Relaxed) + 1, Relaxed);
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

/// Profiles a run: phases by number, then observers, and last the rest.
pub(crate) struct Profiler {
    clock: Arc<Clock>,
    /// Names of all parts but the last.
    names: Vec<&'static str>,
    /// Profile of the part of the run before a checkpoint.
    earlier: Breakdown,
    lists: ListSums,
    sampled: u64,
    /// Steps and builds of lists before it.
    before: [u64; 2],
}

impl Profiler {
    /// A profiler of a simulation with these observers, of which frames and checkpoints are the last.
    pub fn new<X: Numbers>(
        simulation: &mut dyn Stepper<X>,
        observers: Vec<&'static str>,
        earlier: Breakdown,
    ) -> Self {
        let names = [&PHASES[..], &observers].concat();
        let parts = (0..=names.len()).map(|_| Default::default()).collect();
        let (part, since) = (AtomicUsize::new(names.len()), AtomicU64::new(0));
        let clock = Arc::new(Clock { start: Instant::now(), part, since, parts });
        let watch = Arc::clone(&clock);
        let enter = move |phase| watch.enter(phase as usize);
        simulation.data_mut().watch = Some(Box::new(enter));
        let work = simulation.work();
        let before = [work.steps, work.list_builds];
        Self { clock, names, earlier, lists: ListSums::default(), sampled: 0, before }
    }

    /// Stepping begins. The time between an observer and the next phase of a step counts as observing.
    pub fn step(&self) {
        self.clock.enter(Phase::Rest as usize);
    }

    /// An observer begins.
    pub fn observe(&self, observer: &str) {
        let place = self.names.iter().position(|name| *name == observer);
        self.clock.enter(place.unwrap_or(self.names.len()));
    }

    /// Neither stepping nor observing begins.
    pub fn pause(&self) {
        self.clock.enter(self.names.len());
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
        for (k, (name, part)) in self.names.iter().zip(&self.clock.parts).enumerate() {
            let parts = if k < PHASES.len() { &mut all.stepping } else { &mut all.observing };
            let [nanoseconds, times] = part.each_ref().map(|number| number.load(Relaxed));
            add(parts, name, 1e-9 * nanoseconds as f64, times);
        }
        let work = simulation.work();
        all.steps += work.steps - self.before[0];
        all.list_builds += work.list_builds - self.before[1];
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
