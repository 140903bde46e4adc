//! The smallest error of each constant that the gates of a case detect.

use std::collections::BTreeSet;

use touchstone_base::{
    gate::{Bound, Cause, Evidence, Gate},
    mutation::{Constant, Detect, Mutation},
    record::Record,
    spec::{RunKey, RunSpec},
};
use touchstone_report::{Cell, code};

use super::anchor;
use crate::{
    columns::TableColumns,
    detect::{DETECTED, GATES, UNDETECTED},
    runs::{Planned, Runs, Tier},
    section::Section,
    study::Study,
};

/// How to read the errors that gates detect.
pub const READING: &str = "Errors that the gates can detect. One constant of the scene is multiplied by 1 + \
                     e and by 1 - e, while measurements and gates keep the original settings. An error \
                     counts as detected if the run fails a gate with both signs. Gates that compare the \
                     program with itself do not count, and conserved quantities count for constants of the \
                     discretisation alone. An error of 3 % of a physical constant and of 10 % of an \
                     ingredient of the method must be detected, and so must gross faults: a wrong sign (× \
                     -1), a missing term (× 0), a constant that is wrong by a factor. Errors between 0.1 % \
                     and 30 % are tried by bisection, which assumes that a larger error is easier to \
                     detect: `detected from` does not cover the larger errors that were not tried. The \
                     quick tier tries only the largest error that may go undetected.";

/// An error that means that none up to 30 % is detected.
const NONE: f64 = 1.0;

/// Errors of the constants of a case that the gates of some of its runs must detect.
pub struct Sensitivity {
    /// The runs, each judged by the gates that the plans have for it.
    pub runs: Vec<RunSpec>,
    /// The constants.
    pub of: Vec<Watched>,
    /// Are smaller errors than the largest that may go undetected tried?
    pub is_bisected: bool,
}

/// A constant whose errors the gates must detect.
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

    /// Adds gross faults that some gate must detect: factors of the constant.
    pub fn faults(self, factors: &[f64]) -> Self {
        Self { faults: factors.to_vec(), ..self }
    }

    /// A constant to which the gates are blind up to an error, 1 if they are up to 30 %, for a reason and by
    /// a cause of [`causes`](super::causes).
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

/// A constant and the results of the searches: the best of all runs.
struct SensitivityRow<'a> {
    watched: &'a Watched,
    detected: Option<&'a Record>,
    undetected: Option<f64>,
    /// Factors of gross faults, and how many gates detect each.
    faults: Vec<(f64, usize)>,
    /// Was every search made to its end?
    is_whole: bool,
}

impl SensitivityRow<'_> {
    /// The smallest detected error; NaN if a search is missing.
    fn error(&self) -> f64 {
        let error = self.detected.and_then(|record| record.value(DETECTED)).unwrap_or(NONE);
        if self.is_whole { error } else { f64::NAN }
    }

    fn gates(&self) -> String {
        let names = self.detected.and_then(|record| record.numerics.get(GATES));
        let names = names.and_then(|names| names.as_str()).unwrap_or_default();
        names.split_whitespace().map(code).collect::<Vec<_>>().join(" ")
    }
}

impl Study for Sensitivity {
    fn runs(&self) -> Vec<Planned> {
        let mut runs = Vec::new();
        for Watched { constant, faults, .. } in &self.of {
            runs.extend(self.searches(*constant));
            let pairs = faults.iter().flat_map(|factor| self.faulty(*constant, *factor));
            runs.extend(pairs.flat_map(|(healthy, faulty)| [healthy.clone(), faulty]));
        }
        runs.into_iter().map(Planned::new).collect()
    }

    fn evaluate(&self, case: &str, runs: &Runs) -> Option<Section> {
        let row = |watched| row(self, watched, runs);
        let rows: Vec<SensitivityRow> = self.of.iter().map(row).collect();
        let mut section =
            Section::new(&anchor(case, "sensitivity"), "Errors that the gates detect");
        for row in &rows {
            section = section.judge(gate(case, row.watched), row.error());
            for &(factor, failed) in &row.faults {
                let gate = fault_gate(case, row.watched.constant, factor);
                section = section.judge(gate, failed as f64);
            }
        }
        let faults = |row: &SensitivityRow| {
            let of = |(factor, failed): &(f64, usize)| format!("× {factor}: {failed}");
            row.faults.iter().map(of).collect::<Vec<_>>().join(", ")
        };
        let percent = |error: f64| Cell::percent(error, 2);
        let error = move |row: &SensitivityRow| match row.error() {
            NONE => Cell::text("none"),
            error => percent(error),
        };
        let table = TableColumns::<SensitivityRow>::default()
            .text("constant", |row| row.watched.constant.words())
            .num(["must be detected", "-"], move |row| percent(row.watched.constant.allowed()))
            .num(["detected from", "-"], error)
            .num(["not detected", "-"], move |row| row.undetected.map_or(Cell::text("–"), percent))
            .marked("gates that detect it", SensitivityRow::gates)
            .text("gates that detect a gross fault", faults)
            .text("why not smaller", |row| row.watched.blind.as_ref().map_or("", |blind| blind.why))
            .table("Errors of constants.", &rows);
        (!self.of.is_empty()).then(|| section.block(table))
    }

