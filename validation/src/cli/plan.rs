//! `plan`: runs as JSON lines, and what they take, estimated before the first of them: what plans say is a
//! guess. `plan --estimates` writes the table, and the sum is told.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;

use ::report::{counted, seconds, sig};
use base::{
    files::{self, Cell, CsvTable, FileError},
    spec::{RunSpec, Task},
};
use harness::{
    case::{self, Case, Planned, Tier},
    context::Context,
    make::{Job, Making},
    plan,
    size::{self, Size},
};
use rayon::prelude::*;

use super::{Failure, World, arguments, list::default_variant, output};

pub fn plan(arguments: &arguments::Plan, world: &World) -> Result<(), Failure> {
    let cases = world.choose(&arguments.cases)?;
    let jobs = if arguments.set.is_empty() && arguments.variant.is_empty() {
        let of_case = |case| {
            plan::of_case(case, arguments.tier)
                .into_iter()
                .map(move |planned| Job { case, planned })
        };
        cases.into_iter().flat_map(of_case).collect()
    } else {
        let [case] = cases[..] else {
            return Err(Failure::usage(
                "--set and --variant ask for a sweep over the settings of one case; name one case",
            ));
        };
        sweep(case, &arguments.variant, &arguments.set, world)?
    };
    if arguments.estimates.is_some() || arguments.tier == Tier::Deep {
        let making = world.making(Tier::Quick);
        let of = |job: &Job| if making.is_interrupted() { None } else { size(job, true) };
        let sizes: Vec<Option<Size>> = jobs.par_iter().map(of).collect();
        if world.is_interrupted() {
            return Err(Failure::interrupted("no plan is printed"));
        }
        if let Some(path) = &arguments.estimates {
            files::write_atomically(path, &table(&jobs, &sizes)?)?;
        }
        output::say(&sum(&jobs, &sizes));
    }
    let line = |job: &Job| job.planned.spec.canonical() + "\n";
    output::print(&jobs.iter().map(line).collect::<String>())
}

/// More runs than this are no sweep but a mistake.
const MOST_RUNS: f64 = 1e6;

/// Every combination of variants and values, the last setting fastest.
fn sweep(
    case: &'static dyn Case,
    variants: &[String],
    set: &[String],
    world: &World,
) -> Result<Vec<Job>, Failure> {
    let default = [default_variant(case).to_string()];
    let variants = if variants.is_empty() { &default } else { variants };
    let values = |assignment: &String| assignment.matches(',').count() as f64 + 1.0;
    let count = variants.len() as f64 * set.iter().map(values).product::<f64>();
    if count > MOST_RUNS {
        let words = format!(
            "the sweep has {} runs; allowed are at most {MOST_RUNS:.0}; give fewer values",
            sig(count, 3)
        );
        return Err(Failure::usage(words));
    }
    let mut combinations: Vec<Vec<String>> = vec![Vec::new()];
    for assignment in set {
        let texts: Vec<String> = match assignment.split_once('=') {
            Some((key, all)) => all.split(',').map(|value| format!("{key}={value}")).collect(),
            None => vec![assignment.clone()],
        };
        let with = |before: &Vec<String>, text: &String| {
            [&before[..], std::slice::from_ref(text)].concat()
        };
        let all =
            combinations.iter().flat_map(|before| texts.iter().map(move |text| with(before, text)));
        combinations = all.collect();
    }
    let mut jobs = Vec::new();
    for variant in variants {
        for set in &combinations {
            if world.is_interrupted() {
                return Err(Failure::interrupted("no plan is printed"));
            }
            jobs.push(Job { case, planned: Planned::new(case::spec(case, variant, set)?) });
        }
    }
    Ok(jobs)
}

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

/// What each run takes, a row a line of the plan with its number for `run --index`; nothing of a run that is
/// refused.
fn table(jobs: &[Job], sizes: &[Option<Size>]) -> Result<Vec<u8>, FileError> {
    let mut table = CsvTable::new(&["index[-]", "time[s]", "memory[MB]"])?;
    for (index, (job, size)) in jobs.iter().zip(sizes).enumerate() {
        let numbers = size.map(|size| [time(&job.planned.spec, &size), 1e-6 * size.bytes()]);
        let cell = |k: usize| Cell::from(numbers.map(|of| of[k]).filter(|of| of.is_finite()));
        table.cells(&[Cell::Text(index.to_string()), cell(0), cell(1)])?;
    }
    Ok(table.into_bytes())
}

/// What all runs take together, the longest and the largest of them, and how many are refused.
fn sum(jobs: &[Job], sizes: &[Option<Size>]) -> String {
    let sizes = || jobs.iter().zip(sizes).filter_map(|(job, size)| Some((job, size.as_ref()?)));
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

/// The size of the simulation of a job, which ends as soon as it has told it.
fn size(job: &Job, allow_long: bool) -> Option<Size> {
    let told = OnceLock::new();
    let tell = |size: &Size| {
        let _ = told.set(*size); // once
    };
    let context =
        Context { allow_long, estimate: Some(&tell), only_estimate: true, ..Context::default() };
    let spec = RunSpec { task: Task::Simulate, ..job.planned.spec.clone() };
    // What fails here fails again when it is made, and is told then.
    let _ = catch_unwind(AssertUnwindSafe(|| job.case.run(&spec, &context)));
    told.into_inner()
}
