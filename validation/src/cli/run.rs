//! `run`: one variant of one case.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, SystemTime};

use humantime::format_rfc3339_seconds;
use serde_json::Value;
use touchstone_base::{
    absent::Absent,
    files::{self, FileError, OutputFolder},
    gate::Gate,
    lock,
    record::{Profile, Record, Status, marked, name_and_mark},
};
use touchstone_cases::fluids::channel;
use touchstone_harness::{
    case::{self, Case, RunError},
    checkpoint::Checkpoints,
    context::{Context, RunProgress},
    gates::GateIndex,
    pictures,
    rules::{DT, DT_OVER_LIMIT, PLANNED_DT, PLANNED_DT_OVER_LIMIT},
    runs::Judged,
    size::Size,
    store::MOST_BYTES,
};

use super::{
    Exit, Failure, Outcome, Session, arguments,
    checkpoint::{self, CHECKPOINT, ResumableRun},
    interrupt::Hold,
    judged, on_threads, output, profile,
    progress::Bar,
    summary::outcome,
};

pub fn run(arguments: &arguments::Run, session: &Session) -> Outcome {
    if let (Some(file), Some(store)) = (&arguments.specs, &arguments.store) {
        return super::plan::make(file, store, arguments, session);
    }
    if let Some(path) = &arguments.resume {
        let (asked, earlier) = checkpoint::read(path, session.sources)?;
        let case = touchstone_cases::find_in(session.cases, &asked.spec.case)?;
        session.check_references(&[case])?;
        let folder = Folder { output: OutputFolder::create(path)?, is_new: false };
        let asked = ResumableRun { every: arguments.checkpoint_every.or(asked.every), ..asked };
        output::GOES_ON.store(true, Ordering::Relaxed);
        return carry_out(case, asked, Some(earlier), Some(folder), arguments, session);
    }
    let case =
        touchstone_cases::find_in(session.cases, arguments.case.as_deref().unwrap_or_default())?;
    session.check_references(&[case])?;
    let variant = arguments.variant.as_deref().unwrap_or(case.recommended().variant);
    let rows = arguments.rows.iter().map(|rows| format!("rows={rows}"));
    let set: Vec<String> = arguments.set.iter().cloned().chain(rows).collect();
    let mut spec = case::spec(case, variant, &set)?;
    spec.allow_unstable = arguments.allow_unstable;
    spec.measure = arguments.metrics;
    if arguments.checkpoint_every.is_some() && arguments.out.is_none() {
        return Err(Failure::usage(
            "--checkpoint-every needs --out DIR, the folder for the checkpoints",
        ));
    }
    let folder = Folder::of(arguments, case.name(), variant)?;
    let sources = (session.sources)(case.name());
    let &arguments::Run { vtk, allow_long, checkpoint_every: every, .. } = arguments;
    let asked = ResumableRun { spec, sources, every, vtk, allow_long };
    carry_out(case, asked, None, folder, arguments, session)
}

/// Runs, writes and judges; may continue from a checkpoint.
fn carry_out(
    case: &dyn Case,
    asked: ResumableRun,
    earlier: Option<Vec<u8>>,
    folder: Option<Folder>,
    arguments: &arguments::Run,
    session: &Session,
) -> Outcome {
    let good = folder.as_ref().and_then(Folder::checkpointed);
    let lost = Lost { count: AtomicUsize::new(0), good: Mutex::new(good) };
    let computed = on_threads(arguments.threads, || {
        compute(case, &asked, earlier, arguments, (folder.as_ref(), &lost), session)
    });
    let (record, last) = match computed {
        Ok(made) => made,
        Err(failure) => {
            folder.iter().for_each(Folder::remove_if_new_and_empty);
            return Err(failure);
        }
    };
    if let Status::Interrupted { step, time } = record.status {
        return Err(interrupted(folder.as_ref(), asked.vtk.is_some(), step, time));
    }
    let frames = asked.vtk.unwrap_or_default();
    let written = folder.as_ref().map(|folder| write(&record, last, folder, frames)).transpose();
    let is_asked =
        |gate: &Gate| record.absent.get(&gate.metric).is_none_or(|why| *why != Absent::NotAsked);
    let index = GateIndex::of(case);
    let (gates, unasked): (Vec<Gate>, Vec<Gate>) =
        index.gates(&asked.spec).into_iter().partition(is_asked);
    let verdicts: Vec<Judged> =
        gates.into_iter().map(|gate| Judged::of_record(gate, &record)).collect();
    // If a file cannot be written, the record is printed, and if printing fails as well, its numbers are, so
    // that no result is lost.
    let mut table = judged::shown(&verdicts, arguments.all);
    if !unasked.is_empty() {
        let count = unasked.len();
        table += &format!("more gates on metrics not asked for (--metrics all): {count}\n\n");
    }
    let [first, next] = outcome(&index, &asked.spec, &record, &verdicts);
    let text = format!(
        "{}, variant {}\n{first}\n{table}{}{}",
        record.run.case,
        record.run.variant,
        details(&record),
        if next.is_empty() { next } else { format!("\n{next}") },
    );
    let printed = match arguments.json || written.is_err() {
        true => output::print_whole(&record.to_json().map_err(Failure::bug)?),
        false => output::print(&text),
    };
    if printed.is_err() || (written.is_err() && !arguments.json) {
        output::say(&text);
    }
    let exit = match record.status {
        Status::Diverged { .. } => Exit::Diverged,
        _ if verdicts.iter().any(|j| j.judgement.verdict.is_failure()) => Exit::GateFailed,
        _ => Exit::Pass,
    };
    if exit == Exit::Diverged {
        output::say(&format!("touchstone: {}", record.status));
    }
    if let (Some(folder), Some(names)) = (&folder, written?) {
        output::say(&format!("{}: {}", folder.output.path().display(), names.join(", ")));
        folder.remove_checkpoint()?;
    }
    printed?;
    match lost.count.into_inner() {
        0 => Ok(exit),
        count => {
            output::say(&format!("touchstone: frames or checkpoints not written: {count}"));
            Ok(Exit::Usage)
        }
    }
}

