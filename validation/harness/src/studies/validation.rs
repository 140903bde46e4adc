//! The uncertainty of comparisons with references, by ASME V&V 20-2009: E = S − D, result less data, against
//! u_val = (u_num² + u_input² + u_D²)^(1/2).

use base::{
    functions::{ln, powf},
    spec::RunSpec,
};
use report::{Cell, percent, sig};

use super::anchor;
use crate::{
    columns::Columns,
    convergence::{Convergence, Label, Level, convergence},
    declare::Comparison,
    runs::Runs,
    study::Study,
};

/// Roache's factor of safety, and what makes his index a standard uncertainty (V&V 20, section 2).
const SAFETY: f64 = 1.25 / 1.15;
/// The orders that differences of three levels may show: a lower one is taken as this, and a higher one than
/// the method has is a coincidence, not a limit that is approached.
const ORDERS: [f64; 2] = [0.5, 2.5];
/// A comparison whose uncertainty is larger than this share of what is compared would not tell a result that
/// is wrong by a tenth: then |E| < u_val says nothing.
const TELLS: f64 = 0.1;

/// What is known of one comparison. Missing is NaN.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// E = S − D.
    pub error: f64,
    /// u_num, and in words how it follows from the levels.
    pub numerical: (f64, String),
    /// u_input.
    pub input: f64,
    /// u_D.
    pub reference: f64,
}

/// What can be said of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Said {
    /// |E| < u_val.
    NotDistinguishable,
    /// |E| > u_val.
    ModelError,
    /// |E| < u_val, and u_val is too large to say anything.
    TooUncertain,
    /// A run or its ladder is missing.
    Unknown,
}

impl Found {
    /// From the records of a comparison.
    pub fn of(comparison: &Comparison, runs: &Runs) -> Self {
        let value = |spec: &RunSpec| runs.value(spec, comparison.metric.clone());
        let levels = comparison.levels.iter();
        let levels: Vec<Level> = levels
            .map(|level| Level { spacing: level.spacing, value: value(&level.run.spec) })
            .collect();
        let change = |[plain, changed]: &[RunSpec; 2]| value(changed) - value(plain);
        let squares = comparison.inputs.iter().map(change).map(|change| change * change);
        Self {
            error: levels.last().map_or(f64::NAN, |level| level.value),
            numerical: numerical(&levels),
            input: squares.fold(0.0, |sum, square| sum + square).sqrt(),
            reference: comparison.reference,
        }
    }

    /// u_val.
    pub fn uncertainty(&self) -> f64 {
        let parts = [self.numerical.0, self.input, self.reference];
        parts.into_iter().fold(0.0, |sum, part| sum + part * part).sqrt()
    }

    /// The verdict.
    pub fn said(&self) -> Said {
        let (error, uncertainty) = (self.error.abs(), self.uncertainty());
        match error > uncertainty {
            _ if !(error.is_finite() && uncertainty.is_finite()) => Said::Unknown,
            true => Said::ModelError,
            false if uncertainty > TELLS => Said::TooUncertain,
            false => Said::NotDistinguishable,
        }
    }

    /// The verdict in words.
    pub fn in_words(&self) -> String {
        let [error, uncertainty] = [self.error, self.uncertainty()].map(|value| percent(value, 2));
        match self.said() {
            Said::NotDistinguishable => {
                "not distinguishable from the reference at this uncertainty".into()
            }
            Said::ModelError => format!("model error {error} ± {uncertainty}"),
            Said::TooUncertain => format!("uncertain by {uncertainty}: nothing can be said"),
            Said::Unknown => "runs are missing: nothing can be said".into(),
        }
    }
}

/// u_num of the finest of some levels, coarse to fine, and how it was found. Where one order describes all
/// errors, or the last three approach a limit, it is the grid convergence index of the two finest with that
/// order, as a standard uncertainty; else half of the range of the last three, or the distance of the only
/// two.
pub fn numerical(levels: &[Level]) -> (f64, String) {
    let finest = &levels[levels.len().saturating_sub(3)..];
    let range = finest.iter().map(|level| level.value);
    let (low, high) = (range.clone().fold(f64::NAN, f64::min), range.fold(f64::NAN, f64::max));
    let [coarse, middle, fine] = match finest {
        levels if levels.iter().any(|level| !level.value.is_finite()) => {
            return (f64::NAN, "a level is missing".into());
        }
        [] | [_] => return (f64::NAN, "one level".into()),
        [_, _] => return (high - low, "distance of two levels".into()),
        [coarse, middle, fine, ..] => [coarse, middle, fine],
    };
    let [first, last] = [middle.value - coarse.value, fine.value - middle.value];
    let [wide, ratio] = [coarse.spacing / middle.spacing, middle.spacing / fine.spacing];
    let index = |order: f64| SAFETY * last.abs() / (powf(ratio, order) - 1.0);
    let magnitudes: Vec<Level> =
        levels.iter().map(|level| Level { value: level.value.abs(), ..*level }).collect();
    match convergence(&magnitudes) {
        Ok(Convergence { order, interval: [low, high], label: Label::Asymptotic, .. })
            if order >= ORDERS[0] =>
        {
            let [order_, low, high] = [order, low, high].map(|order| sig(order, 2));
            (index(order), format!("order {order_} ({low} … {high})"))
        }
        _ => match order_of_differences(first / last, [wide, ratio]) {
            Some(order) => (index(order), format!("order {} of differences", sig(order, 2))),
            None => (0.5 * (high - low), "half of the range".into()),
        },
    }
}

