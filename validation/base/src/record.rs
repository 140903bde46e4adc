//! The record of a run, one JSON document: settings, outcome, metrics, cost, numerics, manifest.
//!
//! The document states its [`SCHEMA`]; a reader refuses any other. Its last key is the digest of everything
//! before it, so that a reader refuses a damaged or changed document. Floats are stored without loss. There
//! is no `null`: a number that is not finite is written as `{"not_finite": "NaN"}` (see
//! [`number`](crate::number)), and the key of a value that does not exist is omitted.
//!
//! ```
//! use touchstone_base::record::{Metric, Record};
//! let mut record = Record::new("couette", "seed", serde_json::json!({"re": 0.5}), 1);
//! let formula = "sqrt(sum (u - u_exact)^2 / sum u_exact^2)";
//! record.metrics.insert("l2".into(), Metric::new(1e-3, "-", formula));
//! let text = record.to_json()?;
//! assert_eq!(Record::from_json(&text)?, record);
//! # Ok::<(), touchstone_base::record::RecordError>(())
//! ```

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use crate::absent::Absent;
use crate::breakdown::Breakdown;
use crate::manifest::Manifest;
use crate::number::is_default;
use crate::reference::sha256;
use crate::spec::{Measure, RunSpec};
use crate::text::unseen;

/// Version of the document; raised with every change that an older reader would misread.
pub const SCHEMA: u32 = 3;

/// Why a record was not written or not read.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The text is not a record.
    #[error("the record cannot be read: {0}")]
    Unreadable(#[from] serde_json::Error),
    /// The document has another version.
    #[error("the record has schema {found}{}, but this program reads only schema {SCHEMA}", age(.found))]
    Schema {
        /// the stated schema
        found: String,
    },
    /// The document is not as it was written.
    #[error("the record does not have the digest that it states: it was damaged or changed")]
    Damaged,
    /// A text has an invisible character.
    #[error("{path} of the record has {what}")]
    Unseen {
        /// where it is
        path: String,
        /// the character
        what: String,
    },
    /// The document has a `null`, which states neither what is missing nor why.
    #[error("{path} of the record is null; omit the key or give a value")]
    Null {
        /// keys from the root, as in `/numerics/dt`
        path: String,
    },
}

/// The word for a document whose schema is lower than [`SCHEMA`].
fn age(found: &str) -> &'static str {
    match found.parse::<u32>() {
        Ok(found) if found < SCHEMA => " and was made by an older version",
        _ => "",
    }
}

/// Between a record and the digest of all before it.
const SEAL: &str = ",\n  \"digest\": \"";
/// The end of a document.
const END: &str = "\n}\n";

/// The document with its digest as last key.
fn sealed(document: &str) -> String {
    let head = document.strip_suffix(END).unwrap_or(document);
    format!("{head}{SEAL}{}\"{END}", sha256(document.as_bytes()))
}

/// The document before it was [`sealed`]; `None` if it is not as it was then.
fn unsealed(text: &str) -> Option<String> {
    let (head, _) = text.rsplit_once(SEAL)?;
    let document = format!("{head}{END}");
    (sealed(&document) == text).then_some(document)
}

/// Everything about one run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// version of the document
    pub schema: u32,
    /// the run, without the measured part
    #[serde(flatten)]
    pub run: RunSpec,
    /// how the run ended
    pub status: Status,
    /// measured results by name
    pub metrics: BTreeMap<String, Metric>,
    /// results that are undefined in this run, by name, with the reason
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub absent: BTreeMap<String, Absent>,
    /// cost of the run
    pub cost: Cost,
    /// parameters of the method: `h/dx`, kernel, integrator, c0, dt; see
    /// [`number::json`](crate::number::json)
    pub numerics: BTreeMap<String, Value>,
    /// curves by name
    #[serde(default)]
    pub profiles: BTreeMap<String, Profile>,
    /// digest of the final state, see [`digest`]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<String>,
    /// program, compiler, machine
    pub manifest: Manifest,
}

