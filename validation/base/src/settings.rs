//! Settings of a case: named, documented numbers with a unit, an allowed range and a default.
//!
//! [`settings!`](crate::settings!) declares the struct once; the command line
//! (`--set key=value`), the JSON record, the listing and the report's table are derived from it.
//! Neither text nor JSON input can give a struct a value outside its range.
//!
//! ```
//! use base::settings::{self, Settings};
//!
//! base::settings! {
//!     /// A channel between two plates.
//!     pub struct Channel {
//!         /// Reynolds number V L / nu
//!         re: f64 ["-"] in 1e-9..=1e6 = 0.5,
//!         /// rows of particles between the plates
//!         rows: usize ["-"] in 4..=2000 = 20,
//!         /// speed of sound, by Morris' rule unless given
//!         c0: Option<f64> ["m/s"] in 1e-9..=1e5 = None,
//!         /// write every step
//!         verbose: bool = false,
//!     }
//! }
//!
//! let mut channel = Channel::default();
//! settings::apply(&mut channel, &["re=1e-3", "rows=40", "c0=auto"]).unwrap();
//! assert_eq!((channel.re, channel.rows, channel.c0), (1e-3, 40, None));
//! assert!(channel.set("rows", "3").is_err());
//! ```

use std::collections::BTreeMap;
use std::fmt;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use thiserror::Error;

/// What kind of value a setting takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// a real number
    Real,
    /// a real number, or `auto` for "by rule"
    RealOrAuto,
    /// a whole number that is not negative
    Count,
    /// `true` or `false`
    Flag,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Kind::Real => "a number",
            Kind::RealOrAuto => "a number or auto",
            Kind::Count => "a whole number",
            Kind::Flag => "a flag",
        })
    }
}

/// The value of one setting, without its type.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// a flag
    Flag(bool),
    /// a whole number
    Count(u64),
    /// a real number
    Real(f64),
    /// by rule; in JSON and on the command line the word `auto`
    Auto(Auto),
}

/// The word `auto`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Auto {
    /// by rule
    Auto,
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Flag(flag) => write!(f, "{flag}"),
            Value::Count(count) => write!(f, "{count}"),
            Value::Real(real) => write!(f, "{real:?}"), // the shortest text that reads back equal
            Value::Auto(_) => f.write_str("auto"),
        }
    }
}

/// What is known about a setting without an instance.
#[derive(Debug, Clone, Copy)]
pub struct Field {
    /// the key of `--set key=value`
    pub name: &'static str,
    /// SI unit, `-` for none
    pub unit: &'static str,
    /// what it is, one line
    pub doc: &'static str,
    /// what it takes
    pub kind: Kind,
    /// allowed range in words
    pub range: &'static str,
    /// the value unless it is set
    pub default: fn() -> Value,
}

/// Why a setting was refused: in words that name it, its value, and what is allowed.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{0}")]
pub struct SettingError(String);

/// " (did you mean NAME?)" with the name most similar to what was written, or nothing if none is similar.
pub fn hint(names: &[&str], written: &str) -> String {
    let distance = |name: &&&str| edit_distance(name, written);
    let is_close = |name: &&&str| distance(name) <= 1 + name.len() / 3;
    let nearest = names.iter().filter(is_close).min_by_key(distance);
    nearest.map(|name| format!(" (did you mean {name}?)")).unwrap_or_default()
}

