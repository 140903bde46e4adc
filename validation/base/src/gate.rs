//! Gates: a metric, a bound, the kind of evidence behind the bound, and the reason for the bound.
//!
//! A gate passes only if the metric is a finite number inside the bound: NaN, infinity and a metric
//! that was not measured fail. A number that is shown without being judged is marked so.
//!
//! ```
//! use base::gate::{Bound, Evidence, Gate, Verdict};
//! let gate = Gate::new(
//!     "couette.l2.t0.1",
//!     "l2.t0.1",
//!     Bound::Below(2e-3),
//!     Evidence::Analytic,
//!     "second order in dx: 1.9e-3 at 10 rows, and the series is exact to 1e-14",
//! );
//! assert_eq!(gate.judge(Some(1e-3)).verdict, Verdict::Pass);
//! assert_eq!(gate.judge(Some(f64::NAN)).verdict, Verdict::Fail);
//! assert_eq!(gate.judge(None).verdict, Verdict::Fail);
//! ```

use std::collections::BTreeSet;
use std::fmt;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::record::{Record, Status};

/// Where a metric must lie; the ends belong to the bound.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// at most; for a norm, which is never negative
    Below(f64),
    /// at least
    Above(f64),
    /// from low to high
    Within(f64, f64),
    /// this number exactly, as for counts
    Equals(f64),
}

impl Bound {
    /// Is the number finite and inside?
    pub fn contains(self, value: f64) -> bool {
        let is_inside = match self {
            Bound::Below(high) => value <= high,
            Bound::Above(low) => value >= low,
            Bound::Within(low, high) => low <= value && value <= high,
            Bound::Equals(expected) => value == expected,
        };
        value.is_finite() && is_inside
    }

    /// How much of the allowance is left: 1 far inside, 0 at the end, negative outside.
    ///
    /// The allowance is the bound itself (`Below`, `Above`), half the width (`Within`), or the
    /// expected number (`Equals`); where that is zero, the distance in the metric's own unit.
    /// `None` for a number that is not finite.
    pub fn margin(self, value: f64) -> Option<f64> {
        let (distance, allowance) = match self {
            Bound::Below(high) => (high - value, high.abs()),
            Bound::Above(low) => (value - low, low.abs()),
            Bound::Within(low, high) => ((value - low).min(high - value), 0.5 * (high - low)),
            Bound::Equals(expected) => (-(value - expected).abs(), expected.abs()),
        };
        let margin = if allowance > 0.0 { distance / allowance } else { distance };
        margin.is_finite().then_some(margin + 0.0) // + 0: no negative zero
    }

    fn is_sound(self) -> bool {
        match self {
            Bound::Below(end) | Bound::Above(end) | Bound::Equals(end) => end.is_finite(),
            Bound::Within(low, high) => low.is_finite() && high.is_finite() && low < high,
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Bound::Below(high) => write!(f, "at most {}", shown(*high)),
            Bound::Above(low) => write!(f, "at least {}", shown(*low)),
            Bound::Within(low, high) => write!(f, "{} to {}", shown(*low), shown(*high)),
            Bound::Equals(expected) => write!(f, "exactly {}", shown(*expected)),
        }
    }
}

/// Seven significant digits at most, for people: `300`, `1.78398`, `1e-10`.
fn shown(value: f64) -> String {
    let rounded = format!("{value:.6e}").parse().unwrap_or(value);
    let text = format!("{rounded:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_string)
}

/// The kind of evidence behind a bound, strongest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    /// an exact solution of the equations
    Analytic,
    /// a law that holds whatever the solution: conservation, symmetry, equal bits
    Invariant,
    /// the theory of the method: an order, a stability limit, a dispersion relation
    Theory,
    /// an experiment, or an independent computation with an uncertainty
    Reference,
    /// what this program computed before: says changed, not wrong
    Regression,
}

/// What a gate does with its judgement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Purpose {
    /// inside passes, outside fails
    Judge,
    /// show the number and judge nothing
    Report,
    /// a finite number outside is known, for this reason, and does not fail
    Limitation(String),
    /// a control that must lie outside its bound: inside fails
    ExpectFailure,
}

