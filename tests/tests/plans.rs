//! Requirements for every plan of every case.

use std::collections::BTreeSet;

use touchstone_base::functions::powf;
use touchstone_base::gate::{Bound, Cause, Evidence, Gate};
use touchstone_base::random::Random;
use touchstone_base::spec::RunSpec;
use touchstone_cases::CASES;
use touchstone_harness::{
    case::{self, Case, Drawn, Draws, Planned, RunError, Tier},
    gates::GateIndex,
    make::BatchResult,
    plan, sealed,
    studies::{Accuracy, Budgets, Card, Change, Curves, FINER, Map, Picture, STARTS},
    suite,
};

/// A run with a setting that its variant does not read is refused, so a study of it would be empty.
#[test]
fn no_planned_run_sets_what_its_variant_lacks() {
    for case in CASES {
        for planned in plan::of_case(*case, Tier::Full) {
            let refused = case.rules(&planned.spec);
            let spec = &planned.spec;
            assert!(!matches!(refused, Err(RunError::Unused { .. })), "{refused:?}: {spec:?}");
        }
    }
}

/// The figures of a case and of other codes show the error that its card, `run` and `list` state; the figures
/// of ladders have the recommended variant.
#[test]
fn a_case_has_one_error_and_its_ladders_show_what_is_recommended() {
    for (case, tier) in CASES.iter().flat_map(|case| [(case, Tier::Quick), (case, Tier::Full)]) {
        let (studies, name) = (case.studies(tier), case.name());
        let Some(accuracy) = studies.first::<Accuracy>() else { continue };
        assert_eq!(studies.error(), Some(&accuracy.error), "{name}");
        let recommended = case.recommended();
        for accuracy in studies.of::<Accuracy>() {
            let has_it = accuracy.ladders.iter().any(|of| of.variant == recommended.variant);
            assert!(has_it, "{name}: {} lacks {}", accuracy.id, recommended.variant);
        }
        let shown = [Some(recommended.variant), recommended.papers];
        let mut of_card = studies.first::<Card>().into_iter().flat_map(|card| &card.runs);
        assert!(of_card.all(|run| shown.contains(&Some(&*run.variant))), "{name}");
    }
}

/// A caption begins with the question that its figure answers.
#[test]
fn every_figure_answers_a_question() {
    for (case, tier) in CASES.iter().flat_map(|case| [(case, Tier::Quick), (case, Tier::Full)]) {
        let studies = case.studies(tier);
        let curves = studies.of::<Curves>().map(|of| of.caption.clone());
        let maps = studies.of::<Map>().map(|of| of.caption.clone());
        let pictures = studies.of::<Picture>().map(|of| of.heading.caption.to_string());
        let films = studies.of::<Picture>().filter_map(|of| of.film.as_ref());
        let films = films.map(|film| film.caption.to_string());
        for caption in curves.chain(maps).chain(pictures).chain(films) {
            let first = caption.split_once("? ").map(|(question, _)| question);
            let is_one = |question: &str| !question.replace("et al. ", "").contains(". ");
            assert!(first.is_some_and(is_one), "{}: {caption}", case.name());
        }
    }
}

/// The key of a run is the key of its resolved spec; a plan with another form of the spec would miss its
/// record.
#[test]
fn every_planned_run_is_written_as_it_is_read() {
    let tiers = [Tier::Quick, Tier::Full, Tier::Deep];
    for (case, tier) in CASES.iter().flat_map(|case| tiers.map(|tier| (case, tier))) {
        for Planned { spec, .. } in plan::of_case(*case, tier) {
            let read =
                serde_json::from_str::<RunSpec>(&spec.canonical()).expect("a line of a plan");
            let resolved = case::resolved(*case, read).expect("a run that is possible");
            assert_eq!(resolved.canonical(), spec.canonical());
        }
    }
}

/// The plain runs of a variant that differ from its defaults only in settings drawn by sealed problems, with
/// their gates on a metric.
fn judged_of(case: &dyn Case, variant: &str, draws: &Draws, metric: &str) -> Vec<(RunSpec, Gate)> {
    let set: Vec<String> = draws.set.iter().map(ToString::to_string).collect();
    let base = case::spec(case, variant, &set).unwrap().settings;
    let drawn = draws.others.iter().filter(|(_, how)| !matches!(how, Drawn::Any(..)));
    let names: Vec<&str> = drawn.map(|(name, _)| *name).chain(draws.free.iter().copied()).collect();
    let is_alike = |spec: &RunSpec| {
        let base = base.as_object().unwrap().iter();
        spec.variant == variant
            && (spec.is_simulation() && spec.mutation.is_none() && spec.disorder.is_none())
            && base.into_iter().all(|(name, value)| {
                *name == draws.resolution.0
                    || names.contains(&&**name)
                    || spec.settings[name] == *value
            })
    };
    let tiers = [Tier::Quick, Tier::Full];
    let planned = tiers.into_iter().flat_map(|tier| plan::of_case(case, tier));
    let gates = planned.filter(|planned| is_alike(&planned.spec)).flat_map(
        |Planned { spec, gates, .. }| gates.into_iter().map(move |gate| (spec.clone(), gate)),
    );
    gates.filter(|(_, gate)| gate.metric == metric).collect()
}