/// The files of an interrupted run, and how to continue it.
fn interrupted(folder: Option<&Folder>, has_frames: bool, step: u64, time: f64) -> Failure {
    folder.iter().for_each(|folder| folder.remove_if_new_and_empty());
    let kept = if has_frames { "; frames so far are complete" } else { "" };
    let goes_on = match folder.filter(|folder| folder.checkpointed().is_some()) {
        Some(folder) => {
            format!("touchstone run --resume {} continues it", folder.output.path().display())
        }
        None => "the same command begins again, and with --out DIR --checkpoint-every SECONDS an \
                 interrupted run can continue"
            .to_string(),
    };
    let what =
        format!("after step {step}, at t = {time:.4e} s; no record is written{kept}; {goes_on}");
    Failure::interrupted(what)
}

/// Frames and checkpoints that could not be written, and the time of the last checkpoint, whose folder may be
/// missing.
struct Lost {
    count: AtomicUsize,
    good: Mutex<Option<SystemTime>>,
}

impl Lost {
    /// Reports the first of them.
    fn report_lost(&self, error: &RunError, folder: Option<&Folder>) {
        if self.count.fetch_add(1, Ordering::Relaxed) > 0 {
            return;
        }
        let good = folder.zip(*lock(&self.good)).map_or(String::new(), |(folder, time)| {
            let (path, time) = (folder.checkpoint(), format_rfc3339_seconds(time));
            format!("; the last good checkpoint is {} of {time}", path.display())
        });
        output::say(&format!("touchstone: {error}; the run goes on{good}"));
    }
}

/// The record, and all fields of the particles at the end if there is a folder for them.
fn compute(
    case: &dyn Case,
    asked: &ResumableRun,
    earlier: Option<Vec<u8>>,
    arguments: &arguments::Run,
    (folder, lost): (Option<&Folder>, &Lost),
    session: &Session,
) -> Result<(Record, Option<Profile>), Failure> {
    let _hold = asked.every.map(|_| Hold::new());
    let bar = Bar::new();
    let last = Mutex::default();
    let show_size = |size: &Size| {
        if !arguments.json {
            bar.say(&format!("estimate: {size}"));
        }
    };
    let show = |progress: RunProgress| bar.show_run(progress);
    let lose = |error: &RunError| bar.suspend(|| lost.report_lost(error, folder));
    let frames = folder.zip(asked.vtk).map(|(folder, count)| (folder.vtk(), count.into()));
    let write = |state: &[u8]| match folder {
        Some(folder) => checkpoint::write(&folder.output, asked, state)
            .map(|()| *lock(&lost.good) = Some(SystemTime::now())),
        None => Ok(()),
    };
    let every = asked.every.map(|seconds| Duration::from_secs(seconds.into()));
    let checkpoints = every.map(|every| Checkpoints { every, earlier, write: &write });
    let context = Context {
        threads: rayon::current_num_threads(),
        frames,
        checkpoints: checkpoints.as_ref(),
        lost: Some(&lose),
        allow_long: asked.allow_long,
        profile: arguments.profile,
        estimate: Some(&show_size),
        at_the_end: folder.map(|_| &last),
        progress: Some(&show),
        interrupt: Some(session.interrupt),
        ..Context::default()
    };
    let record = case.run(&asked.spec, &context);
    bar.clear();
    let mut record = record?;
    record.manifest.sources = asked.sources.clone();
    Ok((record, last.into_inner().unwrap_or_else(PoisonError::into_inner)))
}

