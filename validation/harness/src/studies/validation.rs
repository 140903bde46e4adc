//! Comparisons with references. Against an exact one all of the error is numerical: it has an order, and
//! falls or stops falling. Where the reference or the inputs have an uncertainty, E = S − D, result minus
//! data, is held against twice u_val = (u_num² + u_input² + u_D²)^(1/2), by ASME V&V 20-2009.

use touchstone_base::{
    functions::{ln, powf},
    record::MetricName,
    spec::RunSpec,
};
use touchstone_report::{Cell, Table, percent, sig};

use super::{Ladder, Level, anchor};
use crate::{
    columns::TableColumns,
    convergence::{Convergence, ErrorLevel, Label, SLOWEST, convergence},
    orders::FittedOrder,
    runs::{Planned, Runs},
    section::Section,
    study::Study,
};

/// From the distance to the limit of refinement to its uncertainty.
struct Safety {
    /// The factor to the uncertainty of 95 %.
    factor: f64,
    /// The divisor that turns this into a standard uncertainty.
    coverage: f64,
}

/// Roache's factor for an order tested by levels; his index is one-sided (V&V 20, section 2).
const TESTED: Safety = Safety { factor: 1.25, coverage: 1.15 };
/// The factor of Eça & Hoekstra (2014) without a tested order, to a two-sided uncertainty.
const UNTESTED: Safety = Safety { factor: 3.0, coverage: 2.0 };
/// The largest order that differences of three levels may show: a higher one than the method has is a
/// coincidence, not a limit that is approached.
const FASTEST: f64 = 2.5;
/// The factor from u_val to an uncertainty of 95 %.
const EXPANDS: f64 = 2.0;
/// A comparison with an uncertainty of 95 % above this fraction of the compared quantity could not detect an
/// error of a tenth: a small E is then no evidence.
const CONCLUSIVE: f64 = 0.1;

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

/// Result of a ladder for its finest level.
#[derive(Clone, Debug, PartialEq)]
pub struct Numerical {
    /// U_num, which bounds the distance from the limit of refinement at 95 %. NaN if unknown.
    pub expanded: f64,
    /// u_num.
    pub standard: f64,
    /// The limit itself: by the order, or the finest level if there is none.
    pub limit: f64,
    /// Does the ladder show an order?
    pub has_order: bool,
    /// How it was found, in words.
    pub how: String,
}

/// Result of one comparison. Missing values are NaN.
#[derive(Clone, Debug)]
pub struct ComparisonResult {
    /// E = S − D, of the finest level.
    pub error: f64,
    /// Numerical uncertainty from the levels.
    pub numerical: Numerical,
    /// u_input.
    pub input: f64,
    /// u_D.
    pub reference: f64,
    /// If the reference is exact: the order of the magnitude of the error.
    pub exact: Option<FittedOrder>,
}

/// Verdict on a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conclusion {
    /// Against an exact reference: the error falls, because the interval of its order is above 0.
    Converges,
    /// Against an exact reference: the error tends to another limit than 0, or fell and then stopped falling.
    Stops,
    /// |E| ≤ 2 u_val.
    NotDistinguishable,
    /// |E| > 2 u_val.
    ModelError,
    /// |E| ≤ 2 u_val, and u_val is too large for a conclusion.
    TooUncertain,
    /// The ladder shows no order.
    NoOrder,
    /// A run or its ladder is missing.
    Unknown,
}

impl Conclusion {
    /// The name for programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converges => "converges",
            Self::Stops => "stops",
            Self::NotDistinguishable => "not-distinguishable",
            Self::ModelError => "model-error",
            Self::TooUncertain => "too-uncertain",
            Self::NoOrder => "ladder-does-not-tell",
            Self::Unknown => "unknown",
        }
    }
}

impl ComparisonResult {
    /// From the records of a comparison.
    pub fn of(comparison: &Comparison, runs: &Runs) -> Self {
        let value = |spec: &RunSpec| runs.value(spec, comparison.metric.clone());
        let levels = comparison.levels.iter();
        let levels: Vec<ErrorLevel> = levels
            .map(|level| ErrorLevel { spacing: level.spacing, value: value(&level.run.spec) })
            .collect();
        let change = |[plain, changed]: &[RunSpec; 2]| value(changed) - value(plain);
        let squares = comparison.inputs.iter().map(change).map(|change| change * change);
        Self {
            error: levels.last().map_or(f64::NAN, |level| level.value),
            exact: comparison.is_exact().then(|| convergence(&magnitudes(&levels), None)),
            numerical: numerical(&levels),
            input: squares.fold(0.0, |sum, square| sum + square).sqrt(),
            reference: comparison.reference,
        }
    }