/// The largest magnitude that a gate allows.
fn most(gate: &Gate) -> Option<f64> {
    match gate.bound {
        Bound::Below(most) => Some(most),
        Bound::Within(low, high) if low < 0.0 && high > 0.0 => Some(high.max(-low)),
        _ => None,
    }
}

/// The bounds of judged runs on a metric, but for windows on the theory of our own methods.
fn bounds_of(all: &[(RunSpec, Gate)]) -> Vec<(&RunSpec, f64)> {
    let is_of_ours =
        |gate: &Gate| matches!(gate.bound, Bound::Within(..)) && gate.evidence == Evidence::Theory;
    let bounds = all.iter().filter(|(_, gate)| !is_of_ours(gate));
    bounds.filter_map(|(spec, gate)| Some((spec, most(gate).filter(|most| *most > 0.0)?))).collect()
}

/// At the settings of a judged run a sealed problem is judged as the worst such run is; of twice the coarsest
/// spacing the bound is 2 to the power of the order higher. Of values of judged runs each one is drawn.
#[test]
fn sealed_problems_are_judged_as_judged_runs_are() {
    for (name, variant) in [
        ("couette", "modern"),
        ("operators", "quintic-gradient"),
        ("periodic_hill", "carried"),
        ("rubber_rings", "lagrangian"),
    ] {
        let case = *CASES.iter().find(|case| case.name() == name).expect(name);
        let draws = case.facts().sealed.expect(name);
        let index = GateIndex::of(case);
        let kept = draws.others.iter().filter(|(_, how)| matches!(how, Drawn::Judged));
        let kept: Vec<&str> = kept.map(|(name, _)| *name).collect();
        let number = |spec: &RunSpec, name: &str| spec.settings[name].as_f64().unwrap();
        let values = |spec: &RunSpec| kept.iter().map(|of| number(spec, of)).collect::<Vec<_>>();
        let fine = |spec: &RunSpec| number(spec, draws.resolution.0);
        let mut of = draws.metrics.iter().map(|of| (*of, judged_of(case, variant, &draws, of)));
        let (metric, all) = of.find(|(_, all)| !bounds_of(all).is_empty()).expect(name);
        let bounds = bounds_of(&all);
        let near = |spec: &RunSpec, expected: f64| {
            let gates = sealed::gates(&index, spec);
            let found = gates.iter().find(|gate| gate.metric == metric).and_then(most);
            let found = found.unwrap_or(f64::NAN);
            let what = format!("{name} {metric} at {}: {found}, not {expected}", spec.settings);
            assert!((found / expected - 1.0).abs() < 1e-9, "{what}");
        };
        let (mut texts, mut seen) = (BTreeSet::new(), Vec::new());
        for (spec, _) in &bounds {
            let same = || bounds.iter().filter(|of| values(of.0) == values(spec));
            let at = |value: f64| {
                same().filter(|of| fine(of.0) == value).map(|of| of.1).fold(0.0, f64::max)
            };
            if !seen.contains(&(values(spec), fine(spec))) {
                near(spec, at(fine(spec)));
                seen.push((values(spec), fine(spec)));
            }
            if !seen.contains(&(values(spec), 0.0)) {
                seen.push((values(spec), 0.0));
                let is_count = spec.settings[draws.resolution.0].is_u64();
                let end = if is_count { f64::min } else { f64::max };
                let coarsest = same().map(|of| fine(of.0)).fold(f64::NAN, end);
                let mut coarser = (*spec).clone();
                let (next, ratio) = match is_count {
                    true => ((coarsest / 2.0).floor(), coarsest / (coarsest / 2.0).floor()),
                    false => (2.0 * coarsest, 2.0),
                };
                coarser.settings[draws.resolution.0] =
                    if is_count { (next as u64).into() } else { next.into() };
                near(&coarser, at(coarsest) * powf(ratio, draws.order));
            }
            texts.extend(kept.iter().map(|of| format!("{of}={}", number(spec, of))));
        }
        assert!(seen.len() > 1, "{name}");
        let drawn = (0..24).flat_map(|seed| sealed::draw(&index, variant, &mut Random::new(seed)));
        let drawn: BTreeSet<String> = drawn.flatten().filter(|one| texts.contains(one)).collect();
        assert_eq!(drawn, texts, "{name}");
    }
}

/// A study that reads a run that is not planned, or more than is measured of it, panics: no study
/// of ours does, with and without records.
#[test]
fn studies_ask_for_no_more_than_is_planned() {
    for tier in [Tier::Quick, Tier::Full, Tier::Deep] {
        suite::judge(suite::plans(CASES, tier), tier, BatchResult::default());
    }
}

