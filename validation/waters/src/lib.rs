//! Water with a free surface.

pub mod dam_break;
pub mod elliptic_drop;
pub mod hydrostatic;
pub mod water;

use harness::case::Case;

/// The cases of the family.
pub const CASES: &[&dyn Case] =
    &[&dam_break::DAM_BREAK, &elliptic_drop::ELLIPTIC_DROP, &hydrostatic::HYDROSTATIC];

#[cfg(test)]
mod tests {
    use base::gate::{Purpose, check_all};
    use harness::case::Tier;

    /// A miss of 118 % and one of 248 % were reported and not judged.
    #[test]
    fn every_gate_on_a_run_is_sound_and_judges() {
        for case in super::CASES {
            for tier in [Tier::Quick, Tier::Full] {
                let plan = case.plan(tier);
                let gates: Vec<_> = plan.into_iter().flat_map(|planned| planned.gates).collect();
                assert_eq!(check_all(&gates), Ok(()));
                assert!(gates.iter().all(|gate| gate.purpose != Purpose::Report));
            }
        }
    }
}
