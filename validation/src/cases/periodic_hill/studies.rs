//! What the runs say together.

use crate::{
    case::Tier,
    suite::{JudgedRun, Study},
};

/// All of them.
pub fn studies(_: Tier, _: &[JudgedRun]) -> Vec<Study> {
    Vec::new()
}
