//! Metrics of two runs of one problem, and which of them became worse.

use std::collections::{BTreeMap, BTreeSet};
use std::mem::discriminant;

use serde::Serialize;
use touchstone_base::{
    gate::{Bound, Gate},
    record::{Metric, name_and_mark},
};
use touchstone_harness::gates::GateIndex;

use super::output;

/// Metrics of a run by name.
pub type Metrics = BTreeMap<String, Metric>;

/// Share of the scale of a metric by which two values may differ and count as equal. The scale is the
/// scale of the bound of its gate, see [`Bound::scale`], or else the larger of the two values. One
/// percent is less than any bound allows, and more than rounding changes.
pub const SHARE: f64 = 0.01;

/// Dimensionless metrics are divided by a scale of the problem: differences below this come from rounding.
const ROUND_OFF: f64 = 1e-12;

/// How a metric changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Change {
    /// by no more than its resolution
    Same,
    /// further inside the bounds of its gates
    Better,
    /// it was not there
    New,
    /// no gate states which direction is better
    Changed,
    /// further outside the bounds of its gates, or not finite any more
    Worse,
    /// it is not there any more, or has another unit or formula
    Gone,
}

impl Change {
    /// The change of a value; `side` states which direction is better.
    pub fn of(side: Option<Bound>, before: f64, now: f64, resolution: f64) -> Self {
        match (before.is_finite(), now.is_finite()) {
            (false, false) if before == now || before.is_nan() && now.is_nan() => Self::Same,
            (false, false) => Self::Changed,
            (false, true) => Self::Better,
            (true, false) => Self::Worse,
            (true, true) if (now - before).abs() <= resolution => Self::Same,
            (true, true) => match side.map(|side| badness(side, now) - badness(side, before)) {
                None => Self::Changed,
                Some(more) if more > resolution => Self::Worse,
                Some(more) if -more > resolution => Self::Better,
                Some(_) => Self::Same,
            },
        }
    }

    /// Does it break the promise that nothing became worse?
    pub fn is_worse(self) -> bool {
        matches!(self, Self::Changed | Self::Worse | Self::Gone)
    }

    pub fn in_words(self, is_there: bool) -> &'static str {
        match self {
            Self::Same => "is equal",
            Self::Better => "is better",
            Self::New => "is new",
            Self::Changed => "changed",
            Self::Worse => "is worse",
            Self::Gone if is_there => "has another unit or formula",
            Self::Gone => "is gone",
        }
    }
}

/// A metric of two runs.
#[derive(Clone, Debug, Serialize)]
pub struct MetricChange {
    /// its name
    pub metric: String,
    /// its unit
    pub unit: String,
    /// the value of the first run, if it has one
    #[serde(with = "touchstone_base::number::option")]
    pub before: Option<f64>,
    /// the value of the second run, if it has one
    #[serde(with = "touchstone_base::number::option")]
    pub now: Option<f64>,
    /// the largest difference that counts as none
    #[serde(with = "touchstone_base::number")]
    pub resolution: f64,
    /// does a gate of these settings read the metric? Then the resolution is a share of its bound
    pub has_gate: bool,
    /// how it changed
    pub change: Change,
}

impl MetricChange {
    /// The line of a message: metric, value before, value now, resolution.
    pub fn in_words(&self) -> String {
        let Self { metric, unit, before, now, resolution, .. } = self;
        let unit = if unit == "-" { String::new() } else { format!(" {unit}") };
        let value =
            |of: &Option<f64>| of.map_or("not measured".into(), |of| format!("{of:?}{unit}"));
        let (before, now) = (value(before), value(now));
        let resolution = touchstone_report::sig(*resolution, 3);
        let (change, of) = (self.change.in_words(self.now.is_some()), self.scale());
        format!(
            "{metric} {change}: {before} before, {now} now, resolution {resolution}{unit} (1 % of the {of})"
        )
    }

