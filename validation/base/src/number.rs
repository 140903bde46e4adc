//! Floats in JSON without loss: a finite number is a JSON number, any other value names itself.
//!
//! JSON has no NaN and no infinity, and `serde_json` writes both as `null`, which a reader would take for
//! "not measured". Here they are written as objects with one key and read back without change:
//! `{"not_finite": "NaN"}`, `{"not_finite": "inf"}`, `{"not_finite": "-inf"}`. `null` itself is refused. Use
//! `#[serde(with = "crate::number")]` on an `f64` field, `crate::number::option` on an `Option<f64>`, and
//! `crate::number::list` on a `Vec<f64>`.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Whether a field is left out of a document.
pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// An `f64` whose JSON form is never `null`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Form", into = "Form")]
pub struct Number(pub f64);

/// The JSON form of a number.
#[derive(Serialize, Deserialize)]
#[serde(untagged, deny_unknown_fields)]
#[serde(expecting = r#"expected a number or {"not_finite": "NaN" | "inf" | "-inf"}"#)]
enum Form {
    Finite(f64),
    Other { not_finite: String },
}

impl From<Number> for Form {
    fn from(Number(value): Number) -> Self {
        match value.is_finite() {
            true => Self::Finite(value),
            false => Self::Other { not_finite: value.to_string() },
        }
    }
}

impl TryFrom<Form> for Number {
    type Error = String;
    fn try_from(form: Form) -> Result<Self, String> {
        match form {
            Form::Finite(value) => Ok(Self(value)),
            Form::Other { not_finite } => match not_finite.as_str() {
                "NaN" => Ok(Self(f64::NAN)),
                "inf" => Ok(Self(f64::INFINITY)),
                "-inf" => Ok(Self(f64::NEG_INFINITY)),
                other => Err(format!("not_finite is {other:?}; allowed are NaN, inf and -inf")),
            },
        }
    }
}

/// The number as a JSON value, for maps of values: `Value::from(f64::NAN)` would be `null`.
pub fn json(value: f64) -> serde_json::Value {
    serde_json::to_value(Number(value)).unwrap_or_default()
}

/// For `#[serde(with = …)]` on an `f64`.
pub fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    Number(*value).serialize(serializer)
}

/// For `#[serde(with = …)]` on an `f64`.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Number::deserialize(deserializer).map(|number| number.0)
}

/// The form of an `Option<f64>`.
pub mod option {
    use super::{Deserialize, Deserializer, Number, Serialize, Serializer};

    /// Writes the number, or `null`.
    pub fn serialize<S: Serializer>(value: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
        value.map(Number).serialize(to)
    }

    /// Reads a number or `null`.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
        Ok(Option::<Number>::deserialize(from)?.map(|number| number.0))
    }
}

/// The form of a `Vec<f64>`.
pub mod list {
    use super::{Deserialize, Deserializer, Number, Serializer};

    /// Writes every number.
    pub fn serialize<S: Serializer>(values: &[f64], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(values.iter().copied().map(Number))
    }

    /// Reads every number.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
        let numbers = Vec::<Number>::deserialize(from)?;
        Ok(numbers.into_iter().map(|number| number.0).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_float_keeps_its_bits() {
        let values = [0.0, -0.0, 1.0, 5e-324, 1.7976931348623157e308, 0.1 + 0.2, -3.2e-7];
        for value in values.into_iter().chain([f64::INFINITY, f64::NEG_INFINITY]) {
            let text = serde_json::to_string(&Number(value)).unwrap();
            let back: Number = serde_json::from_str(&text).unwrap();
            assert_eq!(back.0.to_bits(), value.to_bits(), "{text}");
        }
        let text = serde_json::to_string(&Number(f64::NAN)).unwrap();
        assert_eq!(text, r#"{"not_finite":"NaN"}"#);
        assert!(serde_json::from_str::<Number>(&text).unwrap().0.is_nan());
    }

    #[test]
    fn null_and_strangers_are_refused() {
        for text in ["null", r#""NaN""#, r#"{"not_finite":null}"#, r#"{"not_finite":"nan"}"#, "[1]"]
        {
            assert!(serde_json::from_str::<Number>(text).is_err(), "{text}");
        }
        assert!(!json(f64::NAN).is_null());
    }
}