/// How a run ended.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Status {
    /// to its end
    #[default]
    Completed,
    /// a field of a particle became too large or not finite
    Diverged {
        /// steps done
        step: u64,
        /// simulated time in seconds
        #[serde(with = "crate::number")]
        time: f64,
        /// index of the particle
        particle: usize,
        /// name of the field
        field: String,
        /// the value as text, because it may be NaN
        value_text: String,
    },
    /// before the first step
    Refused {
        /// the setting, its value, and the allowed values
        reason: String,
    },
    /// by the user
    Interrupted {
        /// steps done
        step: u64,
        /// simulated time in seconds
        #[serde(with = "crate::number")]
        time: f64,
    },
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Completed => f.write_str("completed"),
            Self::Diverged { step, time, particle, field, value_text } => {
                // The steps of another code are not known.
                let after = if *step > 0 { format!(" after step {step},") } else { String::new() };
                write!(
                    f,
                    "diverged{after} at t = {time:.4e} s: {field} of particle {particle} is {value_text}"
                )
            }
            Self::Refused { reason } => write!(f, "refused: {reason}"),
            Self::Interrupted { step, time } => {
                write!(f, "interrupted after step {step}, at t = {time:.4e} s")
            }
        }
    }
}

/// One measured result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Metric {
    /// the number
    #[serde(with = "crate::number")]
    pub value: f64,
    /// SI unit, `-` for none
    pub unit: String,
    /// how it was computed, with its scale
    pub formula: String,
}

impl Metric {
    /// A metric with its unit and its formula.
    pub fn new(value: f64, unit: &str, formula: &str) -> Self {
        Metric { value, unit: unit.into(), formula: formula.into() }
    }
}

/// A metric as a case declares it: name, unit and formula are stated once, and every use names the
/// constant, so that a misspelt name does not compile.
///
/// ```
/// use touchstone_base::record::{MetricKey, Record};
/// const L2: MetricKey = MetricKey::new("l2", "-", "rms(u - u_exact)/rms(u_exact)");
/// let mut record = Record::new("couette", "seed", serde_json::json!({}), 1);
/// record.put(L2.at(0.1), 1e-3);
/// assert_eq!(record.value(L2.at(0.1)), Some(1e-3));
/// assert_eq!(record.value(L2), None);
/// assert_eq!(record.metrics["l2@0.1"].formula, "rms(u - u_exact)/rms(u_exact)");
/// const GAP: MetricKey = MetricKey::new("gap", "-", "|E(t) - E(0)|/{}");
/// record.put(GAP.of("M g H"), 0.0);
/// assert_eq!(record.metrics["gap"].formula, "|E(t) - E(0)|/M g H");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MetricKey {
    name: &'static str,
    unit: &'static str,
    formula: &'static str,
}

/// The name of a metric or a profile with its time, or another mark.
pub fn marked(name: &str, mark: impl fmt::Display) -> String {
    format!("{name}@{mark}")
}

/// The name of a metric or a profile without its mark, and the mark: `impulse` and `phase1` of
/// `impulse@phase1`.
pub fn name_and_mark(name: &str) -> (&str, Option<&str>) {
    name.split_once('@').map_or((name, None), |(name, mark)| (name, Some(mark)))
}

/// Whether a metric is one of these, at any time or other mark.
pub fn is_of(keys: &[MetricKey], name: &str) -> bool {
    keys.iter().any(|key| name_and_mark(name).0 == key.name)
}

impl MetricKey {
    /// A metric with its unit and its formula.
    pub const fn new(name: &'static str, unit: &'static str, formula: &'static str) -> Self {
        Self { name, unit, formula }
    }

    /// The column of this name, in a profile and a unit.
    pub const fn column(self, profile: &'static str, unit: &'static str) -> ColumnKey {
        ColumnKey::new(profile, self.name, unit)
    }

    /// The metric at a time, a station or another mark: `name@mark`.
    pub fn at(self, mark: impl fmt::Display) -> MetricName {
        MetricName { key: self, name: marked(self.name, mark), what: String::new() }
    }

    /// The metric with `what` in place of `{}` in its formula.
    pub fn of(self, what: impl fmt::Display) -> MetricName {
        MetricName { what: what.to_string(), ..self.into() }
    }
}

