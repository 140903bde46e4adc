//! What the report says first of a case: errors and costs of two variants, how far they got, verdicts.

use base::{
    record::{Record, Status},
    spec::RunSpec,
};
use report::{Block, Card, Counts, Figure, exact, percent, plain, sci, seconds, sig};

use super::{limit, validation};
use crate::{
    declare::{self, Declaration},
    runs::{Judged, Runs, by_cause},
    study::Study,
};

/// The card of a case, if it declares one.
pub fn card(case: &str, declared: &Declaration, studies: &[Study], runs: &Runs) -> Option<Card> {
    let card = declared.card.as_ref()?;
    let of_runs = runs.all.iter().flat_map(|run| &run.judged);
    let judged: Vec<&Judged> = of_runs.chain(studies.iter().flat_map(|s| &s.judged)).collect();
    let mut facts = vec![("Error:".to_string(), error(card))];
    for (name, spec) in ["Best, ", "Paper's, "].into_iter().zip(&card.runs) {
        facts.push((format!("{name}`{}`:", spec.variant), result(card, runs.record(spec))));
    }
    let stable = stable(declared, &card.runs, runs);
    facts.extend(stable.map(|text| ("Largest stable time step over theory:".into(), text)));
    let compared = validation::line(&declared.comparisons, runs);
    facts.extend(compared.map(|text| ("Comparisons with references:".into(), text)));
    facts.extend(reach(card, runs).map(|text| ("Completed for".into(), text)));
    // The two causes that most gates share.
    let causes = by_cause(judged.iter().copied(), |judged| judged).into_iter().take(2);
    Some(Card {
        id: case.into(),
        title: card.title.into(),
        picture: picture(card.picture, studies),
        facts,
        counts: Counts::of(judged.iter().map(|judged| judged.judgement.verdict)),
        limitations: causes.map(|(cause, _)| cause.what.to_string()).collect(),
    })
}

/// The name of the error, and what it is compared with.
fn error(card: &declare::Card) -> String {
    let uncertainty = card.uncertainty.map(|u| format!(" (± {})", percent(u, 2)));
    format!("{}, against {}{}", card.error, card.against, uncertainty.unwrap_or_default())
}

/// The error of a run and what it cost.
fn result(card: &declare::Card, record: Option<&Record>) -> String {
    let Some(record) = record else { return "not run".into() };
    match headline(card, record) {
        Ok(error) => format!("**{error}** in {}", cost(record)),
        Err(status) => plain(&status),
    }
}

/// The error of a run in per cent.
///
/// # Errors
/// How the run ended, if the error was not measured.
pub fn headline(card: &declare::Card, record: &Record) -> Result<String, String> {
    let value = record.value(card.metric.clone());
    value.map(|value| percent(value, 2)).ok_or_else(|| record.status.to_string())
}

/// The cost of a run in words.
pub fn cost(record: &Record) -> String {
    let known = |number: f64, words: fn(f64) -> String| match number > 0.0 {
        true => words(number),
        false => "unknown".into(),
    };
    let time = known(record.cost.alone_median().unwrap_or(record.cost.cpu_s), seconds);
    let pairs = known(record.cost.pair_interactions as f64, |pairs| sci(pairs, 2));
    format!("{time} on one core, {pairs} pairs")
}

/// The largest stable time steps over their theoretical limits.
fn stable(declared: &Declaration, specs: &[RunSpec], runs: &Runs) -> Option<String> {
    let of = |spec: &RunSpec| {
        let own = declared.limits.of.iter().filter(|limit| limit.spec.variant == spec.variant);
        let ratios = own.filter_map(|limit| limit::of_theory(limit, runs));
        let least = ratios.min_by(f64::total_cmp)?;
        Some(format!("{} (`{}`)", sig(least, 3), spec.variant))
    };
    let found: Vec<String> = specs.iter().filter_map(of).collect();
    (!found.is_empty()).then(|| found.join(", "))
}

/// The smallest and the largest value of a setting with which a run reached its end.
fn reach(card: &declare::Card, runs: &Runs) -> Option<String> {
    let (setting, name, unit) = card.reach;
    let completed = |record: &&Record| record.status == Status::Completed;
    let of = |record: &Record| record.settings[setting].as_f64();
    let values: Vec<f64> = runs.simulations().filter(completed).filter_map(of).collect();
    let [low, high] = [f64::min, f64::max].map(|pick| values.iter().copied().reduce(pick));
    Some(format!("{name} {} to {}{unit}", exact(low?), exact(high?)))
}

/// One panel of a figure of the studies, as small as a card is.
fn picture((id, panel): (&str, usize), studies: &[Study]) -> Option<Figure> {
    let figures = studies.iter().flat_map(|study| &study.blocks).filter_map(|block| match block {
        Block::Figure(figure) => Some(figure),
        _ => None,
    });
    let figure = figures.into_iter().find(|figure| figure.id == id)?;
    let plot = figure.panels.get(panel)?.clone().without_legend();
    let small = Figure::new(format!("{id}-small"), figure.caption.clone()).panel(plot);
    Some(small.panel_size(150.0, 90.0))
}