/// Where a run writes to.
struct Folder {
    output: OutputFolder,
    is_new: bool,
}

impl Folder {
    /// `None` unless files were requested; the folder is tested before the run starts.
    fn of(arguments: &arguments::Run, case: &str, variant: &str) -> Result<Option<Self>, Failure> {
        let path = match (&arguments.out, arguments.vtk) {
            (Some(path), _) => path.clone(),
            (None, Some(_)) => Path::new("reports").join(format!("run-{case}-{variant}")),
            (None, None) => return Ok(None),
        };
        let earlier = record_in(&path);
        let other = earlier["case"].as_str().unwrap_or(case);
        if other != case && !arguments.overwrite {
            return Err(Failure::usage(format!(
                "the folder {path:?} holds a record of the case {other}, and files of {case} would mix with \
                 it; name another folder by --out, or give --overwrite"
            )));
        }
        let (is_new, has_checkpoint) = (!path.exists(), path.join(CHECKPOINT).exists());
        if has_checkpoint && !arguments.overwrite {
            return Err(Failure::usage(format!(
                "the folder {path:?} holds the checkpoint of a run that has not ended; touchstone run \
                 --resume {} continues it, and --overwrite discards it",
                path.display()
            )));
        }
        let folder = Folder { output: OutputFolder::create(&path)?, is_new };
        folder.remove_checkpoint()?;
        Ok(Some(folder))
    }

    /// When the checkpoint was written that is there.
    fn checkpointed(&self) -> Option<SystemTime> {
        fs::metadata(self.checkpoint()).and_then(|file| file.modified()).ok()
    }

    fn checkpoint(&self) -> PathBuf {
        self.output.path().join(CHECKPOINT)
    }

    fn remove_checkpoint(&self) -> Result<(), FileError> {
        let path = self.checkpoint();
        match fs::remove_file(&path) {
            Err(reason) if reason.kind() != io::ErrorKind::NotFound => {
                Err(FileError::File { path, reason })
            }
            _ => Ok(()),
        }
    }

    fn vtk(&self) -> PathBuf {
        self.output.path().join("vtk")
    }

    fn remove_if_new_and_empty(&self) {
        if self.is_new {
            // Refused by the system unless empty, as it should be.
            let _ = fs::remove_dir(self.vtk());
            let _ = fs::remove_dir(self.output.path());
        }
    }
}

