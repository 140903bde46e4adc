//! What the runs of a plan take, estimated before the first of them: what plans say is a guess.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};

use base::spec::{RunSpec, Task};
use harness::{
    context::Context,
    make::{Job, Making},
    size::Size,
};
use rayon::prelude::*;

/// Whole simulations that a bisection takes as long as, or a search for the smallest error that is detected,
/// about: most of the ten or so that it makes diverge early or are of a short time.
const SIMULATIONS: f64 = 3.0;

/// Gives each job the time that its run states before its first step. A run that is refused takes none.
pub fn estimate(jobs: &mut [Job], making: &Making) {
    jobs.par_iter_mut().filter(|_| !making.is_interrupted()).for_each(|job| {
        if let Some(size) = size(job, making.allow_long) {
            let is_one = job.planned.spec.task == Task::Simulate;
            job.planned.seconds = if is_one { 1.0 } else { SIMULATIONS } * size.seconds();
        }
    });
}

/// The size of the simulation of a job, which ends as soon as it has told it.
fn size(job: &Job, allow_long: bool) -> Option<Size> {
    let told = Mutex::new(None);
    let tell = |size: &Size| {
        *told.lock().unwrap_or_else(PoisonError::into_inner) = Some(*size);
    };
    let context =
        Context { allow_long, estimate: Some(&tell), only_estimate: true, ..Context::default() };
    let spec = RunSpec { task: Task::Simulate, ..job.planned.spec.clone() };
    // What fails here fails again when it is made, and is told then.
    let _ = catch_unwind(AssertUnwindSafe(|| job.case.run(&spec, &context)));
    told.into_inner().unwrap_or_else(PoisonError::into_inner)
}