/// A settings struct; implemented by [`settings!`](crate::settings!).
pub trait Settings:
    Clone + Default + PartialEq + fmt::Debug + Serialize + for<'de> Deserialize<'de>
{
    /// All settings in the order of declaration.
    const FIELDS: &'static [Field];

    /// The path of the module that declares them, which begins with the name of its crate.
    const MODULE: &'static str;

    /// Every setting with its value, for tables.
    fn entries(&self) -> Vec<(&'static Field, Value)>;

    /// Sets one setting from text; on error nothing changes.
    fn set(&mut self, key: &str, text: &str) -> Result<(), SettingError>;

    /// The value of a setting, `None` if there is no such setting.
    fn get(&self, key: &str) -> Option<Value> {
        self.entries().into_iter().find(|(field, _)| field.name == key).map(|(_, value)| value)
    }

    /// Checks every range again, for a struct whose public fields were written directly.
    fn validate(&self) -> Result<(), SettingError> {
        let mut copy = self.clone();
        let mut entries = self.entries().into_iter();
        entries.try_for_each(|(field, value)| copy.set(field.name, &value.to_string()))
    }
}

/// Applies assignments `key=value`, one for a key; on error nothing changes.
pub fn apply<S: Settings>(
    settings: &mut S,
    assignments: &[impl AsRef<str>],
) -> Result<(), SettingError> {
    let mut changed = settings.clone();
    let mut given: Vec<(&str, &str)> = Vec::new();
    for assignment in assignments {
        let text = assignment.as_ref();
        let Some((key, value)) = text.split_once('=') else {
            return Err(SettingError(format!("{text:?} is not of the form key=value")));
        };
        let (key, value) = (key.trim(), value.trim());
        changed.set(key, value)?;
        if let Some((_, first)) = given.iter().find(|(other, _)| *other == key) {
            let twice = format!("setting {key} is given twice, as {first:?} and as {value:?}");
            return Err(SettingError(format!("{twice}; give one of them")));
        }
        given.push((key, value));
    }
    *settings = changed;
    Ok(())
}

/// The error for a key that is not among the fields.
pub fn unknown(fields: &'static [Field], key: &str) -> SettingError {
    let keys: Vec<_> = fields.iter().map(|field| field.name).collect();
    let (hint, keys) = (hint(&keys, key), keys.join(", "));
    SettingError(format!("no setting is called {key:?}{hint}; the settings are {keys}"))
}

/// All names, the most similar to what was written first: those that contain it, then those that differ from
/// it by the fewest letters.
pub fn by_similarity<'a>(names: &[&'a str], written: &str) -> Vec<&'a str> {
    let mut sorted = names.to_vec();
    sorted.sort_by_cached_key(|name| (!name.contains(written), edit_distance(name, written)));
    sorted
}

/// Insertions, deletions and replacements between a name and what was written, however long that is.
fn edit_distance(name: &str, written: &str) -> usize {
    strsim::levenshtein(name, &written.chars().take(100).collect::<String>())
}

/// A type that a setting may have.
///
/// A value that is compared with the limits of the range converts to what they are.
pub trait SettingType: Copy + Into<Option<Self::Limit>> {
    /// What the limits of the range are.
    type Limit: PartialOrd;

    /// The kind that errors and listings name.
    const KIND: Kind;

    /// Reads the text; knows nothing of the range.
    fn read(text: &str) -> Option<Self>;

    /// The value without its type.
    fn value(self) -> Value;
}

/// Reads a value. One that is not finite, or outside of the range, is refused.
pub fn read<T: SettingType>(
    text: &str,
    range: Option<std::ops::RangeInclusive<T::Limit>>,
    Field { name, kind, range: words, .. }: &Field,
) -> Result<T, SettingError> {
    let is_allowed = |value: &T| {
        let limited: Option<T::Limit> = (*value).into();
        limited.zip(range).is_none_or(|(number, range)| range.contains(&number))
    };
    let refused =
        || SettingError(format!("setting {name} is {text:?}; allowed is {kind}, {words}"));
    T::read(text).filter(is_allowed).ok_or_else(refused)
}

impl SettingType for f64 {
    type Limit = f64;
    const KIND: Kind = Kind::Real;

    fn read(text: &str) -> Option<Self> {
        text.parse().ok()
    }

    fn value(self) -> Value {
        Value::Real(self)
    }
}

impl SettingType for Option<f64> {
    type Limit = f64;
    const KIND: Kind = Kind::RealOrAuto;