/// A column of a profile as a case declares it: profile, name and unit are stated once, and every use names
/// the constant.
///
/// ```
/// use touchstone_base::record::{ColumnKey, Record};
/// const TIME: ColumnKey = ColumnKey::new("series", "t", "s");
/// const FRONT: ColumnKey = ColumnKey::new("series", "front", "m");
/// let mut record = Record::new("dam_break", "seed", serde_json::json!({}), 1);
/// let rows = [(0.0, 1.0), (0.5, 1.2)];
/// record.put_column(TIME, &rows, |(time, _)| *time);
/// record.put_column(FRONT, &rows, |(_, front)| *front);
/// assert_eq!(record.column(FRONT), [1.0, 1.2]);
/// assert_eq!(record.curve([TIME, FRONT]), rows);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ColumnKey {
    /// name of the profile, without a mark
    pub profile: &'static str,
    /// name of the column
    pub name: &'static str,
    /// SI unit, `-` for none
    pub unit: &'static str,
}

impl ColumnKey {
    /// A column of a profile with its unit.
    pub const fn new(profile: &'static str, name: &'static str, unit: &'static str) -> Self {
        Self { profile, name, unit }
    }
}

/// Declares metrics, a line each: constant, name, unit, formula. The formula is the documentation. After
/// `all NAME;` they are in a list of this name too.
///
/// ```
/// touchstone_base::metrics! {
///     L2 = "l2" ["-"] "rms(u - u_exact)/rms(u_exact)";
///     FORCE = "force" ["U_b^2/H"] "mean body force";
/// }
/// assert_eq!(FORCE, touchstone_base::record::MetricKey::new("force", "U_b^2/H", "mean body force"));
/// assert_eq!(String::from(L2), "l2");
/// ```
#[macro_export]
macro_rules! metrics {
    (all $all:ident; $($constant:ident = $name:literal [$unit:literal] $formula:literal;)+) => {
        $crate::metrics! { $($constant = $name [$unit] $formula;)+ }
        /// Every metric of this list.
        pub const $all: &[$crate::record::MetricKey] = &[$($constant),+];
    };
    ($($constant:ident = $name:literal [$unit:literal] $formula:literal;)+) => {$(
        #[doc = $formula]
        pub const $constant: $crate::record::MetricKey =
            $crate::record::MetricKey::new($name, $unit, $formula);
    )+};
}

/// A metric by its full name in the record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MetricName {
    key: MetricKey,
    /// The name, as gates state it.
    pub name: String,
    what: String,
}

impl MetricName {
    /// The unit.
    pub fn unit(&self) -> &'static str {
        self.key.unit
    }

    /// How it is computed.
    pub fn formula(&self) -> String {
        self.key.formula.replace("{}", &self.what)
    }
}

impl From<MetricKey> for MetricName {
    fn from(key: MetricKey) -> Self {
        Self { key, name: key.name.into(), what: String::new() }
    }
}

impl From<MetricKey> for String {
    fn from(key: MetricKey) -> Self {
        key.name.into()
    }
}

impl From<MetricName> for String {
    fn from(metric: MetricName) -> Self {
        metric.name
    }
}

/// A time that was not measured.
fn unknown() -> f64 {
    f64::NAN
}

fn is_unknown(seconds: &f64) -> bool {
    seconds.is_nan()
}

/// Cost of a run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// wall time of the stepping loop in seconds
    #[serde(default = "unknown", skip_serializing_if = "is_unknown", with = "crate::number")]
    pub wall_s: f64,
    /// processor time of the stepping loop, all threads in seconds
    #[serde(default = "unknown", skip_serializing_if = "is_unknown", with = "crate::number")]
    pub cpu_s: f64,
    /// time steps
    #[serde(default, skip_serializing_if = "is_default")]
    pub steps: u64,
    /// neighbours that were inside the support when the lists were built, summed over all traversals
    #[serde(default, skip_serializing_if = "is_default")]
    pub pair_interactions: u64,
    /// right-hand sides of one particle
    #[serde(default, skip_serializing_if = "is_default")]
    pub particle_rhs: u64,
    /// the largest time step that was taken in seconds: steps are shortened to reach a time exactly
    #[serde(default, skip_serializing_if = "is_default", with = "crate::number")]
    pub largest_dt_s: f64,
    /// particles that move
    #[serde(default, skip_serializing_if = "is_default")]
    pub particles: usize,
    /// threads used
    #[serde(default, skip_serializing_if = "is_default")]
    pub threads: usize,
    /// memory of the solver's arrays in bytes
    #[serde(default, skip_serializing_if = "is_default")]
    pub solver_bytes: u64,
    /// time of observers (gauges, energy ledgers, samples, frames) in seconds, which is no part of the
    /// stepping
    #[serde(default, skip_serializing_if = "is_default", with = "crate::number")]
    pub observing_s: f64,
    /// processor seconds of the stepping, one a repetition, taken while nothing else of this program was at
    /// work; empty if the run was only made side by side with others
    #[serde(default, skip_serializing_if = "Vec::is_empty", with = "crate::number::list")]
    pub alone_s: Vec<f64>,
    /// number of restarts from a checkpoint; times are sums over all parts
    #[serde(default, skip_serializing_if = "is_default")]
    pub resumed: u32,
    /// breakdown of the time, if requested
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub breakdown: Option<Breakdown>,
}

