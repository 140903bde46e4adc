//! Summary of a suite on one screen: a line for each case, then the gates that need attention. And the
//! summary of `run`: the headline error, its bound and its cost first, and a next command.

use touchstone_base::{
    gate::{Gate, Verdict, four_digits},
    record::{self, Record, Status},
    spec::RunSpec,
};
use touchstone_harness::{
    case::{self, Case, Tier},
    gates::GateIndex,
    runs::{Judged, counts},
    studies::{
        Breaks, Card, StepLimits, Studies,
        card::{cost as cost_in_words, headline},
    },
    suite::{CaseResults, JudgedOf, Suite},
};
use touchstone_report::Counts;

use super::{explain, judged, output};

/// Number of failures printed in full; the others by name.
const IN_FULL: usize = 5;

/// A line a case; then the failures in full, the number of limitations, and all counts in a sentence.
pub fn summary(suite: &Suite) -> String {
    let heads = [
        "case",
        "fail",
        "limited",
        "control",
        "pass",
        "error",
        "variant",
        "cost",
        "worst gate",
        "margin",
    ];
    let rows: Vec<_> = suite.cases.iter().filter(|of| !of.runs.all.is_empty()).map(row).collect();
    let mut text = String::new();
    if !rows.is_empty() {
        text = output::table(&heads, rows);
        text += "Error and cost are of the recommended variant, the cost on one core; the margin is the\n\
                 unused share of the bound of the worst gate; for a known limitation, of its wider bound.\n";
    }
    text += &failures(suite);
    text += &judged::submissions(suite);
    let counts = suite.counts();
    let limited = counts.count(Verdict::Limitation);
    if limited > 0 {
        let of_all = Counts::of(std::iter::repeat_n(Verdict::Limitation, limited));
        let limited = Counts { unexplained: counts.unexplained, ..of_all };
        text += &format!(
            "\n{}; `touchstone explain --status limitation` lists what limits them, by cause.\n",
            limited.headline()
        );
    }
    text + &format!("\n{}\n", judged::headline(suite))
}

/// How the gates of a case ended, the error of its recommended variant with the cost, and the gate that is
/// the closest to failing, with the unused share of its bound.
fn row(results: &CaseResults) -> Vec<String> {
    let counts = results.counts();
    let mut row = vec![results.case.name().to_string()];
    let columns = [Verdict::Fail, Verdict::Limitation, Verdict::ExpectedFailure, Verdict::Pass];
    row.extend(columns.map(|verdict| match counts.count(verdict) {
        0 => "0".to_string(),
        count => output::painted(verdict, &count.to_string()),
    }));
    row.extend(match results.recommended() {
        Some(record) => [
            headline(&results.studies, record).unwrap_or_else(|_| "none".into()),
            record.run.variant.clone(),
            touchstone_report::seconds(record.cost.alone_median().unwrap_or(record.cost.cpu_s)),
        ],
        None => Default::default(),
    });
    let worst = worst(results.judged().map(|of| of.judged));
    row.push(worst.map_or(String::new(), |judged| judged.gate.id.clone()));
    let margin = worst.and_then(|judged| judged.judgement.margin);
    row.push(margin.map_or(String::new(), |margin| touchstone_report::percent(margin, 2)));
    row
}

/// The judgement closest to failing: the worst verdict, then the least margin. Controls that fail as expected
/// are left out.
pub fn worst<'a>(all: impl Iterator<Item = &'a Judged>) -> Option<&'a Judged> {
    let rank = |judged: &Judged| match judged.judgement.verdict {
        Verdict::Fail => 0,
        Verdict::Limitation => 1,
        Verdict::Pass | Verdict::ExpectedFailure => 2,
    };
    let margin = |judged: &Judged| judged.judgement.margin.unwrap_or(f64::INFINITY);
    all.min_by(|a, b| rank(a).cmp(&rank(b)).then_with(|| margin(a).total_cmp(&margin(b))))
}

