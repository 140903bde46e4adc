//! `plan`: runs as JSON lines, and their cost, estimated before the first of them: the cost in plans is a
//! guess. `plan --estimates` writes the table and prints the sum. `run --specs` makes the runs of such lines.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use rayon::prelude::*;
use touchstone_base::{
    files,
    record::{Profile, Status},
    spec::RunSpec,
};
use touchstone_harness::{
    case::{self, Case, Planned, Tier},
    estimate::{size, time},
    make::{BatchOptions, BatchResult, Job},
    plan, runs,
    size::{self, Size},
    store::Store,
};
use touchstone_report::{counted, seconds, sig};

use super::{Exit, Failure, Outcome, Session, arguments, output, print_problems, trouble};

pub fn plan(arguments: &arguments::Plan, session: &Session) -> Result<(), Failure> {
    let cases = session.choose(&arguments.cases)?;
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
        sweep(case, &arguments.variant, &arguments.set, session)?
    };
    if arguments.estimates.is_some() || arguments.tier == Tier::Deep {
        let making = session.making(Tier::Quick);
        let of = |job: &Job| if making.is_interrupted() { None } else { size(job, true) };
        let mut sizes: Vec<Option<Size>> = Vec::new();
        jobs.par_iter().map(of).collect_into_vec(&mut sizes);
        session.go_on("no plan is printed")?;
        if let Some(path) = &arguments.estimates {
            files::write_atomically(path, table(&jobs, &sizes).to_csv().as_bytes())?;
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
    session: &Session,
) -> Result<Vec<Job>, Failure> {
    let default = [case.recommended().variant.to_string()];
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
        // Without a value, the assignment as it is, which is then refused.
        let end = assignment.find('=').map_or(assignment.len(), |at| at + 1);
        let (key, values) = assignment.split_at(end);
        let with = |before: &Vec<String>| -> Vec<Vec<String>> {
            let texts = values.split(',').map(|value| format!("{key}{value}"));
            texts.map(|text| [&before[..], &[text]].concat()).collect()
        };
        combinations = combinations.iter().flat_map(with).collect();
    }
    let mut jobs = Vec::new();
    for variant in variants {
        for set in &combinations {
            session.go_on("no plan is printed")?;
            jobs.push(Job { case, planned: Planned::new(case::spec(case, variant, set)?) });
        }
    }
    Ok(jobs)
}

/// The cost of each run, one row for each line of the plan with its number for `run --index`; gaps for a
/// refused run.
fn table(jobs: &[Job], sizes: &[Option<Size>]) -> Profile {
    type Row<'a> = (usize, (&'a Job, &'a Option<Size>));
    let rows: Vec<Row> = jobs.iter().zip(sizes).enumerate().collect();
    let known = |size: &Option<Size>, of: &dyn Fn(&Size) -> f64| size.as_ref().map_or(f64::NAN, of);
    Profile::default()
        .put(&rows, "index", "-", |(index, _)| *index as f64)
        .put(&rows, "time", "s", |(_, (job, size))| {
            known(size, &|size| time(&job.planned.spec, size))
        })
        .put(&rows, "memory", "MB", |(_, (_, size))| known(size, &|size| 1e-6 * size.bytes()))
}

/// Total cost of all runs, the longest and the largest run, and the number of refused runs.
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

/// Makes the runs of a plan, one record each.
pub fn make(file: &Path, store: &Path, arguments: &arguments::Run, session: &Session) -> Outcome {
    let (planned, refused) = planned(file, arguments, session)?;
    print_problems(refused.iter().cloned());
    if planned.is_empty() {
        return Err(Failure::usage(format!("{} describes no run", file.display())));
    }
    let lines = planned.len() + refused.len();
    let job = |planned: Planned| -> Result<Job, Failure> {
        Ok(Job { case: touchstone_cases::find_in(session.cases, &planned.spec.case)?, planned })
    };
    let jobs = runs::merged(planned).into_iter().map(job).collect::<Result<Vec<Job>, _>>()?;
    session.check_references(&jobs.iter().map(|job| job.case).collect::<Vec<_>>())?;
    let store = Store::open(store)?;
    let allow_long = arguments.allow_long;
    // Seconds are not compared here.
    let making = BatchOptions { store: Some(&store), allow_long, ..session.making(Tier::Quick) };
    let made = session.make(&jobs, making, arguments.threads, None)?;
    // Records that the store could not keep are printed.
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

/// How runs ended: in words, and the exit code of all lines.
fn ended(made: &BatchResult, is_a_line_refused: bool) -> (String, Exit) {
    let count =
        |of: fn(&Status) -> bool| made.records.values().filter(|record| of(&record.status)).count();
    let completed = count(|status| *status == Status::Completed);
    let diverged = count(|status| matches!(status, Status::Diverged { .. }));
    let refused = count(|status| matches!(status, Status::Refused { .. }));
    let words = format!(
        "{completed} completed, {diverged} diverged, {refused} refused; {} of them were in the store before",
        made.reused
    );
    // A run that diverged has a record, so that its code hides no line that was refused.
    let is_refused = is_a_line_refused || refused > 0;
    let refused = is_refused.then_some(Exit::Usage);
    let exit = trouble(made).or(refused).or((diverged > 0).then_some(Exit::Diverged));
    (words, exit.unwrap_or(Exit::Pass))
}

/// The runs of the selected lines, and the faults of the other lines.
fn planned(
    file: &Path,
    arguments: &arguments::Run,
    session: &Session,
) -> Result<(Vec<Planned>, Vec<String>), Failure> {
    let text = read(file)
        .map_err(|reason| Failure::usage(format!("cannot read {}: {reason}", file.display())))?;
    let is_empty = |(_, line): &(usize, &str)| line.trim().is_empty();
    let text = text.trim_start_matches('\u{feff}'); // a byte order mark
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
        session.go_on("no run was made")?;
        match spec(line, session) {
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

/// Largest list of runs \[bytes\].
const MOST_BYTES: u64 = 1 << 28;

fn read(file: &Path) -> io::Result<String> {
    let from: Box<dyn Read> = match file.to_str() {
        Some("-") => Box::new(io::stdin()),
        _ => Box::new(File::open(file)?),
    };
    files::text_of(from, MOST_BYTES)
}

/// The run of a line, or the fault of the line.
fn spec(line: &str, session: &Session) -> Result<RunSpec, String> {
    let spec = serde_json::from_str::<RunSpec>(line).map_err(|error| {
        let words = error.to_string();
        let (what, column) = words.split_once(" at line 1 column ").unwrap_or((&words, "1"));
        format!("{what} (column {column})")
    })?;
    let case =
        touchstone_cases::find_in(session.cases, &spec.case).map_err(|error| error.to_string())?;
    case::resolved(case, spec).map_err(|error| error.to_string())
}
