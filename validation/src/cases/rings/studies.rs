//! Studies.
use crate::{
    case::{Case, Tier},
    suite::{JudgedRun, Study},
};
pub fn studies(_case: &'static dyn Case, _tier: Tier, _runs: &[JudgedRun]) -> Vec<Study> {
    Vec::new()
}
