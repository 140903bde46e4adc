//! The code that made a run, and the part of the problem that it used.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, de::Error};

use crate::{number::is_default, text::short};

/// The code of a submission that this program wrote itself, as `export --solve` does.
pub const OURS: &str = "touchstone";
/// Key of the numerics of a record: the machine of the other code, as its submission states it.
pub const MACHINE: &str = "machine";
/// Key of the numerics of a record: the day of the session in which it was made with others, in turn.
pub const SESSION: &str = "session";

/// Reads the name of a code. Refuses names that look like another name: with letters of other scripts, with
/// invisible blanks, or this program's name in other letters.
///
/// # Errors
/// If it is such a name.
pub fn code_name<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    let name = String::deserialize(from)?;
    let is_plain = name.chars().all(|char| (' '..='~').contains(&char));
    let is_other = name == OURS || !name.eq_ignore_ascii_case(OURS);
    let expected = match (is_plain && name.split(' ').all(|word| !word.is_empty()), is_other) {
        (true, true) => return Ok(name),
        (true, false) => "touchstone in lower case for this program, or the name of another code",
        // An empty name is refused with the other texts of the document.
        _ if name.is_empty() => return Ok(name),
        _ => "printable characters of ASCII and single blanks between words",
    };
    let escaped: String = name.escape_default().collect();
    Err(D::Error::custom(format!(
        "the name of the code is \"{}\"; expected {expected}",
        short(&escaped)
    )))
}

/// A run of another code.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Submission {
    /// name of the code
    #[serde(deserialize_with = "code_name")]
    pub code: String,
    /// its version
    pub version: String,
    /// the scheme in its own words, such as `WCSPH, quintic spline`
    pub scheme: String,
    /// part of the problem that it used
    pub division: Division,
    /// SHA-256 of the document that describes the method
    pub method: String,
    /// SHA-256 of the submitted particles, in any format; `None` in a record from before 0.2
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub results: Option<String>,
    /// the seed from which a sealed problem was drawn
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// Does it state the kernel, the support and the step of our own method? Then gates on the theory of
    /// these apply.
    #[serde(default, skip_serializing_if = "is_default")]
    pub states_our_method: bool,
}

/// The part of the problem that a submission used.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Division {
    /// the particles, their spacing and the support of the kernel: compares codes
    #[default]
    Closed,
    /// the problem alone: compares methods
    Open,
}

impl fmt::Display for Division {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

impl fmt::Display for Submission {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}, {}", self.code, self.version, self.scheme)?;
        self.seed.map_or(Ok(()), |seed| write!(f, ", sealed by seed {seed}"))
    }
}
