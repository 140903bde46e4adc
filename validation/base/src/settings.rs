//! Settings of a case: named, documented numbers with a unit, an allowed range and a default.
//!
//! [`settings!`](crate::settings!) declares the struct once; the command line
//! (`--set key=value`), the JSON record, the listing and the report's table are derived from it.
//! Neither text nor JSON input can give a struct a value outside its range.
//!
//! ```
//! use touchstone_base::settings;
//!
//! touchstone_base::settings! {
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
//! assert!(settings::set(&mut channel, "rows", "3").is_err());
//! ```

use std::fmt;

use thiserror::Error;

use crate::text::short;

/// Type of a setting.
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// a flag
    Flag(bool),
    /// a whole number
    Count(u64),
    /// a real number
    Real(f64),
    /// by rule; in JSON and on the command line the word `auto`
    Auto,
}

impl From<Value> for serde_json::Value {
    fn from(value: Value) -> Self {
        match value {
            Value::Flag(flag) => flag.into(),
            Value::Count(count) => count.into(),
            Value::Real(real) => real.into(),
            Value::Auto => "auto".into(),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Flag(flag) => write!(f, "{flag}"),
            Value::Count(count) => write!(f, "{count}"),
            Value::Real(real) => write!(f, "{real:?}"), // the shortest text that reads back equal
            Value::Auto => f.write_str("auto"),
        }
    }
}

impl Value {
    /// The number; `None` for a flag or a value by rule.
    pub fn number(self) -> Option<f64> {
        match self {
            Value::Count(count) => Some(count as f64),
            Value::Real(real) => Some(real),
            Value::Flag(_) | Value::Auto => None,
        }
    }
}

/// Static description of a setting.
#[derive(Debug, Clone, Copy)]
pub struct Field {
    /// the key of `--set key=value`
    pub name: &'static str,
    /// SI unit, `-` for none
    pub unit: &'static str,
    /// description, one line
    pub doc: &'static str,
    /// type of its values
    pub kind: Kind,
    /// allowed range in words
    pub range: &'static str,
    /// its ends, of a number
    pub limits: [f64; 2],
    /// the value unless it is set
    pub default: Value,
}

/// Why a setting was refused: a text with its name, its value, and the allowed values.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{0}")]
pub struct SettingError(pub String);

/// " (did you mean NAME?)" with the name most similar to `written`, or an empty text if none is similar.
pub fn hint(names: &[&str], written: &str) -> String {
    let distance = |name: &&&str| edit_distance(name, written);
    let is_close = |name: &&&str| distance(name) <= 1 + name.len() / 3;
    let nearest = names.iter().filter(is_close).min_by_key(distance);
    nearest.map(|name| format!(" (did you mean {name}?)")).unwrap_or_default()
}

/// A settings struct without its type.
pub trait Values {
    /// All settings in the order of declaration.
    fn fields(&self) -> &'static [Field];

    /// Their values.
    fn values(&self) -> Vec<Value>;

    /// Sets every setting; values of another instance of this settings type fit.
    fn put(&mut self, values: &[Value]);
}

/// A settings struct; implemented by [`settings!`](crate::settings!).
pub trait Settings: SettingType + Clone + Default + PartialEq + fmt::Debug + 'static {
    /// All settings in the order of declaration; the settings of a group are at the place of the group.
    fn all() -> &'static [Field];

    /// The path of the module that declares them, which begins with the name of its crate.
    const MODULE: &'static str;
}

impl<S: Settings> Values for S {
    fn fields(&self) -> &'static [Field] {
        S::all()
    }

    fn values(&self) -> Vec<Value> {
        self.append_to(Vec::new())
    }

    fn put(&mut self, values: &[Value]) {
        self.take(&mut values.iter());
    }
}

/// Sets one setting from text; on error nothing changes.
pub fn set(settings: &mut dyn Values, key: &str, text: &str) -> Result<(), SettingError> {
    let fields = settings.fields();
    let place = fields.iter().position(|field| field.name == key);
    let place = place.ok_or_else(|| unknown(fields, key))?;
    let mut values = settings.values();
    values[place] = fields[place].read(text)?;
    settings.put(&values);
    Ok(())
}

/// Checks every range again, for a struct whose public fields were written directly.
pub fn validate(settings: &dyn Values) -> Result<(), SettingError> {
    let mut read = settings.fields().iter().zip(settings.values());
    read.try_for_each(|(field, value)| field.read(&value.to_string()).map(drop))
}

