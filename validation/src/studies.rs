//! Studies of the method itself, which belong to no case.

pub use lattice::{extremes, stability};
pub use solids::elastic_waves;

use harness::{case::Tier, gate_power, suite::Study};

/// All of them.
pub fn of_the_method(tier: Tier) -> Vec<Study> {
    vec![
        stability::study(tier),
        elastic_waves::study(),
        extremes::study(tier),
        gate_power::study(),
    ]
}
