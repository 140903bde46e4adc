//! `plan`: runs as JSON lines.

use base::{files, spec::RunSpec};
use harness::{
    case::{self, Case, Planned, Tier},
    make::Job,
    plan,
};
use validation::cases;

use super::{
    Exit, Failure, Outcome, World, arguments, estimate::Estimates, list::default_variant, output,
};

pub fn plan(arguments: &arguments::Plan, world: &World) -> Outcome {
    let cases = world.choose(&arguments.cases)?;
    let specs = if arguments.set.is_empty() && arguments.variant.is_empty() {
        let of_case = |case: &&'static dyn Case| plan::of_case(*case, arguments.tier);
        cases.iter().flat_map(of_case).map(|planned| planned.spec).collect()
    } else {
        let [case] = cases[..] else {
            return Err(Failure::usage(
                "--set and --variant ask for a sweep over the settings of one case; name one case",
            ));
        };
        sweep(case, &arguments.variant, &arguments.set, world)?
    };
    let lines: Vec<String> = specs.iter().map(|spec: &RunSpec| spec.canonical() + "\n").collect();
    if arguments.estimates.is_some() || arguments.tier == Tier::Deep {
        estimate(specs, arguments, world)?;
    }
    output::print(&lines.concat())?;
    Ok(Exit::Pass)
}

/// Tells what the runs take together, and writes what each of them takes.
fn estimate(
    specs: Vec<RunSpec>,
    arguments: &arguments::Plan,
    world: &World,
) -> Result<(), Failure> {
    let job = |spec: RunSpec| {
        Ok(Job { case: cases::find_in(world.cases, &spec.case)?, planned: Planned::new(spec) })
    };
    let jobs = specs.into_iter().map(job).collect::<Result<Vec<Job>, Failure>>()?;
    let estimates = Estimates::of(&jobs, &world.making(Tier::Quick));
    if world.is_interrupted() {
        return Err(Failure::interrupted("no plan is printed"));
    }
    if let Some(path) = &arguments.estimates {
        files::write_atomically(path, &estimates.table(&jobs)?)?;
    }
    output::say(&estimates.sum(&jobs));
    Ok(())
}

/// More runs than this are no sweep but a mistake.
const MOST_RUNS: f64 = 1e6;

/// Every combination of variants and values, the last setting fastest.
fn sweep(
    case: &dyn Case,
    variants: &[String],
    set: &[String],
    world: &World,
) -> Result<Vec<RunSpec>, Failure> {
    let default = [default_variant(case).to_string()];
    let variants = if variants.is_empty() { &default } else { variants };
    let values = |assignment: &String| assignment.matches(',').count() as f64 + 1.0;
    let count = variants.len() as f64 * set.iter().map(values).product::<f64>();
    if count > MOST_RUNS {
        let words = format!(
            "the sweep has {} runs; allowed are at most {MOST_RUNS:.0}; give fewer values",
            ::report::sig(count, 3)
        );
        return Err(Failure::usage(words));
    }
    let mut combinations: Vec<Vec<String>> = vec![Vec::new()];
    for assignment in set {
        let (key, values) = assignment.split_once('=').unwrap_or((assignment, ""));
        let one = |before: &Vec<String>, value: &str| {
            let text = if assignment.contains('=') { format!("{key}={value}") } else { key.into() };
            [before.as_slice(), &[text]].concat()
        };
        let all = combinations.iter().flat_map(|c| values.split(',').map(move |v| one(c, v)));
        combinations = all.collect();
    }
    let mut specs = Vec::new();
    for variant in variants {
        for set in &combinations {
            if world.is_interrupted() {
                return Err(Failure::interrupted("no plan is printed"));
            }
            specs.push(case::spec(case, variant, set)?);
        }
    }
    Ok(specs)
}