/// Applies assignments `key=value`, one for a key; on error nothing changes.
pub fn apply(settings: &mut dyn Values, texts: &[impl AsRef<str>]) -> Result<(), SettingError> {
    let before = settings.values();
    let mut given: Vec<(&str, &str)> = Vec::new();
    let applied = texts.iter().try_for_each(|text| {
        let text = text.as_ref();
        let Some((key, value)) = text.split_once('=') else {
            return Err(SettingError(format!("{:?} is not of the form key=value", short(text))));
        };
        let (key, value) = (key.trim(), value.trim());
        set(settings, key, value)?;
        if let Some((_, first)) = given.iter().find(|(other, _)| *other == key) {
            let twice = format!("setting {key} is given twice, as {first:?} and as {value:?}");
            return Err(SettingError(format!("{twice}; give one of them")));
        }
        given.push((key, value));
        Ok(())
    });
    applied.inspect_err(|_| settings.put(&before))
}

/// Settings as one JSON object.
pub fn to_json(settings: &dyn Values) -> serde_json::Value {
    let mut object = serde_json::Map::new();
    for (field, value) in settings.fields().iter().zip(settings.values()) {
        object.insert(field.name.into(), value.into());
    }
    object.into()
}

/// Settings from a JSON object: unknown keys and values outside their range are refused, missing keys keep
/// their default.
pub fn of_json<S: Settings>(json: &serde_json::Value) -> Result<S, SettingError> {
    let mut settings = S::default();
    read(&mut settings, json)?;
    Ok(settings)
}

/// Reads settings over existing values, which missing keys keep; on error some settings are changed.
pub fn read(settings: &mut dyn Values, json: &serde_json::Value) -> Result<(), SettingError> {
    let given = json.as_object().ok_or_else(|| {
        let found = short(&json.to_string());
        SettingError(format!("settings are {found}; allowed is an object of settings by name"))
    })?;
    given.iter().try_for_each(|(key, value)| set(settings, key, &text(value)))
}

/// A value as it is written in `key=value`.
pub fn text(json: &serde_json::Value) -> String {
    match json.as_str() {
        Some("auto") => "auto".into(),
        _ => json.to_string(),
    }
}

/// The error for a key that is not among the fields.
pub fn unknown(fields: &'static [Field], key: &str) -> SettingError {
    let keys: Vec<_> = fields.iter().map(|field| field.name).collect();
    let (hint, keys, key) = (hint(&keys, key), keys.join(", "), short(key));
    SettingError(format!("no setting is called {key:?}{hint}; the settings are {keys}"))
}

/// All names, the most similar to `written` first: names that contain it, then names that differ from it by
/// the fewest letters.
pub fn by_similarity<'a>(names: &[&'a str], written: &str) -> Vec<&'a str> {
    let mut sorted = names.to_vec();
    sorted.sort_by_cached_key(|name| (!name.contains(written), edit_distance(name, written)));
    sorted
}

/// Insertions, deletions and replacements between a name and `written`, of any length.
fn edit_distance(name: &str, written: &str) -> usize {
    strsim::levenshtein(name, &written.chars().take(100).collect::<String>())
}

impl Field {
    /// A flag without a name.
    pub const FLAG: Self = Self {
        name: "",
        unit: "-",
        doc: "",
        kind: Kind::Flag,
        range: "true or false",
        limits: [0.0; 2],
        default: Value::Flag(false),
    };

    /// Its value in settings as JSON; none if it is missing, of another kind or out of range.
    pub fn of_json(&self, settings: &serde_json::Value) -> Option<Value> {
        self.read(&text(settings.get(self.name)?)).ok()
    }

    /// Reads a value. One that is not finite, or outside of the range, is refused.
    fn read(&self, text: &str) -> Result<Value, SettingError> {
        let Self { name, kind, range, limits: [low, high], .. } = self;
        let is_allowed = |number: f64| (*low..=*high).contains(&number);
        let real = || text.parse().ok().filter(|real| is_allowed(*real)).map(Value::Real);
        let value = match kind {
            Kind::Real => real(),
            Kind::RealOrAuto if text == "auto" => Some(Value::Auto),
            Kind::RealOrAuto => real(),
            Kind::Count => count(text).filter(|of| is_allowed(*of as f64)).map(Value::Count),
            Kind::Flag => text.parse().ok().map(Value::Flag),
        };
        let words = || format!("setting {name} is {:?}; allowed is {kind}, {range}", short(text));
        value.ok_or_else(|| SettingError(words()))
    }
}

/// Whole numbers, also in the form `2e3`.
fn count(text: &str) -> Option<u64> {
    const EXACT: f64 = 9007199254740992.0; // 2^53: above it neighbouring floats skip counts
    let is_whole = |real: &f64| (0.0..=EXACT).contains(real) && real.fract() == 0.0;
    let real = || text.parse().ok().filter(is_whole).map(|real| real as u64);
    text.parse().ok().or_else(real)
}

