//! Water with a free surface.

pub mod dam_break;
pub mod elliptic_drop;
pub mod hydrostatic;
pub mod water;
