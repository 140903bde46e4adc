//! Errors and their cost: the observed order in the spacing with its confidence interval, and which settings
//! reach an error with the least work, in seconds of a run that was made alone, and in pair interactions,
//! which do not depend on the machine or on other programs.

use touchstone_base::{
    record::{MetricName, Record, Status, median},
    settings::{Field, Kind},
    spec::RunSpec,
    submission::OURS,
};
use touchstone_report::{
    Axis, Block, Cell, Colour, Figure, Plot, Series, Shape, Table, exact, first_sentence, percent,
};

use super::{Card, Ladder, ladder};
use crate::{
    case::Case,
    columns::TableColumns,
    convergence::{ErrorLevel, convergence},
    looks,
    orders::{self, FittedOrder},
    runs::{Planned, Runs},
    section::Section,
    study::{Studies, Study},
};

/// Error against spacing and against cost.
pub struct Accuracy {
    /// Anchor of its studies in the report: the case in letters, digits and hyphens, and a suffix if the case
    /// has several.
    pub id: String,
    /// The error: the distance from an exact solution or a reference. For a metric with a sign, its
    /// magnitude.
    pub error: MetricName,
    /// The error whose orders gates judge, if it is not the one that is shown.
    pub judged: Option<MetricName>,
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

/// The magnitude of this metric of a run that reached its end, which is its error.
pub fn error_of(metric: &MetricName, record: &Record) -> Option<f64> {
    let value = record.value(metric.clone()).filter(|_| record.status == Status::Completed);
    value.map(f64::abs).filter(|value| value.is_finite())
}

impl Accuracy {
    /// No ladders yet. Arguments: id of the studies, the error metric, and the name of the error with its
    /// unit. Spacings are in units of a length of the problem; the expected order is 2.
    pub fn new(id: &str, error: impl Into<MetricName>, label: &str) -> Self {
        let (id, label, about) = (id.to_string(), label.to_string(), String::new());
        let error = error.into();
        let (spacing, slope) = ("Δx [-]", Some(2.0));
        Self { id, error, judged: None, label, about, spacing, slope, ladders: Vec::new() }
    }

    /// The runs of these variants with the finest spacing of their ladders.
    pub fn finest(&self, variants: &[&str]) -> Vec<RunSpec> {
        self.runs_of(variants, |levels| levels.last())
    }

    /// The runs of these variants with this spacing.
    pub fn spaced(&self, variants: &[&str], spacing: f64) -> Vec<RunSpec> {
        self.runs_of(variants, |levels| levels.iter().find(|level| level.spacing == spacing))
    }

    fn runs_of(
        &self,
        variants: &[&str],
        pick: impl Fn(&[ladder::Level]) -> Option<&ladder::Level>,
    ) -> Vec<RunSpec> {
        let of = |name: &&str| self.ladders.iter().find(|ladder| ladder.variant == *name);
        let levels = variants.iter().filter_map(of).filter_map(|of| pick(&of.levels));
        levels.map(|level| level.run.spec.clone()).collect()
    }
}

/// One run of a ladder.
#[derive(Clone, Debug)]
pub(super) struct LadderPoint {
    /// Spacing.
    pub spacing: f64,
    /// Label in figures: its resolution.
    pub label: String,
    /// Error; NaN if there is none.
    pub error: f64,
    /// Processor seconds of the stepping, sorted \[s\].
    pub seconds: Vec<f64>,
    /// Pair interactions.
    pub pairs: f64,
}

/// Runs that a line joins in a figure.
pub(super) struct Line<'a> {
    /// Name in the legend.
    pub name: &'a str,
    /// The runs, coarse to fine.
    pub points: &'a [LadderPoint],
}

/// The setting that refines the runs of a case: a number of particles, or else a spacing.
pub(super) struct RefiningSetting {
    pub setting: &'static Field,
}

