//! The specification of a run as data: everything that determines its result, and how much is measured of it.
//!
//! A [`RunSpec`] has a canonical JSON form, one line with sorted keys, and a [`RunKey`], the first 16
//! hexadecimal digits of the SHA-256 of this line without the measured part. Equal keys mean one run, in any
//! study.
//!
//! ```
//! use touchstone_base::spec::RunSpec;
//! use serde_json::json;
//! let spec = RunSpec::new("couette", "seed", json!({"rows": 20, "re": 0.5}));
//! let line = r#"{"case":"couette","settings":{"re":0.5,"rows":20},"variant":"seed"}"#;
//! assert_eq!(spec.canonical(), line);
//! assert_eq!(serde_json::from_str::<RunSpec>(line).unwrap(), spec);
//! ```

use std::fmt;

use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value};
use thiserror::Error;

use crate::{
    mutation::{Constant, Detect, Disorder, Mutation},
    number::is_default,
    reference::sha256,
    settings::{self, Settings},
    submission::Submission,
    text::short,
};

/// One run with all settings resolved.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunSpec {
    /// name of the case
    #[serde(deserialize_with = "name")]
    pub case: String,
    /// name of the variant
    #[serde(deserialize_with = "name")]
    pub variant: String,
    /// every setting of the case, by name
    #[serde(deserialize_with = "settings")]
    pub settings: Value,
    /// one simulation, or a bisection of many
    #[serde(default, skip_serializing_if = "is_default")]
    pub task: Task,
    /// run even with a time step beyond the theoretical limit
    #[serde(default, skip_serializing_if = "is_default")]
    pub allow_unstable: bool,
    /// data kept in the record in addition to metrics and curves
    #[serde(default, skip_serializing_if = "is_default")]
    pub keep: Keep,
    /// a deliberate error of the scene
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mutation: Option<Mutation>,
    /// a small disorder of the start
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disorder: Option<Disorder>,
    /// the other code that made the run
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub submission: Option<Box<Submission>>,
    /// how much is measured, which is no part of the key
    #[serde(default, skip_serializing_if = "is_default")]
    pub measure: Measure,
}

/// Longest name of a case or of a variant.
const LONGEST_NAME: usize = 64;

/// Reads the name of a case or of a variant: it becomes a part of names of files, so it must not be a path.
///
/// # Errors
/// If it is empty, too long, or has other characters than letters, digits, `-` and `_`.
pub(crate) fn name<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    let name = String::deserialize(from)?;
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_".contains(&byte);
    match (1..=LONGEST_NAME).contains(&name.len()) && name.bytes().all(is_plain) {
        true => Ok(name),
        false => Err(D::Error::custom(format!(
            "{:?} is not a valid case or variant name: 1 to {LONGEST_NAME} letters, digits, - and _",
            name.chars().take(LONGEST_NAME).collect::<String>()
        ))),
    }
}

/// Reads settings by name, each given once: a second value would silently replace the first.
///
/// # Errors
/// If they are not an object, or one is given twice.
fn settings<'de, D: Deserializer<'de>>(from: D) -> Result<Value, D::Error> {
    struct Once;
    impl<'de> Visitor<'de> for Once {
        type Value = Value;
        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("an object of settings by name")
        }
        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Value, A::Error> {
            let mut settings = Map::new();
            while let Some((name, value)) = map.next_entry::<String, Value>()? {
                if let Some(before) = settings.insert(name.clone(), value) {
                    let words =
                        format!("setting {name} is given twice, the first time as {before}");
                    return Err(A::Error::custom(words));
                }
            }
            Ok(Value::Object(settings))
        }
    }
    from.deserialize_map(Once)
}

/// A field of a spec that has a value which no run can have.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{field} is {value}; allowed is {allowed}")]
pub struct SpecError {
    /// keys from the root, as in `task.bisect.resolution`
    pub field: &'static str,
    /// its value
    pub value: String,
    /// the allowed values
    pub allowed: &'static str,
}

