//! Gates: a metric, a bound, the kind of evidence behind the bound, and the reason for the bound.
//!
//! A gate passes only if the metric is a finite number inside the bound: NaN, infinity, a metric that was not
//! measured, and a run that ended early fail. A known limitation has its own bound, and a number outside this
//! bound fails too.
//!
//! ```
//! use touchstone_base::gate::{Bound, Evidence, Gate, Verdict};
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

use std::borrow::Cow;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::record::{Record, Status};

/// Allowed values of a metric; the ends belong to the bound.
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
    /// At most this in magnitude.
    pub const fn magnitude(most: f64) -> Self {
        Bound::Within(-most, most)
    }

    /// Is the number finite and inside?
    pub fn contains(self, value: f64) -> bool {
        let [low, high] = self.ends();
        value.is_finite() && low <= value && value <= high
    }

    /// The share of the allowance that a number inside leaves: 0 at an end, 1 as far inside as can be.
    ///
    /// The margin is 1 − value/end (`Below`), 1 − end/value (`Above`), or the distance from the nearer end
    /// over half the width (`Within`). `None` for a number outside the bound, for `Equals`, which has no
    /// width, and for a single end that is not above 0.
    pub fn margin(self, value: f64) -> Option<f64> {
        let margin = match self {
            Bound::Below(high) if high > 0.0 => 1.0 - value / high,
            Bound::Above(low) if low > 0.0 => 1.0 - low / value,
            Bound::Within(low, high) => (value - low).min(high - value) / (0.5 * (high - low)),
            _ => return None,
        };
        self.contains(value).then_some(margin.min(1.0))
    }

    /// Scale of a change of the metric: the end (`Below`, `Above`), half the width (`Within`) or the expected
    /// number (`Equals`), or 1 if that is zero.
    pub fn scale(self) -> f64 {
        let scale = match self {
            Bound::Below(end) | Bound::Above(end) | Bound::Equals(end) => end.abs(),
            Bound::Within(low, high) => 0.5 * (high - low),
        };
        if scale > 0.0 { scale } else { 1.0 }
    }

    fn is_sound(self) -> bool {
        match self {
            Bound::Below(end) | Bound::Above(end) | Bound::Equals(end) => end.is_finite(),
            Bound::Within(low, high) => low.is_finite() && high.is_finite() && low < high,
        }
    }

    /// Smallest and largest number inside.
    pub fn ends(self) -> [f64; 2] {
        match self {
            Bound::Below(high) => [f64::NEG_INFINITY, high],
            Bound::Above(low) => [low, f64::INFINITY],
            Bound::Within(low, high) => [low, high],
            Bound::Equals(expected) => [expected; 2],
        }
    }

    /// Is it sound, does it reach beyond the other bound, and is it limited on each side on which that one
    /// is?
    fn is_beyond(self, other: Self) -> bool {
        let ([low, high], [lowest, highest]) = (self.ends(), other.ends());
        let is_open = (low.is_infinite() && lowest.is_finite())
            || (high.is_infinite() && highest.is_finite());
        self.is_sound() && !is_open && (low < lowest || highest < high)
    }
}

impl Bound {
    /// The bound in words, its ends as `number` writes them.
    pub fn in_words(self, number: &dyn Fn(f64) -> String) -> String {
        match self {
            Bound::Below(high) => format!("at most {}", number(high)),
            Bound::Above(low) => format!("at least {}", number(low)),
            Bound::Within(low, high) => format!("{} to {}", number(low), number(high)),
            Bound::Equals(expected) => format!("exactly {expected}"),
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.in_words(&four_digits))
    }
}