    /// Errors of constants are searched in every judged run of the case, not in the few of the full tier.
    fn deepen(&mut self, full: &[Planned]) {
        let known: Vec<RunKey> = self.runs.iter().map(RunSpec::key).collect();
        for Planned { spec, gates, .. } in full {
            let is_healthy = spec.is_simulation() && spec.mutation.is_none();
            if is_healthy && !gates.is_empty() && !known.contains(&spec.key()) {
                self.runs.push(spec.clone());
            }
        }
    }
}

/// The search of that run which detects the smallest error.
fn row<'a>(sensitivity: &Sensitivity, watched: &'a Watched, runs: &'a Runs) -> SensitivityRow<'a> {
    let searches = sensitivity.searches(watched.constant);
    let records: Vec<Option<&Record>> = searches.map(|spec| runs.completed(&spec)).collect();
    let is_whole = records.iter().all(Option::is_some);
    let made = || records.iter().copied().flatten();
    let error = |record: &&Record| record.value(DETECTED).unwrap_or(NONE);
    let detects = made().filter(|record| record.value(DETECTED).is_some());
    let detected = detects.min_by(|a, b| error(a).total_cmp(&error(b)));
    let undetected = match detected {
        Some(record) => record.value(UNDETECTED),
        None => made().find_map(|record| record.value(UNDETECTED)),
    };
    let failed = |factor: &f64| failed(sensitivity, watched.constant, *factor, runs);
    let faults = watched.faults.iter().map(|factor| (*factor, failed(factor))).collect();
    SensitivityRow { watched, detected, undetected, faults, is_whole }
}

/// The gates of the runs that fail with a gross fault, without gates that compare the program with itself.
fn failed(sensitivity: &Sensitivity, of: Constant, factor: f64, runs: &Runs) -> usize {
    let mut failed = BTreeSet::new();
    for (healthy, spec) in sensitivity.faulty(of, factor) {
        let Some((record, healthy)) = runs.record(&spec).zip(runs.judged(healthy)) else {
            continue;
        };
        let gates = healthy.planned.gates.iter();
        let outside = gates.filter(|gate| gate.evidence != Evidence::Regression);
        let fails = outside.filter(|gate| gate.judge_record(record).verdict.is_failure());
        failed.extend(fails.map(|gate| gate.id.as_str()));
    }
    failed.len()
}

/// The gate on the number of gates that detect a gross fault.
fn fault_gate(case: &str, of: Constant, factor: f64) -> Gate {
    let id = format!("{case}.detects.{}_x_{factor}", of);
    let because = "a wrong sign, a missing term, and a constant that is wrong by a factor are faults of the \
                   program, which some gate must detect";
    Gate::new(id, "gates that fail", Bound::Above(1.0), Evidence::Theory, because)
}

