//! The jobs of a batch: runs to make, how they are made, and their records.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

use touchstone_base::{files::FileError, record::Record, spec::RunKey};

use crate::{
    case::{Case, RunError},
    runs::{Planned, Tier},
    store::Store,
    tally::Done,
};

/// A planned run and the case that it is of.
#[derive(Clone)]
pub struct Job {
    /// The case.
    pub case: &'static dyn Case,
    /// The run.
    pub planned: Planned,
}

/// Called before the first run, a few times a second during the runs, and after each run.
pub type OnProgress<'a> = dyn Fn(Done) + Sync + 'a;

/// Called each time that all runs of a case have ended, with the results so far.
pub type Finished<'a> = dyn Fn(BatchResult) + Sync + 'a;

/// How runs are made.
#[derive(Clone, Copy)]
pub struct BatchOptions<'a> {
    /// How much is run: the quick tier repeats fewer timings.
    pub tier: Tier,
    /// Records that exist, and where new ones are kept; without one they are kept in memory alone.
    pub store: Option<&'a Store>,
    /// Digest of the sources that determine the results of a case.
    pub sources: &'a (dyn Fn(&str) -> String + Sync),
    /// May records made by other sources be reused?
    pub reuse_other: bool,
    /// Is every run made again? The record of before stays until the new one is whole.
    pub fresh: bool,
    /// Whether runs may be long; refused runs are then tried again.
    pub allow_long: bool,
    /// Progress callback.
    pub progress: Option<&'a OnProgress<'a>>,
    /// Called when a case is complete, the first one early.
    pub finished: Option<&'a Finished<'a>>,
    /// Set by another thread to stop.
    pub interrupt: Option<&'a AtomicBool>,
}

impl<'a> BatchOptions<'a> {
    /// Is it to stop?
    pub fn is_interrupted(&self) -> bool {
        self.interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Makes every run and keeps the records in memory alone.
    pub fn new(tier: Tier, sources: &'a (dyn Fn(&str) -> String + Sync)) -> Self {
        BatchOptions {
            tier,
            store: None,
            sources,
            reuse_other: false,
            fresh: false,
            allow_long: false,
            progress: None,
            finished: None,
            interrupt: None,
        }
    }
}

/// Records of a plan, and where they come from.
#[derive(Debug, Default)]
pub struct BatchResult {
    /// The records by the key of their run.
    pub records: BTreeMap<RunKey, Record>,
    /// Runs whose record the store had.
    pub reused: usize,
    /// Reused records that were made from other sources.
    pub of_other_sources: usize,
    /// Errors of the store for records that it could not keep. They are still among `records`: a full disk
    /// loses no result.
    pub not_kept: BTreeMap<RunKey, FileError>,
    /// Why records that the store had could not be read; these runs were made again.
    pub unsound: BTreeMap<RunKey, FileError>,
    /// Why runs have no record. None of them costs another its record.
    pub failed: BTreeMap<RunKey, RunError>,
    /// Runs that other codes made of the cases of the plan, as the store has them.
    pub submissions: Vec<Record>,
    /// Runs that other codes made of these cases, as the program contains them.
    pub peers: Vec<Record>,
    /// Why files that say that they are such runs could not be read.
    pub unread: Vec<FileError>,
    /// Was it stopped from outside?
    pub interrupted: bool,
}

/// The jobs of several cases.
pub fn jobs(plans: Vec<(&'static dyn Case, Vec<Planned>)>) -> Vec<Job> {
    let job = |case| move |planned| Job { case, planned };
    plans.into_iter().flat_map(|(case, plan)| plan.into_iter().map(job(case))).collect()
}
