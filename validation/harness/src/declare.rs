//! The declaration of a case, from which the studies common to all cases are made: curves compared with
//! their reference, order of accuracy, error against cost, error budget, largest stable time step, maps. A
//! declaration is plain data for one tier. [`crate::studies`] turns it into runs and the records of these
//! runs into studies.

use std::fmt;

use nalgebra::Vector2;
use serde_json::Value;
use touchstone_base::{
    gate::{Cause, Gate},
    mutation::{Constant, Detect, Mutation},
    record::{MetricKey, MetricName, Record, Status},
    spec::{Bisect, Measure, RunSpec},
};
use touchstone_report::{Axis, Colour, ColourMap};

use crate::{
    rules::Rules,
    runs::{Planned, Runs, Tier},
    study::Study,
};

/// The declaration of one case for one tier.
#[derive(Default)]
pub struct Declaration {
    /// Summary of the case at the top of the report.
    pub card: Option<Card>,
    /// Profiles or histories over their reference.
    pub curves: Vec<Curves>,
    /// Particles of some runs.
    pub pictures: Vec<Picture>,
    /// Resolution ladders: order, error against cost.
    pub accuracy: Vec<Accuracy>,
    /// Comparisons with references whose uncertainty is stated.
    pub comparisons: Vec<Comparison>,
    /// Runs that differ by next to nothing at the start.
    pub ensembles: Option<Ensembles>,
    /// Contributions to the error of the first ladders.
    pub budgets: Budgets,
    /// Largest stable time steps.
    pub limits: StepLimits,
    /// Was this run stable? The criterion of bisections; without one a run is stable if it reaches its end.
    pub is_stable: Option<fn(&Record) -> bool>,
    /// Outcomes over two settings.
    pub maps: Vec<Map>,
    /// Errors of constants that the gates must detect.
    pub sensitivity: Option<Sensitivity>,
    /// The metrics with pair sweeps of their own, which a run measures only if a gate reads one of them or
    /// all metrics are requested.
    pub costly: &'static [MetricKey],
    /// The metrics that need the state after every step, which results of other codes do not have.
    pub stepwise: &'static [MetricKey],
    /// The metrics that compare with the theory of our own methods, which does not apply to other codes.
    pub of_methods: &'static [MetricKey],
    /// The metrics that are rates over a very short time, which results with few digits do not determine.
    pub of_all_digits: &'static [MetricKey],
    /// Facts for another code in addition to the scene.
    pub posed: Posed,
    /// Metrics of a profile or a series from another code without particles.
    pub curve: Option<Curve>,
    /// Drawn settings of sealed problems, and their judgement; `None` if no reference holds at drawn
    /// settings.
    pub sealed: Option<Draws>,
    /// Studies of this case alone.
    pub studies: Option<OwnStudies>,
}

/// Studies of a case, a pure function of the records of its plan.
pub type OwnStudies = Box<dyn Fn(&Runs) -> Vec<Study> + Send + Sync>;

/// Facts of a problem for another code in addition to its scene.
#[derive(Clone, Default)]
pub struct Posed {
    /// The conditions at walls, clamps and surfaces in words.
    pub boundary: &'static str,
    /// Drives or motions of a run with these settings, in addition to its acceleration.
    pub further: Option<fn(&Value) -> Vec<Fact>>,
    /// Every metric of the case.
    pub metrics: Vec<MetricName>,
}

impl Posed {
    /// With these lists of metrics.
    pub fn new(boundary: &'static str, metrics: &[&[MetricKey]]) -> Self {
        let metrics = metrics.concat().into_iter().map(MetricName::from).collect();
        Self { boundary, further: None, metrics }
    }
}

/// A number of a problem that follows from its settings.
pub struct Fact {
    /// Name.
    pub name: &'static str,
    /// Value.
    pub value: f64,
    /// SI unit.
    pub unit: &'static str,
    /// Description with the equation.
    pub about: &'static str,
}

