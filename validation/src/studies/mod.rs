//! Studies: many runs, one question.

pub mod convergence;
pub mod elastic_waves;
pub mod extremes;
pub mod gate_power;
pub mod page;
pub mod stability;
pub mod work_precision;

use crate::{case::Tier, suite::Study};

/// Studies of the method itself, which belong to no case.
pub fn of_the_method(tier: Tier) -> Vec<Study> {
    vec![stability::study(tier), elastic_waves::study(), extremes::study(tier), gate_power::study()]
}