/// Four significant digits at most, for people: `300`, `1.784`, `1e-10`.
pub fn four_digits(value: f64) -> String {
    let rounded = format!("{value:.3e}").parse().unwrap_or(value);
    let text = format!("{rounded:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_string)
}

/// The kind of evidence behind a bound, strongest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    /// an exact solution of the equations
    Analytic,
    /// a law that holds for every solution: conservation, symmetry, equal bits
    Invariant,
    /// the theory of the method: an order, a stability limit, a dispersion relation
    Theory,
    /// an experiment, or an independent computation with an uncertainty
    Reference,
    /// an earlier result of this program: shows changes, not errors
    Regression,
}

/// Why numbers are outside their bounds, for any number of gates.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Cause {
    /// the cause, a sentence
    pub what: Cow<'static, str>,
    /// the remedy, a sentence
    pub mend: Cow<'static, str>,
    /// does it state where numbers are wrong, and not why?
    #[serde(default)]
    pub unexplained: bool,
}

impl Cause {
    /// A cause and its remedy.
    pub const fn new(what: &'static str, mend: &'static str) -> Self {
        Self { what: Cow::Borrowed(what), mend: Cow::Borrowed(mend), unexplained: false }
    }

    /// An error whose cause is not known, or in part alone, and how it could be found.
    pub const fn unexplained(what: &'static str, mend: &'static str) -> Self {
        Self { what: Cow::Borrowed(what), mend: Cow::Borrowed(mend), unexplained: true }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unexplained = if self.unexplained { "Unexplained. " } else { "" };
        write!(f, "{unexplained}{} What would remove it: {}", self.what, self.mend)
    }
}

/// A metric, its bound and its reasons.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Gate {
    /// dotted name, starting with the case
    #[serde(rename = "gate")]
    pub id: String,
    /// name of the metric in the record
    pub metric: String,
    /// allowed values
    pub bound: Bound,
    /// bound of the known limitation, from the evidence for its cause: outside, the gate fails
    pub known: Option<Bound>,
    /// the kind of evidence behind the bound
    pub evidence: Evidence,
    /// the reason for the bound
    pub because: String,
    /// cause of the limitation, and source of its bound
    pub reason: Option<String>,
    /// whether the bound of the limitation was fitted to runs of this program, and so measures them rather
    /// than following from the cause
    #[serde(default)]
    pub fitted: bool,
    /// the cause that the limitation shares with other gates
    pub cause: Option<Cause>,
    /// whether the gate is a control, which must be outside its bound
    pub control: bool,
    /// is an early end of the run the limitation or the expected failure?
    pub may_end_early: bool,
    /// the bound for a code that does not state our own kernel, support and step, and why, if this bound
    /// rests on them
    #[serde(skip)]
    pub of_others: Option<(Bound, String)>,
}

