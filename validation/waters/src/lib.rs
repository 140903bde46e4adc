//! Water with a free surface.

mod causes;
pub mod dam_break;
pub mod elliptic_drop;
pub mod hydrostatic;
pub mod still_wedge;
pub mod water;

use harness::case::Case;

/// The cases of the family.
pub const CASES: &[&dyn Case] = &[
    &dam_break::DAM_BREAK,
    &elliptic_drop::ELLIPTIC_DROP,
    &hydrostatic::HYDROSTATIC,
    &still_wedge::STILL_WEDGE,
];

#[cfg(test)]
mod tests {
    use base::gate::check_all;
    use harness::case::Tier;

    #[test]
    fn every_gate_on_a_run_is_sound() {
        for case in super::CASES {
            for tier in [Tier::Quick, Tier::Full] {
                let plan = case.plan(tier);
                let gates: Vec<_> = plan.into_iter().flat_map(|planned| planned.gates).collect();
                assert_eq!(check_all(&gates), Ok(()));
            }
        }
    }
}
