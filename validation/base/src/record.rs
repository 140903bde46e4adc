//! One run is one JSON document: settings, outcome, metrics, cost, numerics, manifest.
//!
//! The document states its [`SCHEMA`]; a reader refuses any other. Floats keep their bits, and
//! there is no `null` anywhere: a number that is not finite is `{"not_finite": "NaN"}` (see
//! [`number`](crate::number)), a value that does not exist is a key that does not exist.
//!
//! ```
//! use validation::record::{Metric, Record};
//! let mut record = Record::new("couette", "seed", serde_json::json!({"re": 0.5}), 1);
//! let formula = "sqrt(sum (u - u_exact)^2 / sum u_exact^2)";
//! record.metrics.insert("l2".into(), Metric::new(1e-3, "-", formula));
//! let text = record.to_json()?;
//! assert_eq!(Record::from_json(&text)?, record);
//! # Ok::<(), validation::record::RecordError>(())
//! ```

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use crate::manifest::Manifest;
use crate::reference::sha256;

/// Version of the document; raised with every change that an older reader would misread.
pub const SCHEMA: u32 = 1;

/// Why a record was not written or not read.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The text is no record.
    #[error("the record cannot be read: {0}")]
    Unreadable(#[from] serde_json::Error),
    /// The document has another version.
    #[error("the record has schema {found}, this program reads schema {SCHEMA}")]
    Schema {
        /// what the document states
        found: String,
    },
    /// Somewhere there is a `null`, which says neither what is missing nor why.
    #[error("{path} of the record is null; leave it out or say what it is")]
    Null {
        /// keys from the root, as in `/numerics/dt`
        path: String,
    },
}

/// Everything about one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// version of the document
    pub schema: u32,
    /// name of the case
    pub case: String,
    /// name of the variant
    pub variant: String,
    /// settings of the case, all of them
    pub settings: Value,
    /// how the run ended
    pub status: Status,
    /// measured results by name
    pub metrics: BTreeMap<String, Metric>,
    /// what the run took
    pub cost: Cost,
    /// what the run chose: `h/dx`, kernel, integrator, c0, dt; see [`number::json`](crate::number::json)
    pub numerics: BTreeMap<String, Value>,
    /// curves by name
    #[serde(default)]
    pub profiles: BTreeMap<String, Profile>,
    /// digest of the state at the end, see [`digest`]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<String>,
    /// program, compiler, machine
    pub manifest: Manifest,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Status {
    /// to its end
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
        /// the value in words, for it may be NaN
        value_text: String,
    },
    /// before the first step
    Refused {
        /// which setting, its value, what is allowed
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

/// What a run took.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// wall time of the stepping loop in seconds
    #[serde(with = "crate::number")]
    pub wall_s: f64,
    /// processor time of the stepping loop, all threads in seconds
    #[serde(with = "crate::number")]
    pub cpu_s: f64,
    /// time steps
    pub steps: u64,
    /// neighbours visited, those within the skin included, summed over all traversals
    pub pair_interactions: u64,
    /// right-hand sides of one particle
    pub particle_rhs: u64,
    /// particles that move
    pub particles: usize,
    /// threads used
    pub threads: usize,
    /// memory of the solver's arrays in bytes
    pub solver_bytes: u64,
    /// the largest memory that the process held in bytes, where the system tells
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak_rss_bytes: Option<u64>,
}

/// Columns of one length: a profile at one time, or a series in time.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// the columns in order
    pub columns: Vec<Column>,
}

/// One column of a profile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Column {
    /// name
    pub name: String,
    /// SI unit, `-` for none
    pub unit: String,
    /// the numbers
    #[serde(with = "crate::number::list")]
    pub values: Vec<f64>,
}

impl Profile {
    /// Adds a column.
    pub fn with(mut self, name: &str, unit: &str, values: Vec<f64>) -> Self {
        self.columns.push(Column { name: name.into(), unit: unit.into(), values });
        self
    }

    /// The values of a column, none if there is no such column.
    pub fn column(&self, name: &str) -> &[f64] {
        self.columns.iter().find(|c| c.name == name).map_or(&[], |c| &c.values)
    }
}