impl RefiningSetting {
    /// The first setting in which the coarsest and the finest level of a ladder differ.
    pub(super) fn of(case: &dyn Case, studies: &Studies) -> Option<Self> {
        let levels = &studies.ladder()?.levels;
        let ends = [levels.first()?, levels.last()?];
        let [coarse, fine] = ends.map(|level| &level.run.spec.settings);
        let differs = |field: &&Field| field.of_json(coarse) != field.of_json(fine);
        case.fields().iter().find(differs).map(|setting| Self { setting })
    }

    /// Its value of a run.
    pub(super) fn value(&self, settings: &serde_json::Value) -> Option<f64> {
        self.setting.of_json(settings)?.number()
    }

    /// The spacing of a run with this value, in units common to all runs of the case.
    pub(super) fn spacing(&self, value: f64) -> f64 {
        if self.setting.kind == Kind::Count { 1.0 / value } else { value }
    }
}

impl LadderPoint {
    /// Median of the timings \[s\]; NaN if the run was not timed.
    pub(super) fn median(&self) -> f64 {
        median(&self.seconds).unwrap_or(f64::NAN)
    }

    /// Spacing and error.
    pub fn level(&self) -> ErrorLevel {
        ErrorLevel { spacing: self.spacing, value: self.error }
    }

    /// Fastest and slowest \[s\].
    fn spread(&self) -> (f64, f64) {
        let end = |value: Option<&f64>| value.copied().unwrap_or(f64::NAN);
        (end(self.seconds.first()), end(self.seconds.last()))
    }
}

/// The points of a ladder, whose error is the magnitude of a metric.
pub(super) fn points(error: &MetricName, ladder: &Ladder, runs: &Runs) -> Vec<LadderPoint> {
    let levels = ladder.levels.iter();
    let of = levels.map(|level| {
        let record = runs.record(&level.run.spec);
        let error = record.and_then(|record| error_of(error, record));
        let mut seconds = record.map_or(Vec::new(), |record| record.cost.alone_s.clone());
        seconds.sort_by(f64::total_cmp);
        LadderPoint {
            spacing: level.spacing,
            label: level.resolution.count.to_string(),
            error: error.unwrap_or(f64::NAN),
            seconds,
            pairs: record.map_or(f64::NAN, |record| record.cost.pair_interactions as f64),
        }
    });
    of.collect()
}

/// The cost of a run.
pub(super) type Cost = fn(&LadderPoint) -> f64;

/// Points that no other point beats in both error and cost, cheapest first.
fn pareto<'a>(points: impl Iterator<Item = &'a LadderPoint>, cost: Cost) -> Vec<&'a LadderPoint> {
    let mut sorted: Vec<&LadderPoint> = points.filter(|p| p.error.is_finite()).collect();
    sorted.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    let mut front: Vec<&LadderPoint> = Vec::new();
    for point in sorted {
        if front.last().is_none_or(|best| point.error < best.error) {
            front.push(point);
        }
    }
    front
}

/// The least median cost of the points of a ladder with at most this error and with finer levels of at most
/// this error: a single level may be good because parts of its error cancel. NaN if there is none.
fn cheapest(ladder: &[LadderPoint], error: f64) -> f64 {
    let holds = |point: &&LadderPoint| {
        let finer = ladder.iter().filter(|p| p.spacing <= point.spacing);
        finer.into_iter().all(|p| p.error <= error)
    };
    ladder.iter().filter(holds).map(LadderPoint::median).fold(f64::NAN, f64::min)
}

/// The errors for which the table states the least run time.
const GOALS: [f64; 2] = [1e-2, 1e-3];

/// Results for a ladder.
struct LadderRow<'a> {
    of: &'a Ladder,
    points: Vec<LadderPoint>,
    levels: Vec<ErrorLevel>,
    found: FittedOrder,
}

impl Study for Accuracy {
    /// All levels, timed.
    fn runs(&self) -> Vec<Planned> {
        let levels = self.ladders.iter().flat_map(|ladder| &ladder.levels);
        levels.map(|level| level.run.clone().timed()).collect()
    }

