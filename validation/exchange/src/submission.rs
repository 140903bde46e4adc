//! A folder of results of another code: its method, its machine, and its particles, measured by the code that
//! measures our own runs.

use std::{collections::BTreeMap, ops::RangeInclusive, path::Path};

use serde::{
    Deserialize, Deserializer,
    de::{DeserializeOwned, Error},
};
use serde_json::{Map, Value};
use touchstone_base::{
    absent::Absent,
    files,
    gate::Gate,
    record::{self, Cost, Metric, Record, Status},
    reference::sha256,
    spec::{Measure, RunSpec},
    submission::{Division, MACHINE, Submission, code_name},
    text::{first, number, short, unseen},
};
use touchstone_harness::{
    case::{Case, RunError},
    foreign::{self, Foreign, ForeignParticle, Frame, OwnParticle},
    medium::Medium,
    outline::{Outline, role},
    suite,
};
use touchstone_solver::{Domain, Role};

use crate::{
    digits::{self, ROUND_OFF},
    flaw::Flaw,
    problem::{CURVE, ExportedProblem, PROBLEM, ProblemDocument, SCHEMA},
    read::{self, RESULTS, Renamed, Results, SAME_MASS, curve},
};

/// Name of the document that describes the method.
pub const METHOD: &str = "method.json";
/// More particles than these are not in a square of one support radius: usual are ten.
const MOST_IN_SUPPORT: usize = 1000;
/// Mass over density of a particle that a code chose itself, in squares of the problem's spacing.
const VOLUMES: RangeInclusive<f64> = 1e-6..=1e6;
/// Printed flaws of frames.
const MOST_FLAWS: usize = 20;

/// A particle is lost beyond this multiple of the largest distance from the origin at the start.
const FAR: f64 = 1e6;
/// Share by which numbers of a method may differ that are stated as ours.
const SAME: f64 = 1e-6;

/// Name of the document that describes the machine and the cost.
pub const SYSTEM: &str = "system.json";

/// Largest document \[bytes\].
const MOST_BYTES: u64 = 1 << 24;

/// A method as its document describes it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Method {
    /// name of the code
    #[serde(deserialize_with = "code_name")]
    pub code: String,
    /// its version
    pub version: String,
    /// the scheme in words
    pub scheme: String,
    /// part of the problem that it used
    pub division: Division,
    /// settings by name
    pub settings: Map<String, Value>,
    /// changes of the problem
    pub changed: String,
}

/// The machine and the cost of the run, as stated; a number may be unknown.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct System {
    /// name of the machine or of its processor
    pub machine: String,
    /// threads that the run used
    #[serde(deserialize_with = "known")]
    pub threads: Option<f64>,
    /// wall time of the time loop \[s\]
    #[serde(deserialize_with = "known")]
    pub seconds: Option<f64>,
    /// time steps
    #[serde(deserialize_with = "known")]
    pub steps: Option<f64>,
    /// pairs of particles inside the support, summed over all sums
    #[serde(deserialize_with = "known")]
    pub interactions: Option<f64>,
}

/// A number, or the word `unknown`.
fn known<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
    let value = Value::deserialize(from)?;
    match value.as_f64() {
        None if value != "unknown" => {
            Err(D::Error::custom(format!("it is {}", short(&value.to_string()))))
        }
        number => Ok(number),
    }
}

/// A submission as it was read.
pub struct Entry {
    /// The method.
    pub method: Method,
    /// SHA-256 of its document.
    pub digest: String,
    /// The machine.
    pub system: System,
    /// The stated problem, if the folder has one.
    pub asked: Option<ProblemDocument>,
    /// The particles.
    pub results: Results,
    /// The table of a profile or series, of a code that submits no particles, and its columns' names.
    pub curve: Option<(String, Renamed)>,
}

