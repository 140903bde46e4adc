//! What the report says first of a case: errors and costs of two variants, how far they got, verdicts.

use touchstone_base::{
    record::{Record, Status},
    spec::RunSpec,
};
use touchstone_report::{Block, Card, Figure, exact, plain, sci, seconds, sig};

use super::{
    limit,
    validation::{self, Found},
};
use crate::{
    declare::{self, Breaks, Comparison, Declaration},
    runs::{Judged, Runs, by_cause, counts},
    study::Study,
};

/// The card of a case, if it declares one.
pub fn card(case: &str, declared: &Declaration, studies: &[Study], runs: &Runs) -> Option<Card> {
    let card = declared.card.as_ref()?;
    let of_runs = runs.all.iter().flat_map(|run| &run.judged);
    let judged: Vec<&Judged> = of_runs.chain(studies.iter().flat_map(|s| &s.judged)).collect();
    let stated = |spec: &RunSpec| (card.stated)(&spec.settings).in_words();
    let mut facts: Vec<(String, String)> =
        card.runs.first().map(|spec| ("Error:".to_string(), stated(spec))).into_iter().collect();
    for (name, spec) in ["Recommended, ", "Paper's, "].into_iter().zip(&card.runs) {
        facts.push((format!("{name}`{}`:", spec.variant), result(card, declared, spec, runs)));
    }
    for record in card.runs.iter().filter_map(|spec| runs.record(spec)) {
        let words = card.beside.and_then(|beside| beside(record));
        facts.extend(words.map(|words| (format!("`{}`:", record.run.variant), words)));
    }
    let stable = stable(declared, &card.runs, runs);
    facts.extend(stable.map(|text| ("Largest stable time step over theory:".into(), text)));
    let compared = validation::line(&declared.comparisons, runs);
    facts.extend(compared.map(|text| ("Comparisons with references:".into(), text)));
    facts.extend(breaks(card, runs).map(|text| ("Breaks".into(), text)));
    // The two causes that most gates share.
    let causes = by_cause(judged.iter().copied(), |judged| judged).into_iter().take(2);
    Some(Card {
        id: case.into(),
        title: card.title.into(),
        picture: picture(card, declared, studies),
        facts,
        counts: counts(judged.iter().copied()),
        limitations: causes.map(|(cause, _)| cause.what.to_string()).collect(),
    })
}

/// The error of a run, with its uncertainty if the case declares the comparison, and what it cost.
fn result(card: &declare::Card, declared: &Declaration, spec: &RunSpec, runs: &Runs) -> String {
    let Some(record) = runs.record(spec) else { return "not run".into() };
    let error = match headline(card, record) {
        Ok(error) => error,
        Err(status) => return plain(&status),
    };
    let is_this = |of: &&Comparison| {
        let finest = of.levels.last().map(|level| level.run.spec.key());
        of.reference > 0.0 && of.metric == card.metric && finest == Some(spec.key())
    };
    let compared = declared.comparisons.iter().find(is_this);
    let uncertainty = compared.map(|of| Found::of(of, runs).uncertainty());
    let number = |value| format!(" ± {}", (card.stated)(&record.run.settings).number(value));
    let uncertainty = uncertainty.filter(|u| u.is_finite()).map(number).unwrap_or_default();
    format!("**{error}**{uncertainty} in {}", cost(record))
}