    /// The errors of all ladders, if one of them has several levels.
    fn evaluate(&self, _: &str, runs: &Runs) -> Option<Section> {
        let levels_of =
            |points: &[LadderPoint]| points.iter().map(LadderPoint::level).collect::<Vec<_>>();
        let row = |of| {
            let points = points(&self.error, of, runs);
            let levels = levels_of(&points);
            let found = convergence(&levels, self.slope);
            LadderRow { of, points, levels, found }
        };
        let rows: Vec<LadderRow> = self.ladders.iter().map(row).collect();
        let id = format!("{}-work-precision", self.id);
        let section = Section::new(&id, "What a smaller error costs");
        let judged = self.judged.as_ref().unwrap_or(&self.error);
        let section = self.ladders.iter().fold(section, |section, ladder| {
            let Some(gate) = ladder.order.clone() else { return section };
            let found = convergence(&levels_of(&points(judged, ladder, runs)), self.slope);
            section.judge(gate, found.map_or(f64::NAN, |found| found.order))
        });
        let has_levels = rows.iter().any(|row| row.points.len() > 1);
        let summary = "Error against spacing and pair interactions".into();
        let blocks = vec![refined(&id, self, &rows).into()];
        let section =
            section.block(timed(&id, self, &rows)).block(Block::Details { summary, blocks });
        has_levels.then(|| section.block(table(self, &rows)))
    }

    /// Ladders go on by their last ratio.
    fn deepen(&mut self, _: &[Planned]) {
        self.ladders.iter_mut().for_each(Ladder::deepen);
        self.about +=
            " In the deep tier each ladder goes two levels further by the ratio of its last two.";
    }
}

/// The error of a case over run time: the recommended variant, the paper's, and other codes at the settings
/// of the case. Names are the names of the legend, equal in the panels of all cases.
pub fn against_run_time(
    title: &str,
    case: &dyn Case,
    studies: &Studies,
    runs: &Runs,
) -> Option<Plot> {
    let (metric, accuracy) = (studies.error()?, studies.first::<Accuracy>()?);
    let card = studies.first::<Card>()?;
    // A ladder at another value of the setting than the run of the card says so.
    let (value, [before, after]) = (card.breaks.value, card.breaks.words);
    let finest = accuracy.finest(&[case.recommended().variant]).first().map(value);
    let is_other = |finest: &f64| card.runs.first().map(value) != Some(*finest);
    let levels = studies.ladder().map_or(&[][..], |ladder| &ladder.levels);
    let is_refined = levels.windows(2).any(|of| value(&of[0].run.spec) != value(&of[1].run.spec));
    let other = finest.filter(is_other).filter(|_| !is_refined);
    let other = other.map_or(String::new(), |value| format!(", {before}{}{after}", exact(value)));
    let title = format!("{title}{other}");
    let plot = Plot::new(title, Axis::log("run time [s]"), Axis::log(&accuracy.label));
    let session = |name: &str, are_ours: bool| {
        let peers = runs.peers.iter().filter_map(|run| {
            let (record, of) = (&run.record, run.record.run.submission.as_ref()?);
            let is_shown = (of.code == OURS) == are_ours && record.cost.cpu_s.is_finite();
            let what = if are_ours { record.run.variant.clone() } else { of.to_string() };
            is_shown.then_some((what, (record.cost.cpu_s, error_of(metric, record)?)))
        });
        let (names, marks) = peers.unzip();
        Series { names, ..Series::line(name, marks) }
    };
    let others = session("other codes", false).colour(Colour::GREY).open_markers(Shape::Diamond);
    let ours = session("ours in the session of the others", true).open_markers(Shape::Circle);
    let recommended = case.recommended();
    let named = [
        Some(("recommended", recommended.variant)),
        recommended.papers.map(|of| ("the paper's", of)),
    ];
    let lines = named.into_iter().flatten().enumerate().filter_map(|(k, (name, variant))| {
        let ladder = accuracy.ladders.iter().find(|ladder| ladder.variant == variant)?;
        let points = points(metric, ladder, runs);
        let known = points.iter().filter(|point| point.error.is_finite());
        let line = known.clone().map(|point| (point.median(), point.error)).collect();
        let names = known.map(|point| format!("{variant}, {}", point.label)).collect();
        Some(Series { names, ..looks::line(name, line, k) })
    });
    Some(lines.fold(plot.layer(others).layer(ours), Plot::layer))
}