impl Cost {
    /// Median of the timings of a run that had the machine for itself \[s\]; `None` if it was not timed.
    pub fn alone_median(&self) -> Option<f64> {
        median(&self.alone_s)
    }
}

/// The middle of some numbers, the mean of the two in the middle if their count is even.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    (n > 0).then(|| 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]))
}

/// Columns of one length: a profile at one time, or a series in time.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// the columns in order
    pub columns: Vec<ProfileColumn>,
}

/// One column of a profile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProfileColumn {
    /// name
    pub name: String,
    /// SI unit, `-` for none
    pub unit: String,
    /// the numbers
    #[serde(with = "crate::number::list")]
    pub values: Vec<f64>,
}

impl Profile {
    /// Adds a column of this name and unit from rows.
    pub fn put<R>(self, rows: &[R], name: &str, unit: &str, value: impl Fn(&R) -> f64) -> Self {
        self.with(name, unit, rows.iter().map(value).collect())
    }

    /// Adds a column.
    pub fn with(mut self, name: &str, unit: &str, values: Vec<f64>) -> Self {
        self.columns.push(ProfileColumn { name: name.into(), unit: unit.into(), values });
        self
    }

    /// The values of a column, none if there is no such column.
    pub fn column(&self, name: &str) -> &[f64] {
        self.columns.iter().find(|c| c.name == name).map_or(&[], |c| &c.values)
    }

    /// Looks for a number that is not finite.
    ///
    /// # Errors
    /// Returns the column, the row from 1 on, and the value of the first number that is not finite.
    pub fn check_finite(&self) -> Result<(), String> {
        for ProfileColumn { name, unit, values } in &self.columns {
            if let Some(row) = values.iter().position(|value| !value.is_finite()) {
                let value = values[row];
                return Err(format!(
                    "column {name}[{unit}] of row {} is {value}, which is not finite",
                    row + 1
                ));
            }
        }
        Ok(())
    }

    /// Comma-separated values, each column under `name[unit]`. A number is the shortest text that reads back
    /// to the same bits; a number that is not finite, or beyond the end of a shorter column, is an empty
    /// cell.
    pub fn to_csv(&self) -> String {
        let head = |column: &ProfileColumn| format!("{}[{}]", column.name, column.unit);
        let heads: Vec<String> = self.columns.iter().map(head).collect();
        let cell = |number: Option<&f64>| match number {
            Some(number) if number.is_finite() => {
                let text = format!("{number:?}");
                text.strip_suffix(".0").unwrap_or(&text).to_string()
            }
            _ => String::new(),
        };
        let mut text = heads.join(",") + "\n";
        for k in 0..self.columns.iter().map(|column| column.values.len()).max().unwrap_or(0) {
            let cells = self.columns.iter().map(|column| cell(column.values.get(k)));
            text += &(cells.collect::<Vec<_>>().join(",") + "\n");
        }
        text
    }
}

impl Record {
    /// The day on which a record that the program contains was made together with records of other codes.
    pub fn session(&self) -> Option<&str> {
        self.numerics.get(crate::submission::SESSION)?.as_str()
    }

