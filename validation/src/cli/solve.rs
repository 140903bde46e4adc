//! Solves an exported problem as another code would: `export --solve`, and `solve` as the code under test of
//! `probe`.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use serde::Deserialize;
use serde_json::{Value, json};
use touchstone_base::{
    files::OutputFolder,
    lock,
    mutation::Mutation,
    record::{Profile, Record, Status},
    spec::RunSpec,
    submission::OURS,
};
use touchstone_exchange::{
    flaw,
    problem::{CURVE, ExportedProblem, PROBLEM},
    read::{self, COLUMNS, Head, RESULTS, Renamed},
    submission::{METHOD, SYSTEM},
};
use touchstone_harness::{
    case::{self, Case, RunError},
    checkpoint::Checkpoints,
    context::Context,
    relation::Relation,
};

use super::{
    Exit, Failure, Outcome, Session, arguments,
    checkpoint::{self, ResumableRun},
};

/// How a problem is solved.
#[derive(Default)]
pub struct How {
    /// Even if it takes more time or memory than a run may.
    pub allow_long: bool,
    /// With a deliberate error.
    pub mutation: Option<Mutation>,
    /// Stop after this time \[s\], and keep a checkpoint.
    pub stop_after: Option<f64>,
    /// Continue from the checkpoint.
    pub resume: bool,
}

/// The description of this program's method in a submission.
pub fn method(problem: &ExportedProblem) -> String {
    let read = problem.settings().map(|(field, value)| (field.name.to_string(), value.clone()));
    let (mut settings, own) = (Value::Object(read.collect()), &problem.outline.method);
    // With these settings the gates on the theory of our own method apply.
    settings["kernel"] = json!(own.kernel);
    settings["support"] = json!(own.support * problem.outline.medium.h);
    settings["dt"] = json!(problem.outline.dt);
    settings["time_order"] = json!(2);
    let method = json!({
        "code": OURS,
        "version": env!("CARGO_PKG_VERSION"),
        "scheme": problem.spec.variant,
        "division": "closed",
        "settings": settings,
        "changed": "nothing",
    });
    format!("{method:#}\n")
}

/// Makes the run and writes it as another code would: an example of a submission. Returns the names of its
/// files, and how the run ended.
pub fn results(
    case: &dyn Case,
    problem: &ExportedProblem,
    folder: &OutputFolder,
    how: &How,
    session: &Session,
) -> Result<(Vec<String>, Status), Failure> {
    let spec = RunSpec { mutation: how.mutation, ..problem.spec.clone() };
    // Mass and role are for codes that choose their own particles.
    let written = COLUMNS.iter().filter(|(name, ..)| !["mass", "role"].contains(name));
    let add = |results: Profile, (name, unit, _): &Head| results.with(name, unit, Vec::new());
    let mut table = written.fold(Profile::default(), add);
    if how.resume {
        earlier_rows(&mut table, folder.path())?;
    }
    let results = Mutex::new(table);
    let stop = AtomicBool::new(false);
    let write_frame = |time: f64, particles: Profile| {
        let next = problem.outline.times.iter().find(|next| **next > time);
        if how.stop_after.zip(next).is_some_and(|(last, next)| *next > last) {
            stop.store(true, Ordering::Relaxed);
        }
        let mut results = lock(&results);
        if results.column("t").last() == Some(&time) {
            return; // stated twice
        }
        let times = vec![time; particles.column("id").len()];
        let particles = particles.with("t", "s", times);
        for column in &mut results.columns {
            column.values.extend(particles.column(&column.name));
        }
    };
    let sources = (session.sources)(case.name());
    let (of, allow_long) = (spec.clone(), how.allow_long);
    let asked = ResumableRun { spec: of, sources, every: None, vtk: None, allow_long };
    let keep = |state: &[u8]| checkpoint::write(folder, &asked, state);
    let earlier =
        how.resume.then(|| checkpoint::read(folder.path(), session.sources)).transpose()?;
    let earlier = earlier.map(|(_, state)| state);
    let is_checkpointed = how.resume || how.stop_after.is_some();
    let checkpoints = Checkpoints { every: Duration::MAX, earlier, write: &keep };
    let context = Context {
        spec: spec.clone(),
        allow_long,
        interrupt: Some(if how.stop_after.is_some() { &stop } else { session.interrupt }),
        checkpoints: is_checkpointed.then_some(&checkpoints),
        ..Context::default()
    };
    let record = match problem.relation {
        Some(relation) => {
            let on_frame = &mut |time, particles| write_frame(time, particles);
            case.pose(&spec)?.seen_by(relation, &context, on_frame).map_err(declined)?;
            // A record without metrics or work: the seen particles were not measured.
            Record::of(&spec, 1)
        }
        None => case.run(&spec, &Context { at_times: Some(&write_frame), ..context })?,
    };
    session.go_on("the problem is written, its results are not")?;
    let Record { cost, manifest, .. } = &record;
    let counted = |of: Value| if of.as_f64() > Some(0.0) { of } else { json!("unknown") };
    let system = json!({
        "machine": manifest.cpu,
        "threads": cost.threads,
        "seconds": counted(json!(cost.cpu_s / cost.threads.max(1) as f64)),
        "steps": counted(json!(cost.steps)),
        "interactions": counted(json!(cost.pair_interactions)),
    });
    let (name, table) = match series(case, &record).filter(|_| !is_checkpointed) {
        Some(series) => (CURVE, series),
        None => (RESULTS, results.into_inner().unwrap_or_else(PoisonError::into_inner)),
    };
    let failure = |what| Failure::usage(format!("{name} was not written: {what}"));
    table.check_finite().map_err(failure)?;
    folder.write(name, table.to_csv().as_bytes())?;
    folder.write(SYSTEM, format!("{system:#}\n").as_bytes())?;
    Ok(([name, SYSTEM].map(String::from).into(), record.status))
}