/// Error over run time.
fn timed(id: &str, accuracy: &Accuracy, rows: &[LadderRow]) -> Figure {
    let about = first_sentence(&accuracy.about).0;
    let caption = format!("Which variant reaches an error fastest? {about}");
    let axes = ["", "run time on one core [s]", &accuracy.label];
    Figure::new(id, caption).panel(panel(axes, &lines(rows), LadderPoint::median, true))
}

/// Error over spacing and over pair interactions.
fn refined(id: &str, accuracy: &Accuracy, rows: &[LadderRow]) -> Figure {
    let caption = "How fast does the error fall with the spacing and with the work?";
    let levels = rows.iter().map(|row| (row.of.variant, row.levels.as_slice()));
    let axes = [accuracy.spacing, &accuracy.label];
    let spacing = orders::plot("", axes, levels, accuracy.slope.as_slice());
    let axes = ["", "pair interactions [-]", &accuracy.label];
    let counted = panel(axes, &lines(rows), |point| point.pairs, false);
    let figure = Figure::new(format!("{id}-refined"), caption).columns(2).panel_size(320.0, 290.0);
    figure.panel(spacing).panel(counted)
}

fn lines<'a>(rows: &'a [LadderRow]) -> Vec<Line<'a>> {
    rows.iter().map(|row| Line { name: row.of.variant, points: &row.points }).collect()
}

/// Error over a cost, with these names of panel, cost and error; are the ends of lines named by their
/// resolutions?
pub(super) fn panel(
    [title, axis, error]: [&str; 3],
    lines: &[Line],
    cost: Cost,
    is_named: bool,
) -> Plot {
    let mut plot = Plot::new(title, Axis::log(axis), Axis::log(error));
    let all = lines.iter().flat_map(|line| line.points);
    let front = pareto(all, cost).iter().map(|p| (cost(p), p.error)).collect();
    plot = plot.layer(Series::line("best in error and cost", front).colour(PALE).width(7.0));
    for (k, Line { name, points }) in lines.iter().enumerate() {
        let own: Vec<&LadderPoint> = points.iter().filter(|p| p.error.is_finite()).collect();
        let line = own.iter().map(|p| (cost(p), p.error)).collect();
        let mut series = looks::line(name, line, k);
        series.names = own.iter().map(|p| p.label.clone()).collect();
        if is_named {
            let last = own.len().saturating_sub(1);
            let is_end = |k: usize| k == 0 || k == last;
            let labels = own.iter().enumerate();
            series = series.labels(
                labels.map(|(k, p)| if is_end(k) { p.label.clone() } else { String::new() }),
            );
            series.x_bars = own.iter().map(|p| p.spread()).collect();
        }
        plot = plot.layer(series);
    }
    plot
}

/// Behind everything else.
const PALE: Colour = Colour(222, 222, 222);

/// How to read orders, and times to an error.
pub const READING: [&str; 2] = [LABELS, TIMES];

const LABELS: &str = "*Orders agree*: every local order is within 15 % of the fitted one; *asymptotic*: \
    moreover the formal order of the method is within 15 % of it and in its 95 % interval; *floor reached*: \
    the error fell with an order and then stopped; *not yet*: none of these.";
const TIMES: &str = "Times are the least median run time on one core of a level whose error, and that of \
    every finer level, is at most so much: at a single level errors of time and spacing can cancel.";

