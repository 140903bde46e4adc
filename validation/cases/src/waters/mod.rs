//! Water with a free surface.

mod causes;
pub mod dam_break;
pub mod elliptic_drop;
pub mod hydrostatic;
pub mod still_wedge;
pub mod water;
