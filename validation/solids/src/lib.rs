//! Elastic solids.

pub mod cantilever;
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
    &cantilever::CANTILEVER,
    &rings::RUBBER_RINGS,
];

#[cfg(test)]
mod tests {
    use super::*;
    use base::gate;
    use harness::case::Tier;

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
