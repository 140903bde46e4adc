//! How long runs take and how much memory they need, estimated before the first step of each.

use std::panic::{AssertUnwindSafe, catch_unwind};

use rayon::prelude::*;
use touchstone_base::spec::RunSpec;
use touchstone_solver::scene::PARALLEL_FROM;

use crate::{
    jobs::{BatchOptions, Job},
    problem::Steps,
    size::Size,
};

/// Approximate cost of a bisection, or of a search for the smallest detected error, in whole simulations:
/// most of its ten or so runs diverge early or cover a short time.
const SIMULATIONS: f64 = 3.0;

/// Gives each job the time and the size that its run states before its first step. A run that is refused
/// takes no time.
pub fn estimate(jobs: &mut [Job], making: &BatchOptions) {
    jobs.par_iter_mut().filter(|_| !making.is_interrupted()).for_each(|job| {
        if let Some(size) = size(job, making.allow_long) {
            job.planned.seconds = time(&job.planned.spec, &size);
            job.planned.is_large = size.particles >= PARALLEL_FROM as f64;
        }
    });
}

/// Processor time of a run, one simulation or several of this size \[s\].
pub fn time(spec: &RunSpec, size: &Size) -> f64 {
    if spec.is_simulation() { size.seconds() } else { SIMULATIONS * size.seconds() }
}

/// The size of the simulation of a job, unless it is refused.
pub fn size(job: &Job, allow_long: bool) -> Option<Size> {
    let spec = job.planned.spec.simulation();
    // An error here occurs again when the run is made, and is reported then.
    let size = || job.case.pose(&spec)?.size(&spec, Steps::All, allow_long);
    catch_unwind(AssertUnwindSafe(size)).ok()?.ok()
}