/// Settings, the rows at a time, and the positions at the start of the particles that move in their order, to
/// their positions and velocities.
type Place = fn(&Value, &[Vec<f64>], &[Vector2<f64>]) -> Vec<[Vector2<f64>; 2]>;

/// A profile or a series from which some of the metrics follow.
pub struct Curve {
    /// Names and units of its columns after the time.
    pub columns: &'static [(&'static str, &'static str)],
    /// The columns in words.
    pub about: &'static str,
    /// Least number of equidistant times; 0 if the times of the problem suffice.
    pub least: usize,
    /// Rows at each time, for a run with these settings; the first column is ascending.
    pub rows: fn(&Value) -> usize,
    /// Positions and velocities of particles that represent the rows at a time.
    pub place: Place,
    /// The metrics that follow from the curve, at any time; no other metric is measured.
    pub metrics: Vec<MetricKey>,
    /// Makes the scene coarse in which it is measured, if neither its rows nor its times depend on the
    /// resolution. Then `export --solve` writes it in place of particles.
    pub coarsen: Option<fn(&mut Value)>,
    /// How the names of the profiles of a record begin that show it, and their columns.
    pub shown: (&'static str, &'static [&'static str]),
}

/// Drawn settings of the sealed problems of a case, and their judgement.
#[derive(Clone, Copy)]
pub struct Draws {
    /// The variants whose errors change with the order below; all if none is named.
    pub variants: &'static [&'static str],
    /// The setting of the resolution, a number of spacings or a spacing of which a whole number is a length
    /// of 1, and the ends between which it is drawn.
    pub resolution: (&'static str, [f64; 2]),
    /// The formal order of the errors in the spacing.
    pub order: f64,
    /// The errors that may be judged; the judged ones are in the plans of the variant.
    pub metrics: &'static [&'static str],
    /// `key=value` of settings that all have.
    pub set: &'static [&'static str],
    /// Other settings that are drawn.
    pub others: &'static [(&'static str, Drawn)],
    /// Settings in which judged runs may differ, for they change none of the errors.
    pub free: &'static [&'static str],
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

/// Summary of a case at the top of the report: its error with the recommended variant and with the paper's.
pub struct Card {
    /// Name of the problem.
    pub title: &'static str,
    /// The figure with the picture: its first panel that shows the first of the runs, at any resolution
    /// ([`Declaration::pictured`]).
    pub picture: &'static str,
    /// The error.
    pub metric: MetricName,
    /// Name of its magnitude with its unit, for axes.
    pub axis: &'static str,
    /// The words for the error of a run with these settings.
    pub stated: fn(&Value) -> Stated,
    /// Further numbers of a run in a sentence, if it has them.
    pub beside: Option<fn(&Record) -> Option<String>>,
    /// The run of the recommended variant and the run of the paper's.
    pub runs: Vec<RunSpec>,
    /// Where runs of these variants break.
    pub breaks: Breaks,
}

impl Card {
    /// The card of a case that a test makes up, which breaks nowhere.
    #[doc(hidden)]
    pub fn made_up(metric: MetricKey, setting: &'static str, runs: Vec<RunSpec>) -> Self {
        let stated = |_: &Value| Stated {
            name: "made up".into(),
            against: "nothing",
            uncertainty: None,
            unit: "",
        };
        let breaks = Breaks { setting, words: ["", ""], has_broken: |_| Some(false), sign: "" };
        let (title, picture, metric) = ("Main", "none", metric.into());
        Card { title, picture, metric, axis: "error [-]", stated, beside: None, runs, breaks }
    }
}

/// The words for an error, which depend on the settings of the run.
pub struct Stated {
    /// Name, with the conditions of the run.
    pub name: String,
    /// The reference.
    pub against: &'static str,
    /// Standard uncertainty of the reference, in the unit of the error; none if it is exact.
    pub uncertainty: Option<f64>,
    /// Unit of the error; empty for a share, which is shown in per cent.
    pub unit: &'static str,
}

