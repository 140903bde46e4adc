//! Turns the studies of cases into a list of runs in which each run occurs once.

use touchstone_base::{
    functions::log10,
    gate::Gate,
    spec::{RunSpec, Task},
};

use crate::{
    case::Case,
    runs::{self, Planned, Tier},
};

/// The runs of a case in a tier: those of its studies, each once, with the gates of all. The measured
/// metrics of each run include the metrics of its gates.
pub fn of_case(case: &dyn Case, tier: Tier) -> Vec<Planned> {
    let (mut runs, facts) = (case.studies(tier).runs(), case.facts());
    for Planned { spec, gates, .. } in &mut runs {
        spec.measure = spec.measure.max(facts.measure_for(gates));
    }
    runs
}

/// The gates that the plans of both tiers have for the simulation with the settings of this run, each once.
pub fn gates_of(case: &dyn Case, spec: &RunSpec) -> Vec<Gate> {
    let plans = [Tier::Quick, Tier::Full].into_iter().flat_map(|tier| of_case(case, tier));
    let is_this = |of: &RunSpec| {
        let is_alike = of.variant == spec.variant && of.settings == spec.settings;
        of.task == Task::Simulate && is_alike && of.disorder == spec.disorder
    };
    let mut gates: Vec<Gate> = Vec::new();
    for gate in plans.filter(|planned| is_this(&planned.spec)).flat_map(|planned| planned.gates) {
        if gates.iter().all(|other| other.id != gate.id) {
            gates.push(gate);
        }
    }
    gates
}

/// The judged simulation with the nearest settings, and its gate selected by `judges`: of the same variant if
/// there is one, then with the fewest other settings, then with the least ratios of these.
pub fn nearest_judged(
    case: &dyn Case,
    spec: &RunSpec,
    judges: &dyn Fn(Gate) -> Option<Gate>,
) -> Option<(RunSpec, Gate)> {
    let plans = [Tier::Quick, Tier::Full].into_iter().flat_map(|tier| of_case(case, tier));
    let judged = plans.filter(|planned| planned.spec.task == Task::Simulate).filter_map(|of| {
        let spec = of.spec;
        of.gates.into_iter().find_map(judges).map(|gate| (spec, gate))
    });
    let far = |of: &RunSpec| {
        let names = case.fields().iter().map(|field| field.name);
        let both = names.map(|name| (&of.settings[name], &spec.settings[name]));
        let others: Vec<_> = both.filter(|(a, b)| a != b).collect();
        let ratio = |(a, b): &(&serde_json::Value, &serde_json::Value)| {
            let ratio = a.as_f64().zip(b.as_f64()).map(|(a, b)| log10(a / b).abs());
            ratio.filter(|ratio| ratio.is_finite()).unwrap_or(1.0)
        };
        let ratios = others.iter().map(ratio).fold(0.0, |sum, ratio| sum + ratio);
        (of.variant != spec.variant, others.len(), ratios)
    };
    let order = |a: &RunSpec, b: &RunSpec| {
        let (a, b) = (far(a), far(b));
        (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2))
    };
    judged.min_by(|(a, _), (b, _)| order(a, b))
}

/// Each run once, at its first place, with all gates; timed if one of them is, and all of it measured if one
/// of them asks for all.
pub fn merged(all: Vec<Planned>) -> Vec<Planned> {
    let mut merged: Vec<Planned> = Vec::new();
    let mut places = Vec::new();
    for planned in all {
        let place = *runs::entry(&mut places, planned.spec.key(), || merged.len());
        let Some(first) = merged.get_mut(place) else {
            merged.push(planned);
            continue;
        };
        // A run of a table occurs in the plan and in a ladder, with equal gates.
        let others = planned.gates.into_iter().filter(|gate| !first.gates.contains(gate));
        let others: Vec<Gate> = others.collect();
        first.gates.extend(others);
        first.timed |= planned.timed;
        first.spec.measure = first.spec.measure.max(planned.spec.measure);
    }
    merged
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use touchstone_base::{
        gate::{Bound, Evidence, Gate},
        mutation::Disorder,
        record::Record,
        spec::{Measure, RunSpec},
    };

    use super::*;
    use crate::{case::RunError, context::Context, study::Studies, testing::Staged};

    #[test]
    fn a_run_that_is_planned_twice_is_made_once_and_judged_by_all_gates() {
        let gate = |id: &str| Gate::new(id, "l2", Bound::Below(1.0), Evidence::Theory, "why");
        let run = |rows: usize| Planned::new(RunSpec::new("c", "v", json!({ "rows": rows })));
        let all = vec![
            run(20).judged(vec![gate("c.a")]),
            run(40),
            run(20).judged(vec![gate("c.b")]).timed(),
            Planned::new(run(40).spec.measure_all()),
        ];
        let merged = merged(all);
        assert_eq!(merged.len(), 2);
        let first = &merged[0];
        assert_eq!((first.gates.len(), first.timed), (2, true));
        assert!(!merged[1].timed);
        assert_eq!([0, 1].map(|k| merged[k].spec.measure), [Measure::Headline, Measure::All]);
    }

    /// One run, and one with a slightly disordered start, with a gate each.
    struct Starts;

    impl Staged for Starts {
        fn called(&self) -> &'static str {
            "starts"
        }
        fn made(&self, _: &RunSpec, _: &Context) -> Result<Record, RunError> {
            Err(RunError::NoScene("staged"))
        }
        fn studied(&self, tier: Tier) -> Studies {
            let gate = |id: &str| Gate::new(id, "l2", Bound::Below(1.0), Evidence::Theory, "why");
            let run = |disorder| Planned::new(RunSpec { disorder, ..spec() });
            let disorder = Some(Disorder { most: 1e-6, seed: 1 });
            let full = if tier == Tier::Full { vec![gate("c.full")] } else { Vec::new() };
            let ordered = [vec![gate("c.ordered")], full].concat();
            let disordered = run(disorder).judged(vec![gate("c.disordered")]);
            Studies::judging(vec![run(None).judged(ordered), disordered])
        }
    }

    fn spec() -> RunSpec {
        RunSpec::new("starts", "v", json!({}))
    }

    /// The command `run` would have judged a run by the gates of starts that it does not have.
    #[test]
    fn a_run_has_the_gates_of_its_own_start_in_all_tiers() {
        let gates = |spec: &RunSpec| -> Vec<String> {
            gates_of(&Starts, spec).into_iter().map(|gate| gate.id).collect()
        };
        assert_eq!(gates(&spec()), ["c.ordered", "c.full"]);
        let disorder = Some(Disorder { most: 1e-6, seed: 1 });
        assert_eq!(gates(&RunSpec { disorder, ..spec() }), ["c.disordered"]);
        let disorder = Some(Disorder { most: 1e-6, seed: 2 });
        assert_eq!(gates(&RunSpec { disorder, ..spec() }), [""; 0]);
        assert_eq!(gates(&RunSpec { variant: "w".into(), ..spec() }), [""; 0]);
        assert_eq!(gates(&RunSpec { settings: json!({"n": 1}), ..spec() }), [""; 0]);
    }
}