/// Metrics to measure. They do not change the run, and a record with more metrics than requested serves as
/// well.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// metrics of little cost compared with the stepping
    #[default]
    Headline,
    /// also metrics with pair sweeps of their own, such as the work of each term
    All,
}

/// The use of the settings.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Task {
    /// one simulation to its end
    #[default]
    Simulate,
    /// the largest value of one setting with which the simulation is stable
    Bisect(Bisect),
    /// the smallest deliberate error of the scene that the gates of the simulation detect
    Detect(Detect),
}

/// How the largest stable value of a setting is found: value = x · `unit`, x bisected from `guess` down to
/// a bracket of `resolution` · `guess`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bisect {
    /// name of the setting
    pub setting: String,
    /// first x \[-\]
    pub guess: f64,
    /// value of the setting at x = 1, in the unit of the setting
    pub unit: f64,
    /// width of the last bracket over the guess \[-\]
    pub resolution: f64,
    /// the simulation ends after `steps` time steps of the bisected size, `end` = `steps` · value / `unit` of
    /// time, where this is given
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<EndAfter>,
}

/// The end of a run in time steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndAfter {
    /// time steps
    pub steps: f64,
    /// unit of the setting `end` \[s\]
    pub unit: f64,
}

/// Data that a record keeps in addition to metrics and curves.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Keep {
    /// the particles at the end, as the curve `particles`
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub particles: bool,
}

/// Names a run: 16 hexadecimal digits.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RunKey(String);

impl fmt::Display for RunKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl RunSpec {
    /// One simulation that keeps metrics and curves.
    pub fn new(case: &str, variant: &str, settings: Value) -> Self {
        Self { case: case.to_string(), variant: variant.to_string(), settings, ..Self::default() }
    }

    /// The settings as their type; defaults if they belong to another case, which does not happen to a caller
    /// with a run of its own case.
    pub fn settings_as<T: Settings>(&self) -> T {
        settings::of_json(&self.settings).unwrap_or_default()
    }

    /// Is it one simulation, and no search by many?
    pub fn is_simulation(&self) -> bool {
        self.task == Task::Simulate
    }

    /// The simulation with these settings, of a search one of many.
    #[must_use]
    pub fn simulation(&self) -> Self {
        Self { task: Task::Simulate, ..self.clone() }
    }

    /// This run with any time step.
    pub fn allow_unstable(self) -> Self {
        Self { allow_unstable: true, ..self }
    }

    /// This run with its final particles in the record.
    pub fn keep_particles(mut self) -> Self {
        self.keep.particles = true;
        self
    }

    /// The largest stable value of a setting in place of one simulation.
    pub fn bisect(self, bisect: Bisect) -> Self {
        Self { task: Task::Bisect(bisect), ..self }
    }

    /// The smallest error that the gates of this run detect, in place of one simulation.
    pub fn detect(self, detect: Detect) -> Self {
        Self { task: Task::Detect(detect), ..self }
    }

    /// This run with a deliberate error of the scene.
    pub fn mutated(self, mutation: Mutation) -> Self {
        Self { mutation: Some(mutation), ..self }
    }

    /// This run with particles displaced from their initial positions.
    pub fn disordered(self, disorder: Disorder) -> Self {
        Self { disorder: Some(disorder), ..self }
    }

    /// This run with all metrics.
    pub fn measure_all(self) -> Self {
        Self { measure: Measure::All, ..self }
    }

    /// This run with one setting changed, by name; the name must exist.
    pub fn with_setting(mut self, name: &str, value: impl Into<Value>) -> Self {
        if let Some(settings) = self.settings.as_object_mut() {
            settings.insert(name.to_string(), value.into());
        }
        self
    }

    /// The document that serde reads back.
    pub fn to_value(&self) -> Value {
        // By way of the text, as records are written: a second serialiser of all types would be compiled.
        let text = serde_json::to_string_pretty(self).unwrap_or_default();
        serde_json::from_str(&text).unwrap_or_default()
    }

