//! A code that is called once for each problem, with the folder of the problem as its last argument.

use std::ffi::OsString;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use nalgebra::Vector2;
use serde_json::{Value, json};
use touchstone_base::{files, text::first};
use touchstone_harness::{
    case::{self, Case, RunError},
    foreign::{ForeignParticle, Frame},
};

use super::{Pose, floating};
use crate::{
    flaw,
    problem::{ExportedProblem, PROBLEM},
    read::{self, Renamed},
    submission::{self, Entry},
    write::{self, Format},
};

/// Exit code by which a code says that it cannot solve a problem; its last line on standard error is the
/// reason. Test drivers use this number for a skipped test.
pub const DECLINES: i32 = 77;
/// Bytes that are kept of the standard error of a code.
const MOST_WORDS: u64 = 1 << 20;
/// Interval between two looks whether a code has ended.
const LOOK: Duration = Duration::from_millis(2);

/// A code under test.
pub struct Code {
    /// The program and its first arguments.
    pub command: Vec<OsString>,
    /// The folder in which it is called; otherwise the present one.
    pub folder: Option<PathBuf>,
    /// Wall time after which a call has failed.
    pub timeout: Duration,
    /// Are walls exported as particles, not as planes?
    pub walls_of_particles: bool,
    /// Names of columns in its results.
    pub map: Renamed,
    /// Set to end the call under way.
    pub interrupt: &'static AtomicBool,
    /// The variant of our own methods that is under test; where a case has it, it is exported.
    pub variant: Option<String>,
}

/// A moving particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Mass per unit depth \[kg/m\].
    pub mass: f64,
    /// \[m\].
    pub position: Vector2<f64>,
    /// \[m/s\].
    pub velocity: Vector2<f64>,
    /// \[kg/m³\], if it was handed in.
    pub density: Option<f64>,
}

/// The moving particles at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// \[s\].
    pub time: f64,
    /// In the order of their numbers.
    pub states: Vec<State>,
}

/// Results of one problem.
pub struct Solved {
    /// The problem.
    pub problem: ExportedProblem,
    /// The folder as it was read.
    pub entry: Entry,
    /// The moving particles of the problem.
    pub start: Moment,
    /// The moving particles as handed in, ascending in time.
    pub moments: Vec<Moment>,
}

/// The result of a call.
pub enum Ran {
    /// Complete results.
    Solved(Box<Solved>),
    /// The code cannot solve the problem, and why.
    Declined(String),
    /// It ended with another exit code than 0, or by a signal, and with this last line on standard error.
    Ended {
        /// The exit code; `None` after a signal.
        code: Option<i32>,
        /// The line.
        words: String,
    },
    /// There are no results that can be used, and why.
    Failed(String),
    /// It cannot be called, and why.
    NotCalled(String),
}

impl Ran {
    /// Why there are no results.
    pub fn failure(&self) -> String {
        match self {
            Self::Solved(_) => "it was solved".into(),
            Self::Declined(why) | Self::Failed(why) | Self::NotCalled(why) => why.clone(),
            Self::Ended { code: Some(code), words } => {
                format!("the code ended with exit code {code}: {words}")
            }
            Self::Ended { code: None, words } => format!("a signal ended the code: {words}"),
        }
    }
}

impl Solved {
    /// The particles at the end.
    pub fn end(&self) -> &Moment {
        self.moments.last().unwrap_or(&self.start)
    }

    /// The steps of the whole run, as stated.
    pub fn steps(&self) -> Option<f64> {
        self.entry.system.steps
    }
}

impl Moment {
    /// Densities of all particles \[kg/m³\].
    ///
    /// # Errors
    /// If they were not handed in.
    pub fn densities(&self) -> Result<Vec<f64>, String> {
        let all: Option<Vec<f64>> = self.states.iter().map(|of| of.density).collect();
        all.ok_or_else(|| "the results have no column density".into())
    }
}

/// How a process ended.
enum End {
    /// With its exit code, none if a signal ended it, and the end of its standard error.
    Code(Option<i32>, String),
    /// After the allowed time.
    Late,
}

