//! Water with a free surface.

pub mod dam_break;
pub mod elliptic_drop;
pub mod hydrostatic;
pub mod water;

use harness::case::Case;

/// The cases of the family.
pub const CASES: &[&dyn Case] =
    &[&dam_break::DAM_BREAK, &elliptic_drop::ELLIPTIC_DROP, &hydrostatic::HYDROSTATIC];