impl Stated {
    /// A setting as it is written in the words.
    pub fn setting(settings: &Value, name: &str) -> String {
        settings[name].as_f64().map_or_else(|| settings[name].to_string(), touchstone_report::exact)
    }

    /// A number in the unit of the error.
    pub fn number(&self, value: f64) -> String {
        if self.unit.is_empty() {
            return touchstone_report::percent(value, 2);
        }
        format!("{}\u{a0}{}", touchstone_report::sig(value, 2), self.unit)
    }

    /// The name and the reference.
    pub fn in_words(&self) -> String {
        let uncertainty = self.uncertainty.map(|u| format!(" (± {})", self.number(u)));
        format!("{}, against {}{}", self.name, self.against, uncertainty.unwrap_or_default())
    }
}

/// The setting over which a case looks for the value at which runs break.
pub struct Breaks {
    /// The setting.
    pub setting: &'static str,
    /// The words before and after its values.
    pub words: [&'static str; 2],
    /// Whether the result of a run is broken although it may have reached its end; none if the run does not
    /// answer the question, such as a control.
    pub has_broken: fn(&Record) -> Option<bool>,
    /// The sign of that in words.
    pub sign: &'static str,
}

/// A comparison with a reference: exact, or with an uncertainty by ASME V&V 20.
#[derive(Clone)]
pub struct Comparison {
    /// The compared quantity, with its unit if it is a length or a velocity.
    pub what: String,
    /// The reference.
    pub against: &'static str,
    /// E = S − D, result less data; of a norm its magnitude.
    pub metric: MetricName,
    /// The runs, coarse to fine: E is the error of the finest.
    pub levels: Vec<Level>,
    /// Pairs of runs: as it is, and with one input changed by its own uncertainty.
    pub inputs: Vec<[RunSpec; 2]>,
    /// u_D, in the unit of E.
    pub reference: f64,
    /// Where u_input and u_D come from.
    pub because: &'static str,
}

impl Comparison {
    /// A comparison of a ladder with the inputs of the reference, so that u_input is 0.
    pub fn new(
        what: &str,
        against: &'static str,
        metric: impl Into<MetricName>,
        ladder: &Ladder,
        (reference, because): (f64, &'static str),
    ) -> Self {
        let (what, levels) = (format!("`{}`: {what}", ladder.variant), ladder.levels.clone());
        let (metric, inputs) = (metric.into(), Vec::new());
        Self { what, against, metric, levels, inputs, reference, because }
    }

    /// Whether neither the reference nor the input has an uncertainty.
    pub fn is_exact(&self) -> bool {
        self.reference == 0.0 && self.inputs.is_empty()
    }
}

/// The ensembles of a case: runs that differ only by a small disorder of their start. Before their horizon
/// all members agree; after it each is one sample of a distribution.
pub struct Ensembles {
    /// The runs, in one or two sentences.
    pub about: String,
    /// Name of the time, and its unit.
    pub time: [&'static str; 2],
    /// The ensembles.
    pub of: Vec<Ensemble>,
}

/// The runs of one variant that differ in the seed of their disorder.
pub struct Ensemble {
    /// Name with which its gates begin.
    pub id: String,
    /// Name of the variant.
    pub variant: &'static str,
    /// The resolution in words, such as `H/dx = 20`.
    pub label: String,
    /// Its runs.
    pub members: Vec<RunSpec>,
    /// Quantities over time.
    pub histories: Vec<History>,
    /// The numbers whose distribution is shown.
    pub numbers: Vec<Number>,
    /// Is it drawn?
    pub is_drawn: bool,
}

/// A history, by which members part.
pub struct History {
    /// Name with its unit, as for an axis.
    pub name: String,
    /// Points of a record.
    pub points: PointsOf,
    /// Members part where they differ by more than this, the standard uncertainty of the experiment.
    pub tolerance: f64,
    /// Points of each experiment.
    pub measured: Vec<Vec<(f64, f64)>>,
    /// Is it drawn?
    pub is_drawn: bool,
    /// A gate on the time until which all members agree.
    pub gate: Option<Gate>,
}

/// A number of a record.
pub type NumberOf = Box<dyn Fn(&Record) -> Option<f64> + Send + Sync>;

/// A number that each member gives, and which has a distribution.
pub struct Number {
    /// Name, and unit.
    pub name: [&'static str; 2],
    /// Value of a record, if measured.
    pub value: NumberOf,
    /// Value of each experiment.
    pub measured: Vec<f64>,
    /// A gate on the median.
    pub gate: Option<Gate>,
}

/// Error against spacing and against cost.
pub struct Accuracy {
    /// Anchor of its studies in the report: the case in letters, digits and hyphens, and a suffix if the case
    /// has several.
    pub id: String,
    /// The error: the distance from an exact solution or a reference. For a metric with a sign, its
    /// magnitude.
    pub error: MetricName,
    /// Name of the error with its unit, for axes.
    pub label: String,
    /// Runs and comparison, in one or two sentences.
    pub about: String,
    /// Name of the spacing with its unit, for axes.
    pub spacing: &'static str,
    /// The formal order of the method, drawn as a grey line; none if nothing is known. Errors with one order
    /// are called asymptotic only if it is this one.
    pub slope: Option<f64>,
    /// One ladder of resolutions per variant, coarse to fine.
    pub ladders: Vec<Ladder>,
}

impl Declaration {
    /// The error of the case: of its card, or else of its first ladder.
    pub fn error(&self) -> Option<&MetricName> {
        let ladder = self.accuracy.first().map(|accuracy| &accuracy.error);
        self.card.as_ref().map(|card| &card.metric).or(ladder)
    }
}

/// The magnitude of this metric of a run that reached its end, which is its error.
pub fn error_of(metric: &MetricName, record: &Record) -> Option<f64> {
    let value = record.value(metric.clone()).filter(|_| record.status == Status::Completed);
    value.map(f64::abs).filter(|value| value.is_finite())
}

/// Runs of one variant over resolutions.
pub struct Ladder {
    /// Name of the variant.
    pub variant: &'static str,
    /// The runs, coarse to fine.
    pub levels: Vec<Level>,
    /// Gate on the order, if it is judged.
    pub order: Option<Gate>,
}

impl Ladder {
    /// Adds a run before the finer ones; its spacing, and its resolution in words.
    pub fn add(&mut self, run: &Planned, (spacing, resolution): (f64, Resolution)) {
        let place = self.levels.partition_point(|level| level.spacing >= spacing);
        self.levels.insert(place, Level { run: run.clone(), spacing, resolution });
    }
}

/// A run at a resolution, such as one of a ladder.
#[derive(Clone)]
pub struct Level {
    /// The run and its gates.
    pub run: Planned,
    /// Spacing, in the unit of [`Accuracy::spacing`].
    pub spacing: f64,
    /// The resolution in words.
    pub resolution: Resolution,
}

/// A resolution: how many there are of something, such as 20 of `{} rows`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Resolution {
    /// How many.
    pub count: usize,
    words: &'static str,
}

impl Resolution {
    /// A resolution of `count`, with words in which `{}` is replaced by the number.
    pub fn new(count: usize, words: &'static str) -> Self {
        Self { count, words }
    }