/// Reads a document.
fn document<T: DeserializeOwned>(
    folder: &Path,
    name: &str,
    what: &str,
) -> Result<(T, String), Flaw> {
    let text = files::read_text(&folder.join(name), MOST_BYTES)
        .map_err(|reason| Flaw::of(name, format!("cannot be read: {reason}; expected {what}")))?;
    let read = serde_json::from_str(text.trim_start_matches('\u{feff}')).map_err(|error| {
        let flaw = Flaw::of(name, format!("{}; expected {what}", first(&error.to_string(), 200)));
        flaw.at(error.line() as u64)
    })?;
    Ok((read, text))
}

/// Reads the document of a method, and its text.
///
/// # Errors
/// Everything that is wrong with it.
pub fn method(path: &Path) -> Result<(Method, String), Vec<Flaw>> {
    let what = "code, version, scheme, division (closed or open), settings (an object) and changed";
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let folder = path.parent().unwrap_or(Path::new(""));
    let (method, text) = document::<Method>(folder, &name, what).map_err(|flaw| vec![flaw])?;
    let fields = [("code", &method.code), ("version", &method.version), ("scheme", &method.scheme)];
    let unnamed = |(field, text): (&str, &String)| unnamed(&name, field, text);
    let flaws: Vec<Flaw> = fields.into_iter().filter_map(unnamed).collect();
    if flaws.is_empty() { Ok((method, text)) } else { Err(flaws) }
}

/// Reads a folder.
///
/// # Errors
/// Everything that is missing or wrong.
pub fn read(folder: &Path, renamed: &Renamed) -> Result<Entry, Vec<Flaw>> {
    let mut flaws = Vec::new();
    let method = method(&folder.join(METHOD));
    let what = "machine, threads, seconds, steps and interactions, each a number or \"unknown\"";
    let system = document::<System>(folder, SYSTEM, what);
    let asked = asked(folder);
    let path = folder.join(CURVE);
    let text = path.exists().then(|| files::read_text(&path, read::MOST_BYTES));
    let (results, curve) = match text {
        Some(_) if folder.join(RESULTS).exists() => {
            (Err(vec![Flaw::of(CURVE, format!("there is {RESULTS} too; leave one"))]), None)
        }
        Some(Err(reason)) => {
            (Err(vec![Flaw::of(CURVE, format!("cannot be read: {reason}"))]), None)
        }
        // The problem determines which particles represent it.
        Some(Ok(text)) => (Ok(Results::default()), Some((text, renamed.clone()))),
        None => (read::read(folder, renamed), None),
    };
    let method = method.map_err(|all| flaws.extend(all));
    let system = system.map_err(|flaw| flaws.push(flaw));
    let asked = asked.map_err(|flaw| flaws.push(flaw));
    let results = results.map_err(|all| flaws.extend(all));
    if let Ok((system, _)) = &system {
        let System { machine, threads, seconds, steps, interactions } = system;
        flaws.extend(unnamed(SYSTEM, "machine", machine));
        for (name, known, most) in [
            ("threads", threads, 1e6),
            ("steps", steps, 1e15),
            ("interactions", interactions, 1e18),
        ] {
            let is_count = |n: f64| (1.0..=most).contains(&n) && n.fract() == 0.0;
            if let Some(found) = known.filter(|n| !is_count(*n)) {
                let found = number(found);
                let what = format!("it is {found}; expected a whole number from 1 to {most:e}");
                flaws.push(Flaw::of(SYSTEM, what).in_column(name));
            }
        }
        const MOST_SECONDS: f64 = 1e12;
        if let Some(found) = seconds.filter(|n| !(*n > 0.0 && *n <= MOST_SECONDS)) {
            let found = number(found);
            let what =
                format!("it is {found}; expected a number above 0, at most {MOST_SECONDS:e}");
            flaws.push(Flaw::of(SYSTEM, what).in_column("seconds"));
        }
    }
    match (method, system, asked, results) {
        (Ok((method, text)), Ok((system, _)), Ok(asked), Ok(results)) if flaws.is_empty() => {
            let digest = sha256(text.as_bytes());
            Ok(Entry { method, digest, system, asked, results, curve })
        }
        _ => Err(flaws),
    }
}