/// The deep tier has every run of the full one with its gates, and the additions of the harness: each ladder
/// has two finer levels, cells of maps have 20 starts, and every resolution at which another code was timed
/// is included.
#[test]
fn the_deep_tier_has_the_full_one_and_two_levels_and_20_starts() {
    let (mut ladders, mut cells) = (0, 0);
    for case in CASES {
        let [full, deep] = [Tier::Full, Tier::Deep].map(|tier| plan::of_case(*case, tier));
        for run in full {
            let same = deep.iter().find(|of| of.spec.key() == run.spec.key());
            assert!(same.is_some_and(|same| same.gates == run.gates), "{:?}", run.spec);
        }
        let [full, deep] = [Tier::Full, Tier::Deep].map(|tier| case.studies(tier));
        for (full, deep) in full.of::<Accuracy>().zip(deep.of::<Accuracy>()) {
            for (full, deep) in full.ladders.iter().zip(&deep.ladders) {
                let more = if full.levels.len() < 2 { 0 } else { FINER as usize };
                let name = format!("{} {}", case.name(), deep.variant);
                assert_eq!(deep.levels.len(), full.levels.len() + more, "{name}");
                assert!(deep.levels.is_sorted_by(|a, b| a.spacing > b.spacing), "{name}");
                let labels =
                    deep.levels.iter().map(|level| level.resolution.count).collect::<BTreeSet<_>>();
                assert_eq!(labels.len(), deep.levels.len(), "{name}: {labels:?}");
                ladders += more / 2;
            }
        }
        for (full, deep) in full.of::<Map>().zip(deep.of::<Map>()) {
            let [full, deep] = [full, deep].map(|map| {
                let panels = map.panels.iter().flat_map(|panel| &panel.cells).flatten();
                panels.collect::<Vec<_>>()
            });
            assert_eq!(full.len(), deep.len(), "{}", case.name());
            for cell in deep.into_iter().filter(|cell| !cell.is_empty()) {
                let keys: BTreeSet<_> = cell.iter().map(RunSpec::key).collect();
                assert_eq!(keys.len(), STARTS, "{}", case.name());
                cells += 1;
            }
        }
    }
    assert!(ladders > 25 && cells > 30, "{ladders} {cells}");
}

/// A budget changes one thing at a time: a run differs from the run of comparison, named by it or
/// `unchanged`, in one setting, or in as many as its name lists with commas, or in its variant.
#[test]
fn a_budget_compares_each_change_with_the_run_that_it_names() {
    let (mut named, mut count) = (0, 0);
    for (case, tier) in CASES.iter().flat_map(|case| [(case, Tier::Quick), (case, Tier::Full)]) {
        for changes in case.studies(tier).of::<Budgets>().flat_map(|budgets| &budgets.of) {
            let variant = &changes[0].spec.variant;
            let budget = format!("the budget of {} {variant}, {tier:?} tier", case.name());
            assert_eq!((changes[0].what.as_str(), changes[0].against), ("none", 0), "{budget}");
            for change in &changes[1..] {
                count += 1;
                let Change { what, spec, against, .. } = change;
                let other = &changes[*against];
                let name = what.split_once(", against ").or(what.split_once(" over "));
                let (changed, expected) = name.unwrap_or((what, "none"));
                named += usize::from(name.is_some());
                assert!(
                    other.what.starts_with(expected),
                    "{budget}: `{what}` is compared with `{}`, expected `{expected}`",
                    other.what
                );
                let settings = spec.settings.as_object().expect("settings");
                let apart =
                    settings.iter().filter(|(name, value)| other.spec.settings[*name] != **value);
                let apart: Vec<&String> = apart.map(|(name, _)| name).collect();
                let listed = 1 + changed.matches(',').count();
                let is_one = spec.variant != other.spec.variant || apart.len() == listed;
                assert!(is_one, "{budget}: `{what}` and `{}` differ in {apart:?}", other.what);
            }
        }
    }
    assert!(named >= 4 && count > 50, "{count} changes, {named} of which name another run");
}

/// The gates of a case, of its runs and of its studies; without a record every gate fails, and is there.
fn gates(case: &'static dyn Case, tier: Tier) -> Vec<Gate> {
    let suite = suite::judge(suite::plans(&[case], tier), tier, BatchResult::default());
    suite.judged().map(|of| of.judged.gate.clone()).collect()
}

/// The report groups limitations by their causes; 57 of them had 18 reasons and nothing that joined these.
#[test]
fn every_limitation_has_a_cause() {
    let mut causes = BTreeSet::new();
    for (case, tier) in CASES.iter().flat_map(|case| [(case, Tier::Quick), (case, Tier::Full)]) {
        for gate in gates(*case, tier) {
            assert_eq!(gate.known.is_some(), gate.cause.is_some(), "the cause of {}", gate.id);
            causes.extend(gate.cause);
        }
    }
    let words = |text: &str| text.split_whitespace().count();
    for Cause { what, mend, .. } in causes {
        assert!(words(&what) <= 25 && what.ends_with('.'), "one sentence: {what}");
        assert!(words(&mend) <= 20 && mend.ends_with('.'), "one sentence: {mend}");
    }
}