    /// The number of which the resolution is a share.
    fn scale(&self) -> &'static str {
        if self.has_gate { "bound" } else { "value" }
    }

    fn row(&self) -> Vec<String> {
        let number = |of: Option<f64>| of.map_or("-".into(), |of| touchstone_report::sig(of, 5));
        let difference = self.before.zip(self.now).map(|(before, now)| now - before);
        let change = self.change.in_words(self.now.is_some()).to_string();
        vec![
            self.metric.clone(),
            self.unit.clone(),
            number(self.before),
            number(self.now),
            number(difference),
            number(Some(self.resolution)),
            self.scale().into(),
            change,
        ]
    }
}

/// Metrics as a table.
pub fn table(all: &[MetricChange]) -> String {
    let heads = ["metric", "unit", "before", "now", "difference", "resolution", "1 % of", "change"];
    output::table(&heads, all.iter().map(MetricChange::row))
}

/// All metrics of two runs of a case, by name; `gates` judge the later run.
pub fn changes<'a>(
    case: Option<&GateIndex>,
    gates: impl IntoIterator<Item = &'a Gate>,
    [before, now]: [&Metrics; 2],
) -> Vec<MetricChange> {
    let bounds: BTreeMap<&str, Bound> =
        gates.into_iter().map(|gate| (&*gate.metric, gate.bound)).collect();
    let names = before.keys().chain(now.keys()).collect::<BTreeSet<_>>();
    let one = |metric: &String| {
        let (was, is) = (before.get(metric), now.get(metric));
        let of = was.or(is)?;
        let [from, to] = [was, is].map(|of| of.map(|of| of.value));
        let bound = bounds.get(&**metric).copied();
        let resolution = resolution(bound, &of.unit, [from, to]);
        let change = match (was, is) {
            (Some(was), Some(is)) if (&was.unit, &was.formula) == (&is.unit, &is.formula) => {
                let side = bound.or_else(|| side(case?, metric));
                Change::of(side, was.value, is.value, resolution)
            }
            (None, _) => Change::New,
            _ => Change::Gone,
        };
        Some(MetricChange {
            metric: metric.clone(),
            unit: of.unit.clone(),
            before: from,
            now: to,
            resolution,
            has_gate: bound.is_some(),
            change,
        })
    };
    names.into_iter().filter_map(one).collect()
}

/// The bound that states the better side of a metric that no gate of the run reads: a one-sided bound of
/// gates of the case on this metric with any mark (`l2` of `l2@0.1`), if all of them have the same side.
fn side(case: &GateIndex, metric: &str) -> Option<Bound> {
    let gates = case.judged().iter().flat_map(|planned| &planned.gates);
    let of_metric = gates
        .filter(|gate| !gate.control && name_and_mark(&gate.metric).0 == name_and_mark(metric).0);
    let is_one_sided = |of: &Bound| matches!(of, Bound::Below(_) | Bound::Above(_));
    let mut bounds = of_metric.map(|gate| gate.bound).filter(is_one_sided);
    let first = bounds.next()?;
    bounds.all(|of| discriminant(&of) == discriminant(&first)).then_some(first)
}

/// How far a value is on the worse side of a bound.
fn badness(bound: Bound, value: f64) -> f64 {
    match bound {
        Bound::Below(_) => value,
        Bound::Above(_) => -value,
        Bound::Within(low, high) => (value - 0.5 * (low + high)).abs(),
        Bound::Equals(expected) => (value - expected).abs(),
    }
}

/// The largest difference of two values that counts as none.
fn resolution(bound: Option<Bound>, unit: &str, values: [Option<f64>; 2]) -> f64 {
    let largest = values
        .into_iter()
        .flatten()
        .filter(|of| of.is_finite())
        .fold(0.0, |most: f64, of| most.max(of.abs()));
    let share = SHARE * bound.map_or(largest, |bound| bound.scale());
    if unit == "-" { share.max(ROUND_OFF) } else { share }
}
