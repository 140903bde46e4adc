//! The specification of a run as data: everything that determines its result, and how much is measured of it.
//!
//! A [`RunSpec`] has a canonical JSON form, one line with sorted keys, and a [`RunKey`], the first 16
//! hexadecimal digits of the SHA-256 of that line without what is measured. Equal keys mean the same run,
//! whichever study planned it.
//!
//! ```
//! use base::spec::RunSpec;
//! use serde_json::json;
//! let spec = RunSpec::new("couette", "seed", json!({"rows": 20, "re": 0.5}));
//! let line = r#"{"case":"couette","settings":{"re":0.5,"rows":20},"variant":"seed"}"#;
//! assert_eq!(spec.canonical(), line);
//! assert_eq!(RunSpec::from_canonical(line).unwrap(), spec);
//! ```

use std::fmt;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::{
    mutation::{Detect, Mutation},
    reference::sha256,
};

/// One run, resolved: no default is left to be filled in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunSpec {
    /// name of the case
    pub case: String,
    /// name of the variant
    pub variant: String,
    /// every setting of the case, by name
    pub settings: Value,
    /// one simulation, or a bisection of many
    #[serde(default, skip_serializing_if = "Task::is_simulation")]
    pub task: Task,
    /// run even with a time step beyond the theoretical limit
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub allow_unstable: bool,
    /// what the record keeps beside metrics and curves
    #[serde(default, skip_serializing_if = "Keep::is_nothing")]
    pub keep: Keep,
    /// a deliberate error of the scene
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mutation: Option<Mutation>,
    /// how much is measured, which is no part of the key
    #[serde(default, skip_serializing_if = "Measure::is_headline")]
    pub measure: Measure,
}

/// How much is measured of a run. What is measured does not change the run, and a record of which more was
/// measured than is asked for serves as well.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// what costs little beside the stepping
    #[default]
    Headline,
    /// also what takes pair sweeps of its own, such as the work of each term
    All,
}

impl Measure {
    fn is_headline(&self) -> bool {
        *self == Measure::Headline
    }
}

/// What is done with the settings.
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

impl Task {
    fn is_simulation(&self) -> bool {
        *self == Task::Simulate
    }
}

/// What a record keeps beside metrics and curves.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Keep {
    /// the particles at the end, as the curve `particles`
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub particles: bool,
    /// so many pictures at equal intervals from the start, in place of those that the case chooses
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pictures: Option<usize>,
}

impl Keep {
    fn is_nothing(&self) -> bool {
        *self == Keep::default()
    }
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
        let (case, variant) = (case.to_string(), variant.to_string());
        let (task, keep, measure) = (Task::Simulate, Keep::default(), Measure::default());
        Self { case, variant, settings, task, allow_unstable: false, keep, mutation: None, measure }
    }

    /// The same, whatever its time step.
    pub fn allow_unstable(self) -> Self {
        Self { allow_unstable: true, ..self }
    }

    /// The same, with the particles of the end in its record.
    pub fn keep_particles(mut self) -> Self {
        self.keep.particles = true;
        self
    }

    /// The same, with so many pictures at equal intervals from the start.
    pub fn keep_pictures(mut self, count: usize) -> Self {
        self.keep.pictures = Some(count);
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

    /// The same with a deliberate error of the scene.
    pub fn mutated(self, mutation: Mutation) -> Self {
        Self { mutation: Some(mutation), ..self }
    }

    /// The same, of which all is measured.
    pub fn measure_all(self) -> Self {
        Self { measure: Measure::All, ..self }
    }

    /// The same with one setting changed, by name; the caller knows that there is one.
    pub fn with_setting(mut self, name: &str, value: impl Into<Value>) -> Self {
        if let Some(settings) = self.settings.as_object_mut() {
            settings.insert(name.to_string(), value.into());
        }
        self
    }

    /// One line of JSON with sorted keys: equal lines are equal runs.
    pub fn canonical(&self) -> String {
        // Objects of `serde_json::Value` are sorted by key.
        serde_json::to_value(self).unwrap_or_default().to_string()
    }

    /// Reads what [`RunSpec::canonical`] wrote, or any JSON document of the same form.
    ///
    /// # Errors
    /// If the text is no such document.
    pub fn from_canonical(text: &str) -> Result<Self, serde_json::Error> {
        serde_json::from_str(text)
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
            spec.clone().keep_pictures(3),
            spec.clone().bisect(bisect),
            spec.clone().detect(Detect { of: Constant::Xsph, only_allowed: false }),
            spec.clone().detect(Detect { of: Constant::Xsph, only_allowed: true }),
            spec.clone().mutated(Mutation { of: Constant::Xsph, factor: 1.03 }),
        ];
        let keys: std::collections::BTreeSet<_> = others.iter().map(RunSpec::key).collect();
        assert_eq!(keys.len(), others.len());
        assert!(!keys.contains(&spec.key()));
        for spec in others {
            assert_eq!(RunSpec::from_canonical(&spec.canonical()).unwrap(), spec);
        }
    }

    #[test]
    fn what_is_measured_is_written_and_is_no_part_of_the_key() {
        let spec = RunSpec::new("dam_break", "modern", json!({"n": 20}));
        let all = spec.clone().measure_all();
        assert_eq!(all.key(), spec.key());
        assert!(all.canonical().contains(r#""measure":"all""#), "{}", all.canonical());
        assert_eq!(RunSpec::from_canonical(&all.canonical()).unwrap(), all);
        assert!(spec.measure < all.measure);
    }

    #[test]
    fn the_order_in_which_settings_were_written_does_not_matter() {
        let read = |text| RunSpec::from_canonical(text).unwrap().key();
        assert_eq!(
            read(r#"{"case":"c","variant":"v","settings":{"a":1,"b":0.1}}"#),
            read(r#"{"settings":{"b":0.1,"a":1},"variant":"v","case":"c"}"#)
        );
    }
}