    /// u_val.
    pub fn uncertainty(&self) -> f64 {
        let parts = [self.numerical.standard, self.input, self.reference];
        parts.into_iter().fold(0.0, |sum, part| sum + part * part).sqrt()
    }

    /// Whether the ladder shows an order and the uncertainty is small enough for a conclusion.
    pub fn is_conclusive(&self) -> bool {
        !matches!(
            self.conclusion(),
            Conclusion::TooUncertain | Conclusion::NoOrder | Conclusion::Unknown
        )
    }

    /// The ends of the interval of 95 % of the limit of refinement, by the ladder alone.
    pub fn interval(&self) -> [f64; 2] {
        [self.error - self.numerical.expanded, self.error + self.numerical.expanded]
    }

    /// The verdict.
    pub fn conclusion(&self) -> Conclusion {
        let Numerical { has_order, .. } = self.numerical;
        let (error, uncertainty) = (self.error.abs(), EXPANDS * self.uncertainty());
        match &self.exact {
            _ if !(error.is_finite() && uncertainty.is_finite()) => Conclusion::Unknown,
            Some(Ok(of)) if self.stops(of) => Conclusion::Stops,
            Some(Ok(Convergence { interval: [low, _], .. })) if *low > 0.0 => Conclusion::Converges,
            None if has_order && error > uncertainty => Conclusion::ModelError,
            None if has_order && uncertainty > CONCLUSIVE => Conclusion::TooUncertain,
            None if has_order => Conclusion::NotDistinguishable,
            _ => Conclusion::NoOrder,
        }
    }

    /// Whether errors against an exact reference tend to another limit than 0. By levels that approach one,
    /// it must be beyond the uncertainty; without it, they must have fallen and then stopped.
    fn stops(&self, of: &Convergence) -> bool {
        match self.numerical.has_order {
            true => !of.label.is_one_order() && self.error.abs() > self.numerical.expanded,
            false => of.label == Label::FloorReached,
        }
    }

    /// The verdict in words.
    pub fn in_words(&self) -> String {
        let [error, uncertainty] =
            [self.error, EXPANDS * self.uncertainty()].map(|value| percent(value, 2));
        match self.conclusion() {
            Conclusion::Converges => format!("converges with order {}", self.order()),
            Conclusion::Stops => format!("stops at {}", percent(self.numerical.limit.abs(), 2)),
            Conclusion::NotDistinguishable => {
                "not distinguishable from the reference at this uncertainty".into()
            }
            Conclusion::ModelError => format!("model error {error} ± {uncertainty}"),
            Conclusion::TooUncertain => format!("uncertain by {uncertainty}: inconclusive"),
            Conclusion::NoOrder => "no order found".into(),
            Conclusion::Unknown => "runs are missing: inconclusive".into(),
        }
    }

    /// The order of an error against an exact reference with its interval.
    fn order(&self) -> String {
        match &self.exact {
            Some(Ok(of)) => of.in_words(),
            _ => "–".into(),
        }
    }
}

fn magnitudes(levels: &[ErrorLevel]) -> Vec<ErrorLevel> {
    levels.iter().map(|level| ErrorLevel { value: level.value.abs(), ..*level }).collect()
}

