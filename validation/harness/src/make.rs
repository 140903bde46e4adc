//! Runs what a plan asks for and a store lacks: first what is not timed, side by side and the longest first;
//! then, with nothing else of this program at work, what is timed, one run at a time, in rounds over all of
//! them, so that a change of the machine's pace meets every variant alike.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use base::{
    record::{Record, Status},
    spec::{RunKey, RunSpec, Task},
};
use thiserror::Error;

use crate::{
    bisect,
    case::{Case, RunError},
    context::Context,
    planned::{Planned, Tier},
    store::{Found, Store, StoreError},
};

/// A planned run and the case that it is of.
#[derive(Clone)]
pub struct Job {
    /// The case.
    pub case: &'static dyn Case,
    /// The run.
    pub planned: Planned,
}

/// Told after each run: how many are done, how many there are, the name.
pub type Progress<'a> = dyn Fn(usize, usize, &str) + Sync + 'a;

/// How runs are made.
pub struct Making<'a> {
    /// How much is run: the quick tier repeats fewer timings.
    pub tier: Tier,
    /// Records that exist, and where new ones are kept; without one they are kept in memory alone.
    pub store: Option<&'a Store>,
    /// Digest of the sources that decide what a case computes.
    pub sources: &'a (dyn Fn(&str) -> String + Sync),
    /// Are records of other sources good enough?
    pub reuse_other: bool,
    /// Told after each run.
    pub progress: Option<&'a Progress<'a>>,
    /// Set from outside to stop.
    pub interrupt: Option<&'a AtomicBool>,
}

/// Records of a plan, and where they come from.
#[derive(Debug, Default)]
pub struct Made {
    /// By run.
    pub records: BTreeMap<RunKey, Record>,
    /// Runs whose record the store had.
    pub reused: usize,
    /// Those of them that other sources made.
    pub of_other_sources: usize,
    /// Was it stopped from outside?
    pub interrupted: bool,
}

/// Why making runs ended early. A run that is refused or diverges is no such reason: it has a record.
#[derive(Debug, Error)]
pub enum MakeError {
    /// A record could not be kept.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A file of a run could not be written, or a reference could not be read.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// Timings of a run that is cheap enough to be timed again: the fewest that have a median.
const REPETITIONS: usize = 3;

/// Runs up to this many processor seconds are timed again \[s\].
fn timed_again_below(tier: Tier) -> f64 {
    match tier {
        Tier::Quick => 0.1,
        Tier::Full => 0.5,
    }
}

/// Makes every run of the jobs that the store lacks.
///
/// # Errors
/// If a record or a file cannot be written; what was made before is in the store.
pub fn make(jobs: &[Job], making: &Making) -> Result<Made, MakeError> {
    let mut made = Made::default();
    let mut missing = Vec::new();
    for job in jobs {
        let spec = &job.planned.spec;
        let sources = (making.sources)(&spec.case);
        let found = making.store.map_or(Found::Nothing, |store| store.find(spec, &sources));
        let record = match found {
            Found::Same(record) => record,
            Found::Other(record) if making.reuse_other => {
                made.of_other_sources += 1;
                record
            }
            _ => {
                missing.push(job);
                continue;
            }
        };
        if job.planned.timed && record.cost.alone_s.is_empty() && record.status == Status::Completed
        {
            missing.push(job); // it is there, but was made side by side with others
        } else {
            made.reused += 1;
            made.records.insert(spec.key(), *record);
        }
    }
    let (timed, mut rest): (Vec<&Job>, Vec<&Job>) =
        missing.into_iter().partition(|job| job.planned.timed);
    rest.sort_by(|a, b| b.planned.seconds.total_cmp(&a.planned.seconds));
    let batch = Batch { making, all: timed.len() + rest.len(), done: AtomicUsize::new(0) };
    for record in side_by_side(&rest, &batch)? {
        made.records.insert(record.key(), record);
    }
    for record in alone(&timed, &batch)? {
        made.records.insert(record.key(), record);
    }
    made.interrupted = batch.is_interrupted();
    Ok(made)
}

/// The runs that are being made, and who is told of each.
struct Batch<'a> {
    making: &'a Making<'a>,
    all: usize,
    done: AtomicUsize,
}