impl Record {
    /// A record of this process that is yet to be filled: completed, nothing measured.
    pub fn new(case: &str, variant: &str, settings: Value, threads: usize) -> Self {
        Record {
            schema: SCHEMA,
            case: case.into(),
            variant: variant.into(),
            settings,
            status: Status::Completed,
            metrics: BTreeMap::new(),
            cost: Cost { threads, ..Cost::default() },
            numerics: BTreeMap::new(),
            profiles: BTreeMap::new(),
            state: None,
            manifest: Manifest::of_this_process(threads),
        }
    }

    /// A metric's value, `None` if it was not measured.
    pub fn metric(&self, name: &str) -> Option<f64> {
        self.metrics.get(name).map(|metric| metric.value)
    }

    /// A metric's value, NaN if it was not measured.
    pub fn measured(&self, name: &str) -> f64 {
        self.metric(name).unwrap_or(f64::NAN)
    }

    /// A setting as a number, NaN if it is none.
    pub fn setting(&self, name: &str) -> f64 {
        self.settings.get(name).and_then(Value::as_f64).unwrap_or(f64::NAN)
    }

    /// A number that the rules chose, NaN if they chose none.
    pub fn chose(&self, name: &str) -> f64 {
        self.numerics.get(name).and_then(Value::as_f64).unwrap_or(f64::NAN)
    }

    /// The values of a column of a profile, none if there is no such profile or column.
    pub fn column(&self, profile: &str, name: &str) -> &[f64] {
        self.profiles.get(profile).map_or(&[], |profile| profile.column(name))
    }

    /// The document, indented, with a newline at its end.
    pub fn to_json(&self) -> Result<String, RecordError> {
        let value = serde_json::to_value(self)?;
        if let Some(path) = find_null(&value) {
            return Err(RecordError::Null { path });
        }
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Reads a document of this [`SCHEMA`].
    pub fn from_json(text: &str) -> Result<Self, RecordError> {
        let value: Value = serde_json::from_str(text)?;
        match &value["schema"] {
            schema if *schema == SCHEMA => {}
            schema => return Err(RecordError::Schema { found: schema.to_string() }),
        }
        if let Some(path) = find_null(&value) {
            return Err(RecordError::Null { path });
        }
        Ok(serde_json::from_str(text)?) // from the text again: errors then name line and column
    }

    /// 16 hexadecimal digits that name the run: case, variant, settings and commit.
    pub fn key(&self) -> String {
        let Record { case, variant, settings, manifest, .. } = self;
        let identity = serde_json::json!([case, variant, settings, manifest.commit]);
        sha256(identity.to_string().as_bytes())[..16].to_string()
    }
}

/// The path of the first `null`.
fn find_null(value: &Value) -> Option<String> {
    let below = |key: String, child| find_null(child).map(|path| format!("/{key}{path}"));
    match value {
        Value::Null => Some(String::new()),
        Value::Array(items) => {
            items.iter().enumerate().find_map(|(index, item)| below(index.to_string(), item))
        }
        Value::Object(map) => map.iter().find_map(|(key, item)| below(key.clone(), item)),
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
        record.state = Some(digest(&[1.0]));
        record.cost.peak_rss_bytes = Some(1 << 40);
        record
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
        assert_eq!(error, "/numerics/dt of the record is null; leave it out or say what it is");
        let with_null = text.replace("\"quintic\"", "null");
        let error = Record::from_json(&with_null).unwrap_err();
        assert!(matches!(error, RecordError::Null { path } if path == "/numerics/kernel"));
    }

    #[test]
    fn another_schema_and_unknown_keys_are_refused() {
        let text = record().to_json().unwrap();
        let error = Record::from_json(&text.replace("\"schema\": 1", "\"schema\": 2")).unwrap_err();
        assert_eq!(error.to_string(), "the record has schema 2, this program reads schema 1");
        assert!(matches!(Record::from_json("{}"), Err(RecordError::Schema { .. })));
        let error = Record::from_json(&text.replace("\"wall_s\"", "\"wall\"")).unwrap_err();
        assert!(error.to_string().contains("wall"), "{error}");
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
        assert_eq!(run.key(), slower.key());
        assert_ne!(run.key(), Record { settings: json!({"re": 0.6}), ..run.clone() }.key());
        assert_ne!(run.key(), Record { variant: "modern".into(), ..run }.key());
    }
}
