//! Turns the studies of cases into a list of runs in which each run occurs once.

use crate::{
    case::Case,
    runs::{Planned, Tier},
};

/// The runs of all studies of a case in a tier, each once, with the gates of all. The measured
/// metrics of each run include the metrics of its gates.
pub fn of_case(case: &dyn Case, tier: Tier) -> Vec<Planned> {
    let (mut runs, facts) = (case.studies(tier).runs(), case.facts());
    for Planned { spec, gates, .. } in &mut runs {
        spec.measure = spec.measure.max(facts.measure_for(gates));
    }
    runs
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use touchstone_base::{
        gate::{Bound, Evidence, Gate},
        spec::{Measure, RunSpec},
    };

    use super::*;
    use crate::runs::merged;

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
}