/// A relation that does not hold for our method is a problem that it cannot solve.
fn declined(error: RunError) -> Failure {
    match error {
        RunError::NoSymmetry { .. } => Failure { exit: Exit::Declines, reason: error.to_string() },
        error => error.into(),
    }
}

/// The series from which a case measures more than from particles at its few times, if it has one.
fn series(case: &dyn Case, record: &Record) -> Option<Profile> {
    let curve = case.facts().curve.filter(|curve| curve.coarsen.is_some())?;
    let mut record = record.clone();
    record.keep_columns(curve.shown);
    record.profiles.into_values().next()
}

/// Puts the rows of an interrupted solution before its other rows.
fn earlier_rows(table: &mut Profile, folder: &Path) -> Result<(), Failure> {
    let results = read::read(folder, &Renamed::new())
        .map_err(|flaws| Failure::usage(flaw::lines(&flaws).join("\n")))?;
    for frame in &results.frames {
        for of in &frame.particles {
            for column in &mut table.columns {
                column.values.push(match &*column.name {
                    "t" => frame.time,
                    "id" => f64::from(of.id),
                    "x" => of.position.x,
                    "y" => of.position.y,
                    "u" => of.velocity.x,
                    "v" => of.velocity.y,
                    _ => of.density.unwrap_or(f64::NAN),
                });
            }
        }
    }
    Ok(())
}

/// The parts of `problem.json` that `solve` reads.
#[derive(Deserialize)]
struct Document {
    spec: RunSpec,
    relation: Option<String>,
    rigid_body: Option<Value>,
    #[serde(default)]
    probe: Probe,
}

/// Instructions of `probe` for one call.
#[derive(Default, Deserialize)]
struct Probe {
    stop_after: Option<Stop>,
    #[serde(default)]
    resume: bool,
}

#[derive(Deserialize)]
struct Stop {
    value: f64,
}

/// Solves the problem in a folder by the method that it was exported from.
pub fn solve(arguments: &arguments::Solve, session: &Session) -> Outcome {
    let path = arguments.folder.join(PROBLEM);
    let text = touchstone_base::files::read_text(&path, MOST_BYTES);
    let text = text.map_err(|why| Failure::usage(format!("{path:?} cannot be read: {why}")))?;
    let document: Document = serde_json::from_str(&text)
        .map_err(|why| Failure::usage(format!("{path:?} is not a problem file: {why}")))?;
    let Document { spec, relation, rigid_body, probe } = document;
    if rigid_body.is_some() {
        let reason = "it has no rigid bodies that float in a fluid".into();
        return Err(Failure { exit: Exit::Declines, reason });
    }
    let case = touchstone_cases::find_in(session.cases, &spec.case)?;
    let relation =
        relation.map(|name| Relation::named(&name)).transpose().map_err(Failure::usage)?;
    let problem = ExportedProblem::seen(case, case::resolved(case, spec)?, relation, false)?;
    let folder = OutputFolder::create(&arguments.folder)?;
    folder.write(METHOD, method(&problem).as_bytes())?;
    let (stop_after, resume) = (probe.stop_after.map(|stop| stop.value), probe.resume);
    let how = How { mutation: arguments.mutate, stop_after, resume, ..How::default() };
    match results(case, &problem, &folder, &how, session)?.1 {
        status @ Status::Diverged { .. } => {
            Err(Failure { exit: Exit::Diverged, reason: status.to_string() })
        }
        _ => Ok(Exit::Pass),
    }
}

/// Largest problem file \[bytes\].
const MOST_BYTES: u64 = 1 << 24;