impl Gate {
    /// A gate that judges and whose metric must be there.
    ///
    /// # Panics
    /// If the gate is unsound (see [`Gate::check`]): gates are part of the program, not input.
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
            known: None,
            evidence,
            because: because.into(),
            reason: None,
            fitted: false,
            cause: None,
            control: false,
            may_end_early: false,
            of_others: None,
        };
        gate.sound()
    }

    /// Lying outside is known, for a reason, as far as `bound` reaches: a number outside of that, NaN and
    /// a missing metric fail. The cause is shared with other limitations.
    ///
    /// # Panics
    /// If the gate is unsound with the limitation (see [`Gate::check`]).
    pub fn with_limitation(self, bound: Bound, reason: impl Into<String>, cause: &Cause) -> Self {
        let (known, reason, cause) = (Some(bound), Some(reason.into()), Some(cause.clone()));
        Gate { known, reason, cause, ..self }.sound()
    }

    /// Marks the bound of the limitation as fitted to runs of this program.
    pub fn fitted(self) -> Self {
        Gate { fitted: true, ..self }.sound()
    }

    /// Makes the gate a control: it requires a finite number outside the bound.
    pub fn expected_to_fail(self) -> Self {
        Gate { control: true, ..self }
    }

    /// A run that ends early counts as the limitation or as the failure that is expected.
    ///
    /// # Panics
    /// If the gate has neither.
    pub fn may_end_early(self) -> Self {
        Gate { may_end_early: true, ..self }.sound()
    }

    /// Adds the bound for codes with another kernel, support or step: an accuracy that any method of this
    /// resolution reaches, with its own reason.
    ///
    /// # Panics
    /// If the gate is unsound with the bound (see [`Gate::check`]).
    pub fn of_others(self, bound: Bound, because: impl Into<String>) -> Self {
        let because = because.into();
        Gate { bound, because: because.clone(), ..self.clone() }.sound();
        Gate { of_others: Some((bound, because)), ..self }
    }

    /// The gate for the run of another code; `states`: the code states our kernel, support and step. `None`
    /// if the bound is justified by these alone, or by earlier results of this program. Limitations and
    /// controls apply to our method only: for another code the bound alone counts.
    pub fn for_submission(self, states: bool) -> Option<Self> {
        let Gate { id, metric, bound, evidence, because, of_others, .. } = self;
        match of_others {
            _ if evidence == Evidence::Regression => None,
            _ if states => Some(Gate::new(id, metric, bound, evidence, because)),
            Some((bound, because)) => {
                Some(Gate::new(id, metric, bound, Evidence::Analytic, because))
            }
            None if evidence == Evidence::Theory => None,
            None => Some(Gate::new(id, metric, bound, evidence, because)),
        }
    }

    /// Panics unless it is sound.
    fn sound(self) -> Self {
        match self.check() {
            Ok(()) => self,
            Err(error) => panic!("{error}"),
        }
    }

    /// Has the gate a name, a metric, sound bounds and reasons?
    ///
    /// # Errors
    /// Checks the gate; an error is its fault.
    pub fn check(&self) -> Result<(), String> {
        let Gate { id, metric, bound, known, because, reason, .. } = self;
        let is_blank = |text: &str| text.trim().is_empty();
        if is_blank(id) || is_blank(metric) {
            return Err(format!(
                "a gate must have a name and a metric, but has the name {id:?} and the metric {metric:?}"
            ));
        }
        if is_blank(because) || known.is_some() && reason.as_deref().is_none_or(is_blank) {
            return Err(format!("gate {id} does not say why its bound has this value"));
        }
        let is_limited = known.is_some();
        if [reason.is_some(), self.cause.is_some()] != [is_limited; 2] || is_limited && self.control
        {
            return Err(format!(
                "gate {id} must have the bound, the reason and the cause of a limitation together, and no \
                 limitation if it is a control"
            ));
        }
        if self.fitted && !is_limited {
            return Err(format!("gate {id} has no limitation that could be fitted to runs"));
        }
        if !bound.is_sound() {
            return Err(format!(
                "the bound of gate {id} is {bound}, but its ends must be finite and in ascending order"
            ));
        }
        if self.may_end_early && known.is_none() && !self.control {
            return Err(format!(
                "gate {id} lets a run end early and names neither a limitation nor an expected failure"
            ));
        }
        match known {
            Some(known) if !known.is_beyond(*bound) => Err(format!(
                "the limitation of gate {id} is {known}, which must have finite ends in ascending order and \
                 reach beyond the gate's {bound} on one side"
            )),
            _ => Ok(()),
        }
    }

    /// The allowed values in words, with the bound of the limitation.
    pub fn bounds(&self) -> String {
        self.bounds_in(&four_digits)
    }

    /// The allowed values in words, with numbers formatted by `number`.
    pub fn bounds_in(&self, number: &dyn Fn(f64) -> String) -> String {
        let fitted = if self.fitted { ", fitted to own runs" } else { "" };
        let known = |known: Bound| format!("; limitation{fitted}: {}", known.in_words(number));
        self.bound.in_words(number) + &self.known.map(known).unwrap_or_default()
    }

    /// Judges a record: its metric by [`Gate::judge`] if the run reached its end. A run that ended early
    /// fails, unless the gate judges this end.
    pub fn judge_record(&self, record: &Record) -> Judgement {
        let verdict = match (self.may_end_early, self.control) {
            _ if record.status == Status::Completed => {
                return self.judge(record.metric(&self.metric));
            }
            (true, true) => Verdict::ExpectedFailure,
            (true, false) => Verdict::Limitation,
            (false, _) => Verdict::Fail,
        };
        Judgement { verdict, value: None, margin: None }
    }

    /// Judges a metric. Every gate passes only on a finite number inside its bound.
    ///
    /// | metric | plain gate | with a limitation | control |
    /// |---|---|---|---|
    /// | finite, inside | pass | pass | fail |
    /// | outside, inside the limitation's bound | fail | limitation | expected failure |
    /// | outside of both | fail | fail | expected failure |
    /// | NaN, infinite, missing | fail | fail | fail |
    pub fn judge(&self, value: Option<f64>) -> Judgement {
        let is_within = |bound: &Bound| value.is_some_and(|value| bound.contains(value));
        let is_inside = is_within(&self.bound);
        let (verdict, bound) = match self.known.filter(is_within) {
            _ if self.control && !is_inside && value.is_some_and(f64::is_finite) => {
                (Verdict::ExpectedFailure, None)
            }
            _ if self.control => (Verdict::Fail, None),
            _ if is_inside => (Verdict::Pass, Some(self.bound)),
            Some(known) => (Verdict::Limitation, Some(known)),
            None => (Verdict::Fail, None),
        };
        let margin = bound.zip(value).and_then(|(bound, value)| bound.margin(value));
        Judgement { verdict, value, margin }
    }
}