/// Type of a setting: a [`Scalar`], or a group, which is another settings struct whose settings are included
/// at its place.
pub trait SettingType {
    /// The fields that a setting of this type declares, with this value as default: `declared` with its kind
    /// and default, or the fields of the group.
    fn expand(&self, declared: Field) -> Vec<Field>;

    /// Appends their values.
    fn append_to(&self, values: Vec<Value>) -> Vec<Value>;

    /// Takes the next value for each of them; one of another kind changes nothing.
    fn take(&mut self, values: &mut std::slice::Iter<'_, Value>);
}

/// A number or a flag.
pub trait Scalar: Copy {
    /// The kind that errors and listings name.
    const KIND: Kind;

    /// The value without its type.
    fn value(self) -> Value;

    /// The value with its type, if it is of this kind.
    fn of(value: Value) -> Option<Self>;
}

impl<T: Scalar> SettingType for T {
    fn expand(&self, declared: Field) -> Vec<Field> {
        vec![Field { kind: T::KIND, default: self.value(), ..declared }]
    }

    fn append_to(&self, mut values: Vec<Value>) -> Vec<Value> {
        values.push(self.value());
        values
    }

    fn take(&mut self, values: &mut std::slice::Iter<'_, Value>) {
        if let Some(value) = values.next().and_then(|value| T::of(*value)) {
            *self = value;
        }
    }
}

impl Scalar for f64 {
    const KIND: Kind = Kind::Real;

    fn value(self) -> Value {
        Value::Real(self)
    }

    fn of(value: Value) -> Option<Self> {
        if let Value::Real(real) = value { Some(real) } else { None }
    }
}

impl Scalar for Option<f64> {
    const KIND: Kind = Kind::RealOrAuto;

    fn value(self) -> Value {
        self.map_or(Value::Auto, Value::Real)
    }

    fn of(value: Value) -> Option<Self> {
        if value == Value::Auto { Some(None) } else { f64::of(value).map(Some) }
    }
}

impl Scalar for usize {
    const KIND: Kind = Kind::Count;

    fn value(self) -> Value {
        Value::Count(self as u64)
    }

    fn of(value: Value) -> Option<Self> {
        if let Value::Count(count) = value { Some(count as usize) } else { None }
    }
}

impl Scalar for bool {
    const KIND: Kind = Kind::Flag;

    fn value(self) -> Value {
        Value::Flag(self)
    }

    fn of(value: Value) -> Option<Self> {
        if let Value::Flag(flag) = value { Some(flag) } else { None }
    }
}

/// Declares a settings struct; see the module [`settings`](mod@crate::settings) for an example.
///
/// `name: type ["unit"] in low..=high = default`, with literals as limits and
/// `f64`, `Option<f64>`, `usize` as types; `name: bool = default` has no unit nor range;
/// `name: Struct = default` is a group: the settings of another settings struct.
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

        impl $crate::settings::SettingType for $Struct {
            fn expand(&self, _: $crate::settings::Field) -> Vec<$crate::settings::Field> {
                let fields = [$($crate::settings::SettingType::expand(
                    &self.$name,
                    $crate::settings::Field {
                        name: stringify!($name),
                        doc: concat!($($doc),+).trim_ascii(),
                        $(
                            unit: $unit,
                            range: concat!(stringify!($low), " to ", stringify!($high), " [", $unit, "]"),
                            limits: [$low as f64, $high as f64],
                        )?
                        ..$crate::settings::Field::FLAG
                    },
                )),+];
                fields.concat()
            }

            fn append_to(&self, values: Vec<$crate::settings::Value>) -> Vec<$crate::settings::Value> {
                $(let values = $crate::settings::SettingType::append_to(&self.$name, values);)+
                values
            }

            fn take(&mut self, values: &mut std::slice::Iter<'_, $crate::settings::Value>) {
                $($crate::settings::SettingType::take(&mut self.$name, values);)+
            }
        }

        impl $crate::settings::Settings for $Struct {
            const MODULE: &'static str = module_path!();