    /// A record of a run that was refused before its first step, for this reason.
    pub fn refused(spec: &RunSpec, reason: String) -> Self {
        Self { status: Status::Refused { reason }, ..Self::of(spec, 1) }
    }

    /// The run, without the measured part.
    pub fn spec(&self) -> RunSpec {
        self.run.clone()
    }

    /// The measured part of the run: all, unless a metric is absent because it was not requested.
    pub fn measured(&self) -> Measure {
        let is_part = self.absent.values().any(|reason| *reason == Absent::NotAsked);
        if is_part { Measure::Headline } else { Measure::All }
    }

    /// A record of one simulation of this process that is yet to be filled: completed, nothing measured.
    pub fn new(case: &str, variant: &str, settings: Value, threads: usize) -> Self {
        Self::of(&RunSpec::new(case, variant, settings), threads)
    }

    /// The manifest of any run.
    pub fn of(spec: &RunSpec, threads: usize) -> Self {
        Record {
            schema: SCHEMA,
            run: RunSpec { measure: Measure::default(), ..spec.clone() },
            cost: Cost { threads, ..Cost::default() },
            manifest: Manifest::of_this_process(threads),
            ..Record::default()
        }
    }

    /// A metric's value, `None` if it was not measured.
    pub fn metric(&self, name: &str) -> Option<f64> {
        self.metrics.get(name).map(|metric| metric.value)
    }

    /// States a metric.
    pub fn put(&mut self, metric: impl Into<MetricName>, value: f64) {
        let MetricName { key, name, what } = metric.into();
        let formula = key.formula.replace("{}", &what);
        self.metrics.insert(name, Metric::new(value, key.unit, &formula));
    }

    /// Puts a metric with a value, else states the reason for its absence.
    pub fn put_or(&mut self, metric: impl Into<MetricName>, value: Option<f64>, reason: &str) {
        match value {
            Some(value) => self.put(metric, value),
            None => self.leave_out(metric, Absent::because(reason)),
        }
    }

    /// Puts a metric, or states why a snapshot does not determine its value.
    pub fn put_or_absent(&mut self, metric: impl Into<MetricName>, value: Result<f64, Absent>) {
        match value {
            Ok(value) => self.put(metric, value),
            Err(absent) => self.leave_out(metric, absent),
        }
    }

    /// Why a metric is absent; of `impulse@phase1` perhaps by the name `impulse`, of all phases.
    pub fn absent_as(&self, metric: &str) -> Option<&Absent> {
        let is_there = self.metrics.contains_key(metric);
        let of_all = Some(name_and_mark(metric).0).filter(|_| !is_there);
        self.absent.get(metric).or_else(|| self.absent.get(of_all?))
    }

    /// States why a metric is absent: this run gives it no meaning.
    pub fn leave_out(&mut self, metric: impl Into<MetricName>, reason: Absent) {
        self.absent.insert(metric.into().name, reason);
    }

    /// Takes out every metric that is to go, and states why it is absent.
    pub fn take_out(&mut self, is_to_go: &dyn Fn(&str, &Metric) -> bool, reason: &Absent) {
        let taken = self.metrics.extract_if(.., |name, metric| is_to_go(name, metric));
        self.absent.extend(taken.map(|(name, _)| (name, reason.clone())));
    }

    /// States why several metrics are absent.
    pub fn leave_all_out(&mut self, metrics: &[MetricKey], reason: &Absent) {
        metrics.iter().for_each(|metric| self.leave_out(*metric, reason.clone()));
    }

    /// A metric's value, `None` if it was not measured.
    pub fn value(&self, metric: impl Into<MetricName>) -> Option<f64> {
        self.metric(&metric.into().name)
    }

    /// Adds a column to its profile, with a value of each row.
    pub fn put_column<R>(&mut self, key: ColumnKey, rows: &[R], value: impl Fn(&R) -> f64) {
        self.put_known_column(key, rows, |row| Ok(value(row)));
    }

    /// Adds a column to its profile, if its value is known in all rows.
    pub fn put_known_column<R>(
        &mut self,
        key: ColumnKey,
        rows: &[R],
        value: impl Fn(&R) -> Result<f64, Absent>,
    ) {
        let ColumnKey { profile, name, unit } = key;
        let Ok(values) = rows.iter().map(value).collect() else { return };
        let column = ProfileColumn { name: name.into(), unit: unit.into(), values };
        self.profiles.entry(profile.into()).or_default().columns.push(column);
    }