    /// One line of JSON with sorted keys, which serde reads back: equal lines are equal runs.
    pub fn canonical(&self) -> String {
        self.to_value().to_string() // objects of `serde_json::Value` are sorted by key
    }

    /// Checks the parts of a document that no case checks: all but names and settings.
    ///
    /// # Errors
    /// The first field that is outside of its range.
    pub fn check(&self) -> Result<(), SpecError> {
        let within = |field, value: f64, range: std::ops::RangeInclusive<f64>, allowed| {
            let refused = || SpecError { field, value: format!("{value:?}"), allowed };
            range.contains(&value).then_some(()).ok_or_else(refused)
        };
        if let Some(of) = &self.submission {
            let allowed = "none: only `touchstone submit` records runs of other codes";
            return Err(SpecError { field: "submission", value: short(&of.to_string()), allowed });
        }
        if let Some(mutation) = self.mutation {
            // Studies omit a term, reverse its sign, and search for the smallest visible error.
            let (range, allowed) = match mutation.of {
                Constant::TimeStep => (0.1..=10.0, "0.1 to 10"),
                _ => (-1000.0..=1000.0, "-1000 to 1000"),
            };
            within("mutation.factor", mutation.factor, range, allowed)?;
        }
        if let Some(Disorder { most, .. }) = self.disorder {
            within("disorder.most", most, 0.0..=0.5, "0 to 0.5")?;
        }
        let Task::Bisect(Bisect { guess, unit, resolution, end, .. }) = self.task else {
            return Ok(());
        };
        let positive = 1e-300..=1e300;
        let allowed = "1e-300 to 1e300";
        within("task.bisect.guess", guess, positive.clone(), allowed)?;
        within("task.bisect.unit", unit, positive.clone(), allowed)?;
        within("task.bisect.resolution", resolution, 1e-6..=1.0, "1e-6 to 1")?;
        if let Some(EndAfter { steps, unit }) = end {
            within("task.bisect.end.steps", steps, 1.0..=1e10, "1 to 1e10")?;
            within("task.bisect.end.unit", unit, positive, allowed)?;
        }
        Ok(())
    }