/// A metric, its bound and its reasons.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Gate {
    /// dotted name, starting with the case
    pub id: String,
    /// name of the metric in the record
    pub metric: String,
    /// where it must lie
    pub bound: Bound,
    /// the kind of evidence behind the bound
    pub evidence: Evidence,
    /// why the bound is where it is
    pub because: String,
    /// what the judgement is for
    pub purpose: Purpose,
    /// may the metric be missing?
    pub may_be_missing: bool,
    /// does it judge what was measured of a run that did not reach its end?
    #[serde(default)]
    pub even_if_diverged: bool,
}

/// What is wrong with a gate itself.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum GateError {
    /// No reason, so nobody can tell whether the bound is right.
    #[error("gate {id} does not say why its bound has this value")]
    NoReason {
        /// the gate
        id: String,
    },
    /// Name or metric is empty.
    #[error(
        "a gate must have a name and a metric, but has the name {id:?} and the metric {metric:?}"
    )]
    NoName {
        /// the gate
        id: String,
        /// its metric
        metric: String,
    },
    /// Ends that are not finite or not in order.
    #[error(
        "the bound of gate {id} is {bound}, but its ends must be finite and in ascending order"
    )]
    Bound {
        /// the gate
        id: String,
        /// its bound
        bound: Bound,
    },
    /// Two gates of one name.
    #[error("two gates are called {id}")]
    Duplicate {
        /// the gates
        id: String,
    },
}

impl Gate {
    /// A gate that judges and whose metric must be there.
    ///
    /// # Panics
    /// If the gate is unsound (see [`Gate::check`]): gates are written by us, not by users.
    pub fn new(
        id: impl Into<String>,
        metric: impl Into<String>,
        bound: Bound,
        evidence: Evidence,
        because: impl Into<String>,
    ) -> Self {
        let gate = Gate {
            id: id.into(),
            metric: metric.into(),
            bound,
            evidence,
            because: because.into(),
            purpose: Purpose::Judge,
            may_be_missing: false,
            even_if_diverged: false,
        };
        match gate.check() {
            Ok(()) => gate,
            Err(error) => panic!("{error}"),
        }
    }

    /// The number is shown and not judged.
    pub fn reported(self) -> Self {
        Gate { purpose: Purpose::Report, ..self }
    }

    /// Lying outside is known, for a reason; NaN and a missing metric still fail.
    pub fn with_limitation(self, reason: impl Into<String>) -> Self {
        Gate { purpose: Purpose::Limitation(reason.into()), ..self }
    }

    /// A control: a finite number outside the bound is what must come out.
    pub fn expected_to_fail(self) -> Self {
        Gate { purpose: Purpose::ExpectFailure, ..self }
    }

    /// The metric may be missing, as in the quick tier.
    pub fn when_measured(self) -> Self {
        Gate { may_be_missing: true, ..self }
    }

    /// What was measured before a run diverged counts as well; otherwise it is as good as missing.
    pub fn even_if_diverged(self) -> Self {
        Gate { even_if_diverged: true, ..self }
    }

    /// The number that the gate judges: none of a run that did not reach its end, however good it was
    /// until then.
    pub fn value(&self, record: &Record) -> Option<f64> {
        let counts = record.status == Status::Completed || self.even_if_diverged;
        if counts { record.metric(&self.metric) } else { None }
    }

    /// Has the gate a name, a metric, a sound bound and a reason?
    pub fn check(&self) -> Result<(), GateError> {
        let is_blank = |text: &str| text.trim().is_empty();
        let Gate { id, metric, bound, because, purpose, .. } = self;
        if is_blank(id) || is_blank(metric) {
            return Err(GateError::NoName { id: id.clone(), metric: metric.clone() });
        }
        if is_blank(because) || matches!(purpose, Purpose::Limitation(why) if is_blank(why)) {
            return Err(GateError::NoReason { id: id.clone() });
        }
        match bound.is_sound() {
            true => Ok(()),
            false => Err(GateError::Bound { id: id.clone(), bound: *bound }),
        }
    }

    /// Judges a metric; see [`judge`].
    pub fn judge(&self, value: Option<f64>) -> Judgement {
        judge(self, value)
    }
}

/// Checks every gate, and that no two have the same name.
pub fn check_all(gates: &[Gate]) -> Result<(), GateError> {
    let mut names = BTreeSet::new();
    for gate in gates {
        gate.check()?;
        if !names.insert(&gate.id) {
            return Err(GateError::Duplicate { id: gate.id.clone() });
        }
    }
    Ok(())
}

