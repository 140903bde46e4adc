//! Facts of a case that depend on neither the tier nor a run: the data that metrics need, the facts that
//! another code must know, and when a run counts as stable.

use nalgebra::Vector2;
use touchstone_base::{
    gate::Gate,
    record::{ColumnKey, MetricKey, MetricName, Record},
    spec::{Measure, RunSpec},
};

/// Facts of a case.
#[derive(Default)]
pub struct Facts {
    /// The criterion of bisections: was this run stable? Without one a run is stable if it reaches its end.
    pub is_stable: Option<fn(&Record) -> bool>,
    /// The metrics with pair sweeps of their own, which a run measures only if a gate reads one of them or
    /// all metrics are requested.
    pub costly: &'static [MetricKey],
    /// The metrics that need the state after every step, which results of other codes do not have.
    pub stepwise: &'static [MetricKey],
    /// The metrics that compare with the theory of our own methods, which does not apply to other codes.
    pub of_methods: &'static [MetricKey],
    /// The metrics that are rates over a very short time, which results with few digits do not determine.
    pub of_all_digits: &'static [MetricKey],
    /// A variant that was added after the first results of other codes.
    pub late_variant: Option<&'static str>,
    /// Facts for another code in addition to the scene.
    pub statement: Statement,
    /// Metrics of a profile or a series from another code without particles.
    pub curve: Option<SubmittedCurve>,
    /// Drawn settings of sealed problems, and their judgement; `None` if no reference holds at drawn
    /// settings.
    pub sealed: Option<Draws>,
}

impl Facts {
    /// How much must be measured of a run with these gates.
    pub fn measure_for(&self, gates: &[Gate]) -> Measure {
        let mut costly = self.costly.iter().map(|metric| String::from(*metric));
        let is_read = costly.any(|metric| gates.iter().any(|gate| gate.metric == metric));
        if is_read { Measure::All } else { Measure::Headline }
    }
}

/// Facts of a problem for another code in addition to its scene.
#[derive(Clone, Default)]
pub struct Statement {
    /// The conditions at walls, clamps and surfaces in words.
    pub boundary: &'static str,
    /// Drives or motions of a run, in addition to its acceleration.
    pub further: Option<fn(&RunSpec) -> Vec<Parameter>>,
    /// Every metric of the case.
    pub metrics: Vec<MetricName>,
}

impl Statement {
    /// With these lists of metrics.
    pub fn new(boundary: &'static str, metrics: &[&[MetricKey]]) -> Self {
        let metrics = metrics.concat().into_iter().map(MetricName::from).collect();
        Self { boundary, further: None, metrics }
    }
}

/// A number of a problem that follows from its settings.
pub struct Parameter {
    /// Name.
    pub name: &'static str,
    /// Value.
    pub value: f64,
    /// SI unit.
    pub unit: &'static str,
    /// Description with the equation.
    pub about: &'static str,
}

/// A run, the rows at a time, and the positions at the start of the particles that move in their order, to
/// their positions and velocities.
type Place = fn(&RunSpec, &[Vec<f64>], &[Vector2<f64>]) -> Vec<[Vector2<f64>; 2]>;

/// A profile or a series from which some of the metrics follow.
pub struct SubmittedCurve {
    /// Names and units of its columns after the time.
    pub columns: &'static [(&'static str, &'static str)],
    /// The columns in words.
    pub about: &'static str,
    /// Least number of equidistant times; 0 if the times of the problem suffice.
    pub least: usize,
    /// Rows at each time of a run; the first column is ascending.
    pub rows: fn(&RunSpec) -> usize,
    /// Positions and velocities of particles that represent the rows at a time.
    pub place: Place,
    /// The metrics that follow from the curve, at any time; no other metric is measured.
    pub metrics: Vec<MetricKey>,
    /// The run in whose coarse scene it is measured, if neither its rows nor its times depend on the
    /// resolution. Then `export --solve` writes it in place of particles.
    pub coarsen: Option<fn(&RunSpec) -> RunSpec>,
    /// The columns of a record that show it, in one profile, whose name may have a time as mark.
    pub shown: &'static [ColumnKey],
}

/// Drawn settings of the sealed problems of a case, and their judgement.
#[derive(Clone, Copy)]
pub struct Draws {
    /// The variants whose errors change with the order below; all if none is named.
    pub variants: &'static [&'static str],
    /// The setting of the resolution, a number of spacings or a spacing that divides a length of 1, and the
    /// ends between which it is drawn.
    pub resolution: (&'static str, [f64; 2]),
    /// The formal order of the errors in the spacing.
    pub order: f64,
    /// The errors that may be judged; the judged ones are in the plans of the variant.
    pub metrics: &'static [&'static str],
    /// `key=value` of settings that all have.
    pub set: &'static [&'static str],
    /// Other settings that are drawn.
    pub others: &'static [(&'static str, Drawn)],
    /// Settings in which judged runs may differ, because they change none of the errors.
    pub free: &'static [&'static str],
}

impl Draws {
    /// Draws of a resolution alone, for errors of variants that change with an order.
    pub const fn new(
        variants: &'static [&'static str],
        resolution: (&'static str, [f64; 2]),
        order: f64,
        metrics: &'static [&'static str],
    ) -> Self {
        Self { variants, resolution, order, metrics, set: &[], others: &[], free: &[] }
    }
}

/// How a setting is drawn that is not the resolution.
#[derive(Clone, Copy)]
pub enum Drawn {
    /// Evenly in the logarithm between these ends, within the values of judged runs.
    Between(f64, f64),
    /// One of the values of judged runs.
    Judged,
    /// Uniform between these ends: reference and error do not depend on the value.
    Any(f64, f64),
}
