//! The gates of a case by the settings that they judge.

use std::sync::OnceLock;

use serde_json::Value;
use touchstone_base::{functions::log10, gate::Gate, spec::RunSpec};

use crate::{
    case::Case,
    plan,
    runs::{Planned, Tier},
};

/// The judged simulations of the quick and the full tier of a case: planned once, at their first use.
pub struct GateIndex<'a> {
    /// The case.
    pub case: &'a dyn Case,
    judged: OnceLock<Vec<Planned>>,
}

impl<'a> GateIndex<'a> {
    /// The index of a case.
    pub fn of(case: &'a dyn Case) -> Self {
        Self { case, judged: OnceLock::new() }
    }

    /// The simulations that have gates, in both tiers.
    pub fn judged(&self) -> &[Planned] {
        self.judged.get_or_init(|| {
            let tiers = [Tier::Quick, Tier::Full].into_iter();
            let mut planned: Vec<Planned> =
                tiers.flat_map(|tier| plan::of_case(self.case, tier)).collect();
            planned.retain(|of| of.spec.is_simulation() && !of.gates.is_empty());
            planned
        })
    }

    /// The gates that both tiers have for the simulation with the settings of this run, each once.
    pub fn gates(&self, spec: &RunSpec) -> Vec<Gate> {
        let is_this = |of: &&Planned| {
            let Planned { spec: of, .. } = of;
            let is_alike = of.variant == spec.variant && of.settings == spec.settings;
            is_alike && of.disorder == spec.disorder
        };
        let mut gates: Vec<Gate> = Vec::new();
        for gate in self.judged().iter().filter(is_this).flat_map(|planned| &planned.gates) {
            if gates.iter().all(|other| other.id != gate.id) {
                gates.push(gate.clone());
            }
        }
        gates
    }

    /// The judged simulation with the nearest settings, and its gate selected by `judges`: of the same
    /// variant if there is one, then with the fewest other settings, then with the least ratios of these.
    pub fn nearest(
        &self,
        spec: &RunSpec,
        judges: &dyn Fn(Gate) -> Option<Gate>,
    ) -> Option<(RunSpec, Gate)> {
        let judged = self.judged().iter().filter_map(|of| {
            let gate = of.gates.iter().cloned().find_map(judges);
            gate.map(|gate| (&of.spec, gate))
        });
        let far = |of: &RunSpec| {
            let names = self.case.fields().iter().map(|field| field.name);
            let both = names.map(|name| (&of.settings[name], &spec.settings[name]));
            let others: Vec<_> = both.filter(|(a, b)| a != b).collect();
            let ratio = |(a, b): &(&Value, &Value)| {
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
        let nearest = judged.min_by(|(a, _), (b, _)| order(a, b));
        nearest.map(|(spec, gate)| (spec.clone(), gate))
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use touchstone_base::{
        gate::{Bound, Evidence},
        mutation::Disorder,
        record::Record,
    };

    use super::*;
    use crate::{case::RunError, context::Context, study::Studies, testing::Staged};

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
            GateIndex::of(&Starts).gates(spec).into_iter().map(|gate| gate.id).collect()
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
