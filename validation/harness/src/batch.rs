//! Makes runs: side by side, the longest first; long and large ones on all threads; timed ones one at a time
//! while this program does nothing else.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use rayon::prelude::*;
use touchstone_base::{
    lock,
    record::{Record, Status},
    spec::{RunSpec, Task},
};

use crate::{
    bisect,
    case::{self, RunError},
    context::{self, Context},
    detect,
    gates::GateIndex,
    jobs::{BatchOptions, BatchResult, Job},
    runs::Tier,
    store::RunLease,
    tally::{Done, Tally},
};

/// Timings of a run that is cheap enough to be timed again: the fewest that have a median.
const REPETITIONS: usize = 3;

/// Runs up to this many processor seconds are timed again \[s\].
fn timed_again_below(tier: Tier) -> f64 {
    match tier {
        Tier::Quick => 0.1,
        Tier::Full | Tier::Deep => 0.5,
    }
}

/// The part of a run in the wall time of the batch \[s\], from its time on all its threads together: the
/// whole time with repetitions if it is timed, otherwise its part of the time of all threads.
fn of_batch(job: &Job, making: &BatchOptions, seconds: f64) -> f64 {
    match job.planned.timed {
        true if seconds < timed_again_below(making.tier) => REPETITIONS as f64 * seconds,
        true => seconds,
        false => seconds / rayon::current_num_threads() as f64,
    }
}

/// The runs that are made on all threads, one at a time, and the others, each the longest first. On one
/// thread a run of the first kind would take longer than all runs together on all threads, which would wait
/// for it.
fn on_all_threads(mut jobs: Vec<&Job>, threads: usize) -> [Vec<&Job>; 2] {
    jobs.sort_by(|a, b| b.planned.seconds.total_cmp(&a.planned.seconds));
    let all: f64 = jobs.iter().map(|job| job.planned.seconds).sum();
    let keeps_waiting =
        |job: &&Job| job.planned.is_large && job.planned.seconds > all / threads as f64;
    jobs.into_iter().partition(keeps_waiting).into()
}

/// The runs in progress, and the callbacks.
pub(crate) struct Batch<'a> {
    making: &'a BatchOptions<'a>,
    tally: Mutex<Tally>,
    made: Mutex<BatchResult>,
    /// The gates of each case, for searches of the errors that they detect.
    gates: BTreeMap<&'static str, GateIndex<'static>>,
}

impl<'a> Batch<'a> {
    /// A batch of jobs that are still to be made, with the records that exist.
    pub(crate) fn new(jobs: &[Job], made: BatchResult, making: &'a BatchOptions<'a>) -> Self {
        let (mut tally, mut gates) = (Tally::default(), BTreeMap::new());
        for job in jobs {
            let expected = of_batch(job, making, job.planned.seconds);
            tally.plan(job.planned.spec.key(), job.case.name(), expected);
            gates.entry(job.case.name()).or_insert_with(|| GateIndex::of(job.case));
        }
        let batch = Self { making, tally: Mutex::new(tally), made: Mutex::new(made), gates };
        batch.update_tally(|_| ());
        batch
    }

    /// Makes some of the jobs: first those that take all threads, then the others side by side, and last the
    /// timed ones.
    pub(crate) fn make_all(&self, jobs: Vec<&Job>) {
        let (timed, rest): (Vec<&Job>, Vec<&Job>) =
            jobs.into_iter().partition(|job| job.planned.timed);
        let threads = rayon::current_num_threads();
        let [one_by_one, side_by_side] = on_all_threads(rest, threads);
        one_by_one.into_iter().for_each(|job| self.make(job, threads));
        // Each thread takes the longest run that is left.
        side_by_side.into_iter().par_bridge().for_each(|job| self.make(job, 1));
        self.alone(&timed);
    }

    /// All records so far.
    pub(crate) fn made(self) -> BatchResult {
        let mut made = self.made.into_inner().unwrap_or_else(PoisonError::into_inner);
        made.interrupted = self.making.is_interrupted();
        made
    }

    /// Changes the tally and reports the progress.
    fn update_tally(&self, change: impl FnOnce(&mut Tally)) {
        let mut tally = lock(&self.tally);
        change(&mut tally);
        if let Some(progress) = self.making.progress {
            let (share, left) = (tally.share(), tally.left());
            let (runs, all) = (tally.done, tally.runs.len());
            progress(Done { runs, all, share, left, last: &tally.last });
        }
    }

    /// Keeps a record, in the store too if there is one, or notes why it could not be written there.
    fn keep(&self, record: Record) {
        let written = self.making.store.map(|store| store.write(&record));
        let mut made = lock(&self.made);
        if let Some(Err(error)) = written {
            made.not_kept.entry(record.run.key()).or_insert(error);
        }
        made.records.insert(record.run.key(), record);
    }