/// The numerical uncertainty of the finest level from levels, coarse to fine. Where one order describes all
/// errors, of one sign, it is the grid convergence index of the two finest levels with this order. Where the
/// differences of the last three levels have an order, which three levels determine and cannot test, it is
/// three times the distance from the limit of this order; else three times the range of the last three
/// levels, or the distance of the only two.
pub fn numerical(levels: &[ErrorLevel]) -> Numerical {
    let found = |limit: f64, distance: f64, safety: Safety, order: Option<String>, how: &str| {
        let (expanded, has_order) = (safety.factor * distance, order.is_some());
        let how = order.map_or(how.into(), |order| format!("order {order}{how}"));
        Numerical { expanded, standard: expanded / safety.coverage, limit, has_order, how }
    };
    let finest = &levels[levels.len().saturating_sub(3)..];
    let values = finest.iter().map(|level| level.value);
    let range = values.clone().fold(f64::NAN, f64::max) - values.fold(f64::NAN, f64::min);
    let unknown = |how| found(f64::NAN, f64::NAN, UNTESTED, None, how);
    let [coarse, middle, fine] = match finest {
        levels if levels.iter().any(|level| !level.value.is_finite()) => {
            return unknown("a level is missing");
        }
        [] | [_] => return unknown("one level"),
        [_, fine] => return found(fine.value, range, UNTESTED, None, "distance of two levels"),
        [coarse, middle, fine, ..] => [coarse, middle, fine],
    };
    let [first, last] = [middle.value - coarse.value, fine.value - middle.value];
    let [wide, ratio] = [coarse.spacing / middle.spacing, middle.spacing / fine.spacing];
    let by_order = |order: f64, safety, words, how| {
        let left = last / (powf(ratio, order) - 1.0);
        found(fine.value + left, left.abs(), safety, Some(words), how)
    };
    let is_of_one_sign = levels.iter().all(|level| level.value * fine.value > 0.0);
    let of_all = convergence(&magnitudes(levels), None).ok();
    let tested =
        of_all.filter(|of| of.label.is_one_order() && of.order >= SLOWEST && is_of_one_sign);
    if let Some(of) = tested {
        return by_order(of.order, TESTED, of.in_words(), "");
    }
    match order_of_differences(first / last, wide, ratio) {
        Some(order) => by_order(order, UNTESTED, sig(order, 2), " of differences"),
        None => found(fine.value, range, UNTESTED, None, "no order: range of three levels"),
    }
}

/// The order p of (h₁ᵖ − h₂ᵖ)/(h₂ᵖ − h₃ᵖ) = this ratio of differences, by Celik's iteration (2008); none if
/// the differences do not shrink, change their sign, or shrink too slowly or too fast.
fn order_of_differences(differences: f64, wide: f64, ratio: f64) -> Option<f64> {
    let next = |p: f64| {
        let uneven = (powf(ratio, p) - 1.0) / (powf(wide, p) - 1.0);
        (ln(differences * uneven) / ln(ratio)).clamp(SLOWEST, FASTEST)
    };
    let order = (0..50).fold(1.0, |p, _| next(p));
    (differences > 1.0 && SLOWEST < order && order < FASTEST).then_some(order)
}

/// How to read comparisons with exact references and with uncertain ones.
pub const READING: [&str; 2] = [OF_EXACT, OF_UNCERTAIN];

const OF_EXACT: &str = "Errors of the finest level against exact references. Such an error is entirely \
    numerical, so V&V 20 does not apply. Order: of all levels, with its interval of 95 %. *Converges*: \
    this interval is above 0. *Stops at*: the differences of the last three levels approach another limit \
    than 0, by more than three times the distance from it, or the error fell and then stopped falling.";

const OF_UNCERTAIN: &str = "Uncertainty of the comparisons with references that have their own, by ASME V&V \
    20-2009. E is the finest result minus the reference; norms have no sign. u_num follows from the \
    ladder. Where one order describes all levels, U_num of 95 % is 1.25 times the distance of the finest \
    from the limit of that order (grid convergence index), and u_num is U_num/1.15. Where only the \
    differences of the last three levels have an order, which is not tested, U_num is 3 times the distance \
    from its limit, otherwise 3 times the range of the last three (Eça & Hoekstra 2014); u_num is U_num/2. \
    u_input is the change by inputs that are wrong by their own uncertainty, of the coarsest run; u_D the \
    uncertainty that the reference states; u_val the root of the sum of squares. |E| ≤ 2 u_val: not \
    distinguishable; |E| > 2 u_val: model error. If |E| ≤ 2 u_val and 2 u_val exceeds a tenth of the \
    compared quantity, the comparison is inconclusive. Without an order there is no verdict.";

/// The comparisons of a case with references, exact ones and others.
pub struct Comparisons(pub Vec<Comparison>);

impl Study for Comparisons {
    fn runs(&self) -> Vec<Planned> {
        let mut runs = Vec::new();
        for Comparison { levels, inputs, .. } in &self.0 {
            let levels = levels.iter().map(|level| &level.run.spec);
            runs.extend(levels.chain(inputs.iter().flatten()).cloned().map(Planned::new));
        }
        runs
    }