fn failures(suite: &Suite) -> String {
    let failed = suite.judged().filter(|of| of.judged.judgement.verdict.is_failure());
    let all: Vec<JudgedOf> = failed.collect();
    let mut text = String::new();
    for of in all.iter().take(IN_FULL) {
        text += &format!("\n{}", explain::in_full(of));
    }
    let more: Vec<&str> = all.iter().skip(IN_FULL).map(|of| &*of.judged.gate.id).collect();
    if !more.is_empty() {
        let words = touchstone_report::counted(more.len(), "more gate fails", "more gates fail");
        let words = format!("{words}: {}", more.join(", "));
        text += &format!("\n{}", output::wrap(&words, ""));
    }
    text
}

/// The lines about a run that come before its tables, and the command to go on with, which comes after them.
pub fn outcome(
    index: &GateIndex,
    spec: &RunSpec,
    record: &Record,
    verdicts: &[Judged],
) -> [String; 2] {
    let case = index.case;
    let studies = case.studies(Tier::Quick);
    let (error, metric) = error_of(&studies, record);
    let card = studies.first::<Card>();
    let beside = card.and_then(|card| card.beside).and_then(|beside| beside(record));
    let nearest = if verdicts.is_empty() { nearest(index, &studies, record, &Some) } else { None };
    let (bound, gates) = match &nearest {
        Some(nearest) => (nearest.in_words(case, &studies), String::new()),
        None => (bound(&studies, record, verdicts, &metric), counts(verdicts).headline()),
    };
    let lines = [
        ("error", error),
        ("also", beside.unwrap_or_default()),
        ("breaks", card.and_then(|card| broken(&card.breaks, record)).unwrap_or_default()),
        ("bound", bound),
        ("gates", gates),
        ("cost", cost_in_words(record)),
    ];
    let told = lines.iter().filter(|(_, words)| !words.is_empty());
    let nearest = nearest.map(|nearest| nearest.spec);
    let next = next(case, &studies, spec, record, verdicts, nearest.as_ref());
    let next = if next.is_empty() { next } else { output::hanging("next", 7, &next) };
    [told.map(|(head, words)| output::hanging(head, 7, words)).collect(), next]
}

/// The judged run with the nearest settings to a run that no gate judges.
pub struct Nearest {
    pub spec: RunSpec,
    pub gate: Gate,
}

/// The nearest settings at which a gate that `judges` allows reads a number of this record: the error of the
/// case, if there is such a gate of the same variant.
pub fn nearest(
    index: &GateIndex,
    studies: &Studies,
    record: &Record,
    judges: &dyn Fn(Gate) -> Option<Gate>,
) -> Option<Nearest> {
    let measured =
        |gate: Gate| judges(gate).filter(|gate| record.metrics.contains_key(&gate.metric));
    let card = studies.first::<Card>().map(|card| &card.metric.name);
    let of_card = |gate: Gate| measured(gate).filter(|gate| Some(&gate.metric) == card);
    let spec = record.spec();
    let of_card = index.nearest(&spec, &of_card);
    let is_own = |(of, _): &(RunSpec, Gate)| of.variant == spec.variant;
    let found = of_card.clone().filter(is_own);
    let (spec, gate) = found.or_else(|| index.nearest(&spec, &measured)).or(of_card)?;
    Some(Nearest { spec, gate })
}

impl Nearest {
    /// The judged quantity.
    pub fn in_words(&self, case: &dyn Case, studies: &Studies) -> String {
        let Nearest { spec, gate } = self;
        let there = case::command(case, spec).replacen("touchstone run ", "", 1);
        let bound = gate.bound.in_words(&in_unit(studies, &gate.metric, spec));
        let Gate { id, metric, .. } = gate;
        format!(
            "none for these settings; the nearest run with a bound is {there}: {metric} {bound} ({id})"
        )
    }
}

/// Writes a value of a metric of this run in the unit in which the error of the case is stated, if the metric
/// is that error.
fn in_unit(studies: &Studies, metric: &str, spec: &RunSpec) -> impl Fn(f64) -> String + use<> {
    let card = studies.first::<Card>().filter(|card| card.metric.name == metric);
    let unit = card.map(|card| (card.stated)(spec).unit);
    move |value| match unit {
        None => four_digits(value),
        Some("") => format!("{}\u{a0}%", four_digits(100.0 * value)),
        Some(unit) => format!("{}\u{a0}{unit}", four_digits(value)),
    }
}