    fn read(text: &str) -> Option<Self> {
        if text == "auto" { Some(None) } else { f64::read(text).map(Some) }
    }

    fn value(self) -> Value {
        self.map_or(Value::Auto(Auto::Auto), Value::Real)
    }
}

impl SettingType for usize {
    type Limit = usize;
    const KIND: Kind = Kind::Count;

    /// Whole numbers, also written as `2e3`.
    fn read(text: &str) -> Option<Self> {
        const EXACT: f64 = 9007199254740992.0; // 2^53: above it neighbouring floats skip counts
        let is_whole = |real: &f64| (0.0..=EXACT).contains(real) && real.fract() == 0.0;
        let real = || text.parse().ok().filter(is_whole).map(|real| real as usize);
        text.parse().ok().or_else(real)
    }

    fn value(self) -> Value {
        Value::Count(self as u64)
    }
}

impl SettingType for bool {
    type Limit = bool;
    const KIND: Kind = Kind::Flag;

    fn read(text: &str) -> Option<Self> {
        text.parse().ok()
    }

    fn value(self) -> Value {
        Value::Flag(self)
    }
}

/// Writes settings as one JSON object; used by [`settings!`](crate::settings!).
pub fn serialize<S: Settings, T: Serializer>(settings: &S, to: T) -> Result<T::Ok, T::Error> {
    to.collect_map(settings.entries().into_iter().map(|(field, value)| (field.name, value)))
}

/// Reads settings from a JSON object: unknown keys and values outside their range are refused,
/// missing keys keep their default. Used by [`settings!`](crate::settings!).
pub fn deserialize<'de, S: Settings, D: Deserializer<'de>>(from: D) -> Result<S, D::Error> {
    let mut settings = S::default();
    for (key, value) in BTreeMap::<String, Value>::deserialize(from)? {
        settings.set(&key, &value.to_string()).map_err(D::Error::custom)?;
    }
    Ok(settings)
}

