//! What the runs of a plan take, estimated before the first of them: what plans say is a guess.
//! `plan --estimates` writes the table, and the sum is told.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, PoisonError};

use ::report::{counted, seconds, sig};
use base::files::{Cell, CsvTable, FileError};
use base::spec::{RunSpec, Task};
use harness::{
    context::Context,
    make::{Job, Making},
    size::{self, Size},
};
use rayon::prelude::*;

/// Whole simulations that a bisection takes as long as, or a search for the smallest error that is detected,
/// about: most of the ten or so that it makes diverge early or are of a short time.
const SIMULATIONS: f64 = 3.0;

/// Gives each job the time that its run states before its first step. A run that is refused takes none.
pub fn estimate(jobs: &mut [Job], making: &Making) {
    jobs.par_iter_mut().filter(|_| !making.is_interrupted()).for_each(|job| {
        if let Some(size) = size(job, making.allow_long) {
            job.planned.seconds = time(&job.planned.spec, &size);
        }
    });
}

/// Processor time of a run, one simulation or several of this size \[s\].
fn time(spec: &RunSpec, size: &Size) -> f64 {
    if spec.task == Task::Simulate { size.seconds() } else { SIMULATIONS * size.seconds() }
}

/// What each of the runs of a plan takes, in its order; nothing of a run that is refused.
pub struct Estimates(Vec<Option<Size>>);

impl Estimates {
    /// Those of these runs, long ones included.
    pub fn of(jobs: &[Job], making: &Making) -> Self {
        let of = |job: &Job| if making.is_interrupted() { None } else { size(job, true) };
        Self(jobs.par_iter().map(of).collect())
    }

    /// A row a line of the plan, with its number for `run --index`.
    pub fn table(&self, jobs: &[Job]) -> Result<Vec<u8>, FileError> {
        let mut table = CsvTable::new(&["index[-]", "time[s]", "memory[MB]"])?;
        for (index, (job, size)) in jobs.iter().zip(&self.0).enumerate() {
            let numbers = size.map(|size| [time(&job.planned.spec, &size), 1e-6 * size.bytes()]);
            let cell = |k: usize| Cell::from(numbers.map(|of| of[k]).filter(|of| of.is_finite()));
            table.cells(&[Cell::Text(index.to_string()), cell(0), cell(1)])?;
        }
        Ok(table.into_bytes())
    }

    /// Their sum, the longest and the largest of them, and how many are refused.
    pub fn sum(&self, jobs: &[Job]) -> String {
        let sizes =
            || jobs.iter().zip(&self.0).filter_map(|(job, size)| Some((job, size.as_ref()?)));
        let times: Vec<f64> = sizes().map(|(job, size)| time(&job.planned.spec, size)).collect();
        format!(
            "estimate: {}, {} refused; about {} on one core, the longest {}; memory of the largest {} MB; \
             {} of more than {} or {} GB a simulation need --allow-long",
            counted(jobs.len(), "run", "runs"),
            jobs.len() - times.len(),
            seconds(times.iter().sum()),
            seconds(times.iter().copied().fold(0.0, f64::max)),
            sig(1e-6 * sizes().map(|(_, size)| size.bytes()).fold(0.0, f64::max), 2),
            sizes().filter(|(_, size)| size.is_too_much()).count(),
            seconds(size::MOST_SECONDS),
            sig(1e-9 * size::MOST_BYTES, 2),
        )
    }
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
