//! Why a record lacks a metric.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize};

/// Why a metric is absent; in documents a sentence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(into = "String")]
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
    (Absent::NotAsked, "not asked for: --metrics all"),
    (Absent::EveryStep, "it is measured after every step"),
    (Absent::OwnTerms, "it needs the sums of this program's own terms"),
    (Absent::OwnTheory, "it compares with the theory of this program's own method"),
    (Absent::OfParticles, "it follows from particles, and the submission is a profile or a series"),
];

/// Before the name of a column that was not submitted.
const NOT_GIVEN: &str = "not given: ";

impl Absent {
    /// The outcome of the run, or its settings, give the metric no meaning, for this reason.
    pub fn because(why: impl Into<String>) -> Self {
        Self::NoMeaning(why.into())
    }

    /// The reason with this sentence in a document.
    fn read(text: String) -> Self {
        if let Some((fixed, _)) = FIXED.into_iter().find(|(_, sentence)| *sentence == text) {
            return fixed;
        }
        match text.strip_prefix(NOT_GIVEN) {
            Some(column) => Self::NotGiven(column.into()),
            None => Self::NoMeaning(text),
        }
    }

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

impl<'de> Deserialize<'de> for Absent {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        String::deserialize(from).map(Self::read)
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
            assert_eq!(Absent::read(absent.to_string()), absent);
            let of_values = matches!(absent, Absent::NoMeaning(_));
            assert_eq!(absent.is_known_before(), !of_values, "{absent}");
        }
    }
}