    /// The resolution refined by a factor, rounded to a whole number.
    pub fn finer(self, times: f64) -> Self {
        Self { count: (self.count as f64 * times).round() as usize, ..self }
    }
}

impl fmt::Display for Resolution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words.replace("{}", &self.count.to_string()))
    }
}

/// Error budgets: one run with one thing changed at a time.
#[derive(Default)]
pub struct Budgets {
    /// The runs, in one or two sentences.
    pub about: String,
    /// The changes of each variant; the first one is none.
    pub of: Vec<Vec<Change>>,
}

/// A run with one thing changed.
pub struct Change {
    /// The change, such as `dt/2`.
    pub what: String,
    /// The part of the error that this changes; `time` is the time step.
    pub part: &'static str,
    /// The run.
    pub spec: RunSpec,
    /// Index of the change that it is compared with; mostly 0.
    pub against: usize,
}

impl Accuracy {
    /// No ladders yet. Arguments: id of the studies, the error metric, and the name of the error with its
    /// unit. Spacings are in units of a length of the problem; the expected order is 2.
    pub fn new(id: &str, error: impl Into<MetricName>, label: &str) -> Self {
        let (id, label, about) = (id.to_string(), label.to_string(), String::new());
        let error = error.into();
        let (spacing, slope) = ("Δx [-]", Some(2.0));
        Self { id, error, label, about, spacing, slope, ladders: Vec::new() }
    }