/// What came of a gate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// a finite number inside the bound
    Pass,
    /// outside, not finite, missing, or a control that passed
    Fail,
    /// shown, not judged
    Reported,
    /// outside, known for this reason
    Limitation(String),
    /// a control that failed, as it must
    ExpectedFailure,
    /// missing, as it may
    NotMeasured,
}

impl Verdict {
    /// Does it fail the run? Only [`Verdict::Fail`] does.
    pub fn is_failure(&self) -> bool {
        *self == Verdict::Fail
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Pass => f.write_str("pass"),
            Verdict::Fail => f.write_str("FAIL"),
            Verdict::Reported => f.write_str("reported, not judged"),
            Verdict::Limitation(reason) => write!(f, "known limitation: {reason}"),
            Verdict::ExpectedFailure => f.write_str("fails, as it must"),
            Verdict::NotMeasured => f.write_str("not measured"),
        }
    }
}

/// A verdict with the number it rests on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    /// name of the gate
    pub id: String,
    /// what came of it
    pub verdict: Verdict,
    /// the metric, if it was measured
    #[serde(with = "crate::number::optional", default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// what is left of the allowance, see [`Bound::margin`]
    #[serde(with = "crate::number::optional", default, skip_serializing_if = "Option::is_none")]
    pub margin: Option<f64>,
}