impl Code {
    /// The problem of a pose.
    ///
    /// # Errors
    /// As [`ExportedProblem::seen`].
    pub fn problem(&self, cases: &[&dyn Case], pose: &Pose) -> Result<ExportedProblem, RunError> {
        let named = cases.iter().find(|case| case.name() == pose.case);
        let case =
            *named.ok_or_else(|| RunError::Foreign(format!("there is no case {}", pose.case)))?;
        let asked = self.variant.as_deref();
        let has = |name: &&str| case.variants().iter().any(|variant| variant.name == *name);
        let usual = if self.walls_of_particles { pose.particles } else { pose.planes };
        let mut spec = case::spec(case, asked.filter(has).unwrap_or(usual), &pose.set)?;
        spec.allow_unstable = pose.allow_unstable;
        let mut problem = ExportedProblem::seen(case, spec, pose.relation, false)?;
        if let Some(draft) = pose.draft {
            floating::put_in(&mut problem, draft);
        }
        Ok(problem)
    }

    /// Lets the code solve the problem of a pose in a new folder.
    pub fn solve(&self, cases: &[&dyn Case], pose: &Pose, folder: &Path) -> Ran {
        let problem = match self.problem(cases, pose) {
            Ok(problem) => problem,
            Err(why) => return Ran::Declined(format!("the problem cannot be stated: {why}")),
        };
        let end = problem.outline.times.last().copied().unwrap_or_default();
        let mut calls: Vec<Value> = Vec::new();
        if let Some(share) = pose.interrupt {
            calls.push(json!({ "stop_after": { "value": share * end, "unit": "s" } }));
        }
        calls.push(if calls.is_empty() { json!({}) } else { json!({ "resume": true }) });
        let last = calls.len() - 1;
        for (k, probe) in calls.into_iter().enumerate() {
            if let Err(why) = put(&problem, pose.draft.is_some(), probe, folder) {
                return Ran::Failed(format!("the problem cannot be written: {why}"));
            }
            match self.call(folder, pose.threads.unwrap_or(1)) {
                Ok(End::Code(Some(0), _)) => {}
                Ok(End::Code(Some(DECLINES), words)) => return Ran::Declined(last_line(&words)),
                Ok(End::Code(code, words)) => {
                    return Ran::Ended { code, words: last_line(&words) };
                }
                Ok(End::Late) => {
                    let most = self.timeout.as_secs_f64();
                    return Ran::Failed(format!("the code did not end within {most} s"));
                }
                Err(why) => {
                    let program = self.command.first().cloned().unwrap_or_default();
                    return Ran::NotCalled(format!("{program:?} cannot be called: {why}"));
                }
            }
            if k < last && !stopped(folder, pose.interrupt.unwrap_or(1.0) * end, &self.map) {
                return Ran::Declined("the code does not stop at `stop_after`".into());
            }
        }
        match solved(problem, folder, &self.map) {
            Ok(solved) => Ran::Solved(Box::new(solved)),
            Err(flaws) => Ran::Failed(format!("results that cannot be used: {flaws}")),
        }
    }

    /// Calls the code once.
    fn call(&self, folder: &Path, threads: u16) -> io::Result<End> {
        let (program, arguments) = self.command.split_first().ok_or(io::ErrorKind::InvalidInput)?;
        let mut command = Command::new(program);
        command.args(arguments).arg(folder).stdin(Stdio::null()).stdout(Stdio::null());
        if let Some(inside) = &self.folder {
            command.current_dir(inside);
        }
        for name in ["OMP_NUM_THREADS", "RAYON_NUM_THREADS"] {
            command.env(name, threads.to_string());
        }
        // A group of its own: what the code starts ends with it.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.stderr(Stdio::piped()).spawn()?;
        let words = child.stderr.take().map(|stream| {
            thread::spawn(move || {
                let (mut words, mut stream) = (Vec::new(), stream);
                drop((&mut stream).take(MOST_WORDS).read_to_end(&mut words));
                drop(io::copy(&mut stream, &mut io::sink()));
                String::from_utf8_lossy(&words).into_owned()
            })
        });
        let started = Instant::now();
        let status = loop {
            match child.try_wait()? {
                Some(status) => break status,
                None if started.elapsed() > self.timeout
                    || self.interrupt.load(Ordering::Relaxed) =>
                {
                    end(&mut child);
                    return Ok(End::Late);
                }
                None => thread::sleep(LOOK),
            }
        };
        let words = words.and_then(|words| words.join().ok()).unwrap_or_default();
        Ok(End::Code(status.code(), words))
    }
}