/// Errors of the ids of a frame with their rows: all expected ids must occur once, and each must be below
/// `end`.
fn misnumbered(frame: &Frame, expected: &[u32], end: usize) -> Vec<(usize, String)> {
    let (mut wrong, time) = (Vec::new(), number(frame.time));
    let mut ids: Vec<(u32, usize)> =
        frame.particles.iter().enumerate().map(|(row, of)| (of.id, row)).collect();
    ids.sort_unstable();
    if let Some([_, (id, row)]) = ids.array_windows().find(|[a, b]| a.0 == b.0) {
        wrong.push((*row, format!("particle {id} is there twice at t = {time} s")));
    }
    let has = |id: u32| ids.binary_search_by_key(&id, |(id, _)| *id).is_ok();
    let mut lacking = expected.iter().filter(|id| !has(**id));
    if let Some(first) = lacking.next() {
        // The last id decides: a file that only lacks the first particle ends with the last of the problem.
        let last = ids.last().map(|(id, _)| *id as usize);
        let ends = [Some(end), expected.last().map(|id| *id as usize + 1)];
        let is_higher = ends.contains(&last) && expected.iter().all(|id| has(id + 1));
        let higher = "; each id is one higher than in the problem, whose ids begin at 0";
        let (count, all) = (1 + lacking.count(), expected.len());
        let why = if is_higher { higher } else { "" };
        let what = format!(
            "{count} of {all} moving particles are missing at t = {time} s, the first with the id \
             {first}{why}"
        );
        wrong.push((0, what));
    }
    if let Some((id, row)) = ids.iter().find(|(id, _)| *id as usize >= end) {
        let last = end.saturating_sub(1);
        let what = format!("particle {id} is not in the problem, whose ids are 0 to {last}");
        wrong.push((*row, what));
    }
    wrong
}

/// The first number of a curve of a record that is not finite, in words.
fn hole(record: &Record) -> Option<String> {
    record.profiles.iter().find_map(|(name, curve)| {
        let why = curve.check_finite().err()?;
        Some(format!("the particles determine no value of the curve {name}: {why}"))
    })
}

/// A particle with a coordinate beyond this is lost \[m\].
fn reach(problem: &ExportedProblem) -> f64 {
    let Outline { particles, medium, .. } = &problem.outline;
    let places = ["x", "y"].into_iter().flat_map(|axis| particles.column(axis));
    FAR * places.fold(problem.outline.method.support * medium.h, |most, x| most.max(x.abs()))
}

/// Bounds beyond which a run of the problem has diverged: 30 % of the density for a fluid, a half for a
/// solid, and twice the sum of the sound speed, the largest initial speed and the speed of a fall until the
/// end.
fn limits(problem: &ExportedProblem) -> touchstone_solver::DivergenceBounds {
    let Outline { particles, medium, times, .. } = &problem.outline;
    let share = if problem.is_solid() { 0.5 } else { 0.7 };
    let start = particles.column("density").iter().copied();
    let [low, high] = [f64::min, f64::max].map(|end| start.clone().fold(medium.eos.density, end));
    let speeds = particles.column("u").iter().zip(particles.column("v"));
    let fastest = speeds.map(|(u, v)| (u * u + v * v).sqrt()).fold(0.0, f64::max);
    let fall = medium.acceleration.norm() * times.last().copied().unwrap_or_default();
    let speed = 2.0 * (medium.eos.sound_speed + fastest + fall);
    let most = if problem.is_solid() { 2.0 * high } else { 1.3 * high };
    touchstone_solver::DivergenceBounds { density: [share * low, most], speed }
}

/// Error for a frame with so many particles in one support that pairs exceed the memory.
fn crowded(frame: &Frame, support: f64, domain: &Domain, reach: f64) -> Option<String> {
    let mut cells: BTreeMap<[i64; 2], usize> = BTreeMap::new();
    for placed in frame.particles.iter().filter(|placed| placed.position.amax() <= reach) {
        let cell = domain.wrap(placed.position) / support;
        *cells.entry([cell.x.floor() as i64, cell.y.floor() as i64]).or_default() += 1;
    }
    let most = cells.into_values().max().filter(|most| *most > MOST_IN_SUPPORT)?;
    let time = frame.time;
    Some(format!(
        "{most} particles are in a square of one support radius, {support} m, at t = {time} s; expected at \
         most {MOST_IN_SUPPORT}, or a problem with a finer spacing"
    ))
}