/// The error of a run in its unit.
///
/// # Errors
/// How the run ended, if the error was not measured.
pub fn headline(card: &declare::Card, record: &Record) -> Result<String, String> {
    let value = record.value(card.metric.clone());
    let stated = (card.stated)(&record.run.settings);
    value.map(|value| stated.number(value)).ok_or_else(|| record.status.to_string())
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

/// For the variant of each run of the card the smallest value of a setting at which a run broke, or the range
/// of values at which none did.
fn breaks(card: &declare::Card, runs: &Runs) -> Option<String> {
    let Breaks { setting, words: [before, after], has_broken, sign } = card.breaks;
    let of = |spec: &RunSpec| {
        let own = runs.simulations().filter(|record| {
            record.run.variant == spec.variant
                && record.run.mutation.is_none()
                && record.run.disorder.is_none()
        });
        let answers = own.filter_map(|record| {
            let is_refused = matches!(record.status, Status::Refused { .. });
            let has_broken = has_broken(record).filter(|_| !is_refused)?;
            let broken = has_broken || record.status != Status::Completed;
            Some((record.run.settings[setting].as_f64()?, broken))
        });
        let answers: Vec<(f64, bool)> = answers.collect();
        let broken = answers.iter().filter(|(_, broken)| *broken).map(|(value, _)| *value);
        let least = |values: &mut dyn Iterator<Item = f64>| values.reduce(f64::min);
        let text = match least(&mut broken.into_iter()) {
            Some(value) => format!("at {before}{}{after} ({sign}, or it diverges)", exact(value)),
            None => {
                let low = least(&mut answers.iter().map(|(value, _)| *value))?;
                let high = answers.iter().map(|(value, _)| *value).fold(low, f64::max);
                let values = match low == high {
                    true => exact(low),
                    false => format!("{} to {}", exact(low), exact(high)),
                };
                format!("in no run at {before}{values}{after}")
            }
        };
        Some(format!("`{}` {text}", spec.variant))
    };
    let found: Vec<String> = card.runs.iter().filter_map(of).collect();
    (!found.is_empty()).then(|| found.join("; "))
}

/// The panel that shows the run of the card, as small as a card is.
fn picture(card: &declare::Card, declared: &Declaration, studies: &[Study]) -> Option<Figure> {
    let (id, panel) = (card.picture, declared.pictured(card)?);
    let figures = studies.iter().flat_map(|study| &study.blocks).filter_map(|block| match block {
        Block::Figure(figure) => Some(figure),
        _ => None,
    });
    let figure = figures.into_iter().find(|figure| figure.id == id)?;
    let plot = figure.panels.get(panel)?.clone().without_legend();
    let small = Figure::new(format!("{id}-small"), figure.caption.clone()).panel(plot);
    Some(small.panel_size(150.0, 90.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        bisect::STABLE,
        declare::{Stated, StepLimit, StepLimits},
        studies::tests::{ERROR, comparison, records, run, spec},
    };

    fn made_up() -> declare::Card {
        declare::Card {
            title: "Made up",
            picture: "none",
            metric: ERROR.into(),
            stated: |settings| Stated {
                name: format!("distance at n = {}", settings["n"]),
                against: "nothing",
                uncertainty: Some(0.5),
                unit: "a",
            },
            beside: None,
            runs: vec![spec("good", 1), spec("bad", 1)],
            breaks: Breaks {
                setting: "n",
                words: ["n = ", ""],
                has_broken: |record| Some(record.value(ERROR)? > 1.0),
                sign: "it is torn",
            },
        }
    }

    /// The card said "completed for" the value of a torn run, and of a variant that diverged in another run.
    #[test]
    fn a_variant_breaks_at_its_least_value_that_is_torn_or_diverges() {
        let of = |variant: &str, n, error: f64| run(spec(variant, n), |r| r.put(ERROR, error));
        let mut diverged = of("bad", 4, 0.1);
        let (field, value_text) = ("density".into(), "NaN".into());
        diverged.record.status =
            Status::Diverged { step: 1, time: 0.1, particle: 0, field, value_text };
        let good = [of("good", 2, 0.5), of("good", 7, 0.9)];
        let all = |more: Vec<_>| Runs::new(good.iter().cloned().chain(more).collect());
        let whole = "`good` in no run at n = 2 to 7";
        let torn = all(vec![of("bad", 1, 0.5), of("bad", 5, 2.0), of("bad", 6, 0.5)]);
        let at = |n: usize| format!("{whole}; `bad` at n = {n} (it is torn, or it diverges)");
        assert_eq!(breaks(&made_up(), &torn), Some(at(5)));
        let both = all(vec![of("bad", 5, 2.0), diverged]);
        assert_eq!(breaks(&made_up(), &both), Some(at(4)));
        assert_eq!(breaks(&made_up(), &all(Vec::new())), Some(whole.into()));
        let one = Runs::new(vec![of("good", 2, 0.5)]);
        assert_eq!(breaks(&made_up(), &one).as_deref(), Some("`good` in no run at n = 2"));
    }

    /// The uncertainty beside an error is u_val, of which that of the reference is a part: here
    /// (0.6² + 0.4²)^(1/2), for u_num is 3/2 of the range of the levels 0.6, 0.2 and 0.2. A run that is
    /// compared nowhere, or with an exact reference, has none.
    #[test]
    fn an_error_has_the_uncertainty_of_its_comparison() {
        let of = |n, error: f64| run(spec("good", n), |r| r.put(ERROR, error));
        let runs = Runs::new(vec![of(10, 0.6), of(14, 0.2), of(20, 0.2), of(40, 0.5)]);
        let compared = Comparison { reference: 0.4, ..comparison("good", &[10, 14, 20]) };
        let exact = comparison("good", &[14, 20, 40]);
        let declared = Declaration { comparisons: vec![compared, exact], ..Declaration::default() };
        let told = |n| result(&made_up(), &declared, &spec("good", n), &runs);
        let unit = "\u{a0}a";
        assert!(told(20).starts_with(&format!("**0.20{unit}** ± 0.72{unit} in ")), "{}", told(20));
        for n in [14, 40] {
            assert!(!told(n).contains('±'), "n = {n}: {}", told(n));
        }
        assert_eq!(told(80), "not run");
    }

    /// The largest stable step of a variant is that of its worst scene.
    #[test]
    fn the_stable_step_of_a_variant_is_the_least_of_its_scenes() {
        let limit = |(variant, n): (&str, usize)| StepLimit {
            scene: "made up".into(),
            spec: spec(variant, n),
            theory: 1.0,
            theory_at: 2.0,
            default_at: 1.0,
            gate: None,
        };
        let scenes = [("good", 1), ("good", 2), ("good", 3), ("bad", 1)];
        let stable_at = |of: f64| move |r: &mut Record| r.put(STABLE, of);
        let made = scenes.iter().zip([2.4, 2.2, 3.0, 1.0]);
        let runs = records(made.map(|((variant, n), of)| (spec(variant, *n), stable_at(of))));
        let limits = StepLimits { about: String::new(), of: scenes.map(limit).into() };
        let declared = Declaration { limits, ..Declaration::default() };
        let found = stable(&declared, &[spec("good", 9), spec("bad", 9)], &runs);
        assert_eq!(found.as_deref(), Some("1.10 (`good`), 0.500 (`bad`)"));
    }

    /// An error has the unit and the words of the run that has it.
    #[test]
    fn an_error_is_stated_with_the_settings_of_its_run() {
        let judged = run(spec("good", 3), |r| r.put(ERROR, -0.0576));
        assert_eq!(headline(&made_up(), &judged.record), Ok("−0.058\u{a0}a".into()));
        let stated = (made_up().stated)(&judged.record.run.settings).in_words();
        assert_eq!(stated, "distance at n = 3, against nothing (± 0.50\u{a0}a)");
    }
}
