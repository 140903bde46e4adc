//! Sealed problems: settings that are drawn from a seed and from the digest of the method as it is before the
//! seed is known, so that a method which was tuned for the problems that everybody knows shows it.

use base::{
    random::Random,
    reference::sha256,
    settings::{Field, Kind},
};
use harness::case::{Case, RunError};
use serde_json::Value;

use crate::problem::Sealed;

/// The settings that are drawn, where a case has them: name, and the least and the largest factor of the
/// default of the variant; of a setting whose default is 0, the ends of its range.
const DRAWN: [(&str, f64, f64); 8] = [
    ("re", 0.2, 5.0),
    ("rows", 0.6, 2.0),
    ("n", 0.6, 2.0),
    ("spacing", 0.6, 1.6),
    ("speed", 0.4, 1.6),
    ("angle", 0.0, 90.0),
    ("perturb", 0.0, 0.2),
    ("seed", 1.0, 1000.0),
];

/// `key=value` of the settings of a sealed problem.
///
/// # Errors
/// If the case has no such variant.
pub fn draw(case: &dyn Case, variant: &str, sealed: &Sealed) -> Result<Vec<String>, RunError> {
    let digest = sha256(format!("{} {} {}", case.name(), sealed.seed, sealed.method).as_bytes());
    let seed = u64::from_str_radix(&digest[..16], 16).unwrap_or(sealed.seed);
    let mut random = Random::new(seed);
    let defaults = case.settings(variant, &[])?;
    let mut drawn = Vec::new();
    for (name, least, most) in DRAWN {
        let share = random.uniform();
        let Some(field) = case.fields().iter().find(|field| field.name == name) else { continue };
        let Some(default) = defaults.get(name).and_then(Value::as_f64) else { continue };
        let set = format!("{name}={}", value(field, default, [least, most], share));
        // A setting that the variant does not read, or a value that it does not allow, is left as it is.
        let with = [drawn.as_slice(), std::slice::from_ref(&set)].concat();
        if case.settings(variant, &with).is_ok() {
            drawn = with;
        }
    }
    Ok(drawn)
}

/// Between the two factors of the default, evenly in the logarithm; three digits are enough.
fn value(field: &Field, default: f64, [least, most]: [f64; 2], share: f64) -> String {
    let value = match default == 0.0 || field.name == "seed" {
        true => least + share * (most - least),
        false => default * least * base::functions::exp(share * base::functions::ln(most / least)),
    };
    match field.kind {
        Kind::Count => value.round().to_string(),
        _ => format!("{value:.2e}").parse().unwrap_or(value).to_string(),
    }
}