/// Error for a text that reports and records cannot show in one line.
fn unnamed(file: &str, field: &str, text: &str) -> Option<Flaw> {
    let is_name = !text.trim().is_empty() && text.chars().count() <= 100;
    let unseen = unseen(text);
    if is_name && unseen.is_none() {
        return None;
    }
    let shown: String = text.chars().take(100).collect();
    let has = unseen.map_or(String::new(), |what| format!(" and has {what}"));
    let what = format!("it is {shown:?}{has}; expected 1 to 100 visible characters");
    Some(Flaw::of(file, what).in_column(field))
}

/// The problem that the folder has, if it has one.
fn asked(folder: &Path) -> Result<Option<ProblemDocument>, Flaw> {
    if let Ok(false) = folder.join(PROBLEM).try_exists() {
        return Ok(None);
    }
    let (asked, _) =
        document::<ProblemDocument>(folder, PROBLEM, "the document as it was exported")?;
    match asked.schema {
        SCHEMA => Ok(Some(asked)),
        other => {
            let what = format!("schema is {other}; this program reads schema {SCHEMA}");
            Err(Flaw::of(PROBLEM, what))
        }
    }
}

impl Entry {
    /// Places the particles of the problem so that they represent a profile or series, if there is one.
    ///
    /// # Errors
    /// If the case measures none, or everything that is wrong with the table.
    pub fn particles_from_curve(
        &mut self,
        case: &dyn Case,
        problem: &ExportedProblem,
    ) -> Result<(), Vec<Flaw>> {
        let Some((text, renamed)) = &self.curve else { return Ok(()) };
        let Some(curve) = case.facts().curve else {
            let what = format!("{} is measured of particles alone; expected these", case.name());
            return Err(vec![Flaw::of(CURVE, what)]);
        };
        self.results = curve::frames(&curve, text, renamed, problem)?;
        Ok(())
    }

    /// The (coarser) problem used for measuring, if it differs from the submitted one. A series of one
    /// point does not depend on the resolution, and all particles of a fine scene would be held for each of
    /// its times.
    ///
    /// # Errors
    /// As [`ExportedProblem::of`].
    pub fn scene(
        &self,
        case: &dyn Case,
        problem: &ExportedProblem,
    ) -> Result<Option<ExportedProblem>, RunError> {
        let curve = self.curve.as_ref().and_then(|_| case.facts().curve);
        let Some(coarsen) = curve.and_then(|curve| curve.coarsen) else { return Ok(None) };
        ExportedProblem::of(case, coarsen(&problem.spec)).map(Some)
    }

    /// The measured particles: for a curve the problem's.
    fn particles(&self) -> Division {
        if self.curve.is_some() { Division::Closed } else { self.method.division }
    }

    /// For a profile or series, removes metrics that need particles. Their number is known in the closed
    /// division, where it is the problem's.
    fn only_of_curve(&self, case: &dyn Case, problem: &ExportedProblem, record: &mut Record) {
        let Some(curve) = case.facts().curve.filter(|_| self.curve.is_some()) else {
            return;
        };
        let why = Absent::OfParticles;
        record.take_out(&|name, _| !record::is_of(&curve.metrics, name), &why);
        let is_to_be_told = |(name, why): &(&String, &mut Absent)| {
            **why != Absent::OwnTheory && !record::is_of(&curve.metrics, name)
        };
        for (_, reason) in record.absent.iter_mut().filter(is_to_be_told) {
            *reason = why.clone();
        }
        for name in problem.gates.iter().map(|gate| &gate.metric) {
            if !record::is_of(&curve.metrics, name) {
                record.absent.entry(name.clone()).or_insert_with(|| why.clone());
            }
        }
        record.keep_columns(curve.shown);
        record.state = None;
        record.cost.particles = match self.method.division {
            Division::Closed => problem.moving().len(),
            Division::Open => 0,
        };
    }