    /// The runs of these variants with the finest spacing of their ladders.
    pub fn finest(&self, variants: &[&str]) -> Vec<RunSpec> {
        let ladder = |name: &&str| self.ladders.iter().find(|ladder| ladder.variant == *name);
        let finest = variants.iter().filter_map(ladder).filter_map(|ladder| ladder.levels.last());
        finest.map(|level| level.run.spec.clone()).collect()
    }
}

impl StepLimit {
    /// The bisection of a setting that is the time step over its theoretical limit, or proportional to it:
    /// the setting has the value `unit` at the limit. `rules` are the step rules of the run with its default
    /// step. The gate judges the largest stable step over the limit.
    pub fn proportional(
        scene: &str,
        spec: RunSpec,
        (setting, unit): (&str, f64),
        rules: &Rules,
        gate: Option<Gate>,
    ) -> Self {
        let setting = setting.to_string();
        let bisect = Bisect { setting, guess: 1.0, unit, resolution: 0.02, end: None };
        Self {
            scene: scene.into(),
            spec: spec.allow_unstable().bisect(bisect),
            theory_at: 1.0,
            theory: rules.dt_limit(),
            default_at: rules.dt() / rules.dt_limit(),
            gate,
        }
    }
}

impl Change {
    /// A change that is compared with the unchanged run.
    pub fn new(what: impl Into<String>, part: &'static str, spec: RunSpec) -> Self {
        Self { what: what.into(), part, spec, against: 0 }
    }
}

/// Largest stable time steps against theory.
#[derive(Default)]
pub struct StepLimits {
    /// The runs and the criterion of stability, in one or two sentences.
    pub about: String,
    /// One per variant and scene.
    pub of: Vec<StepLimit>,
}

/// The largest stable time step of one variant.
pub struct StepLimit {
    /// The scene in words.
    pub scene: String,
    /// The bisection.
    pub spec: RunSpec,
    /// Theoretical limit \[s\].
    pub theory: f64,
    /// The x of the bisection at the theoretical limit.
    pub theory_at: f64,
    /// The x of the bisection at the default step.
    pub default_at: f64,
    /// A gate on the largest stable step over the theoretical limit.
    pub gate: Option<Gate>,
}

/// Errors of the constants of a case that the gates of some of its runs must detect.
pub struct Sensitivity {
    /// The runs, each judged by the gates that the plans have for it.
    pub runs: Vec<RunSpec>,
    /// The constants.
    pub of: Vec<Watched>,
    /// Are smaller errors than the largest that may go undetected tried?
    pub is_bisected: bool,
}

/// A constant, an error of which the gates must detect.
pub struct Watched {
    /// The constant.
    pub constant: Constant,
    /// Where the gates do not detect the largest allowed error: the errors that they detect, and the reason.
    pub blind: Option<Blind>,
    /// Is the allowed error tried in the quick tier too?
    pub is_quick: bool,
    /// Factors of gross faults, such as -1 for a wrong sign and 0 for a term that is missing.
    pub faults: Vec<f64>,
}

/// How blind the gates are to errors of a constant.
pub struct Blind {
    /// The relative error that they do detect, 1 for none up to 30 % \[-\].
    pub up_to: f64,
    /// The reason for this constant.
    pub why: &'static str,
    /// The cause that it shares with other constants.
    pub cause: &'static Cause,
}

