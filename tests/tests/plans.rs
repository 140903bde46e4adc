//! What every plan must be, whatever the case.

use std::collections::BTreeSet;

use base::gate::{Cause, Gate};
use base::spec::RunSpec;
use cases::CASES;
use harness::{
    case::{self, Case, Planned, RunError, Tier},
    declare::Change,
    deep::{FINER, STARTS},
    make::Made,
    plan,
    runs::Runs,
    studies, suite,
};

/// A run that sets what its variant does not read is refused, and a study of it would have nothing to say.
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

/// The key of a run is that of its resolved spec; a plan that wrote one otherwise would miss its record.
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

/// A study that reads what its run does not measure shows gaps, and a gate of the case fails. Here no run is
/// made: what is planned is looked up all the same.
#[test]
fn studies_ask_for_no_more_than_is_planned() {
    for tier in [Tier::Quick, Tier::Full, Tier::Deep] {
        let suite = suite::judge(suite::plans(CASES, tier), tier, Made::default());
        for case in suite.cases {
            let asked = case.runs.unplanned();
            assert!(asked.is_empty(), "{}: {}", case.case.name(), asked.join("\n"));
        }
    }
}

/// The deep tier has every run of the full one with its gates, and what the harness adds: each ladder goes on
/// by two levels of finer spacing, cells of maps have 20 starts, and every resolution at which another
/// code was timed is one of ours.
#[test]
fn the_deep_tier_has_the_full_one_and_two_levels_and_20_starts() {
    let (mut ladders, mut cells) = (0, 0);
    for case in CASES {
        let [full, deep] = [Tier::Full, Tier::Deep].map(|tier| plan::of_case(*case, tier));
        for run in full {
            let same = deep.iter().find(|of| of.spec.key() == run.spec.key());
            assert!(same.is_some_and(|same| same.gates == run.gates), "{:?}", run.spec);
        }
        let [full, deep] = [Tier::Full, Tier::Deep].map(|tier| case.declaration(tier));
        for (full, deep) in full.accuracy.iter().zip(&deep.accuracy) {
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
        for (full, deep) in full.maps.iter().zip(&deep.maps) {
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

/// A budget changes one thing at a time: a run differs in one setting, or in as many as its name lists with
/// commas, or in its variant, from the run that it is compared with, which its name states or is unchanged.
#[test]
fn a_budget_compares_each_change_with_the_run_that_it_names() {
    let (mut named, mut count) = (0, 0);
    for (case, tier) in CASES.iter().flat_map(|case| [(case, Tier::Quick), (case, Tier::Full)]) {
        let budgets = case.declaration(tier).budgets.of.into_iter();
        for changes in budgets {
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

/// The gates of a case that are known without a run: of its plan, and those that its studies declare.
fn gates(case: &dyn Case, tier: Tier) -> Vec<Gate> {
    let runs = Runs::default();
    let studies = studies::of(case.name(), &case.declaration(tier), &runs).into_iter();
    let of_studies = studies.flat_map(|study| study.judged).map(|judged| judged.gate);
    let planned = plan::of_case(case, tier).into_iter().flat_map(|planned| planned.gates);
    planned.chain(of_studies).collect()
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