/// The gate on the smallest error that is detected.
fn gate(case: &str, watched: &Watched) -> Gate {
    let id = format!("{case}.detects.{}", watched.constant);
    let because = match watched.constant.is_physical() {
        true => "a result with a physical constant that is wrong by 3 % is wrong",
        false => "an ingredient of the method that is wrong by 10 % is a fault of the program",
    };
    let bound = Bound::Below(watched.constant.allowed());
    let gate = Gate::new(id, DETECTED, bound, Evidence::Theory, because);
    match &watched.blind {
        Some(Blind { up_to, why, cause }) => {
            gate.with_limitation(Bound::Below(*up_to), *why, cause)
        }
        None => gate,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use touchstone_base::gate::Verdict;

    use super::*;
    use crate::{
        runs::JudgedRun,
        studies::{
            causes::NOT_MEASURED,
            tests::{ERROR, column, evaluate, records, spec, tables},
        },
    };

    /// A search that was not made counted as one that found nothing, which a limitation allows.
    #[test]
    fn a_search_that_is_missing_fails() {
        let run = RunSpec::new("case", "seed", json!({}));
        let watched = [
            Watched::new(Constant::Height).faults(&[0.0]),
            Watched::blind_up_to(Constant::Speed, 1.0, "nothing depends on it", &NOT_MEASURED),
        ];
        let of = Sensitivity::new(Tier::Full, [run], watched);
        let study = evaluate(&of, Runs::new(Vec::new()));
        assert_eq!(study.judged.len(), 3);
        for judged in study.judged {
            assert_eq!(judged.judgement.verdict, Verdict::Fail, "{}", judged.gate.id);
        }
    }

    /// One of two searched runs was made, and detects 2 %: the other one is still missing.
    #[test]
    fn one_search_of_two_is_not_all() {
        let of = [spec("seed", 1), spec("seed", 2)];
        let sensitivity = Sensitivity::new(Tier::Full, of, [Watched::new(Constant::Viscosity)]);
        let all = sensitivity.searches(Constant::Viscosity);
        let made = all.take(1).map(|search| (search, self::search(Some(0.02), None)));
        let study = evaluate(&sensitivity, records(made));
        assert_eq!(study.judged[0].judgement.verdict, Verdict::Fail);
    }

    /// Result of a search: the smallest detected error, and the largest smaller one that is not detected.
    fn search(detected: Option<f64>, undetected: Option<f64>) -> impl FnOnce(&mut Record) {
        move |record: &mut Record| {
            if let Some(error) = detected {
                record.put(DETECTED, error);
                record.numerics.insert(GATES.into(), format!("case.at_{error}").into());
            }
            if let Some(error) = undetected {
                record.put(UNDETECTED, error);
            }
        }
    }

    /// The run that detects the smaller error counts, in any order, with its own gates and its own largest
    /// undetected error. A later run that detects nothing must not add its 30 % to the 2 % of another one.
    #[test]
    fn the_run_that_sees_most_counts() {
        let of = [spec("seed", 1), spec("seed", 2)];
        let sensitivity = Sensitivity::new(Tier::Full, of, [Watched::new(Constant::Viscosity)]);
        for (first, second, expected) in [
            (
                (Some(0.02), Some(0.01)),
                (Some(0.05), Some(0.03)),
                ["2.0 %", "1.0 %", "`case.at_0.02`"],
            ),
            (
                (Some(0.05), Some(0.03)),
                (Some(0.02), Some(0.01)),
                ["2.0 %", "1.0 %", "`case.at_0.02`"],
            ),
            ((None, Some(0.3)), (Some(0.02), None), ["2.0 %", "–", "`case.at_0.02`"]),
            ((Some(0.02), None), (None, Some(0.3)), ["2.0 %", "–", "`case.at_0.02`"]),
            ((None, Some(0.3)), (None, Some(0.3)), ["none", "30 %", ""]),
        ] {
            let searches = sensitivity.searches(Constant::Viscosity);
            let found = [first, second].map(|(detected, undetected)| search(detected, undetected));
            let study = evaluate(&sensitivity, records(searches.zip(found)));
            let table = tables(&study)[0];
            let shown = ["detected from", "not detected", "gates that detect it"]
                .map(|head| column(table, head).concat());
            assert_eq!(shown, expected, "of {first:?} and {second:?}");
            let verdict = &study.judged[0].judgement.verdict;
            let passes = expected[0] != "none";
            assert_eq!(*verdict == Verdict::Pass, passes, "3 % must be detected: {verdict:?}");
        }
    }

    /// Gates count once, whichever of the runs fails them, and one that compares the program with itself does
    /// not count.
    #[test]
    fn a_gross_fault_counts_the_gates_that_it_fails() {
        let of = [spec("seed", 1), spec("seed", 2)];
        let watched = Watched::new(Constant::Viscosity).faults(&[-1.0]);
        let sensitivity = Sensitivity::new(Tier::Full, of.clone(), [watched]);
        let gate =
            |id: &str, evidence| Gate::new(id, ERROR, Bound::Below(0.1), evidence, "made up");
        let planned = |spec: RunSpec, gates: Vec<Gate>| {
            let record = Record::of(&spec, 1);
            JudgedRun::new(Planned::new(spec).judged(gates), record)
        };
        let both = |k: usize| {
            let own = gate(&format!("case.own_{k}"), Evidence::Analytic);
            vec![
                gate("case.shared", Evidence::Theory),
                own,
                gate("case.before", Evidence::Regression),
            ]
        };
        let mut runs: Vec<JudgedRun> =
            of.iter().enumerate().map(|(k, spec)| planned(spec.clone(), both(k))).collect();
        for ((_, spec), error) in sensitivity.faulty(Constant::Viscosity, -1.0).zip([0.2, 0.05]) {
            let mut run = planned(spec, Vec::new());
            run.record.put(ERROR, error);
            runs.push(run);
        }
        let study = evaluate(&sensitivity, Runs::new(runs));
        let shown = column(tables(&study)[0], "gates that detect a gross fault");
        assert_eq!(shown, ["× -1: 2"], "`case.shared` and `case.own_0` of the first run");
        let of_fault = study.judged.iter().find(|judged| judged.gate.id.contains("_x_-1"));
        assert_eq!(of_fault.expect("a gate").judgement.verdict, Verdict::Pass);
    }
}