    /// The name of the run.
    pub fn key(&self) -> RunKey {
        let run = Self { measure: Measure::default(), ..self.clone() };
        RunKey(sha256(run.canonical().as_bytes())[..16].to_string())
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::mutation::Constant;

    #[test]
    fn whatever_decides_the_result_changes_the_key() {
        let spec = RunSpec::new("couette", "seed", json!({"rows": 20}));
        let bisect =
            Bisect { setting: "dt".into(), guess: 1.0, unit: 0.1, resolution: 0.01, end: None };
        let others = [
            RunSpec { case: "poiseuille".into(), ..spec.clone() },
            RunSpec { variant: "plain".into(), ..spec.clone() },
            spec.clone().with_setting("rows", 40),
            spec.clone().allow_unstable(),
            spec.clone().keep_particles(),
            spec.clone().bisect(bisect),
            spec.clone().detect(Detect { of: Constant::Xsph, only_allowed: false }),
            spec.clone().detect(Detect { of: Constant::Xsph, only_allowed: true }),
            spec.clone().mutated(Mutation { of: Constant::Xsph, factor: 1.03 }),
            spec.clone().disordered(Disorder { most: 1e-6, seed: 1 }),
            spec.clone().disordered(Disorder { most: 1e-6, seed: 2 }),
            spec.clone().disordered(Disorder { most: 2e-6, seed: 1 }),
        ];
        let keys: std::collections::BTreeSet<_> = others.iter().map(RunSpec::key).collect();
        assert_eq!(keys.len(), others.len());
        assert!(!keys.contains(&spec.key()));
        for spec in others {
            assert_eq!(serde_json::from_str::<RunSpec>(&spec.canonical()).unwrap(), spec);
        }
    }

    #[test]
    fn what_is_measured_is_written_and_is_no_part_of_the_key() {
        let spec = RunSpec::new("dam_break", "modern", json!({"n": 20}));
        let all = spec.clone().measure_all();
        assert_eq!(all.key(), spec.key());
        assert!(all.canonical().contains(r#""measure":"all""#), "{}", all.canonical());
        assert_eq!(serde_json::from_str::<RunSpec>(&all.canonical()).unwrap(), all);
        assert!(spec.measure < all.measure);
    }

    /// A resolution of 0 never ended.
    #[test]
    fn a_field_that_no_run_can_have_is_refused_with_its_range() {
        let spec = |rest: &str| {
            let line = format!(r#"{{"case":"c","variant":"v","settings":{{}},{rest}}}"#);
            serde_json::from_str::<RunSpec>(&line)
                .map_err(|e| e.to_string())?
                .check()
                .map_err(|e| e.to_string())
        };
        let bisect = |rest: &str| {
            let defaults = [("guess", "1"), ("unit", "1"), ("resolution", "0.01")];
            let given = |name: &str| rest.starts_with(&format!(",\"{name}\":"));
            let others = defaults.iter().filter(|(name, _)| !given(name));
            let others: String =
                others.map(|(name, value)| format!(r#","{name}":{value}"#)).collect();
            spec(&format!(r#""task":{{"bisect":{{"setting":"dt"{others}{rest}}}}}"#))
        };
        assert_eq!(bisect(""), Ok(()));
        let refused = [
            (
                spec(r#""mutation":{"of":"xsph","factor":-1001}"#),
                "mutation.factor is -1001.0; allowed is -1000 to 1000",
            ),
            (
                spec(r#""mutation":{"of":"time_step","factor":-1}"#),
                "mutation.factor is -1.0; allowed is 0.1 to 10",
            ),
            (
                spec(r#""disorder":{"most":0.6,"seed":1}"#),
                "disorder.most is 0.6; allowed is 0 to 0.5",
            ),
            (bisect(r#","resolution":0"#), "task.bisect.resolution is 0.0; allowed is 1e-6 to 1"),
            (bisect(r#","resolution":-1"#), "task.bisect.resolution is -1.0"),
            (bisect(r#","guess":0"#), "task.bisect.guess is 0.0"),
            (bisect(r#","unit":-2"#), "task.bisect.unit is -2.0"),
            (bisect(r#","end":{"steps":0,"unit":1}"#), "task.bisect.end.steps is 0.0"),
            (bisect(r#","end":{"steps":9,"unit":0}"#), "task.bisect.end.unit is 0.0"),
        ];
        for (found, expected) in refused {
            let error = found.expect_err(expected);
            assert!(error.starts_with(expected), "expected {expected}, found {error}");
        }
    }

    /// The last of several values was used, and the others were lost in silence.
    #[test]
    fn a_setting_that_is_given_twice_is_refused() {
        let read = |settings: &str| {
            let line = format!(r#"{{"case":"c","variant":"v","settings":{settings}}}"#);
            serde_json::from_str::<RunSpec>(&line).map_err(|error| error.to_string())
        };
        let twice = read(r#"{"rows":8,"re":1,"rows":10}"#).unwrap_err();
        assert!(twice.starts_with("setting rows is given twice, the first time as 8"), "{twice}");
        assert!(read("null").unwrap_err().contains("expected an object of settings by name"));
        assert_eq!(read(r#"{"rows":8}"#).unwrap().settings, json!({"rows": 8}));
    }

    #[test]
    fn the_order_in_which_settings_were_written_does_not_matter() {
        let read = |text| serde_json::from_str::<RunSpec>(text).unwrap().key();
        assert_eq!(
            read(r#"{"case":"c","variant":"v","settings":{"a":1,"b":0.1}}"#),
            read(r#"{"settings":{"b":0.1,"a":1},"variant":"v","case":"c"}"#)
        );
    }
}