/// Declares a settings struct; see the module [`settings`](mod@crate::settings) for an example.
///
/// `name: type ["unit"] in low..=high = default`, with literals as limits and
/// `f64`, `Option<f64>`, `usize` as types; `name: bool = default` has no unit nor range.
#[macro_export]
macro_rules! settings {
    (
        $(#[doc = $struct_doc:literal])+
        pub struct $Struct:ident {
            $(
                $(#[doc = $doc:literal])+
                $name:ident : $kind:ty $([$unit:literal] in $low:literal ..= $high:literal)?
                    = $default:expr
            ),+ $(,)?
        }
    ) => {
        $(#[doc = $struct_doc])+
        #[derive(Debug, Clone, PartialEq)]
        pub struct $Struct {
            $(
                $(#[doc = $doc])+
                $(#[doc = concat!(" \\[", $unit, "\\]")])?
                pub $name: $kind,
            )+
        }

        impl Default for $Struct {
            fn default() -> Self {
                $Struct { $($name: $default),+ }
            }
        }

        impl $crate::settings::Settings for $Struct {
            const MODULE: &'static str = module_path!();

            // The unit and the range of a flag are the last of their lists, those of a number the first.
            const FIELDS: &'static [$crate::settings::Field] = &[$($crate::settings::Field {
                name: stringify!($name),
                unit: [$($unit,)? "-"][0],
                doc: concat!($($doc),+).trim_ascii(),
                kind: <$kind as $crate::settings::SettingType>::KIND,
                range: [
                    $(concat!(stringify!($low), " to ", stringify!($high), " [", $unit, "]"),)?
                    "true or false",
                ][0],
                default: || <$kind as $crate::settings::SettingType>::value($default),
            }),+];

            fn entries(&self) -> Vec<(&'static $crate::settings::Field, $crate::settings::Value)> {
                let values = [$($crate::settings::SettingType::value(self.$name)),+];
                Self::FIELDS.iter().zip(values).collect()
            }

            fn set(&mut self, key: &str, text: &str) -> Result<(), $crate::settings::SettingError> {
                match Self::FIELDS.iter().find(|field| field.name == key) {
                    $(Some(field) if key == stringify!($name) => {
                        let range = [$($low..=$high)?].into_iter().next();
                        self.$name = $crate::settings::read(text, range, field)?;
                    })+
                    _ => return Err($crate::settings::unknown(Self::FIELDS, key)),
                }
                Ok(())
            }
        }

        impl $crate::settings::serde::Serialize for $Struct {
            fn serialize<S: $crate::settings::serde::Serializer>(
                &self,
                to: S,
            ) -> Result<S::Ok, S::Error> {
                $crate::settings::serialize(self, to)
            }
        }

        impl<'de> $crate::settings::serde::Deserialize<'de> for $Struct {
            fn deserialize<D: $crate::settings::serde::Deserializer<'de>>(
                from: D,
            ) -> Result<Self, D::Error> {
                $crate::settings::deserialize(from)
            }
        }
    };
}

#[doc(hidden)]
pub use serde; // for the macro, in crates that do not depend on serde

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    crate::settings! {
        /// A channel between two plates.
        pub struct Channel {
            /// Reynolds number
            /// V L / nu
            re: f64 ["-"] in 1e-9..=1e6 = 0.5,
            /// rows of particles
            rows: usize ["-"] in 4..=2000 = 20,
            /// seed of the perturbation
            seed: usize ["-"] in 0..=4294967295 = 7,
            /// speed of sound
            c0: Option<f64> ["m/s"] in 1e-9..=1e5 = None,
            /// shift of the lower plate
            shift: f64 ["m"] in -1.0..=1.0 = 0.0,
            /// say more
            verbose: bool = false,
        }
    }

    fn channel(assignments: &[&str]) -> Result<Channel, SettingError> {
        let mut channel = Channel::default();
        apply(&mut channel, assignments)?;
        Ok(channel)
    }

    #[test]
    fn fields_carry_what_the_declaration_says() {
        let re = &Channel::FIELDS[0];
        assert_eq!((re.name, re.unit, re.kind), ("re", "-", Kind::Real));
        assert_eq!((re.doc, re.range), ("Reynolds number V L / nu", "1e-9 to 1e6 [-]"));
        assert_eq!((re.default)(), Value::Real(0.5));
        let printed: Vec<_> = Channel::default()
            .entries()
            .iter()
            .map(|(field, value)| format!("{}={value}", field.name))
            .collect();
        assert_eq!(printed.join(" "), "re=0.5 rows=20 seed=7 c0=auto shift=0.0 verbose=false");
    }

    #[test]
    fn assignments_are_read_in_order_and_all_or_nothing() {
        let set =
            channel(&["re = 1e-3", "rows=1e2", "c0=12.5", "shift=-0.5", "verbose=true"]).unwrap();
        let expected =
            Channel { re: 1e-3, rows: 100, c0: Some(12.5), shift: -0.5, verbose: true, seed: 7 };
        assert_eq!(set, expected);
        assert_eq!(channel(&["c0=auto"]).unwrap().c0, None);
        let twice = channel(&["c0=12.5", "rows=40", "c0 = auto"]).unwrap_err().to_string();
        assert_eq!(
            twice,
            "setting c0 is given twice, as \"12.5\" and as \"auto\"; give one of them"
        );
        let mut kept = Channel::default();
        assert!(apply(&mut kept, &["rows=40", "re=nonsense"]).is_err());
        assert_eq!(kept, Channel::default());
    }

    #[test]
    fn errors_name_setting_value_and_range() {
        let says = |assignment: &str| channel(&[assignment]).unwrap_err().to_string();
        assert_eq!(
            says("row=40"),
            "no setting is called \"row\" (did you mean rows?); \
             the settings are re, rows, seed, c0, shift, verbose"
        );
        assert!(
            says("viscosity=1").starts_with("no setting is called \"viscosity\"; the settings")
        );
        assert_eq!(
            says("rows=3"),
            "setting rows is \"3\"; allowed is a whole number, 4 to 2000 [-]"
        );
        assert_eq!(
            says("rows=-3"),
            "setting rows is \"-3\"; allowed is a whole number, 4 to 2000 [-]"
        );
        assert_eq!(
            says("re=1e300"),
            "setting re is \"1e300\"; allowed is a number, 1e-9 to 1e6 [-]"
        );
        assert_eq!(says("re=NaN"), "setting re is \"NaN\"; allowed is a number, 1e-9 to 1e6 [-]");
        assert_eq!(
            says("c0=inf"),
            "setting c0 is \"inf\"; allowed is a number or auto, 1e-9 to 1e5 [m/s]"
        );
        assert_eq!(
            says("rows=20.5"),
            "setting rows is \"20.5\"; allowed is a whole number, 4 to 2000 [-]"
        );
        assert_eq!(says("re"), "\"re\" is not of the form key=value");
        assert_eq!(
            says("rows=99999999999999999999999"),
            "setting rows is \"99999999999999999999999\"; allowed is a whole number, 4 to 2000 [-]"
        );
        assert!(says("re=").starts_with("setting re is \"\"; allowed is a number"));
        assert!(says("verbose=yes").ends_with("allowed is a flag, true or false"));
    }

    #[test]
    fn json_round_trips_and_cannot_carry_an_invalid_value() {
        let set = channel(&["re=0.1", "c0=3", "seed=4294967295"]).unwrap();
        let text = serde_json::to_string(&set).unwrap();
        assert_eq!(serde_json::from_str::<Channel>(&text).unwrap(), set);
        let auto = serde_json::to_string(&Channel::default()).unwrap();
        assert!(auto.contains(r#""c0":"auto""#), "{auto}");
        assert_eq!(serde_json::from_str::<Channel>(&auto).unwrap(), Channel::default());
        assert_eq!(serde_json::from_str::<Channel>(r#"{"re":2}"#).unwrap().re, 2.0);
        for refused in [r#"{"rows":3}"#, r#"{"rouws":30}"#, r#"{"re":null}"#, r#"{"re":"1"}"#] {
            assert!(serde_json::from_str::<Channel>(refused).is_err(), "{refused}");
        }
    }

    #[test]
    fn validate_finds_what_was_written_past_set() {
        assert_eq!(Channel::default().validate(), Ok(()));
        let wrong = Channel { re: f64::NAN, ..Channel::default() };
        assert!(wrong.validate().is_err_and(|e| e.0.starts_with("setting re is \"NaN\"; allowed")));
        let wrong = Channel { c0: Some(-1.0), ..Channel::default() };
        assert!(
            wrong.validate().is_err_and(|e| e.0.starts_with("setting c0 is \"-1.0\"; allowed"))
        );
    }

    proptest! {
        #[test]
        fn no_text_panics_or_leaves_an_invalid_struct(
            key in "re|rows|seed|c0|shift|verbose|.{0,40}",
            text in "-?[0-9]{0,30}(\\.[0-9]{0,9})?(e-?[0-9]{1,4})?|auto|NaN|inf|true|.{0,40}",
        ) {
            let mut settings = Channel::default();
            let outcome = settings.set(&key, &text);
            prop_assert_eq!(settings.validate(), Ok(()));
            if outcome.is_err() {
                prop_assert_eq!(&settings, &Channel::default());
            }
            let _ = apply(&mut settings, &[format!("{key}={text}"), text]);
            prop_assert_eq!(settings.validate(), Ok(()));
        }

        #[test]
        fn printed_values_read_back_equal(re in 1e-9..=1e6f64, rows in 4..=2000usize, auto: bool) {
            let set = Channel { re, rows, c0: (!auto).then_some(re.min(1e5)), ..Channel::default() };
            let mut back = Channel::default();
            for (field, value) in set.entries() {
                back.set(field.name, &value.to_string()).unwrap();
            }
            prop_assert_eq!(set, back);
        }
    }
}