impl Watched {
    /// A constant whose allowed error the gates detect.
    pub fn new(constant: Constant) -> Self {
        Self { constant, blind: None, is_quick: false, faults: Vec::new() }
    }

    /// Tries the allowed error in the quick tier as well.
    pub fn quick(self) -> Self {
        Self { is_quick: true, ..self }
    }

    /// Adds gross faults, each of which some gate must detect: factors of the constant.
    pub fn faults(self, factors: &[f64]) -> Self {
        Self { faults: factors.to_vec(), ..self }
    }

    /// A constant to which the gates are blind up to an error, 1 if they are up to 30 %, for a reason and by
    /// a cause of [`crate::studies::causes`].
    pub fn blind_up_to(
        constant: Constant,
        up_to: f64,
        why: &'static str,
        cause: &'static Cause,
    ) -> Self {
        Self { blind: Some(Blind { up_to, why, cause }), ..Self::new(constant) }
    }
}

impl Sensitivity {
    /// The full tier bisects every constant and makes every gross fault. The quick tier tries, on the first
    /// run alone, the largest allowed error of the constants that are marked for it.
    pub fn new(
        tier: Tier,
        runs: impl IntoIterator<Item = RunSpec>,
        of: impl IntoIterator<Item = Watched>,
    ) -> Self {
        let is_bisected = tier == Tier::Full;
        let mut of: Vec<Watched> = of.into_iter().collect();
        let mut runs: Vec<RunSpec> = runs.into_iter().collect();
        if !is_bisected {
            of.retain(|watched| watched.is_quick);
            of.iter_mut().for_each(|watched| watched.faults.clear());
            runs.truncate(1);
        }
        Self { runs, of, is_bisected }
    }

    /// The searches for a constant, one a run.
    pub fn searches(&self, constant: Constant) -> impl Iterator<Item = RunSpec> {
        let detect = Detect { of: constant, only_allowed: !self.is_bisected };
        self.runs.iter().map(move |run| run.clone().detect(detect))
    }

    /// The runs with a constant multiplied by a factor.
    pub fn faulty(&self, of: Constant, factor: f64) -> impl Iterator<Item = (&RunSpec, RunSpec)> {
        let mutation = Mutation { of, factor };
        let faulty = |run: &RunSpec| run.clone().allow_unstable().measure_all();
        self.runs.iter().map(move |run| (run, faulty(run).mutated(mutation)))
    }
}

/// Outcomes over two settings.
pub struct Map {
    /// Anchor of the study and of its figure.
    pub id: String,
    /// Title of the section.
    pub title: String,
    /// Caption of the figure.
    pub caption: String,
    /// Name of the horizontal setting, with its unit.
    pub x: String,
    /// Name of the vertical setting, with its unit.
    pub y: String,
    /// The possible outcomes of a cell, in the order of the legend.
    pub outcomes: Vec<(String, Colour)>,
    /// Panels side by side.
    pub panels: Vec<MapPanel>,
    /// The outcome of a cell from its records, as an index of `outcomes`, and a short text. A run that was
    /// refused has a record too.
    pub outcome: fn(&[&Record]) -> (usize, String),
}

/// One panel of a map.
pub struct MapPanel {
    /// Title of the panel.
    pub title: String,
    /// Values of the horizontal setting, left to right.
    pub x: Vec<String>,
    /// Values of the vertical setting, bottom to top.
    pub y: Vec<String>,
    /// `cells[row][column]`: the runs of a cell; none if it is not run.
    pub cells: Vec<Vec<Vec<RunSpec>>>,
}