    /// Does it fit the problem?
    ///
    /// # Errors
    /// Everything that does not.
    pub fn check(&self, problem: &ExportedProblem) -> Result<(), Vec<Flaw>> {
        let mut flaws = Vec::new();
        let Results { frames, places, .. } = &self.results;
        let file = places.first().map_or("results", |(file, _)| file.as_str());
        if let Some((frame, why)) = foreign::misplaced(frames, &problem.outline.times) {
            let (file, line) = &places[frame];
            let what = format!("t = {} s: {why}", number(frames[frame].time));
            flaws.push(Flaw::of(file, what).at(*line).in_column("t"));
        }
        for time in foreign::missing(frames, &problem.outline.times) {
            let what =
                format!("there are no particles at t = {time} s, at which the problem is measured");
            flaws.push(Flaw::of(file, what).in_column("t"));
        }
        let expected = match self.particles() {
            Division::Closed => problem.moving(),
            Division::Open => self.own_ids(problem, &mut flaws),
        };
        flaws.extend(self.contradictions(problem).take(MOST_FLAWS));
        let all = match self.particles() {
            Division::Closed => problem.outline.particles.column("id").len(),
            Division::Open => expected.len(),
        };
        let support = problem.outline.method.support * problem.outline.medium.h;
        let (domain, reach) = (&problem.outline.domain, reach(problem));
        for (frame, (file, line)) in frames.iter().zip(places) {
            if flaws.len() >= MOST_FLAWS {
                flaws.push(Flaw::of(file, "more flaws like these; later entries were not checked"));
                break;
            }
            let flaw = |what: String| Flaw::of(file, what).in_column("id");
            flaws.extend(crowded(frame, support, domain, reach).map(|what| flaw(what).at(*line)));
            let wrong = misnumbered(frame, &expected, all).into_iter();
            flaws.extend(wrong.map(|(row, what)| flaw(what).at(line + row as u64)));
        }
        if flaws.is_empty() { Ok(()) } else { Err(flaws) }
    }