    fn evaluate(&self, case: &str, runs: &Runs) -> Option<Section> {
        let rows: Vec<Row> = self.0.iter().map(|of| (of, ComparisonResult::of(of, runs))).collect();
        let (exact, uncertain): (Vec<Row>, Vec<Row>) =
            rows.into_iter().partition(|(_, found)| found.exact.is_some());
        let section = Section::new(&anchor(case, "uncertainty"), "Comparisons with references");
        let tables = [(exact, of_exact as fn(&[Row]) -> Table), (uncertain, of_uncertain)];
        let tables = tables.into_iter().filter(|(rows, _)| !rows.is_empty());
        let section = tables.fold(section, |section, (rows, table)| section.block(table(&rows)));
        (!self.0.is_empty()).then_some(section)
    }
}

type Row<'a> = (&'a Comparison, ComparisonResult);

fn columns<'a>() -> TableColumns<'a, Row<'a>> {
    TableColumns::default()
        .marked("comparison", |(of, _): &Row| of.what.clone())
        .text("with", |(of, _)| of.against)
        .of(["E", "-"], |(_, found)| found.error, show)
}

fn show(value: f64) -> Cell {
    Cell::percent(value, 2)
}

fn of_exact(rows: &[Row]) -> Table {
    columns()
        .text("verdict", |(_, found)| found.in_words())
        .table("Errors against exact references.", rows)
}

