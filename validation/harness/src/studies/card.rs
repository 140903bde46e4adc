//! What the report says first of a case: errors and costs of two variants, how far they got, verdicts.

use std::collections::BTreeMap;

use base::{
    record::{Record, Status},
    spec::RunSpec,
};
use report::{Block, Card, Counts, Figure, Legend, Panel, exact, percent, sci, seconds, sig};

use super::{limit, validation};
use crate::{
    declare::{self, Declaration},
    runs::{Judged, Runs},
    study::Study,
};

/// The card of a case, if it declares one.
pub fn card(case: &str, declared: &Declaration, studies: &[Study], runs: &Runs) -> Option<Card> {
    let card = declared.card.as_ref()?;
    let of_runs = runs.all.iter().flat_map(|run| &run.judged);
    let judged: Vec<&Judged> = of_runs.chain(studies.iter().flat_map(|s| &s.judged)).collect();
    let mut facts = vec![("Error:".to_string(), error(card))];
    for (name, spec) in ["Best, ", "Paper's, "].into_iter().zip(&card.runs) {
        let found = runs.record(spec).map(|record| Headline::of(card, record));
        facts.push((format!("{name}`{}`:", spec.variant), result(found)));
    }
    let stable = stable(declared, &card.runs, runs);
    facts.extend(stable.map(|text| ("Largest stable time step over theory:".into(), text)));
    let compared = validation::line(&declared.comparisons, runs);
    facts.extend(compared.map(|text| ("Comparisons by V&V 20:".into(), text)));
    facts.extend(reach(card, runs).map(|text| ("Completed for".into(), text)));
    Some(Card {
        id: case.into(),
        title: card.title.into(),
        picture: picture(card.picture, studies),
        facts,
        counts: Counts::of(judged.iter().map(|judged| judged.judgement.verdict)),
        limitations: main_limitations(&judged),
    })
}

/// The name of the error, and what it is compared with.
fn error(card: &declare::Card) -> String {
    let uncertainty = card.uncertainty.map(|u| format!(" (± {})", percent(u, 2)));
    format!("{}, against {}{}", card.error, card.against, uncertainty.unwrap_or_default())
}

/// The error of a run and what it cost.
fn result(found: Option<Headline>) -> String {
    let Some(found) = found else { return "not run".into() };
    match found.error() {
        Ok(error) => format!("**{error}** in {}", found.cost()),
        Err(status) => status,
    }
}

/// The headline error of a run, and what it cost.
#[derive(Clone, Debug)]
pub struct Headline {
    /// Name of the variant.
    pub variant: String,
    /// The error, if it was measured.
    pub value: Option<f64>,
    /// How the run ended.
    pub status: Status,
    /// Processor time for stepping \[s\], with the machine for itself if the run was timed so.
    pub seconds: f64,
    /// Pair interactions.
    pub pairs: f64,
}

impl Headline {
    /// Of a record of the case that declares the card.
    pub fn of(card: &declare::Card, record: &Record) -> Self {
        Self::new(record, record.value(card.metric.clone()))
    }

    /// Of a record whose error is this.
    pub fn new(record: &Record, value: Option<f64>) -> Self {
        let cost = &record.cost;
        Self {
            variant: record.variant.clone(),
            value,
            status: record.status.clone(),
            seconds: cost.alone_median().unwrap_or(cost.cpu_s),
            pairs: cost.pair_interactions as f64,
        }
    }

    /// The best run of a case and that of the paper's variant, as far as they were made.
    pub fn all(declared: &Declaration, runs: &Runs) -> Vec<Self> {
        let of_card = |card: &declare::Card| -> Vec<Self> {
            let records = runs.records(card.runs.iter().cloned());
            records.into_iter().map(|record| Self::of(card, record)).collect()
        };
        declared.card.as_ref().map(of_card).unwrap_or_default()
    }

    /// The error in per cent, or how the run ended.
    ///
    /// # Errors
    /// If the error was not measured.
    pub fn error(&self) -> Result<String, String> {
        self.value.map(|value| percent(value, 2)).ok_or_else(|| self.status.to_string())
    }

    /// The cost in words.
    pub fn cost(&self) -> String {
        let known = |number: f64, words: String| match number > 0.0 {
            true => words,
            false => "unknown".into(),
        };
        let time = known(self.seconds, seconds(self.seconds));
        let pairs = known(self.pairs, sci(self.pairs, 2));
        format!("{time} on one core, {pairs} pairs")
    }
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
    let values: Vec<f64> = runs
        .simulations()
        .filter(completed)
        .filter_map(|record| record.settings[setting].as_f64())
        .collect();
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
    let panel = match figure.panels.get(panel)?.clone() {
        Panel::Plot(plot) => Panel::Plot(plot.legend(Legend::Hidden)),
        other => other,
    };
    let mut small = Figure::new(format!("{id}-small"), figure.caption.clone());
    small.panels.push(panel);
    Some(small.panel_size(150.0, 90.0))
}

/// The two causes that most gates share.
fn main_limitations(judged: &[&Judged]) -> Vec<String> {
    let mut causes: BTreeMap<&str, usize> = BTreeMap::new();
    for judged in judged {
        if let Some(cause) = judged.limitation().and_then(|known| known.cause.as_ref()) {
            *causes.entry(&cause.what).or_default() += 1;
        }
    }
    let mut causes: Vec<(&str, usize)> = causes.into_iter().collect();
    causes.sort_by_key(|(_, gates)| std::cmp::Reverse(*gates));
    causes.into_iter().take(2).map(|(what, _)| what.to_string()).collect()
}