/// Orders, intervals, and the costs of errors.
fn table(accuracy: &Accuracy, rows: &[LadderRow]) -> Table {
    let about = format!("Orders and times. {}", first_sentence(&accuracy.about).1);
    let finest = |row: &LadderRow| row.points.last().map_or(f64::NAN, |p| p.error);
    let columns = TableColumns::default()
        .code("variant", |row: &LadderRow| row.of.variant)
        .order(|row: &LadderRow| &row.found)
        .of(["finest error", "-"], finest, |error| Cell::percent(error, 2));
    let columns = GOALS.iter().fold(columns, |columns, goal| {
        let head = format!("time to {}", percent(*goal, 1));
        columns.of([&head, ""], |row| cheapest(&row.points, *goal), Cell::seconds)
    });
    columns.table(about, rows)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use touchstone_base::gate::{Bound, Evidence, Gate, Verdict};

    use super::*;
    use crate::studies::tests::{ERROR, column, comparison, evaluate, records, spec, tables};

    fn point(name: &str, error: f64, seconds: &[f64]) -> LadderPoint {
        let (label, seconds) = (name.to_string(), seconds.to_vec());
        LadderPoint { spacing: 0.1, label, error, seconds, pairs: 1.0 }
    }

    #[test]
    fn the_front_keeps_what_nothing_beats_and_ignores_failures() {
        let points = [
            point("slow and good", 1e-4, &[1.0, 2.0, 3.0]),
            point("fast and bad", 1e-2, &[0.1]),
            point("slow and bad", 2e-2, &[1.5]),
            point("failed", f64::NAN, &[0.01]),
        ];
        let front = pareto(points.iter(), LadderPoint::median);
        assert_eq!(names(front), ["fast and bad", "slow and good"]);
        assert_eq!(points[0].median(), 2.0);
        assert_eq!(points[0].spread(), (1.0, 3.0));
    }

    fn names<'a>(points: impl IntoIterator<Item = &'a LadderPoint>) -> Vec<String> {
        points.into_iter().map(|p| p.label.clone()).collect()
    }

    /// A run that is a tenth worse at a higher cost is dropped, one that is a hundredth better is kept.
    #[test]
    fn the_front_drops_what_is_a_little_worse_and_keeps_what_is_a_little_better() {
        let points = [
            point("a hundredth better", 0.99e-2, &[4.0]),
            point("a tenth worse", 1.1e-2, &[2.0]),
            point("cheapest", 1e-2, &[1.0]),
            point("a thousandth worse", 1.001e-2, &[3.0]),
            point("equal and dearer", 1e-2, &[1.5]),
            point("worse than the best alone", 0.9901e-2, &[5.0]),
        ];
        assert_eq!(
            names(pareto(points.iter(), LadderPoint::median)),
            ["cheapest", "a hundredth better"]
        );
        // Work equals the index, so the first point is the cheapest.
        let work = |k: usize| LadderPoint { pairs: k as f64, ..points[k].clone() };
        let work: Vec<LadderPoint> = (0..points.len()).map(work).collect();
        assert_eq!(names(pareto(work.iter(), |p| p.pairs)), ["a hundredth better"]);
    }

    /// The cost of a level is the median, not the mean or the minimum.
    #[test]
    fn the_cost_is_a_median_and_every_finer_level_counts() {
        let disturbed = [point("disturbed once", 1e-3, &[2.0, 2.1, 30.0])];
        assert_eq!((cheapest(&disturbed, 1e-3), disturbed[0].spread()), (2.1, (2.0, 30.0)));
        assert!(cheapest(&disturbed, 1e-5).is_nan());
        // A failure has no error, so coarser levels do not count either.
        let failed = LadderPoint { spacing: 0.05, ..point("failed later", f64::NAN, &[9.0]) };
        assert!(cheapest(&[point("failed later", 1e-3, &[1.0]), failed], 1e-2).is_nan());
    }

    #[test]
    fn an_error_that_a_finer_level_does_not_reach_is_not_the_cheapest() {
        let of = |spacing: f64, error: f64, seconds: f64| LadderPoint {
            spacing,
            ..point("cancels", error, &[seconds])
        };
        let points = [of(0.1, 1e-3, 0.1), of(0.05, 2e-3, 1.0), of(0.025, 5e-4, 9.0)];
        assert_eq!(cheapest(&points, 1e-3), 9.0);
        assert_eq!(cheapest(&points, 3e-3), 0.1);
    }

    /// Ladders of `seed` and `best` at n = 10, 20, 40, 80; the order of `best` is judged. Errors are a
    /// function of variant and n; each run took n/20 s, n/40 s and n/10 s.
    fn study_of(error: impl Fn(&str, f64) -> f64) -> Section {
        let bound = Bound::Within(2.9, 3.1);
        let gate = Gate::new("case.order", "order", bound, Evidence::Theory, "made up");
        let levels = [10, 20, 40, 80];
        let ladder = |(variant, order)| {
            let levels = comparison(variant, &levels).levels;
            Ladder { variant, levels, order, refine: Arc::new(|_, _| None) }
        };
        let ladders = [("seed", None), ("best", Some(gate))].map(ladder).into();
        let accuracy = Accuracy { ladders, ..Accuracy::new("case", ERROR, "Error [-]") };
        let each = ["seed", "best"].into_iter().flat_map(|v| levels.map(|n| (v, n)));
        let made = each.map(|(variant, n)| {
            let error = error(variant, n as f64);
            let fill = move |record: &mut Record| {
                record.put(ERROR, error);
                record.cost.alone_s = [20.0, 40.0, 10.0].map(|share| n as f64 / share).into();
            };
            (spec(variant, n), fill)
        });
        evaluate(&accuracy, records(made))
    }

    #[test]
    fn each_ladder_has_the_order_of_its_own_errors() {
        let study = study_of(|variant, n| match variant {
            "seed" => -4.0 / (n * n), // a metric with a sign
            _ => 8.0 / n.powi(3),
        });
        let table = tables(&study)[0];
        assert_eq!(column(table, "variant"), ["`seed`", "`best`"]);
        let local = column(table, "local orders, coarse to fine");
        assert_eq!(local, ["2.0, 2.0, 2.0", "3.0, 3.0, 3.0"]);
        assert_eq!(column(table, "label"), ["asymptotic", "orders agree"], "2 is the formal order");
        let finest = column(table, "finest error");
        assert_eq!(finest, ["0.062 %", "0.0016 %"], "4/80² and 8/80³");
        let times = GOALS.map(|goal| column(table, &format!("time to {}", percent(goal, 1))));
        assert_eq!(times, [["1.00 s", "500 ms"], ["4.00 s", "1.00 s"]], "n = 20 and 10, 80 and 20");
        let [judged] = study.judged.as_slice() else { panic!("one order is judged") };
        assert_eq!((&*judged.gate.id, &judged.judgement.verdict), ("case.order", &Verdict::Pass));
        let order = judged.judgement.value.expect("an order");
        assert!((order - 3.0).abs() < 1e-12, "order {order} of errors 8/n³");
        let [Block::Figure(timed), Block::Details { blocks, .. }, _] = &study.blocks[..] else {
            panic!("a figure, a folded one and a table")
        };
        let [_, touchstone_report::Layer::Series(seed), _] = &timed.panels[0].layers[..] else {
            panic!("the front and two ladders")
        };
        assert_eq!(seed.x_bars, [(0.25, 1.0), (0.5, 2.0), (1.0, 4.0), (2.0, 8.0)], "over run time");
        assert_eq!(seed.labels, ["0", "", "", "0"], "the ends of lines alone are named");
        let [Block::Figure(refined)] = &blocks[..] else { panic!("a folded figure") };
        let slope = refined.panels[0].layers.last();
        let Some(touchstone_report::Layer::Series(slope)) = slope else {
            panic!("the formal order")
        };
        assert_eq!(slope.labels, ["order 2"]);
    }

    #[test]
    fn a_level_that_failed_leaves_no_order_and_its_gate_fails() {
        let study = study_of(|_, n| if n == 20.0 { f64::NAN } else { 1.0 / n });
        let judged = &study.judged[0].judgement;
        assert!(judged.verdict.is_failure() && judged.value.is_some_and(f64::is_nan), "{judged:?}");
        let label = &column(tables(&study)[0], "label")[0];
        assert!(label.starts_with("no order: the level with spacing 0.05"), "{label}");
        // Coarser levels have no cost either.
        assert_eq!(column(tables(&study)[0], &format!("time to {}", percent(0.01, 1))), ["–"; 2]);
    }
}