    /// Mass and role that the files state, where the problem has others.
    fn contradictions<'a>(
        &'a self,
        problem: &'a ExportedProblem,
    ) -> impl Iterator<Item = Flaw> + 'a {
        let Results { stated, places, .. } = &self.results;
        let file = places.first().map_or("results", |(file, _)| file.as_str());
        let is_closed = self.particles() == Division::Closed;
        let of =
            |name: &str, id: u32| problem.outline.particles.column(name).get(id as usize).copied();
        let other = move |(id, (mass, stated)): (&u32, &(f64, Option<Role>))| {
            if let Some(expected) = of("mass", *id)
                && (mass - expected).abs() > SAME_MASS * expected
            {
                let [mass, expected] = [*mass, expected].map(number);
                let what = format!("particle {id} has {mass} kg/m, in the problem {expected} kg/m");
                return Some(Flaw::of(file, what).in_column("mass"));
            }
            let (stated, expected) = ((*stated)?, of("role", *id)?);
            let what = || {
                let stated = stated as u8;
                format!("particle {id} has the role {stated}, in the problem {expected}")
            };
            (role(expected) != Some(stated)).then(|| Flaw::of(file, what()).in_column("role"))
        };
        stated.iter().filter(move |_| is_closed).filter_map(other)
    }

    /// The ids of the particles of a code with its own particles, and the flaws of its start.
    fn own_ids(&self, problem: &ExportedProblem, flaws: &mut Vec<Flaw>) -> Vec<u32> {
        let Results { frames, own, places, .. } = &self.results;
        let (file, line) = &places[0];
        let mut flaw = |column, what| flaws.push(Flaw::of(file, what).at(*line).in_column(column));
        let mut ids: Vec<u32> =
            frames.first().into_iter().flat_map(|f| &f.particles).map(|p| p.id).collect();
        ids.sort_unstable();
        if let Some((k, id)) = ids.iter().enumerate().find(|(k, id)| **id as usize != *k) {
            let what = "ids of the first frame are not 0, 1, 2 and so on, each once";
            flaw("id", format!("{what}: {id} is in place of {k}"));
        }
        if own.iter().any(|own| own.mass.is_nan()) {
            let what = "it is missing; in the open division each particle states its mass";
            flaw("mass", what.into());
        }
        let Medium { dx, eos, .. } = &problem.outline.medium;
        let share =
            |own: &OwnParticle| own.mass / own.start.density.unwrap_or(eos.density) / (dx * dx);
        let is_usual = |own: &&OwnParticle| own.mass.is_nan() || VOLUMES.contains(&share(own));
        if let Some(own) = own.iter().find(|own| !is_usual(own)) {
            let [mass, share, low, high] =
                [own.mass, share(own), *VOLUMES.start(), *VOLUMES.end()].map(number);
            flaw(
                "mass",
                format!(
                    "particle {} has {mass} kg/m, and mass over density {share} times the square of the \
                     problem's spacing; expected {low} to {high} times",
                    own.start.id
                ),
            );
        }
        if frames.first().is_some_and(|frame| frame.time != 0.0) {
            let what = "the first frame is not at t = 0, at which an open submission starts";
            flaw("t", what.into());
        }
        ids
    }

    /// Code of the run.
    fn submission(&self, problem: &ExportedProblem) -> Submission {
        let Method { code, version, scheme, division, .. } = self.method.clone();
        let sealed = self.asked.as_ref().and_then(|asked| asked.sealed.as_ref());
        let (method, seed) = (self.digest.clone(), sealed.map(|sealed| sealed.seed));
        let results = Some(self.digest_of_results());
        let states_our_method = self.states_our_method(problem);
        Submission { code, version, scheme, division, method, results, seed, states_our_method }
    }

    /// SHA-256 of the particles in the order of their ids: equal results of two codes are detected in any
    /// format.
    fn digest_of_results(&self) -> String {
        let mut digests = String::new();
        let mut add = |bytes: Vec<u8>| digests += &sha256(&bytes);
        for frame in &self.results.frames {
            let mut particles: Vec<&ForeignParticle> = frame.particles.iter().collect();
            particles.sort_by_key(|placed| placed.id);
            let numbers =
                |&ForeignParticle { id, position: at, velocity, density }: &ForeignParticle| {
                    let density = density.unwrap_or(f64::NAN);
                    [f64::from(id), at.x, at.y, velocity.x, velocity.y, density]
                };
            let numbers = particles.into_iter().flat_map(numbers);
            add([frame.time].into_iter().chain(numbers).flat_map(f64::to_le_bytes).collect());
        }
        let own = self.results.own.iter().map(|own| own.mass);
        add(own.flat_map(f64::to_le_bytes).collect());
        sha256(digests.as_bytes())
    }

    /// The frames, with the particles of the code itself in the open division.
    fn foreign(&self, problem: &ExportedProblem) -> Foreign<'_> {
        let mut own = match self.particles() {
            Division::Open => self.results.own.clone(),
            Division::Closed => Vec::new(),
        };
        own.sort_by_key(|own| own.start.id);
        let (domain, reach, limits) = (problem.outline.domain, reach(problem), limits(problem));
        let density = problem.outline.medium.eos.density;
        Foreign { frames: &self.results.frames, own, domain, reach, limits, density }
    }

    /// Measures the particles in a scene like a run of the problem.
    ///
    /// # Errors
    /// If the case refuses the run, or a frame cannot be put in place of its particles.
    pub fn measure(
        &self,
        case: &dyn Case,
        scene: &RunSpec,
        problem: &ExportedProblem,
    ) -> Result<Record, RunError> {
        let ours = RunSpec { measure: Measure::Headline, submission: None, ..scene.clone() };
        let mut record = case.pose(&ours)?.measure_frames(&ours, &self.foreign(problem))?;
        record.run.submission = Some(Box::new(self.submission(problem)));
        record.run.settings = problem.spec.settings.clone();
        self.leave_out_rounded(case, problem, &mut record);
        suite::mark_own_metrics_absent(case, &mut record);
        record.numerics.clear();
        record.numerics.insert(MACHINE.into(), self.system.machine.as_str().into());
        self.only_of_curve(case, problem, &mut record);
        if self.particles() == Division::Open {
            record.profiles.clear(); // those that follow rows of the problem's own particles
        }
        record.cost = self.cost(&record);
        if let (Status::Completed, Some(reason)) = (&record.status, hole(&record)) {
            record.status = Status::Refused { reason };
        }
        Ok(record)
    }

    /// The digits that were not submitted, in words, if there are few: rounding of a file is not a flaw of a
    /// method.
    pub fn few_digits(&self, problem: &ExportedProblem) -> Option<String> {
        let Results { frames, own, .. } = &self.results;
        let own: BTreeMap<u32, ForeignParticle> = match self.particles() {
            Division::Closed => BTreeMap::new(),
            Division::Open => own.iter().map(|own| (own.start.id, own.start)).collect(),
        };
        let start = |id| if own.is_empty() { problem.start_of(id) } else { own.get(&id).copied() };
        digits::few(frames.last()?, &start).filter(|_| self.curve.is_none())
    }

    /// Removes metrics that rounded numbers do not determine: measurements over a very short time, and
    /// comparisons with round-off.
    fn leave_out_rounded(&self, case: &dyn Case, problem: &ExportedProblem, record: &mut Record) {
        let Some(few) = self.few_digits(problem) else { return };
        let rates = case.facts().of_all_digits;
        let is_of_round_off =
            |of: &&Gate| of.bound.ends().iter().any(|end| *end != 0.0 && end.abs() <= ROUND_OFF);
        let of_round_off = problem.gates.iter().filter(is_of_round_off);
        let metrics: Vec<&String> = of_round_off.map(|gate| &gate.metric).collect();
        let is_to_go = |name: &str, _: &Metric| {
            record::is_of(rates, name) || metrics.iter().any(|metric| *metric == name)
        };
        record.take_out(&is_to_go, &Absent::NotGiven(few));
    }

    /// The stated steps to the end of the problem, or the number of our own.
    pub fn steps(&self, problem: &ExportedProblem) -> f64 {
        let end = problem.outline.times.last().copied().unwrap_or_default();
        self.system.steps.unwrap_or(end / problem.outline.dt)
    }

    /// Whether the method states our kernel, support and step, and made the corresponding number of steps.
    fn states_our_method(&self, problem: &ExportedProblem) -> bool {
        let Outline { medium, times, dt, .. } = &problem.outline;
        let is = |name: &str, expected: f64| {
            let stated = self.method.settings.get(name).and_then(Value::as_f64);
            stated.is_some_and(|stated| (stated - expected).abs() <= SAME * expected)
        };
        let kernel = self.method.settings.get("kernel").and_then(Value::as_str);
        let end = times.last().copied().unwrap_or_default();
        // Steps are shortened to reach each of the times.
        let expected = (end / dt).ceil() + times.len() as f64;
        let as_many =
            self.system.steps.is_none_or(|made| made <= expected && made >= (end / dt).floor());
        self.particles() == Division::Closed
            && kernel == Some(problem.outline.method.kernel)
            && is("support", problem.outline.method.support * medium.h)
            && is("dt", *dt)
            && as_many
    }

    fn cost(&self, record: &Record) -> Cost {
        let System { threads, seconds, steps, interactions, .. } = &self.system;
        let count = |known: &Option<f64>| known.map_or(0, |number| number as u64);
        let processor = seconds.zip(*threads).map(|(s, threads)| s * threads);
        Cost {
            wall_s: seconds.unwrap_or(f64::NAN),
            cpu_s: processor.unwrap_or(f64::NAN),
            alone_s: processor.into_iter().collect(),
            steps: count(steps),
            pair_interactions: count(interactions),
            particles: record.cost.particles,
            threads: count(threads) as usize,
            ..Cost::default()
        }
    }
}
