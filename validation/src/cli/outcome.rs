//! How `run` ends, for a person who reads ten seconds: the headline error, its bound, its cost, and a command
//! to go on with.

use base::{
    gate::Verdict,
    record::{Record, Status},
    spec::RunSpec,
};
use harness::{
    case::{self, Case, Tier},
    declare::Declaration,
    runs::Judged,
    studies::{cost_in_words, headline},
};
use report::Counts;

use super::{output, summary};

/// The lines after the tables of a run.
pub fn outcome(case: &dyn Case, spec: &RunSpec, record: &Record, verdicts: &[Judged]) -> String {
    let declared = case.declaration(Tier::Quick);
    let (error, metric) = error(&declared, record, verdicts);
    let lines = [
        ("error", error),
        ("bound", bound(verdicts, &metric)),
        ("gates", gates(verdicts)),
        ("cost", cost_in_words(record)),
        ("next", next(case, &declared, spec, record, verdicts)),
    ];
    let told = lines.iter().filter(|(_, words)| !words.is_empty());
    told.map(|(head, words)| output::hanging(head, 7, words)).collect()
}

/// The error that the card of the case shows, if the run has it, and otherwise the first number that is
/// judged; and the name of its metric.
fn error(declared: &Declaration, record: &Record, verdicts: &[Judged]) -> (String, String) {
    if let Some(card) = &declared.card
        && let Ok(error) = headline(card, record)
    {
        let words = format!("{error}, {}, against {}", card.error, card.against);
        return (words, card.metric.name.clone());
    }
    let first = verdicts.iter().find(|judged| judged.judgement.value.is_some());
    let found = first.and_then(|judged| record.metrics.get_key_value(&judged.gate.metric));
    found.map_or_else(Default::default, |(name, metric)| {
        let value = report::sig(metric.value, 4);
        (format!("{name} = {value} [{}], {}", metric.unit, metric.formula), name.clone())
    })
}

/// The bound of that metric, with the verdict.
fn bound(verdicts: &[Judged], metric: &str) -> String {
    let of_metric = verdicts.iter().filter(|judged| judged.gate.metric == metric);
    let Some(Judged { gate, judgement, .. }) = summary::worst(of_metric) else {
        return "none: no plan has a gate on this number for this variant with these settings"
            .into();
    };
    let margin = judgement.margin.map(|m| format!(", {} of it left", report::percent(m, 2)));
    let (verdict, margin) = (judgement.verdict, margin.unwrap_or_default());
    format!("{}: {verdict}{margin} ({})", gate.bounds(), gate.id)
}

fn gates(verdicts: &[Judged]) -> String {
    match verdicts.is_empty() {
        true => String::new(),
        false => Counts::of(verdicts.iter().map(|judged| judged.judgement.verdict)).headline(),
    }
}

/// The command to try next.
fn next(
    case: &dyn Case,
    declared: &Declaration,
    spec: &RunSpec,
    record: &Record,
    verdicts: &[Judged],
) -> String {
    let name = case.name();
    let worst = summary::worst(verdicts.iter())
        .filter(|judged| matches!(judged.judgement.verdict, Verdict::Fail | Verdict::Limitation));
    match (worst, &record.status) {
        (Some(judged), _) => format!("touchstone explain {}", judged.gate.id),
        (None, Status::Diverged { .. }) if !declared.limits.of.is_empty() => {
            format!("touchstone stability {name}")
        }
        (None, Status::Diverged { .. }) => format!("touchstone list {name}"),
        (None, _) if verdicts.is_empty() => {
            format!("touchstone verify {name} (makes and judges the runs that have gates)")
        }
        (None, _) => finer(case, declared, spec).unwrap_or_default(),
    }
}

/// The run with half the spacing: by the setting in which the levels of a ladder differ.
pub fn finer(case: &dyn Case, declared: &Declaration, spec: &RunSpec) -> Option<String> {
    let ladders = declared.accuracy.iter().flat_map(|accuracy| &accuracy.ladders);
    let ladder = ladders.into_iter().find(|ladder| ladder.levels.len() > 1)?;
    let [coarse, fine] =
        [ladder.levels.first()?, ladder.levels.last()?].map(|level| &level.run.spec.settings);
    let names = case.fields().iter().map(|field| field.name);
    let (name, is_count) = names.into_iter().find_map(|name| {
        let [coarse, fine] = [coarse, fine].map(|settings| settings[name].as_f64());
        (coarse? != fine?).then_some((name, coarse < fine))
    })?;
    let now = spec.settings[name].as_f64()?;
    let half_the_spacing = if is_count { 2.0 * now } else { 0.5 * now };
    let mut set = case::changed(case, spec);
    set.retain(|assignment| assignment.split('=').next() != Some(name));
    set.push(format!("{name}={half_the_spacing}"));
    case::spec(case, &spec.variant, &set).ok()?;
    Some(case::command(case, &spec.variant, &set))
}
