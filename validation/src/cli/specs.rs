//! `run --specs`: the runs of a plan, one record each.

use std::fs;
use std::io::{self, Read};
use std::path::Path;

use anyhow::Context as _;
use base::{record::Status, spec::RunSpec};
use harness::{
    case::{Case, Planned, Tier},
    make::Job,
    store::Store,
};
use validation::cases;

use super::{Exit, Failure, Outcome, World, arguments, output};

pub fn run(file: &Path, arguments: &arguments::Run, world: &World) -> Outcome {
    let Some(path) = &arguments.store else {
        return Err(Failure::usage(anyhow::anyhow!("--specs needs --store DIR")));
    };
    let specs = chosen(read(file)?, arguments)?;
    let job = |mut spec: RunSpec| -> Result<Job, Failure> {
        spec.measure = spec.measure.max(arguments.metrics.into());
        let case: &'static dyn Case = cases::find_in(world.cases, &spec.case)?;
        Ok(Job { case, planned: Planned::new(spec) })
    };
    let jobs = specs.into_iter().map(job).collect::<Result<Vec<Job>, Failure>>()?;
    let store = Store::open(path)?;
    let tier = Tier::Quick; // nothing is timed here
    let &arguments::Run { allow_long, threads, .. } = arguments;
    let made = world.make(&jobs, tier, Some(&store), false, allow_long, threads)?;
    let ended = |of: fn(&Status) -> bool| made.records.values().filter(|r| of(&r.status)).count();
    let words = format!(
        "{} runs: {} completed, {} diverged, {} refused; {} of them were in the store before",
        made.records.len(),
        ended(|status| *status == Status::Completed),
        ended(|status| matches!(status, Status::Diverged { .. })),
        ended(|status| matches!(status, Status::Refused { .. })),
        made.reused
    );
    // What the store could not keep is not lost.
    for record in made.not_kept.keys().filter_map(|key| made.records.get(key)) {
        output::print_whole(&record.to_json()?)?;
    }
    if made.interrupted {
        let rest = "the same command makes the missing runs";
        return Err(Failure::interrupted(format!("{words}; {rest}")));
    }
    output::say(&format!("{words}; {}", store.path().display()));
    Ok(if made.not_kept.is_empty() { Exit::Pass } else { Exit::Usage })
}

/// Reads JSON lines; empty lines are skipped.
fn read(file: &Path) -> Result<Vec<RunSpec>, Failure> {
    let mut text = String::new();
    let read = match file.to_str() {
        Some("-") => io::stdin().read_to_string(&mut text).map(|_| text),
        _ => fs::read_to_string(file),
    };
    let text =
        read.with_context(|| format!("cannot read {}", file.display())).map_err(Failure::usage)?;
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let parse = |(k, line): (usize, &str)| {
        RunSpec::from_canonical(line)
            .with_context(|| {
                format!("line {} of {} does not describe a run", k + 1, file.display())
            })
            .map_err(Failure::usage)
    };
    lines.map(parse).collect()
}

/// The one that was asked for, or all.
fn chosen(specs: Vec<RunSpec>, arguments: &arguments::Run) -> Result<Vec<RunSpec>, Failure> {
    let count = specs.len();
    let (chosen, missing): (Vec<RunSpec>, String) = match (&arguments.only, arguments.index) {
        (Some(key), _) => {
            let of_key = specs.into_iter().filter(|spec| spec.key().to_string() == *key);
            (of_key.collect(), format!("no run of the file has the key {key}"))
        }
        (None, Some(index)) => {
            let words =
                format!("there is no run {index}; the file has {count} runs, counted from 0");
            (specs.into_iter().nth(index).into_iter().collect(), words)
        }
        (None, None) => (specs, "the file describes no run".into()),
    };
    match chosen.is_empty() {
        true => Err(Failure::usage(anyhow::anyhow!(missing))),
        false => Ok(chosen),
    }
}