fn of_uncertain(rows: &[Row]) -> Table {
    let mut sources: Vec<String> = Vec::new();
    for (of, _) in rows {
        let source = format!("{}, {}", of.against, of.because);
        if !sources.contains(&source) {
            sources.push(source);
        }
    }
    let caption = "Differences from uncertain references.";
    columns()
        .of(["U_num", "-"], |(_, found)| found.numerical.expanded, show)
        .of(["u_num", "-"], |(_, found)| found.numerical.standard, show)
        .text("from", |(_, found)| found.numerical.how.clone())
        .of(["u_input", "-"], |(_, found)| found.input, show)
        .of(["u_D", "-"], |(_, found)| found.reference, show)
        .of(["u_val", "-"], |(_, found)| found.uncertainty(), show)
        .text("verdict", |(_, found)| found.in_words())
        .table(format!("{caption} Uncertainties of {}.", sources.join("; of ")), rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::tests::{column, comparison, runs, spec, tables, whole};

    fn of(values: &[(f64, f64)]) -> Numerical {
        let level = |&(n, value): &(f64, f64)| ErrorLevel { spacing: 1.0 / n, value };
        numerical(&values.iter().map(level).collect::<Vec<_>>())
    }

    fn near(value: f64, expected: f64) {
        assert!((value / expected - 1.0).abs() < 1e-6, "{value} instead of {expected}");
    }

    /// Errors 3/n² of any sign: the distance from the limit 0 is the error itself.
    #[test]
    fn a_power_law_has_its_index_with_the_factor_of_a_tested_order() {
        for sign in [1.0, -1.0] {
            let found = of(&[10.0, 14.0, 20.0, 40.0].map(|n| (n, sign * 3.0 / (n * n))));
            near(found.expanded, 1.25 * 3.0 / 1600.0);
            near(found.standard, found.expanded / 1.15);
            assert!(found.limit.abs() < 1e-12 && found.has_order);
            assert!(found.how.starts_with("order 2.0 ("), "{}", found.how);
        }
        // A power law whose sign alternates approaches 0, but not from one side: its last three range by
        // 0.03.
        let found = of(&[(10.0, 0.04), (20.0, -0.02), (40.0, 0.01)]);
        near(found.expanded, 3.0 * 0.06);
        // An order below 1/2 is no order: the range of 0.8, 0.9 and 1.
        let slow = [1.0_f64, 0.9, 0.8].map(|value| (powf(value, -1.0 / 0.2), value));
        let found = of(&slow);
        near(found.expanded, 3.0 * 0.2);
        assert!(!found.has_order, "{}", found.how);
    }

    /// 0.5 + 1/n approaches a limit that is not 0, on uneven spacings. Three levels fix its order.
    #[test]
    fn an_order_that_nothing_tests_has_the_larger_factor() {
        let found = of(&[10.0, 14.0, 20.0].map(|n| (n, 0.5 + 1.0 / n)));
        near(found.expanded, 3.0 * 0.05);
        near(found.standard, 1.5 * 0.05);
        near(found.limit, 0.5);
        assert_eq!((found.has_order, &*found.how), (true, "order 1.0 of differences"));
    }

    #[test]
    fn a_ladder_without_an_order_has_three_times_its_range() {
        for (values, range, why) in [
            ([-0.02, 0.03, 0.01], 0.05, "not monotone"),
            ([-0.1, 0.0, 0.3], 0.4, "differences that grow"),
            ([1.0, 0.51, 0.5], 0.5, "beyond an order of 2.5"),
            ([1.0, 0.5, 0.1], 0.9, "below an order of 1/2"),
            ([0.3, 0.3, 0.3], 0.0, "nothing changes"),
        ] {
            // A coarser level counts for nothing here.
            let found = of(&[(5.0, 9.0), (10.0, values[0]), (20.0, values[1]), (40.0, values[2])]);
            assert!((found.expanded - 3.0 * range).abs() < 1e-12, "{why}: {found:?}");
            assert!((found.standard - 1.5 * range).abs() < 1e-12, "{why}: {found:?}");
            assert_eq!((found.limit, found.has_order), (values[2], false), "{why}");
            assert_eq!(found.how, "no order: range of three levels", "{why}");
        }
        let found = of(&[(10.0, 0.3), (20.0, 0.1)]);
        near(found.expanded, 0.6);
        assert!(!found.has_order && found.how == "distance of two levels");
        for values in [&[][..], &[(10.0, 0.1)], &[(10.0, 0.1), (20.0, f64::NAN), (40.0, 0.1)]] {
            assert!(of(values).expanded.is_nan() && of(values).standard.is_nan());
        }
    }

    #[test]
    fn verdicts_follow_from_the_error_and_all_uncertainties() {
        let found = |error, [standard, input, reference]: [f64; 3], has_order| ComparisonResult {
            error,
            numerical: Numerical {
                expanded: 2.0 * standard,
                standard,
                limit: error,
                has_order,
                how: String::new(),
            },
            input,
            reference,
            exact: None,
        };
        let parts = [0.004, 0.006, 0.012];
        near(found(0.0, parts, true).uncertainty(), 0.014);
        assert_eq!(found(-0.0279, parts, true).conclusion(), Conclusion::NotDistinguishable);
        assert_eq!(found(-0.0281, parts, true).conclusion(), Conclusion::ModelError);
        assert_eq!(found(0.1, [0.0501, 0.0, 0.0], true).conclusion(), Conclusion::TooUncertain);
        assert_eq!(found(0.1, [0.0501, 0.0, 0.0], true).conclusion(), Conclusion::TooUncertain);
        assert_eq!(
            found(0.09, [0.0499, 0.0, 0.0], true).conclusion(),
            Conclusion::NotDistinguishable
        );
        assert_eq!(found(0.3, [0.1, 0.0, 0.0], true).conclusion(), Conclusion::ModelError);
        // However large the error is: without an order there is no model error.
        for error in [0.0, 0.01, 1e3] {
            let found = found(error, parts, false);
            assert_eq!(
                (found.conclusion(), &*found.in_words()),
                (Conclusion::NoOrder, "no order found")
            );
        }
        for missing in [f64::NAN, f64::INFINITY] {
            assert_eq!(found(missing, [0.0; 3], true).conclusion(), Conclusion::Unknown);
            assert_eq!(found(0.1, [missing, 0.0, 0.0], true).conclusion(), Conclusion::Unknown);
        }
        let words = found(-0.0281, parts, true).in_words().replace('\u{a0}', " ");
        assert_eq!(words, "model error −2.8 % ± 2.8 %");
    }

    /// Against an exact reference an error converges or stalls, for any C and p: the verdict is never "not
    /// distinguishable", nor an error of a model.
    #[test]
    fn against_an_exact_reference_an_error_converges_or_stops() {
        let verdict = |error: &dyn Fn(f64) -> f64| {
            let all = [8, 10, 14, 20];
            let runs = runs(all.map(|n| (spec("best", n), error(n as f64))));
            let found = ComparisonResult::of(&comparison("best", &all), &runs);
            (found.conclusion(), found.in_words().replace('\u{a0}', " "))
        };
        for (factor, order) in [(3.0, 2.0), (-0.1, 1.0), (40.0, 0.7)] {
            let (said, words) = verdict(&|n| factor * powf(n, -order));
            assert_eq!(said, Conclusion::Converges, "{words}");
            assert!(
                words.starts_with(&format!("converges with order {}", sig(order, 2))),
                "{words}"
            );
        }
        // Local orders 2.2, 2.1 and 1.75 are one order: the error is larger than its index, 0.96 of it, and
        // does not stop.
        let uneven = [(1, 0.0), (2, 2.2), (4, 4.3), (8, 6.05)];
        let errors = uneven.map(|(n, bits)| (spec("best", n), powf(2.0, -bits)));
        let found = ComparisonResult::of(&comparison("best", &[1, 2, 4, 8]), &runs(errors));
        assert!(found.error > found.numerical.expanded, "{found:?}");
        assert_eq!(found.conclusion(), Conclusion::Converges);
        let expected = (Conclusion::Stops, "stops at 1.0 %".to_string());
        assert_eq!(verdict(&|n| 0.01 + 1.0 / (n * n)), expected);
        assert_eq!(verdict(&|n| -0.01 - 1.0 / (n * n)), expected);
        // Fell with second order, and then rises.
        let floor = |n: f64| if n < 15.0 { 1.0 / (n * n) } else { 0.006 };
        assert_eq!(verdict(&floor), (Conclusion::Stops, "stops at 0.60 %".into()));
        let noise = |n: f64| if n == 10.0 || n == 20.0 { 0.3 } else { 0.1 };
        assert_eq!(verdict(&noise).0, Conclusion::NoOrder);
        assert_eq!(verdict(&|n| if n == 10.0 { f64::NAN } else { 1.0 / n }).0, Conclusion::Unknown);
    }

    #[test]
    fn a_comparison_reads_its_ladder_and_the_runs_of_its_inputs() {
        let uncertain = Comparison {
            inputs: vec![
                [spec("best", 40), spec("changed", 1)],
                [spec("best", 40), spec("changed", 2)],
            ],
            reference: 0.01,
            ..comparison("best", &[10, 20, 40])
        };
        let of = |n: f64| 0.2 + 1.0 / n;
        let mut all: Vec<_> = [10, 20, 40].map(|n| (spec("best", n), of(n as f64))).into();
        all.extend([(spec("changed", 1), of(40.0) + 0.03), (spec("changed", 2), of(40.0) - 0.04)]);
        let runs = runs(all);
        let found = ComparisonResult::of(&uncertain, &runs);
        near(found.input, 0.05);
        near(found.numerical.standard, 1.5 * 0.025);
        near(found.error, 0.225);
        assert_eq!(found.conclusion(), Conclusion::ModelError);
        let all = [uncertain, comparison("best", &[10, 20, 40])];
        let section = Comparisons(all.to_vec()).evaluate("a_case", &runs).expect("a section");
        assert_eq!(section.id, "a-case-uncertainty");
        let [exact, uncertain] = tables(&section)[..] else { panic!("two tables") };
        assert_eq!(column(uncertain, "E"), ["22 %"]);
        assert_eq!(column(uncertain, "u_input"), ["5.0 %"]);
        assert_eq!(column(exact, "verdict"), ["stops at 20 %"]);
    }

    #[test]
    fn each_ladder_has_its_conclusion() {
        let uncertain =
            |variant, ns: &[usize]| Comparison { reference: 0.01, ..comparison(variant, ns) };
        let (ladder, law) = ([10, 14, 20], |n: f64| 1.0 / (n * n));
        let of = |variant, value: &dyn Fn(f64) -> f64| {
            ladder.map(|n| (spec(variant, n), value(n as f64)))
        };
        let all = [
            of("law", &law),
            of("floor", &|n| 0.4 + law(n)),
            of("noise", &|n| if n == 14.0 { 0.02 } else { 0.01 }),
            of("slow", &|n| 0.02 + 2.0 / n),
        ];
        let made = runs(all.concat());
        let compared = [
            (comparison("law", &ladder), Conclusion::Converges),
            (comparison("floor", &ladder), Conclusion::Stops),
            (uncertain("law", &ladder), Conclusion::NotDistinguishable),
            (uncertain("floor", &ladder), Conclusion::ModelError),
            (uncertain("slow", &ladder), Conclusion::TooUncertain),
            (uncertain("noise", &ladder), Conclusion::NoOrder),
            (uncertain("none", &ladder), Conclusion::Unknown),
            (uncertain("missing", &ladder), Conclusion::Unknown),
        ];
        let all = compared.iter().map(|(of, _)| of.clone()).collect();
        let runs = whole(Comparisons(all).runs(), made);
        for (of, expected) in &compared {
            assert_eq!(ComparisonResult::of(of, &runs).conclusion(), *expected);
        }
    }
}