/// The order p of (h₁ᵖ − h₂ᵖ)/(h₂ᵖ − h₃ᵖ) = this ratio of differences, by Celik's iteration (2008); none if
/// the differences do not shrink, change their sign, or shrink too fast.
fn order_of_differences(differences: f64, [wide, ratio]: [f64; 2]) -> Option<f64> {
    let next = |p: f64| {
        let uneven = (powf(ratio, p) - 1.0) / (powf(wide, p) - 1.0);
        (ln(differences * uneven) / ln(ratio)).clamp(ORDERS[0], ORDERS[1])
    };
    let order = (0..50).fold(1.0, |p, _| next(p));
    (differences > 1.0 && order < ORDERS[1]).then_some(order)
}

/// All comparisons of a case in one table.
pub fn study(case: &str, comparisons: &[Comparison], runs: &Runs) -> Study {
    let caption = "Uncertainty of the comparisons by ASME V&V 20-2009. E is the finest result less the \
                   reference; norms have no sign. u_num follows from the ladder: the grid convergence index \
                   of the two finest runs with the observed order, times 1/1.15; where errors are not \
                   monotone, or fall faster than with an order of 2.5, half of the range of the last three. \
                   u_input is the change by inputs that are wrong by their own uncertainty, of the coarsest \
                   run; u_D the uncertainty that the reference states; u_val the root of the sum of squares. \
                   |E| < u_val: not distinguishable; |E| > u_val: model error. If |E| < u_val and u_val is \
                   above a tenth of what is compared, nothing can be said.";
    type Row<'a> = (&'a Comparison, Found);
    let rows: Vec<Row> = comparisons.iter().map(|of| (of, Found::of(of, runs))).collect();
    let show = |value| Cell::percent(value, 2);
    let table = Columns::<Row>::default()
        .text("comparison", |(of, _)| of.what.clone())
        .text("with", |(of, _)| of.against)
        .of(["E", "-"], |(_, found)| found.error, show)
        .of(["u_num", "-"], |(_, found)| found.numerical.0, show)
        .text("from", |(_, found)| found.numerical.1.clone())
        .of(["u_input", "-"], |(_, found)| found.input, show)
        .of(["u_D", "-"], |(_, found)| found.reference, show)
        .text("u_input and u_D", |(of, _)| of.because)
        .of(["u_val", "-"], |(_, found)| found.uncertainty(), show)
        .text("verdict", |(_, found)| found.in_words())
        .table(caption, &rows);
    Study::new(&anchor(case, "uncertainty"), "Uncertainty of every comparison").block(table)
}