/// Ends a process and all that it has started.
fn end(child: &mut Child) {
    #[cfg(unix)]
    drop(Command::new("kill").args(["-KILL", "--", &format!("-{}", child.id())]).status());
    drop(child.kill());
    drop(child.wait());
}

/// Writes a problem. `probe` is for this call alone.
fn put(
    problem: &ExportedProblem,
    is_floating: bool,
    probe: Value,
    folder: &Path,
) -> Result<(), String> {
    let words = |error: &dyn std::fmt::Display| error.to_string();
    let output = files::OutputFolder::create(folder).map_err(|error| words(&error))?;
    let mut files = write::files(problem, Format::Csv).map_err(|error| words(&error))?;
    let mut document = problem.to_json();
    document["probe"] = probe;
    if is_floating {
        document["rigid_body"] = floating::statement(problem);
    }
    for (name, bytes) in &mut files {
        if *name == PROBLEM {
            *bytes = format!("{document:#}\n").into_bytes();
        }
        output.write(name, bytes).map_err(|error| words(&error))?;
    }
    Ok(())
}

/// Do the results in a folder end by this time?
fn stopped(folder: &Path, time: f64, map: &Renamed) -> bool {
    let is_early = |frame: &Frame| frame.time <= time * (1.0 + 1e-9);
    // A code may write nothing before its end.
    read::names(folder).is_ok_and(|names| names.is_empty())
        || read::read(folder, map).is_ok_and(|results| results.frames.iter().all(is_early))
}

/// Reads the results of a problem.
fn solved(problem: ExportedProblem, folder: &Path, map: &Renamed) -> Result<Solved, String> {
    let first_flaw = |flaws: Vec<flaw::Flaw>| {
        let mut lines = flaw::lines(&flaws);
        let others = lines.split_off(lines.len().min(1)).len();
        let more = if others > 0 { format!("; and {others} more") } else { String::new() };
        lines.join("") + &more
    };
    let entry = submission::read(folder, map).map_err(first_flaw)?;
    if entry.curve.is_some() {
        return Err("a curve in place of particles; expected the particles".into());
    }
    if entry.method.division != touchstone_base::submission::Division::Closed {
        return Err("particles of the code's own choice; expected division closed".into());
    }
    entry.check(&problem).map_err(first_flaw)?;
    let (moving, masses) = (problem.moving(), problem.outline.particles.column("mass"));
    let state = |of: ForeignParticle| {
        let ForeignParticle { id, position, velocity, density } = of;
        State { mass: masses[id as usize], position, velocity, density }
    };
    let states = moving.iter().filter_map(|id| problem.start_of(*id)).map(state);
    let start = Moment { time: 0.0, states: states.collect() };
    let moment = |frame: &Frame| {
        let moves = |of: &ForeignParticle| moving.binary_search(&of.id).is_ok();
        let mut all: Vec<_> = frame.particles.iter().copied().filter(moves).collect();
        all.sort_by_key(|of| of.id);
        Moment { time: frame.time, states: all.into_iter().map(state).collect() }
    };
    let moments: Vec<Moment> = entry.results.frames.iter().map(moment).collect();
    Ok(Solved { problem, entry, start, moments })
}

/// The last line of a text that is not empty.
fn last_line(words: &str) -> String {
    let line = words.lines().rev().find(|line| !line.trim().is_empty());
    let line = line.map_or("it printed no reason", str::trim);
    first(line, 200)
}

/// The folder of a pose inside another one, numbered in the order of the calls.
pub fn folder_of(all: &Path, number: usize, pose: &Pose) -> PathBuf {
    let relation = pose.relation.map_or(String::new(), |by| format!("-{}", by.name()));
    all.join(format!("{number:02}-{}{relation}", pose.case))
}
