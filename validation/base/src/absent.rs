//! Why a record lacks a metric.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Reason for an absent metric that takes long to measure, in a run measured for its headline only.
pub const NOT_ASKED: &str = "not asked for: --metrics all";

/// Why a metric is absent; in documents a sentence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub enum Absent {
    /// Takes long to measure, and the run was measured for its headline only.
    NotAsked,
    /// Submission: the case measures this metric after every step.
    EveryStep,
    /// Submission: the metric needs the sums of this program's own terms.
    OwnTerms,
    /// Submission: the metric compares with the theory of this program's own method.
    OwnTheory,
    /// Submission of a profile or a series: the metric needs particles.
    OfParticles,
    /// Submission: the metric needs a column, or times, that the submission lacks.
    NotGiven(String),
    /// The outcome of the run, or its settings, give it no meaning.
    NoMeaning(String),
}

/// Reasons with one sentence for every run.
const FIXED: [(Absent, &str); 5] = [
    (Absent::NotAsked, NOT_ASKED),
    (Absent::EveryStep, "it is measured after every step"),
    (Absent::OwnTerms, "it needs the sums of this program's own terms"),
    (Absent::OwnTheory, "it compares with the theory of this program's own method"),
    (Absent::OfParticles, "it follows from particles, and the submission is a profile or a series"),
];

/// Before the name of a column that was not submitted.
const NOT_GIVEN: &str = "not given: ";

impl Absent {
    /// Is a gate on the metric not applicable to a submission? Only if this was known before its numbers were
    /// read; a submission whose numbers determine no value fails.
    pub fn is_known_before(&self) -> bool {
        !matches!(self, Absent::NoMeaning(_))
    }
}

impl fmt::Display for Absent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Absent::NotGiven(column) => write!(f, "{NOT_GIVEN}{column}"),
            Absent::NoMeaning(why) => f.write_str(why),
            fixed => {
                let sentence = FIXED.iter().find(|(of, _)| of == fixed);
                f.write_str(sentence.map_or("", |(_, sentence)| sentence))
            }
        }
    }
}

impl From<String> for Absent {
    fn from(text: String) -> Self {
        if let Some((fixed, _)) = FIXED.into_iter().find(|(_, sentence)| *sentence == text) {
            return fixed;
        }
        match text.strip_prefix(NOT_GIVEN) {
            Some(column) => Absent::NotGiven(column.into()),
            None => Absent::NoMeaning(text),
        }
    }
}

impl From<&str> for Absent {
    fn from(text: &str) -> Self {
        text.to_string().into()
    }
}

impl From<&String> for Absent {
    fn from(text: &String) -> Self {
        text.clone().into()
    }
}

impl From<Absent> for String {
    fn from(absent: Absent) -> Self {
        absent.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reason_is_read_back_from_its_sentence() {
        let fixed = FIXED.map(|(of, _)| of);
        let others = [Absent::NotGiven("density".into()), Absent::NoMeaning("no contact".into())];
        for absent in fixed.into_iter().chain(others) {
            assert_eq!(Absent::from(absent.to_string()), absent);
            let of_values = matches!(absent, Absent::NoMeaning(_));
            assert_eq!(absent.is_known_before(), !of_values, "{absent}");
        }
    }
}