/// Result of a gate, in order of severity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// a finite number inside the bound
    Pass,
    /// a control that failed, as it must
    ExpectedFailure,
    /// outside for a known reason, and inside the bound of that reason
    Limitation,
    /// outside, not finite, missing, or a control that passed
    Fail,
}

impl Verdict {
    /// Every verdict, mildest first.
    pub const ALL: [Self; 4] = [Self::Pass, Self::ExpectedFailure, Self::Limitation, Self::Fail];

    /// Does it fail the run? Only [`Verdict::Fail`] does.
    pub fn is_failure(self) -> bool {
        self == Verdict::Fail
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Pass => f.write_str("pass"),
            Verdict::Fail => f.write_str("FAIL"),
            Verdict::Limitation => f.write_str("known limitation"),
            Verdict::ExpectedFailure => f.write_str("expected failure"),
        }
    }
}

/// A verdict with the number it rests on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    /// the result
    pub verdict: Verdict,
    /// the metric, if it was measured
    #[serde(with = "crate::number::option")]
    pub value: Option<f64>,
    /// remaining margin inside the bound of the gate, or else of its limitation, see [`Bound::margin`]
    #[serde(with = "crate::number::option")]
    pub margin: Option<f64>,
}

/// A gate and its judgement: in JSON an object of one level, from whose numbers the verdict follows.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Judged {
    /// The gate.
    #[serde(flatten)]
    pub gate: Gate,
    /// Unit of the metric; `None` if the record lacks it.
    pub unit: Option<String>,
    /// The judgement.
    #[serde(flatten)]
    pub judgement: Judgement,
}

impl Judged {
    /// Judges a number of a study without unit.
    pub fn new(gate: Gate, value: Option<f64>) -> Self {
        Self::in_unit("-", gate, value)
    }

    /// Judges a number of a study in this unit.
    pub fn in_unit(unit: &str, gate: Gate, value: Option<f64>) -> Self {
        let judgement = gate.judge(value);
        Self { gate, judgement, unit: Some(unit.into()) }
    }

    /// Judges the record of a run.
    pub fn of_record(gate: Gate, record: &Record) -> Self {
        let judgement = gate.judge_record(record);
        let unit = record.metrics.get(&gate.metric).map(|metric| metric.unit.clone());
        Self { gate, judgement, unit }
    }