impl MapPanel {
    /// A panel over values of two settings; `cell(x, y)` are the runs of a cell.
    pub fn over<A: Copy + ToString, B: Copy + ToString>(
        title: &str,
        x: &[A],
        y: &[B],
        cell: impl Fn(A, B) -> Vec<RunSpec>,
    ) -> Self {
        let row = |y: &B| x.iter().map(|x| cell(*x, *y)).collect();
        let cells = y.iter().map(row).collect();
        let (x, y) = (x.iter().map(A::to_string).collect(), y.iter().map(B::to_string).collect());
        Self { title: title.into(), x, y, cells }
    }
}

/// Curves over their reference.
pub struct Curves {
    /// Anchor of the study and of its figure.
    pub id: String,
    /// Title of the section.
    pub title: String,
    /// Caption of the figure.
    pub caption: String,
    /// The panels, row by row.
    pub panels: Vec<CurvePanel>,
}

/// Particles of some runs, coloured by a stored value.
pub struct Picture {
    /// Anchor of the study and of its figure, title of the section, caption.
    pub texts: [&'static str; 3],
    /// Name of the colour bar with its unit, and its colours.
    pub colours: (&'static str, ColourMap),
    /// Width and height of a panel \[px\].
    pub size: [f64; 2],
    /// The panels.
    pub panels: Vec<PicturePanel>,
    /// Number of panels in a row.
    pub columns: usize,
    /// The shown function of the value of a particle, such as its logarithm.
    pub shown: fn(f64) -> f64,
    /// Ends of the colour range for all panels; `None`: each panel has the range of its values.
    pub range: Option<[f64; 2]>,
}

/// One panel of a picture.
pub struct PicturePanel {
    /// Title of the panel.
    pub title: String,
    /// A run that keeps particles.
    pub spec: RunSpec,
    /// The profile of its record that has them.
    pub profile: String,
    /// Their spacing, in the unit of their places.
    pub spacing: f64,
    /// Lines over the particles, in the same unit.
    pub lines: Vec<Vec<(f64, f64)>>,
}

/// One panel of curves.
pub struct CurvePanel {
    /// Title of the panel.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves of runs.
    pub lines: Vec<CurveOf>,
    /// Curves of references: name and points. A curve without name is drawn as a guide.
    pub references: Vec<(String, Vec<(f64, f64)>)>,
    /// Are curves of runs drawn as symbols?
    pub symbols: bool,
}

/// A curve of a run.
pub struct CurveOf {
    /// Name in the legend.
    pub name: String,
    /// The run.
    pub spec: RunSpec,
    /// Points of a record.
    pub points: PointsOf,
}

/// Points of a curve from a record.
pub type PointsOf = Box<dyn Fn(&Record) -> Vec<(f64, f64)> + Send + Sync>;

impl CurveOf {
    /// Two columns of a profile of a run.
    pub fn columns(
        name: impl Into<String>,
        spec: RunSpec,
        profile: &'static str,
        [x, y]: [&'static str; 2],
    ) -> Self {
        let points = move |record: &Record| {
            let [x, y] = [x, y].map(|name| record.column(profile, name).iter().copied());
            x.zip(y).collect()
        };
        Self { name: name.into(), spec, points: Box::new(points) }
    }
}

impl CurvePanel {
    /// Lines over one reference, on linear axes.
    pub fn linear(
        title: &str,
        [x, y]: [&str; 2],
        lines: Vec<CurveOf>,
        (name, points): (&str, Vec<(f64, f64)>),
    ) -> Self {
        let (title, references) = (title.into(), vec![(name.into(), points)]);
        let (x, y) = (Axis::linear(x), Axis::linear(y));
        Self { title, x, y, lines, references, symbols: false }
    }
}

impl Declaration {
    /// A value of this error, of a run, in its unit.
    pub fn number(&self, record: &Record, value: f64) -> String {
        if let Some(card) = &self.card {
            return (card.stated)(&record.run.settings).number(value);
        }
        let metric = self.error().and_then(|metric| record.metrics.get(&metric.name));
        match metric.map_or("-", |metric| &*metric.unit) {
            "-" | "1" => touchstone_report::percent(value, 2),
            unit => format!("{}\u{a0}{unit}", touchstone_report::sig(value, 2)),
        }
    }

    /// The panel of the figure on the card: the first that shows the first run of the card, at any resolution
    /// of the ladders of the case.
    pub fn pictured(&self, card: &Card) -> Option<usize> {
        let wanted = card.runs.first()?;
        let levels = self.accuracy.iter().flat_map(|accuracy| &accuracy.ladders);
        let levels: Vec<&RunSpec> =
            levels.flat_map(|ladder| &ladder.levels).map(|level| &level.run.spec).collect();
        let is_resolution = |name: &str| {
            let values = levels.iter().filter(|spec| spec.variant == wanted.variant);
            let mut values = values.map(|spec| &spec.settings[name]);
            values.next().is_some_and(|first| values.any(|value| value != first))
        };
        let is_shown = |spec: &RunSpec| {
            let (Some(a), Some(b)) = (spec.settings.as_object(), wanted.settings.as_object())
            else {
                return false;
            };
            let differ = a.iter().filter(|(name, value)| b.get(*name) != Some(*value));
            spec.variant == wanted.variant
                && differ.into_iter().all(|(name, _)| is_resolution(name))
        };
        let curves = self.curves.iter().find(|curves| curves.id == card.picture).map(|curves| {
            let shows = |panel: &CurvePanel| panel.lines.iter().any(|line| is_shown(&line.spec));
            curves.panels.iter().position(shows)
        });
        let pictures = self.pictures.iter().find(|picture| picture.texts[0] == card.picture);
        let place = |of: &Picture| of.panels.iter().position(|panel| is_shown(&panel.spec));
        curves.unwrap_or_else(|| pictures.and_then(place))
    }

    /// How much must be measured of a run with these gates.
    pub fn measure_for(&self, gates: &[Gate]) -> Measure {
        let mut costly = self.costly.iter().map(|metric| String::from(*metric));
        let is_read = costly.any(|metric| gates.iter().any(|gate| gate.metric == metric));
        if is_read { Measure::All } else { Measure::Headline }
    }

    /// Every run that the studies need.
    pub fn runs(&self) -> Vec<Planned> {
        let mut runs = Vec::new();
        for accuracy in &self.accuracy {
            let levels = accuracy.ladders.iter().flat_map(|ladder| &ladder.levels);
            runs.extend(levels.map(|level| level.run.clone().timed()));
        }
        let mut plain = |spec: &RunSpec| runs.push(Planned::new(spec.clone()));
        for Comparison { levels, inputs, .. } in &self.comparisons {
            levels.iter().for_each(|level| plain(&level.run.spec));
            inputs.iter().flatten().for_each(&mut plain);
        }
        let ensembles = self.ensembles.iter().flat_map(|ensembles| &ensembles.of);
        ensembles.flat_map(|ensemble| &ensemble.members).for_each(&mut plain);
        self.budgets.of.iter().flatten().for_each(|change| plain(&change.spec));
        self.limits.of.iter().for_each(|limit| plain(&limit.spec));
        let cells = self.maps.iter().flat_map(|map| &map.panels).flat_map(|panel| &panel.cells);
        cells.flatten().flatten().for_each(&mut plain);
        if let Some(sensitivity) = &self.sensitivity {
            for Watched { constant, faults, .. } in &sensitivity.of {
                sensitivity.searches(*constant).for_each(|spec| plain(&spec));
                let faulty = faults.iter().flat_map(|f| sensitivity.faulty(*constant, *f));
                faulty.for_each(|(_, spec)| plain(&spec));
            }
        }
        let panels = self.curves.iter().flat_map(|curves| &curves.panels);
        panels.flat_map(|panel| &panel.lines).for_each(|line| plain(&line.spec));
        let pictured = self.pictures.iter().flat_map(|picture| &picture.panels);
        pictured.for_each(|panel| plain(&panel.spec));
        self.card.iter().flat_map(|card| &card.runs).for_each(&mut plain);
        runs
    }
}
