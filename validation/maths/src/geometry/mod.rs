//! Where particles of walls stand, and the fluid before them: straight tanks and any smooth curve; and how
//! many pieces and holes a body of particles has.

mod curve;
mod hill;
mod tank;
mod topology;

pub use curve::{Curve, Row};
pub use hill::Hill;
pub use tank::Tank;
pub use topology::{BOND, Bonds, Topology};