            fn all() -> &'static [$crate::settings::Field] {
                use $crate::settings::{Field, SettingType};
                static ALL: std::sync::LazyLock<Vec<Field>> =
                    std::sync::LazyLock::new(|| $Struct::default().expand(Field::FLAG));
                &ALL
            }
        }
    };
}

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
            seed: usize ["-"] in 0..=1000000000 = 7,
            /// speed of sound
            c0: Option<f64> ["m/s"] in 1e-9..=1e5 = None,
            /// shift of the lower plate
            shift: f64 ["m"] in -1.0..=1.0 = 0.0,
            /// say more
            verbose: bool = false,
        }
    }

    crate::settings! {
        /// Two plates and a channel of ten rows between them.
        pub struct Plates {
            /// speed of a plate
            speed: f64 ["m/s"] in 0.0..=1.0 = 0.1,
            /// the channel
            channel: Channel = Channel { rows: 10, ..Channel::default() },
            /// steady plates
            steady: bool = true,
        }
    }

    #[test]
    fn settings_of_a_group_stand_in_its_place_and_have_the_defaults_of_the_whole() {
        let fields = Plates::all();
        let names: Vec<_> = fields.iter().map(|field| field.name).collect();
        assert_eq!(names.join(" "), "speed re rows seed c0 shift verbose steady");
        assert_eq!((fields[2].default, fields[2].range), (Value::Count(10), "4 to 2000 [-]"));
        assert_eq!(Channel::all()[1].default, Value::Count(20));
        let mut plates = Plates::default();
        apply(&mut plates, &["c0=2", "steady=false", "speed=0.5"]).unwrap();
        let channel = Channel { rows: 10, c0: Some(2.0), ..Channel::default() };
        assert_eq!(plates, Plates { speed: 0.5, channel, steady: false });
        let refused = set(&mut plates, "rows", "3").unwrap_err();
        assert_eq!(refused.0, "setting rows is \"3\"; allowed is a whole number, 4 to 2000 [-]");
        let json = to_json(&plates);
        assert_eq!(json["c0"], 2.0);
        assert_eq!(of_json::<Plates>(&json).unwrap(), plates);
        plates.channel.re = -1.0;
        assert!(validate(&plates).is_err());
    }

    fn channel(assignments: &[&str]) -> Result<Channel, SettingError> {
        let mut channel = Channel::default();
        apply(&mut channel, assignments)?;
        Ok(channel)
    }

    #[test]
    fn fields_carry_what_the_declaration_says() {
        let re = &Channel::all()[0];
        assert_eq!((re.name, re.unit, re.kind), ("re", "-", Kind::Real));
        assert_eq!((re.doc, re.range), ("Reynolds number V L / nu", "1e-9 to 1e6 [-]"));
        assert_eq!(re.default, Value::Real(0.5));
        let printed: Vec<_> = Channel::default()
            .fields()
            .iter()
            .zip(Channel::default().values())
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
        let set = channel(&["re=0.1", "c0=3", "seed=1000000000"]).unwrap();
        let of_text = |text: &str| of_json::<Channel>(&serde_json::from_str(text).unwrap());
        assert_eq!(of_text(&to_json(&set).to_string()).unwrap(), set);
        let auto = to_json(&Channel::default()).to_string();
        assert!(auto.contains(r#""c0":"auto""#), "{auto}");
        assert_eq!(of_text(&auto).unwrap(), Channel::default());
        assert_eq!(of_text(r#"{"re":2}"#).unwrap().re, 2.0);
        for refused in [r#"{"rows":3}"#, r#"{"rouws":30}"#, r#"{"re":null}"#, r#"{"re":"1"}"#] {
            assert!(of_text(refused).is_err(), "{refused}");
        }
    }

    #[test]
    fn validate_finds_what_was_written_past_set() {
        assert_eq!(validate(&Channel::default()), Ok(()));
        let wrong = Channel { re: f64::NAN, ..Channel::default() };
        assert!(validate(&wrong).is_err_and(|e| e.0.starts_with("setting re is \"NaN\"; allowed")));
        let wrong = Channel { c0: Some(-1.0), ..Channel::default() };
        assert!(
            validate(&wrong).is_err_and(|e| e.0.starts_with("setting c0 is \"-1.0\"; allowed"))
        );
    }

    proptest! {
        #[test]
        fn no_text_panics_or_leaves_an_invalid_struct(
            key in "re|rows|seed|c0|shift|verbose|.{0,40}",
            text in "-?[0-9]{0,30}(\\.[0-9]{0,9})?(e-?[0-9]{1,4})?|auto|NaN|inf|true|.{0,40}",
        ) {
            let mut settings = Channel::default();
            let outcome = set(&mut settings, &key, &text);
            prop_assert_eq!(validate(&settings), Ok(()));
            if outcome.is_err() {
                prop_assert_eq!(&settings, &Channel::default());
            }
            let _ = apply(&mut settings, &[format!("{key}={text}"), text]);
            prop_assert_eq!(validate(&settings), Ok(()));
        }

        #[test]
        fn printed_values_read_back_equal(re in 1e-9..=1e6f64, rows in 4..=2000usize, auto: bool) {
            let set = Channel { re, rows, c0: (!auto).then_some(re.min(1e5)), ..Channel::default() };
            let mut back = Channel::default();
            for (field, value) in Channel::all().iter().zip(set.values()) {
                super::set(&mut back, field.name, &value.to_string()).unwrap();
            }
            prop_assert_eq!(set, back);
        }
    }
}