/// One line for the card of a case: how many comparisons ended how.
pub fn line(comparisons: &[Comparison], runs: &Runs) -> Option<String> {
    let said: Vec<Said> = comparisons.iter().map(|of| Found::of(of, runs).said()).collect();
    let names = [
        (Said::NotDistinguishable, "not distinguishable from the reference"),
        (Said::ModelError, "with an error beyond the uncertainty"),
        (Said::TooUncertain, "too uncertain"),
        (Said::Unknown, "without a run"),
    ];
    let counted = names.into_iter().filter_map(|(of, name)| {
        let count = said.iter().filter(|said| **said == of).count();
        (count > 0).then(|| format!("{count} {name}"))
    });
    (!said.is_empty()).then(|| counted.collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::tests::{column, comparison, runs, spec, tables};

    fn of(values: &[(f64, f64)]) -> (f64, String) {
        let level = |&(n, value): &(f64, f64)| Level { spacing: 1.0 / n, value };
        numerical(&values.iter().map(level).collect::<Vec<_>>())
    }

    fn near(value: f64, expected: f64) {
        assert!((value / expected - 1.0).abs() < 1e-6, "{value} instead of {expected}");
    }

    #[test]
    fn a_power_law_has_its_own_error_as_uncertainty_times_the_factor() {
        // Errors 3/n² of any sign: the index is the error itself.
        for sign in [1.0, -1.0] {
            let (found, how) = of(&[10.0, 14.0, 20.0, 40.0].map(|n| (n, sign * 3.0 / (n * n))));
            near(found, 3.0 / 1600.0 * 1.25 / 1.15);
            assert!(how.starts_with("order 2.0 ("), "{how}");
        }
        // 0.5 + 1/n approaches a limit that is not 0, on uneven spacings, and is no slow power law.
        let (found, how) = of(&[10.0, 14.0, 20.0].map(|n| (n, 0.5 + 1.0 / n)));
        near(found, 0.05 * 1.25 / 1.15);
        assert_eq!(how, "order 1.0 of differences");
        // An order beyond 2.5, or below 1/2, is not believed.
        let (found, how) = of(&[(10.0, 1.0), (20.0, 0.51), (40.0, 0.5)]);
        assert_eq!((found, &*how), (0.25, "half of the range"));
        let (_, how) = of(&[(10.0, 1.0), (20.0, 0.5), (40.0, 0.1)]);
        assert_eq!(how, "order 0.50 of differences");
    }

    #[test]
    fn what_is_not_monotone_has_a_range_and_what_is_missing_has_nothing() {
        let (found, how) = of(&[(5.0, 9.0), (10.0, -0.02), (14.0, 0.03), (20.0, 0.01)]);
        assert_eq!((found, &*how), (0.025, "half of the range"));
        // Differences that grow approach nothing.
        let (found, how) = of(&[(10.0, -0.1), (14.0, 0.0), (20.0, 0.3)]);
        assert_eq!((found, &*how), (0.2, "half of the range"));
        let (found, how) = of(&[(10.0, 0.3), (20.0, 0.1)]);
        assert!((found - 0.2).abs() < 1e-15 && how == "distance of two levels");
        for values in [&[][..], &[(10.0, 0.1)], &[(10.0, 0.1), (20.0, f64::NAN), (40.0, 0.1)]] {
            assert!(of(values).0.is_nan());
        }
    }

    #[test]
    fn verdicts_follow_from_the_error_and_all_uncertainties() {
        let found = |error, parts: [f64; 3]| Found {
            error,
            numerical: (parts[0], String::new()),
            input: parts[1],
            reference: parts[2],
        };
        near(found(0.0, [0.02, 0.03, 0.06]).uncertainty(), 0.07);
        assert_eq!(found(-0.069, [0.02, 0.03, 0.06]).said(), Said::NotDistinguishable);
        assert_eq!(found(-0.071, [0.02, 0.03, 0.06]).said(), Said::ModelError);
        assert_eq!(found(0.1, [0.2, 0.0, 0.0]).said(), Said::TooUncertain);
        assert_eq!(found(0.3, [0.2, 0.0, 0.0]).said(), Said::ModelError);
        for missing in [found(f64::NAN, [0.0; 3]), found(0.1, [f64::NAN, 0.0, 0.0])] {
            assert_eq!(missing.said(), Said::Unknown);
        }
        let words = found(-0.071, [0.02, 0.03, 0.06]).in_words().replace('\u{a0}', " ");
        assert_eq!(words, "model error −7.1 % ± 7.0 %");
    }

    #[test]
    fn a_comparison_reads_its_ladder_and_the_runs_of_its_inputs() {
        let comparison = Comparison {
            inputs: vec![
                [spec("best", 40), spec("changed", 1)],
                [spec("best", 40), spec("changed", 2)],
            ],
            reference: 0.01,
            ..comparison("best", &[10, 20, 40])
        };
        let of = |n: f64| 0.1 + 1.0 / n;
        let mut all: Vec<_> = [10, 20, 40].map(|n| (spec("best", n), of(n as f64))).into();
        all.extend([(spec("changed", 1), of(40.0) + 0.03), (spec("changed", 2), of(40.0) - 0.04)]);
        let runs = runs(all);
        let found = Found::of(&comparison, &runs);
        near(found.input, 0.05);
        near(found.numerical.0, 0.025 * 1.25 / 1.15);
        near(found.error, 0.125);
        assert_eq!(found.said(), Said::ModelError);
        let all = [comparison];
        let table = study("a_case", &all, &runs);
        assert_eq!(
            (&*table.id, &*column(tables(&table)[0], "E")[0]),
            ("a-case-uncertainty", "12 %")
        );
        let said = line(&all, &runs).expect("a line");
        assert_eq!(said, "1 with an error beyond the uncertainty");
        assert_eq!(line(&[], &runs), None);
    }
}
