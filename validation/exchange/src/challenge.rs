//! Sealed problems: settings drawn from a seed and from the description of the method, so that tuning a
//! method for the public problems becomes visible.

use serde_json::{Map, Value, json};
use touchstone_base::{random::Random, reference::sha256, spec::RunSpec};
use touchstone_harness::{case::Case, gates::GateIndex, sealed};

use crate::{
    problem::Sealed,
    submission::{METHOD, Method},
};

impl Method {
    /// SHA-256 of code, version, scheme, division and settings, independent of their order and white space.
    /// The prose of `changed` is excluded.
    pub fn digest(&self) -> String {
        let Self { code, version, scheme, division, settings, .. } = self;
        let settings: Map<String, Value> =
            settings.iter().map(|(name, value)| (name.clone(), usual(value))).collect();
        sha256(json!([code, version, scheme, division, settings]).to_string().as_bytes())
    }

    /// The digest without prose: letters and digits of names, numbers and truth values of settings. Otherwise
    /// a change of words would draw other problems, until one fits.
    fn digest_without_prose(&self) -> String {
        let Self { code, version, scheme, division, settings, .. } = self;
        let plain = |text: &String| -> String {
            text.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
        };
        let [code, version, scheme] = [code, version, scheme].map(plain);
        let mut numbers = Vec::new();
        settings.values().for_each(|value| add_numbers(value, &mut numbers));
        sha256(json!([code, version, scheme, division, numbers]).to_string().as_bytes())
    }
}

/// Adds the numbers and truth values of a value, in the order of names.
fn add_numbers(value: &Value, all: &mut Vec<Value>) {
    match value {
        Value::Number(_) | Value::Bool(_) => all.push(usual(value)),
        Value::Array(of) => of.iter().for_each(|value| add_numbers(value, all)),
        Value::Object(of) => of.values().for_each(|value| add_numbers(value, all)),
        Value::Null | Value::String(_) => {}
    }
}

/// A value by which equal numbers are written alike, such as 1 and 1.0.
fn usual(value: &Value) -> Value {
    match value {
        Value::Number(number) => number.as_f64().map_or_else(|| value.clone(), Value::from),
        Value::Array(all) => all.iter().map(usual).collect(),
        Value::Object(all) => all
            .iter()
            .map(|(name, value)| (name.clone(), usual(value)))
            .collect::<Map<_, _>>()
            .into(),
        other => other.clone(),
    }
}

/// Is the problem of a submission the one that its seed and its method give?
///
/// # Errors
/// The changed items.
pub fn check(
    case: &dyn Case,
    sealed: &Sealed,
    method: &Method,
    spec: &RunSpec,
) -> Result<(), String> {
    if sealed.method != method.digest() {
        return Err(format!(
            "{METHOD}: the SHA-256 of its code, version, scheme, division and settings is {}; the problem \
             was sealed for {}, so the method was changed afterwards",
            method.digest(),
            sealed.method
        ));
    }
    let drawn = draw(case, &spec.variant, sealed.seed, method)?;
    let settings = case.settings(&spec.variant, &drawn).map_err(|error| error.to_string())?;
    match settings == spec.settings {
        true => Ok(()),
        false => {
            Err("problem.json is not the one that its seed and method give: settings differ".into())
        }
    }
}

/// `key=value` of the settings of a sealed problem.
///
/// # Errors
/// If no bound is known for problems that the case or the variant could draw.
pub fn draw(
    case: &dyn Case,
    variant: &str,
    seed: u64,
    method: &Method,
) -> Result<Vec<String>, String> {
    let text = format!("{} {variant} {seed} {}", case.name(), method.digest_without_prose());
    let digest = sha256(text.as_bytes());
    let start = u64::from_str_radix(&digest[..16], 16).unwrap_or(seed);
    sealed::draw(&GateIndex::of(case), variant, &mut Random::new(start))
}