/// A number of a record in words.
pub fn in_words(name: &str, metric: &record::Metric) -> String {
    format!(
        "{name} = {} [{}], {}",
        touchstone_report::sig(metric.value, 4),
        metric.unit,
        metric.formula
    )
}

/// The error of the case, from its card or its first ladder, in words; and the name of its metric.
pub fn error_of(studies: &Studies, record: &Record) -> (String, String) {
    let Some(metric) = studies.error() else {
        return Default::default();
    };
    let measured = record.metrics.get(&metric.name);
    let words = match (studies.first::<Card>(), measured) {
        // The name includes a time that the run did not reach.
        _ if record.status != Status::Completed => format!("none: {}", record.status),
        (_, None) => {
            let reason = record.absent.get(&metric.name).map(ToString::to_string);
            let none = "no reference has these settings, or the run ends before it is compared";
            let reason = reason.unwrap_or_else(|| none.into());
            format!("{} was not measured: {reason}", metric.name)
        }
        (Some(card), Some(found)) => {
            let stated = (card.stated)(&record.run);
            format!("{}, {}", stated.number(found.value), stated.in_words())
        }
        (None, Some(found)) => in_words(&metric.name, found),
    };
    (words, metric.name.clone())
}

/// The setting at which the run broke, if it did.
fn broken(breaks: &Breaks, record: &Record) -> Option<String> {
    let Breaks { value, words: [before, after], has_broken, sign } = breaks;
    has_broken(record).filter(|broken| *broken)?;
    let value = touchstone_report::exact(value(&record.run));
    Some(format!("at {before}{value}{after}: {sign}"))
}

/// The bound of that metric in the unit of the error, with the verdict; of the gate nearest to its bound if
/// this metric has none.
pub fn bound(studies: &Studies, record: &Record, verdicts: &[Judged], metric: &str) -> String {
    let of_metric = worst(verdicts.iter().filter(|judged| judged.gate.metric == metric));
    let Some(Judged { gate, judgement, .. }) = of_metric.or_else(|| worst(verdicts.iter())) else {
        return String::new();
    };
    let margin =
        judgement.margin.map(|m| format!(", {} of it left", touchstone_report::percent(m, 2)));
    let (verdict, margin) = (judgement.verdict, margin.unwrap_or_default());
    let verdict = output::painted(verdict, &verdict.to_string());
    let bound = gate.bounds_in(&in_unit(studies, &gate.metric, &record.spec()));
    let other = match of_metric {
        Some(_) => String::new(),
        None => format!("none on this error; of {} ", gate.metric),
    };
    format!("{other}{bound}: {verdict}{margin} ({})", gate.id)
}

/// The command to try next.
fn next(
    case: &dyn Case,
    studies: &Studies,
    spec: &RunSpec,
    record: &Record,
    verdicts: &[Judged],
    nearest: Option<&RunSpec>,
) -> String {
    let name = case.name();
    let has_limits = studies.of::<StepLimits>().any(|limits| !limits.of.is_empty());
    let worst = worst(verdicts.iter())
        .filter(|judged| matches!(judged.judgement.verdict, Verdict::Fail | Verdict::Limitation));
    match (worst, &record.status) {
        (Some(judged), _) => format!("touchstone explain {}", judged.gate.id),
        (None, record::Status::Diverged { .. }) if has_limits => {
            format!("touchstone stability {name}")
        }
        (None, record::Status::Diverged { .. }) => format!("touchstone list {name}"),
        (None, _) if verdicts.is_empty() => match nearest {
            Some(spec) => format!("{} (the nearest run with a bound)", case::command(case, spec)),
            None => format!("touchstone verify {name} (makes and judges the runs that have gates)"),
        },
        (None, _) => finer(case, studies, spec).unwrap_or_default(),
    }
}

/// The run with half the spacing, as the ladders of its case are refined.
pub fn finer(case: &dyn Case, studies: &Studies, spec: &RunSpec) -> Option<String> {
    let finer = (studies.ladder()?.refine)(spec, 0.5)?.run.spec;
    Some(case::command(case, &finer))
}
