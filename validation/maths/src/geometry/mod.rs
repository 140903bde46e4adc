//! Where particles of walls stand, and the fluid before them: straight tanks and any smooth curve.

mod curve;
mod hill;
mod tank;

pub use curve::{Curve, Row};
pub use hill::Hill;
pub use tank::Tank;