impl Batch<'_> {
    fn is_interrupted(&self) -> bool {
        self.making.interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Keeps a record and says that it is there; one that was interrupted is dropped.
    fn done(&self, job: &Job, record: Record) -> Result<Option<Record>, MakeError> {
        if matches!(record.status, Status::Interrupted { .. }) {
            return Ok(None);
        }
        if let Some(store) = self.making.store {
            store.write(&record)?;
        }
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        if let Some(progress) = self.making.progress {
            progress(done, self.all, &format!("{} {}", job.case.name(), job.planned.spec.variant));
        }
        Ok(Some(record))
    }

    fn run(&self, job: &Job) -> Result<Record, MakeError> {
        let interrupt = self.making.interrupt;
        let context = Context { threads: 1, interrupt, ..Context::default() };
        let mut record = run(job.case, &job.planned.spec, &context)?;
        record.manifest.sources = (self.making.sources)(job.case.name());
        Ok(record)
    }
}

/// Each thread takes the longest run that is left.
fn side_by_side(jobs: &[&Job], batch: &Batch) -> Result<Vec<Record>, MakeError> {
    let (next, made) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || -> Result<Vec<Record>, MakeError> {
        let mut mine = Vec::new();
        while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
            if batch.is_interrupted() {
                break;
            }
            mine.extend(batch.done(job, batch.run(job)?)?);
        }
        Ok(mine)
    };
    // Not a broadcast, which would wait for threads of the pool that are busy with other things.
    rayon::scope(|scope| {
        for _ in 0..rayon::current_num_threads() {
            scope.spawn(|_| {
                let mine = work();
                made.lock().unwrap_or_else(PoisonError::into_inner).push(mine);
            });
        }
    });
    let made = made.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(made.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// One run at a time; cheap ones again in further rounds. A record is kept as soon as it is there, and
/// again with the timings of a later round.
fn alone(jobs: &[&Job], batch: &Batch) -> Result<Vec<Record>, MakeError> {
    let again_below = timed_again_below(batch.making.tier);
    let mut records: Vec<Record> = Vec::new();
    for job in jobs {
        if batch.is_interrupted() {
            return Ok(records);
        }
        let mut record = batch.run(job)?;
        record.cost.alone_s = vec![record.cost.cpu_s];
        records.extend(batch.done(job, record)?);
    }
    for _ in 1..REPETITIONS {
        for (job, record) in jobs.iter().zip(&mut records) {
            if !batch.is_interrupted() && record.cost.alone_s[0] < again_below {
                let again = batch.run(job)?;
                if !matches!(again.status, Status::Interrupted { .. }) {
                    record.cost.alone_s.push(again.cost.cpu_s);
                }
            }
        }
    }
    let again = records.iter().filter(|record| record.cost.alone_s.len() > 1);
    again
        .filter_map(|record| batch.making.store.map(|store| store.write(record)))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(records)
}

/// One run of a case: a simulation, or a bisection of many. Settings that make no run are a record too,
/// with the reason; what remains an error is a file that cannot be written.
///
/// # Errors
/// [`RunError::File`], [`RunError::Frame`] and [`RunError::Reference`].
pub fn run(case: &dyn Case, spec: &RunSpec, context: &Context) -> Result<Record, RunError> {
    let record = match &spec.task {
        Task::Simulate => case.run(spec, context),
        Task::Bisect(bisect) => bisect::run(case, spec, bisect, context),
    };
    match record {
        Err(refusal) if refusal.is_refusal() => Ok(Record::refused(spec, refusal.to_string())),
        Err(error) => Err(error),
        Ok(record) => Ok(record.of(spec)),
    }
}

/// The jobs of several cases.
pub fn jobs(plans: Vec<(&'static dyn Case, Vec<Planned>)>) -> Vec<Job> {
    let job = |case| move |planned| Job { case, planned };
    plans.into_iter().flat_map(|(case, plan)| plan.into_iter().map(job(case))).collect()
}
