//! What the runs of a plan take, estimated before the first of them: what plans say is a guess.

use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};

use base::spec::{RunSpec, Task};
use harness::{
    context::Context,
    make::Job,
    size::Size,
    store::{Found, Store},
};
use rayon::prelude::*;

/// Whole simulations that a bisection takes as long as, or a search for the smallest error that is detected,
/// about: most of the ten or so that it makes diverge early or are of a short time.
const SIMULATIONS: f64 = 3.0;

/// The jobs, those that the store lacks with the estimate that each run makes before its first step.
pub fn estimated(jobs: &[Job], store: Option<&Store>, sources: fn(&str) -> String) -> Vec<Job> {
    let one = |job: &Job| {
        let mut job = job.clone();
        let spec = &job.planned.spec;
        let is_made = store
            .is_some_and(|store| matches!(store.find(spec, &sources(&spec.case)), Found::Same(_)));
        if !is_made && let Some(size) = size(&job) {
            let simulations = if spec.task == Task::Simulate { 1.0 } else { SIMULATIONS };
            job.planned.seconds = simulations * size.seconds();
        }
        job
    };
    jobs.par_iter().map(one).collect()
}

/// The size of the simulation of a job, which is stopped as soon as it has told it.
fn size(job: &Job) -> Option<Size> {
    let (told, stop) = (Mutex::new(None), AtomicBool::new(true));
    let tell = |size: &Size| {
        // A run may consist of several simulations, the first of which is the longest.
        told.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(*size);
    };
    let context = Context {
        threads: 1,
        allow_long: true,
        estimate: Some(&tell),
        interrupt: Some(&stop),
        ..Context::default()
    };
    let spec = RunSpec { task: Task::Simulate, ..job.planned.spec.clone() };
    // Settings that are refused have no size: such a run takes no time.
    let _ = job.case.run(&spec, &context);
    told.into_inner().unwrap_or_else(PoisonError::into_inner)
}