    /// Makes a run unless stopped, keeps its record, and reports the record, and the case if it was the last
    /// run of its case. Timed runs are profiled.
    fn make(&self, job: &Job, threads: usize) {
        if self.making.is_interrupted() {
            return;
        }
        let (key, start) = (job.planned.spec.key(), Instant::now());
        if let Some(mut record) = self.run(job, threads, job.planned.timed) {
            if job.planned.timed {
                record.cost.alone_s = vec![record.cost.cpu_s];
            }
            let name = format!("{} {}", job.case.name(), record.run.variant);
            self.keep(record);
            let took = of_batch(job, self.making, threads as f64 * start.elapsed().as_secs_f64());
            self.update_tally(|tally| tally.finish(&key, name, took));
        }
        let is_last = lock(&self.tally).end(&key);
        let Some(finished) = self.making.finished.filter(|_| is_last) else { return };
        if !self.making.is_interrupted() {
            let made = lock(&self.made);
            let BatchResult { reused, of_other_sources, .. } = *made;
            let (records, submissions) = (made.records.clone(), made.submissions.clone());
            drop(made);
            finished(BatchResult {
                records,
                submissions,
                reused,
                of_other_sources,
                ..BatchResult::default()
            });
        }
    }

    /// Makes a run, and finds out where its time goes if it is to be profiled; none if it failed or was
    /// interrupted.
    fn run(&self, job: &Job, threads: usize, profile: bool) -> Option<Record> {
        let (interrupt, spec, start) = (self.making.interrupt, &job.planned.spec, Instant::now());
        let begun = self.making.store.map(|store| store.begin(spec));
        let is_one = spec.is_simulation();
        let show = |progress: context::RunProgress| {
            begun.iter().for_each(RunLease::beat);
            if !is_one {
                return; // of a bisection nobody knows how many simulations are left
            }
            let part = progress.time / progress.end;
            let took = of_batch(job, self.making, threads as f64 * start.elapsed().as_secs_f64());
            self.update_tally(|tally| tally.reach(&spec.key(), part, took));
        };
        let (progress, allow_long) = (Some(&show as _), self.making.allow_long);
        let context =
            Context { threads, allow_long, profile, interrupt, progress, ..Context::default() };
        let gates = &self.gates[job.case.name()];
        let made = catch_unwind(AssertUnwindSafe(|| run(gates, spec, &context)));
        match made.unwrap_or(Err(RunError::Bug)) {
            Ok(mut record) => {
                begun.into_iter().for_each(|begun| begun.end(None));
                record.manifest.sources = (self.making.sources)(job.case.name());
                let is_whole = !matches!(record.status, Status::Interrupted { .. });
                is_whole.then_some(record)
            }
            Err(failed) => {
                begun.into_iter().for_each(|begun| begun.end(Some(&failed.to_string())));
                lock(&self.made).failed.entry(spec.key()).or_insert(failed);
                None
            }
        }
    }

    /// One run at a time, the first of each profiled; cheap ones again in further rounds. A record is kept as
    /// soon as it is there, and again with the timings of the later rounds.
    fn alone(&self, jobs: &[&Job]) {
        jobs.iter().for_each(|job| self.make(job, 1));
        let record = |job: &Job| lock(&self.made).records.get(&job.planned.spec.key()).cloned();
        let is_cheap = |record: &Record| {
            record.cost.alone_s.iter().any(|seconds| *seconds < timed_again_below(self.making.tier))
        };
        let made = jobs.iter().filter_map(|job| Some((*job, record(job)?)));
        let mut cheap: Vec<(&Job, Record)> = made.filter(|(_, record)| is_cheap(record)).collect();
        for _ in 1..REPETITIONS {
            for (job, record) in &mut cheap {
                if self.making.is_interrupted() {
                    break;
                }
                record.cost.alone_s.extend(self.run(job, 1, false).map(|again| again.cost.cpu_s));
            }
        }
        let again = cheap.into_iter().map(|(_, record)| record);
        again.filter(|record| record.cost.alone_s.len() > 1).for_each(|record| self.keep(record));
    }
}

/// One run of a case: a simulation, or a search by many. Settings that are refused give a
/// record too, with the reason; the only error is a file that cannot be written.
///
/// # Errors
/// [`RunError::File`] and [`RunError::Reference`].
pub fn run(gates: &GateIndex, spec: &RunSpec, context: &Context) -> Result<Record, RunError> {
    match &spec.task {
        Task::Simulate => case::record_of(gates.case, spec, context),
        Task::Bisect(bisect) => bisect::run(gates.case, spec, bisect, context),
        Task::Detect(detect) => detect::run(gates, spec, detect, context),
    }
}