    /// The reason of the limitation, if it is the verdict.
    pub fn limitation(&self) -> Option<&str> {
        let is_limited = self.judgement.verdict == Verdict::Limitation;
        self.gate.reason.as_deref().filter(|_| is_limited)
    }

    /// The verdict in words, with the reason of a limitation.
    pub fn words(&self) -> String {
        let reason = self.limitation().map(|reason| format!(": {reason}"));
        self.judgement.verdict.to_string() + &reason.unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gate(bound: Bound) -> Gate {
        Gate::new("case.metric", "metric", bound, Evidence::Analytic, "it is so")
    }

    const CAUSE: Cause = Cause::new("Rubber tears.", "Another rubber.");

    const NOT_FINITE: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

    #[test]
    fn bounds_are_shown_without_rounding_dust() {
        assert_eq!(Bound::Below(0.1 + 0.2).to_string(), "at most 0.3");
        assert_eq!(Bound::Equals(300.0).to_string(), "exactly 300");
        assert_eq!(Bound::Within(-1e-10, 1.78398).to_string(), "-1e-10 to 1.784");
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
        use Verdict::{ExpectedFailure, Fail, Limitation, Pass};
        let plain = gate(Bound::Below(1.0));
        let limited =
            plain.clone().with_limitation(Bound::Below(2.0), "tensile instability", &CAUSE);
        let expected = [
            (plain.clone(), [Pass, Fail, Fail, Fail]),
            (limited, [Pass, Limitation, Fail, Fail]),
            (plain.expected_to_fail(), [Fail, ExpectedFailure, ExpectedFailure, Fail]),
        ];
        for (gate, [inside, outside, far, none]) in expected {
            assert_eq!(gate.judge(Some(0.5)).verdict, inside, "{gate:?}");
            assert_eq!(gate.judge(Some(1.5)).verdict, outside, "{gate:?}");
            assert_eq!(gate.judge(Some(2.5)).verdict, far, "{gate:?}");
            for value in NOT_FINITE.map(Some).into_iter().chain([None]) {
                assert_eq!(gate.judge(value).verdict, none, "{gate:?}: {value:?}");
            }
        }
    }

    /// A run that diverged was "not measured": the gates of a method that broke down neither passed nor
    /// failed.
    #[test]
    fn an_early_end_fails_unless_the_gate_names_it() {
        let mut record = Record::new("case", "seed", serde_json::json!({}), 1);
        record.metrics.insert("metric".into(), crate::record::Metric::new(0.5, "-", "exact"));
        let plain = gate(Bound::Below(1.0));
        assert_eq!(plain.judge_record(&record).verdict, Verdict::Pass);
        record.status = Status::Interrupted { step: 3, time: 0.1 };
        let limited = plain.clone().with_limitation(Bound::Below(2.0), "it tears", &CAUSE);
        let control = plain.clone().expected_to_fail();
        for gate in [plain.clone(), limited.clone(), control.clone()] {
            let judgement = gate.judge_record(&record);
            assert_eq!((judgement.verdict, judgement.value), (Verdict::Fail, None), "{gate:?}");
        }
        let verdict = |gate: Gate| gate.may_end_early().judge_record(&record).verdict;
        assert_eq!(verdict(limited), Verdict::Limitation);
        assert_eq!(verdict(control), Verdict::ExpectedFailure);
        let silent = Gate { may_end_early: true, ..plain };
        assert!(silent.check().is_err_and(|words| words.contains("lets a run end early")));
    }

    #[test]
    fn a_limitation_has_a_bound_that_is_wider_than_the_gates() {
        let known = |bound: Bound, known: Bound| {
            let reason = Some("it is soft".into());
            Gate { known: Some(known), reason, cause: Some(CAUSE), ..gate(bound) }.check()
        };
        let within = Bound::Within(-0.1, 0.1);
        let whole = gate(within).with_limitation(Bound::Within(-0.5, 0.1), "it is soft", &CAUSE);
        let halves = [
            Gate { cause: None, ..whole.clone() },
            Gate { known: None, ..whole.clone() },
            Gate { control: true, ..whole },
        ];
        for half in halves {
            assert!(half.check().unwrap_err().contains("together"), "{half:?}");
        }
        for wider in [Bound::Within(-0.5, 0.1), Bound::Within(0.2, 0.5), Bound::Within(-1.0, 1.0)] {
            assert_eq!(known(within, wider), Ok(()), "{wider}");
        }
        assert_eq!(known(Bound::Equals(2.0), Bound::Within(2.0, 12.0)), Ok(()));
        assert_eq!(known(Bound::Above(0.0), Bound::Above(-0.2)), Ok(()));
        let refused = [
            (within, Bound::Within(-0.05, 0.1)),
            (within, Bound::Below(0.5)),
            (Bound::Below(1.0), Bound::Below(1.0)),
            (Bound::Below(1.0), Bound::Above(0.0)),
            (Bound::Below(1.0), Bound::Below(f64::INFINITY)),
        ];
        for (bound, narrow) in refused {
            let error = known(bound, narrow).unwrap_err();
            assert!(error.starts_with("the limitation of gate"), "{bound}, {narrow}");
        }
    }

    /// Counts that were exactly as expected passed with a margin of 0 %, and numbers outside had one of
    /// -14,891 %.
    #[test]
    fn the_margin_is_what_is_left_of_an_allowance() {
        for (bound, value, margin) in [
            (Bound::Below(2.0), 0.5, Some(0.75)),
            (Bound::Below(2.0), -1.0, Some(1.0)),
            (Bound::Below(2.0), 3.0, None),
            (Bound::Below(0.0), -0.25, None),
            (Bound::Above(2.0), 2.0, Some(0.0)),
            (Bound::Above(2.0), 200.0, Some(0.99)),
            (Bound::Above(0.0), 3.0, None),
            (Bound::Within(1.0, 3.0), 2.0, Some(1.0)),
            (Bound::Within(1.0, 3.0), 3.0, Some(0.0)),
            (Bound::Within(1.0, 3.0), 300.0, None),
            (Bound::Equals(4.0), 4.0, None),
            (Bound::Equals(0.0), 149.0, None),
        ] {
            assert_eq!(gate(bound).judge(Some(value)).margin, margin, "{bound}: {value}");
        }
        // Remaining margin of a limitation.
        let limited =
            gate(Bound::Below(1.0)).with_limitation(Bound::Below(4.0), "it is known", &CAUSE);
        let margins = [0.5, 3.0, 5.0].map(|value| limited.judge(Some(value)).margin);
        assert_eq!(margins, [Some(0.5), Some(0.25), None]);
    }

    #[test]
    fn an_unsound_gate_is_refused() {
        let sound = gate(Bound::Below(1.0));
        let refused = |gate: Gate| gate.check().unwrap_err();
        let silent = Gate { because: " ".into(), ..sound.clone() };
        assert_eq!(refused(silent), "gate case.metric does not say why its bound has this value");
        let known = Some(Bound::Below(2.0));
        let causeless = Gate { known, reason: Some(String::new()), ..sound.clone() };
        assert!(refused(causeless).contains("does not say why"));
        let nameless = Gate { metric: String::new(), ..sound.clone() };
        assert!(refused(nameless).contains("must have a name"));
        for bound in [Bound::Below(f64::NAN), Bound::Within(1.0, 1.0), Bound::Within(1.0, 0.0)] {
            let unsound = Gate { bound, ..sound.clone() };
            assert!(refused(unsound).starts_with("the bound of gate"));
        }
        assert_eq!(sound.check(), Ok(()));
    }

    #[test]
    #[should_panic(expected = "does not say why")]
    fn a_gate_without_a_reason_cannot_be_made() {
        Gate::new("case.metric", "metric", Bound::Below(1.0), Evidence::Theory, "");
    }
}
