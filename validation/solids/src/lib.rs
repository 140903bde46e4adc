//! Elastic solids.

mod causes;
pub mod elastic_bar;
pub mod elastic_wave;
pub mod oscillating_plate;
pub mod rings;
pub mod solid;
pub mod spinning_disk;

use harness::case::Case;

/// The cases of the family.
pub const CASES: &[&dyn Case] = &[
    &elastic_wave::ELASTIC_WAVE,
    &elastic_bar::ELASTIC_BAR,
    &spinning_disk::SPINNING_DISK,
    &oscillating_plate::OSCILLATING_PLATE,
    &rings::RUBBER_RINGS,
];

#[cfg(test)]
mod tests {
    use super::*;
    use base::gate;
    use harness::{case::Tier, context::Context};

    /// Each gate of the total Lagrangian variants, by the runs themselves.
    #[test]
    fn total_lagrangian_solids_stay_within_their_bounds() {
        let mut judged = 0;
        for case in CASES {
            let plan = case.plan(Tier::Quick).into_iter();
            for planned in plan.filter(|planned| planned.spec.variant == "lagrangian") {
                let record = case.run(&planned.spec, &Context::default()).expect("a run");
                for gate in planned.gates {
                    let found = record.metric(&gate.metric);
                    let verdict = gate.judge(found).verdict;
                    assert!(!verdict.is_failure(), "{}: {found:?}", gate.id);
                    judged += 1;
                }
            }
        }
        assert!(judged > 60, "{judged} gates");
    }

    #[test]
    fn the_gates_of_every_plan_are_sound() {
        for case in CASES {
            for tier in [Tier::Quick, Tier::Full] {
                let gates = case.plan(tier).into_iter().flat_map(|planned| planned.gates);
                let gates = gates.collect::<Vec<_>>();
                assert_eq!(gate::check_all(&gates), Ok(()), "{}", case.name());
            }
        }
    }
}