/// Judges a metric. Whatever the gate is for, it passes only on a finite number inside its bound.
///
/// | metric | `Judge` | `Report` | `Limitation` | `ExpectFailure` |
/// |---|---|---|---|---|
/// | finite, inside | pass | reported | pass | fail |
/// | finite, outside | fail | reported | limitation | expected failure |
/// | NaN, infinite | fail | reported | fail | fail |
/// | missing | fail | not measured | fail | fail |
///
/// A missing metric is `NotMeasured` where the gate allows that.
pub fn judge(gate: &Gate, value: Option<f64>) -> Judgement {
    let is_finite = value.is_some_and(f64::is_finite);
    let is_inside = value.is_some_and(|value| gate.bound.contains(value));
    let verdict = match (&gate.purpose, value) {
        (Purpose::Report, None) => Verdict::NotMeasured,
        (_, None) if gate.may_be_missing => Verdict::NotMeasured,
        (Purpose::Report, Some(_)) => Verdict::Reported,
        (Purpose::ExpectFailure, _) if is_finite && !is_inside => Verdict::ExpectedFailure,
        (Purpose::ExpectFailure, _) => Verdict::Fail,
        (_, _) if is_inside => Verdict::Pass,
        (Purpose::Limitation(reason), _) if is_finite => Verdict::Limitation(reason.clone()),
        (_, _) => Verdict::Fail,
    };
    let margin = value.and_then(|value| gate.bound.margin(value));
    Judgement { id: gate.id.clone(), verdict, value, margin }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gate(bound: Bound) -> Gate {
        Gate::new("case.metric", "metric", bound, Evidence::Analytic, "it is so")
    }

    const NOT_FINITE: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

    #[test]
    fn bounds_are_shown_without_rounding_dust() {
        assert_eq!(Bound::Below(0.1 + 0.2).to_string(), "at most 0.3");
        assert_eq!(Bound::Equals(300.0).to_string(), "exactly 300");
        assert_eq!(Bound::Within(-1e-10, 1.78398).to_string(), "-1e-10 to 1.78398");
    }

    #[test]
    fn only_a_finite_number_inside_passes() {
        let bounds =
            [Bound::Below(1.0), Bound::Above(1.0), Bound::Within(0.0, 1.0), Bound::Equals(1.0)];
        for bound in bounds {
            assert_eq!(gate(bound).judge(Some(1.0)).verdict, Verdict::Pass, "{bound}: its end");
            assert_eq!(gate(bound).judge(None).verdict, Verdict::Fail);
            for value in NOT_FINITE {
                let judgement = gate(bound).judge(Some(value));
                assert_eq!((judgement.verdict, judgement.margin), (Verdict::Fail, None));
            }
        }
        let outside = [1.0000000000000002, 0.9999999999999999, -5e-324, 0.0];
        for (bound, value) in bounds.into_iter().zip(outside) {
            assert!(gate(bound).judge(Some(value)).verdict.is_failure(), "{bound}: {value}");
        }
    }

    #[test]
    fn the_table_of_purposes_holds() {
        let plain = gate(Bound::Below(1.0));
        let limited = plain.clone().with_limitation("tensile instability");
        let known = Verdict::Limitation("tensile instability".into());
        let expected = [
            (plain.clone(), Verdict::Pass, Verdict::Fail, Verdict::Fail, Verdict::Fail),
            (limited, Verdict::Pass, known, Verdict::Fail, Verdict::Fail),
            (
                plain.clone().reported(),
                Verdict::Reported,
                Verdict::Reported,
                Verdict::Reported,
                Verdict::NotMeasured,
            ),
            (
                plain.clone().expected_to_fail(),
                Verdict::Fail,
                Verdict::ExpectedFailure,
                Verdict::Fail,
                Verdict::Fail,
            ),
            (
                plain.when_measured(),
                Verdict::Pass,
                Verdict::Fail,
                Verdict::Fail,
                Verdict::NotMeasured,
            ),
        ];
        for (gate, inside, outside, not_finite, missing) in expected {
            let purpose = &gate.purpose;
            assert_eq!(gate.judge(Some(0.5)).verdict, inside, "{purpose:?}");
            assert_eq!(gate.judge(Some(1.5)).verdict, outside, "{purpose:?}");
            for value in NOT_FINITE {
                assert_eq!(gate.judge(Some(value)).verdict, not_finite, "{purpose:?}");
            }
            assert_eq!(gate.judge(None).verdict, missing, "{purpose:?}");
        }
    }

    #[test]
    fn the_margin_is_what_is_left() {
        for (bound, value, margin) in [
            (Bound::Below(2.0), 0.5, 0.75),
            (Bound::Below(2.0), 3.0, -0.5),
            (Bound::Below(0.0), 0.25, -0.25),
            (Bound::Above(2.0), 3.0, 0.5),
            (Bound::Within(1.0, 3.0), 2.0, 1.0),
            (Bound::Within(1.0, 3.0), 3.0, 0.0),
            (Bound::Within(1.0, 3.0), 4.0, -1.0),
            (Bound::Equals(4.0), 3.0, -0.25),
            (Bound::Equals(0.0), 0.0, 0.0),
        ] {
            assert_eq!(gate(bound).judge(Some(value)).margin, Some(margin), "{bound}: {value}");
        }
    }

    #[test]
    fn an_unsound_gate_is_refused() {
        let sound = gate(Bound::Below(1.0));
        let refused = |gate: Gate| gate.check().unwrap_err();
        let silent = Gate { because: " ".into(), ..sound.clone() };
        assert_eq!(
            refused(silent).to_string(),
            "gate case.metric does not say why its bound has this value"
        );
        assert!(matches!(refused(sound.clone().with_limitation("")), GateError::NoReason { .. }));
        let nameless = Gate { metric: String::new(), ..sound.clone() };
        assert!(matches!(refused(nameless), GateError::NoName { .. }));
        for bound in [Bound::Below(f64::NAN), Bound::Within(1.0, 1.0), Bound::Within(1.0, 0.0)] {
            let unsound = Gate { bound, ..sound.clone() };
            assert!(matches!(refused(unsound), GateError::Bound { .. }));
        }
        let twice = check_all(&[sound.clone(), sound.clone()]);
        assert_eq!(twice, Err(GateError::Duplicate { id: "case.metric".into() }));
        assert_eq!(check_all(&[sound]), Ok(()));
    }

    #[test]
    #[should_panic(expected = "does not say why")]
    fn a_gate_without_a_reason_cannot_be_made() {
        Gate::new("case.metric", "metric", Bound::Below(1.0), Evidence::Theory, "");
    }

    #[test]
    fn judgements_round_trip_without_null() {
        for value in [Some(0.5), Some(f64::INFINITY), None] {
            let judgement = gate(Bound::Within(0.0, 1.0)).judge(value);
            let text = serde_json::to_string(&judgement).unwrap();
            assert!(!text.contains("null"), "{text}");
            assert_eq!(serde_json::from_str::<Judgement>(&text).unwrap(), judgement);
        }
    }
}