    /// The values of a column, none if the record does not have it.
    pub fn column(&self, key: ColumnKey) -> &[f64] {
        self.profiles.get(key.profile).map_or(&[], |profile| profile.column(key.name))
    }

    /// Removes all columns but these, of profiles with any mark, and all profiles without columns.
    pub fn keep_columns(&mut self, kept: &[ColumnKey]) {
        self.profiles.retain(|name, profile| {
            let of = name_and_mark(name).0;
            let is_kept =
                |c: &ProfileColumn| kept.iter().any(|k| k.profile == of && k.name == c.name);
            profile.columns.retain(is_kept);
            !profile.columns.is_empty()
        });
    }

    /// The points (x, y) of two columns.
    pub fn curve(&self, [x, y]: [ColumnKey; 2]) -> Vec<(f64, f64)> {
        self.column(x).iter().copied().zip(self.column(y).iter().copied()).collect()
    }

    /// The document, indented, with its digest and a newline at its end.
    pub fn to_json(&self) -> Result<String, RecordError> {
        let text = serde_json::to_string_pretty(self)?;
        check(&serde_json::from_str(&text)?)?;
        Ok(sealed(&(text + "\n")))
    }

    /// Reads a document of this [`SCHEMA`] that is as [`Record::to_json`] wrote it.
    pub fn from_json(text: &str) -> Result<Self, RecordError> {
        let value: Value = serde_json::from_str(text)?;
        match &value["schema"] {
            schema if *schema == SCHEMA => {}
            schema => return Err(RecordError::Schema { found: schema.to_string() }),
        }
        let document = unsealed(text).ok_or(RecordError::Damaged)?;
        check(&value)?;
        Ok(serde_json::from_str(&document)?) // from the text again: errors then name line and column
    }
}

/// Refuses a `null`, and a text that a page or a terminal would not show as it is.
fn check(document: &Value) -> Result<(), RecordError> {
    let Some((path, unseen)) = flaw(document) else { return Ok(()) };
    Err(unseen.map_or(RecordError::Null { path: path.clone() }, |what| RecordError::Unseen {
        path,
        what,
    }))
}

/// The path of the first flaw; with the invisible character, or `None` for a `null`.
fn flaw(value: &Value) -> Option<(String, Option<String>)> {
    let below = |key: &str, child| flaw(child).map(|(path, what)| (format!("/{key}{path}"), what));
    let unseen = |text: &str| unseen(text).map(|what| (String::new(), Some(what)));
    match value {
        Value::Null => Some((String::new(), None)),
        Value::String(text) => unseen(text),
        Value::Array(items) => {
            items.iter().enumerate().find_map(|(index, item)| below(&index.to_string(), item))
        }
        Value::Object(map) => {
            map.iter().find_map(|(key, item)| unseen(key).or_else(|| below(key, item)))
        }
        _ => None,
    }
}