/// The record of an earlier run in a folder, in any version; null if there is none.
fn record_in(folder: &Path) -> Value {
    let text = files::read_text(&folder.join(RECORD), MOST_BYTES).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// Name of the file of the record.
const RECORD: &str = "record.json";

/// Name of the index of frames.
const INDEX: &str = "vtk/particles.pvd";

/// Name of the table of a curve.
fn table_of(curve: &str) -> String {
    format!("{}.csv", curve.replace([' ', '/', '\\'], "-"))
}

/// Files of an earlier run other than its record; the first `frames` frames belong to this run.
fn left_by_earlier(folder: &Path, frames: u16) -> Vec<String> {
    let record = record_in(folder);
    if record.is_null() {
        return Vec::new();
    }
    let curves = record["profiles"].as_object().into_iter().flat_map(|of| of.keys());
    let others = ["profile.csv", "profile.png", INDEX].map(String::from);
    let frames = (frames..).map(|k| format!("vtk/particles_{k:04}.vtu"));
    let frames = frames.take_while(|name| folder.join(name).exists());
    curves.map(|curve| table_of(curve)).chain(others).chain(frames).collect()
}

/// Writes the record, its figures and the final particles, removes other files of an earlier run, and returns
/// the names. `frames` is the number of frames of this run.
fn write(
    record: &Record,
    last: Option<Profile>,
    folder: &Folder,
    frames: u16,
) -> Result<Vec<String>, Failure> {
    let Folder { output, .. } = folder;
    let earlier = left_by_earlier(output.path(), frames);
    output.write(RECORD, record.to_json().map_err(Failure::bug)?.as_bytes())?;
    let mut names = vec![RECORD.to_string()];
    if let Some(shown) = channel::velocities(record).or(last) {
        output.write("profile.csv", shown.to_csv().as_bytes())?;
        names.push("profile.csv".into());
    }
    for (name, profile) in &record.profiles {
        // Curves at one time are in profile.csv, particles in the frames.
        if name_and_mark(name).1.is_none() && name != pictures::END {
            let file = table_of(name);
            output.write(&file, profile.to_csv().as_bytes())?;
            names.push(file);
        }
    }
    if frames > 0 {
        names.push(INDEX.into());
    }
    for name in earlier.iter().filter(|name| !names.contains(name)) {
        drop(fs::remove_file(output.path().join(name)));
    }
    let _ = fs::remove_dir(folder.vtk()); // refused by the system unless empty
    Ok(names)
}

/// The metrics of a record, what is absent, the parameters that follow from the settings, and the work.
fn details(record: &Record) -> String {
    let Record { numerics, cost, .. } = record;
    let value = |value: &Value| match value.as_f64() {
        Some(number) if !value.is_u64() => touchstone_report::sig(number, 4),
        _ => value.as_str().map_or_else(|| value.to_string(), String::from),
    };
    // A step is shortened to reach the end and the times of samples: it is planned, then used.
    let is_used = |name: &str, number: &Value| {
        let mut steps = [(PLANNED_DT, DT), (PLANNED_DT_OVER_LIMIT, DT_OVER_LIMIT)].into_iter();
        let used =
            steps.find(|(planned, _)| *planned == name).and_then(|(_, used)| numerics.get(used));
        used.is_some_and(|used| value(used) == value(number))
    };
    let shown = numerics.iter().filter(|(name, number)| !is_used(name, number));
    let shown = shown.map(|(name, number)| format!("{name}\u{a0}{}", value(number)));
    let shown: Vec<String> = shown.collect();
    let numerics = match shown.is_empty() {
        true => String::new(),
        false => output::hanging("with", 7, &shown.join(", ")),
    };
    let rate = cost.particle_rhs as f64 / cost.cpu_s.max(1e-9) / 1e6;
    let work = format!(
        "{} particles, {} steps, {rate:.2} million particle right-hand sides per second on one core",
        cost.particles, cost.steps
    );
    let profile = cost.breakdown.as_ref().map(|breakdown| profile::tables(cost, breakdown));
    let (metrics, absent, profile) = (metrics(record), absent(record), profile.unwrap_or_default());
    format!("{metrics}{absent}\n{numerics}{}{profile}", output::hanging("work", 7, &work))
}

/// The results that the run does not have, by the reason.
fn absent(record: &Record) -> String {
    let mut names: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for (name, reason) in &record.absent {
        names.entry(reason.to_string()).or_default().push(name);
    }
    let line = |(reason, names): (&String, &Vec<&str>)| {
        output::wrap(&format!("absent: {} ({reason})", names.join(", ")), "    ")
    };
    let lines: String = names.iter().map(line).collect();
    if lines.is_empty() { lines } else { format!("\n{lines}") }
}

/// Metrics `name@tau` as a table over tau, the others below.
fn metrics(record: &Record) -> String {
    let (mut times, mut of_times, mut single) = (Vec::new(), BTreeMap::new(), Vec::new());
    for (name, metric) in &record.metrics {
        if let (name, Some(time)) = name_and_mark(name) {
            times.push(time);
            of_times.entry(name).or_insert(metric);
        } else {
            let value = touchstone_report::sig(metric.value, 4);
            single.push(vec![name.clone(), value, metric.unit.clone(), metric.formula.clone()]);
        }
    }
    let number = |text: &&str| text.parse().unwrap_or(f64::NAN);
    times.sort_by(|a, b| number(a).total_cmp(&number(b)).then(a.cmp(b)));
    times.dedup();
    let value = |name: &str, time: &str| {
        let metric = record.metrics.get(&marked(name, time));
        metric.map(|metric| touchstone_report::sig(metric.value, 4)).unwrap_or_default()
    };
    // Times of channels are νt/L²; times of other cases are in the units of their formulas.
    let at = if channel::velocities(record).is_some() { "at νt/L²" } else { "at" };
    let heads: Vec<&str> = std::iter::once(at).chain(of_times.keys().copied()).collect();
    let row = |time: &&str| {
        let values = of_times.keys().map(|name| value(name, time));
        std::iter::once(time.to_string()).chain(values).collect()
    };
    let mut text = String::new();
    if !times.is_empty() {
        text += &output::table(&heads, times.iter().map(row));
        for (name, metric) in &of_times {
            text += &format!("    {name} = {} [{}]\n", metric.formula, metric.unit);
        }
        text.push('\n');
    }
    text + &output::table(&["metric", "value", "unit", "formula"], single)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_base::record::MetricKey;

    /// The phases of colliding rings were listed five times each.
    #[test]
    fn places_that_are_words_are_listed_once() {
        const FIRST: MetricKey = MetricKey::new("first", "s", "made up");
        const SECOND: MetricKey = MetricKey::new("second", "s", "made up");
        let mut record = Record::new("made_up", "plain", Value::Null, 1);
        for at in ["early", "late"] {
            record.put(FIRST.at(at), 1.0);
            record.put(SECOND.at(at), 2.0);
        }
        let text = metrics(&record);
        for at in ["early", "late"] {
            assert_eq!(text.lines().filter(|line| line.starts_with(at)).count(), 1, "{text}");
        }
    }
}
