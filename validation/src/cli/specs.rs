//! `run --specs`: the runs of a plan, one record each.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use base::{record::Status, spec::RunSpec};
use harness::{
    case::{self, Planned, Tier},
    make::{Job, Made, Making},
    plan,
    store::Store,
};
use report::counted;
use validation::cases;

use super::{Exit, Failure, Outcome, World, arguments, output, tell, trouble};

pub fn run(file: &Path, store: &Path, arguments: &arguments::Run, world: &World) -> Outcome {
    let (planned, refused) = planned(file, arguments, world)?;
    tell(&refused);
    if planned.is_empty() {
        return Err(Failure::usage(format!("{} describes no run", file.display())));
    }
    let lines = planned.len() + refused.len();
    let job = |planned: Planned| -> Result<Job, Failure> {
        Ok(Job { case: cases::find_in(world.cases, &planned.spec.case)?, planned })
    };
    let jobs = plan::merged(planned).into_iter().map(job).collect::<Result<Vec<Job>, _>>()?;
    world.check_references(&jobs.iter().map(|job| job.case).collect::<Vec<_>>())?;
    let store = Store::open(store)?;
    let allow_long = arguments.allow_long;
    // Nothing is timed here.
    let making = Making { store: Some(&store), allow_long, ..world.making(Tier::Quick) };
    let made = world.make(&jobs, making, arguments.threads, None)?;
    // What the store could not keep is not lost.
    for record in made.not_kept.keys().filter_map(|key| made.records.get(key)) {
        output::print_whole(&record.to_json().map_err(Failure::bug)?)?;
    }
    let (runs, lines) = (counted(jobs.len(), "run", "runs"), counted(lines, "line", "lines"));
    let (ends, exit) = ended(&made, !refused.is_empty());
    let words = format!("{runs} in {lines}: {ends}");
    if made.interrupted {
        let rest = "the same command makes the missing runs";
        return Err(Failure::interrupted(format!("{words}; {rest}")));
    }
    output::say(&format!("{words}; {}", store.path().display()));
    Ok(exit)
}

/// How runs ended: in words, and the exit code of the worst of all lines.
fn ended(made: &Made, is_a_line_refused: bool) -> (String, Exit) {
    let count =
        |of: fn(&Status) -> bool| made.records.values().filter(|record| of(&record.status)).count();
    let completed = count(|status| *status == Status::Completed);
    let diverged = count(|status| matches!(status, Status::Diverged { .. }));
    let refused = count(|status| matches!(status, Status::Refused { .. }));
    let words = format!(
        "{completed} completed, {diverged} diverged, {refused} refused; {} of them were in the store before",
        made.reused
    );
    let is_refused = is_a_line_refused || refused > 0;
    let ends = [
        trouble(made),
        (diverged > 0).then_some(Exit::Diverged),
        is_refused.then_some(Exit::Usage),
    ];
    let worst = ends.into_iter().flatten().max_by_key(|exit| *exit as u8);
    (words, worst.unwrap_or(Exit::Pass))
}

/// The runs of the lines that were asked for, and what is wrong with the other lines.
fn planned(
    file: &Path,
    arguments: &arguments::Run,
    world: &World,
) -> Result<(Vec<Planned>, Vec<String>), Failure> {
    let text = read(file)
        .map_err(|reason| Failure::usage(format!("cannot read {}: {reason}", file.display())))?;
    let is_empty = |(_, line): &(usize, &str)| line.trim().is_empty();
    let mut lines: Vec<(usize, &str)> =
        text.lines().enumerate().filter(|line| !is_empty(line)).collect();
    if let Some(index) = &arguments.index {
        let count = lines.len();
        lines = lines.into_iter().take(index.end).skip(index.start).collect();
        if lines.is_empty() {
            return Err(Failure::usage(format!(
                "there is no run {}; the file has {}, counted from 0",
                index.start,
                counted(count, "run", "runs")
            )));
        }
    }
    let (mut planned, mut refused) = (Vec::new(), Vec::new());
    for (number, line) in lines {
        if world.is_interrupted() {
            return Err(Failure::interrupted("no run was made"));
        }
        match spec(line, world) {
            Ok(spec) => planned.push(Planned::new(spec)),
            Err(why) => refused.push(format!("line {} of {}: {why}", number + 1, file.display())),
        }
    }
    for Planned { spec, .. } in &mut planned {
        spec.measure = spec.measure.max(arguments.metrics);
    }
    if let Some(key) = &arguments.only {
        planned.retain(|planned| planned.spec.key().to_string() == *key);
        match planned.is_empty() {
            true => refused.push(format!("no run of {} has the key {key}", file.display())),
            false => refused.clear(), // they are not asked for
        }
    }
    Ok((planned, refused))
}

/// More than this is no list of runs \[bytes\].
const MOST_BYTES: u64 = 1 << 28;

fn read(file: &Path) -> io::Result<String> {
    let from: Box<dyn Read> = match file.to_str() {
        Some("-") => Box::new(io::stdin()),
        _ => Box::new(File::open(file)?),
    };
    let mut text = String::new();
    if from.take(MOST_BYTES + 1).read_to_string(&mut text)? as u64 > MOST_BYTES {
        let words = format!("it has more than {MOST_BYTES} bytes");
        return Err(io::Error::new(io::ErrorKind::InvalidData, words));
    }
    Ok(text)
}

/// The run that a line describes, or what is wrong with the line.
fn spec(line: &str, world: &World) -> Result<RunSpec, String> {
    let spec = RunSpec::from_canonical(line).map_err(|error| {
        let words = error.to_string();
        let (what, column) = words.split_once(" at line 1 column ").unwrap_or((&words, "1"));
        format!("{what} (column {column})")
    })?;
    let case = cases::find_in(world.cases, &spec.case).map_err(|error| error.to_string())?;
    case::resolved(case, spec).map_err(|error| error.to_string())
}