/// A 128-bit digest of the bit patterns of a state, in order: equal digests mean equal bits.
///
/// 0 and -0 differ, and so do NaNs of different payload. The first half of SHA-256.
pub fn digest(values: &[f64]) -> String {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_bits().to_le_bytes()).collect();
    sha256(&bytes)[..32].to_string()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::number;

    fn record() -> Record {
        let mut record = Record::new("couette", "seed", json!({"re": 0.5, "c0": "auto"}), 2);
        for (name, value) in [("l2", 0.1 + 0.2), ("linf", f64::INFINITY), ("mass", -0.0)] {
            record.metrics.insert(name.into(), Metric::new(value, "-", "max |u - u_exact| / V0"));
        }
        record.numerics.insert("dt".into(), number::json(3.2e-7));
        record.numerics.insert("kernel".into(), "quintic".into());
        let profile = Profile::default().with("y", "m", vec![1e-300, 0.1]);
        record.profiles.insert("t=0.1".into(), profile.with("u", "m/s", vec![f64::INFINITY, 0.3]));
        record.absent.insert("order".into(), Absent::because("there is one level"));
        record.state = Some(digest(&[1.0]));
        record.cost.alone_s = vec![0.1, 0.3];
        record
    }

    #[test]
    fn a_number_that_is_not_finite_is_told_with_its_place() {
        let sound = Profile::default().with("t", "s", vec![0.0, 1.0]);
        assert_eq!(sound.check_finite(), Ok(()));
        let error = sound.with("u", "m/s", vec![2.0, f64::NAN]).check_finite().unwrap_err();
        assert_eq!(error, "column u[m/s] of row 2 is NaN, which is not finite");
    }

    #[test]
    fn a_table_has_units_keeps_every_bit_and_has_a_gap_where_there_is_no_number() {
        let table = Profile::default().with("t", "s", vec![1.0, -0.0, 0.1 + 0.2]);
        let table = table.with("u", "m/s", vec![f64::NAN, 1e-300]);
        assert_eq!(table.to_csv(), "t[s],u[m/s]\n1,\n-0,1e-300\n0.30000000000000004,\n");
    }

    #[test]
    fn a_record_round_trips_bit_by_bit() {
        let record = record();
        let text = record.to_json().unwrap();
        let back = Record::from_json(&text).unwrap();
        assert_eq!(back, record);
        assert_eq!(back.metrics["mass"].value.to_bits(), (-0.0_f64).to_bits());
        assert_eq!(back.to_json().unwrap(), text);
        assert_eq!((back.metric("linf"), back.metric("none")), (Some(f64::INFINITY), None));
    }

    #[test]
    fn every_status_round_trips() {
        let (step, time) = (1717, 0.0123);
        let diverged = Status::Diverged {
            step,
            time,
            particle: 42,
            field: "velocity".into(),
            value_text: "NaN".into(),
        };
        let refused = Status::Refused { reason: "setting rows is 3; allowed is 4 to 2000".into() };
        for status in [Status::Completed, diverged, refused, Status::Interrupted { step, time }] {
            let record = Record { status, ..record() };
            assert_eq!(Record::from_json(&record.to_json().unwrap()).unwrap(), record);
        }
    }

    /// The digest of a changed record can be recomputed, so it does not protect against U+FFFE, which ends a
    /// report.
    #[test]
    fn a_text_with_a_character_that_nobody_sees_is_refused() {
        let text = record().to_json().unwrap();
        let document = unsealed(&text).unwrap();
        for (escape, number) in [("\\ufffe", "U+FFFE"), ("\u{202e}", "U+202E"), ("\\n", "U+000A")] {
            for (from, to) in [
                ("\"quintic\"", format!("\"quin{escape}tic\"")),
                ("\"dt\"", format!("\"d{escape}t\"")),
            ] {
                let forged = sealed(&document.replacen(from, &to, 1));
                let error = Record::from_json(&forged).expect_err(&to).to_string();
                assert!(error.contains("/numerics") && error.contains(number), "{error}");
            }
        }
    }

    #[test]
    fn nan_is_a_status_and_null_is_refused() {
        let mut record = record();
        record.metrics.insert("l2".into(), Metric::new(f64::NAN, "-", "0/0"));
        let text = record.to_json().unwrap();
        let value: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value["metrics"]["l2"]["value"], json!({"not_finite": "NaN"}));
        assert!(Record::from_json(&text).unwrap().metric("l2").unwrap().is_nan());

        record.numerics.insert("dt".into(), Value::from(f64::NAN)); // what serde_json does
        let error = record.to_json().unwrap_err().to_string();
        assert_eq!(error, "/numerics/dt of the record is null; omit the key or give a value");
        let with_null = changed(&text, "\"quintic\"", "null");
        let error = Record::from_json(&with_null).unwrap_err();
        assert!(matches!(error, RecordError::Null { path } if path == "/numerics/kernel"));
    }

    #[test]
    fn another_schema_and_unknown_keys_are_refused() {
        let text = record().to_json().unwrap();
        let of_schema = |schema: u32| {
            let other = format!("\"schema\": {schema}");
            Record::from_json(&changed(&text, "\"schema\": 3", &other)).unwrap_err().to_string()
        };
        assert_eq!(of_schema(4), "the record has schema 4, but this program reads only schema 3");
        assert_eq!(
            of_schema(2),
            "the record has schema 2 and was made by an older version, but this program reads only schema 3"
        );
        assert!(matches!(Record::from_json("{}"), Err(RecordError::Schema { .. })));
        let error = Record::from_json(&changed(&text, "\"wall_s\"", "\"wall\"")).unwrap_err();
        assert!(error.to_string().contains("unknown field `wall`"), "{error}");
    }

    /// A document with one text replaced by another, and the digest of the result.
    fn changed(text: &str, from: &str, to: &str) -> String {
        sealed(&unsealed(text).unwrap().replace(from, to))
    }

    /// An error of 6e-4 that an editor made 1e-12 passed, and 68 of 300 flipped bits were taken.
    #[test]
    fn no_bit_of_a_record_can_change_unseen() {
        let text = record().to_json().unwrap();
        for place in 0..text.len() {
            for bit in 0..8 {
                let mut bytes = text.clone().into_bytes();
                bytes[place] ^= 1 << bit;
                let Ok(other) = String::from_utf8(bytes) else { continue };
                let read = Record::from_json(&other);
                assert!(read.is_err(), "bit {bit} of byte {place} was flipped unseen: {other}");
            }
        }
        let edited = text.replace("\"kernel\": \"quintic\"", "\"kernel\": \"cubic\"");
        assert!(matches!(Record::from_json(&edited), Err(RecordError::Damaged)));
        for end in [1, 2, 40, 100] {
            assert!(Record::from_json(&text[..text.len() - end]).is_err(), "cut by {end} bytes");
        }
        assert!(matches!(Record::from_json(&text.repeat(2)), Err(RecordError::Unreadable(_))));
    }

    /// The records of this test are small; a digest of their first 4096 bytes passed.
    #[test]
    fn no_digit_of_a_large_record_can_change_unseen() {
        let mut record = record();
        let values: Vec<f64> = (0..20_000).map(|k| 1.0 / f64::from(k + 3)).collect();
        record.profiles.insert("all".into(), Profile::default().with("x", "m", values));
        let text = record.to_json().unwrap();
        for part in 1..=40 {
            let from = text.len() * part / 41;
            let digit = text[from..].find(|c: char| c.is_ascii_digit()).expect("a digit") + from;
            let mut bytes = text.clone().into_bytes();
            bytes[digit] = if bytes[digit] == b'7' { b'8' } else { b'7' };
            let read = Record::from_json(&String::from_utf8(bytes).unwrap());
            assert!(matches!(read, Err(RecordError::Damaged)), "digit {digit} of {}", text.len());
        }
    }

    #[test]
    fn a_name_that_is_a_path_is_refused() {
        let text = record().to_json().unwrap();
        for name in ["x/../../EVIL", "..", "", "a b", "\\u001b[2J"] {
            let path = changed(&text, "\"seed\"", &format!("\"{name}\""));
            let error = Record::from_json(&path).unwrap_err().to_string();
            let is_told =
                ["letters, digits, - and _", "U+001B"].iter().any(|of| error.contains(of));
            assert!(is_told, "{name:?}: {error}");
        }
    }

    #[test]
    fn a_digest_sees_every_bit() {
        let state = [1.0, 2.0, 3.0];
        assert_eq!(digest(&state).len(), 32);
        assert_eq!(digest(&state), digest(&state.clone()));
        for other in [[1.0, 2.0, 3.0000000000000004], [2.0, 1.0, 3.0], [0.0, 2.0, 3.0]] {
            assert_ne!(digest(&state), digest(&other));
        }
        assert_ne!(digest(&[0.0]), digest(&[-0.0]));
        assert_eq!(digest(&[]), "e3b0c44298fc1c149afbf4c8996fb924"); // SHA-256 of nothing
    }

    #[test]
    fn the_key_names_what_was_run_and_not_how_fast() {
        let run = record();
        let slower = Record { cost: Cost::default(), ..run.clone() };
        assert_eq!(run.run.key(), slower.run.key());
        let key = |other: RunSpec| Record { run: other, ..run.clone() }.run.key();
        assert_ne!(run.run.key(), key(run.spec().with_setting("re", 0.6)));
        assert_ne!(run.run.key(), key(RunSpec { variant: "modern".into(), ..run.spec() }));
    }
}
