//! Where particles of walls stand, and the fluid before them: straight tanks and any smooth curve; and how
//! many pieces and holes a body of particles has.

mod curve;
mod hill;
mod layers;
mod nearest;
mod polyline;
mod tank;
mod topology;

pub use curve::{Curve, ParticleRow};
pub use hill::Hill;
pub use layers::layers;
pub use nearest::nearest;
pub use polyline::row_behind;
pub use tank::Tank;
pub use topology::{BOND, Bonds, Topology};

use nalgebra::Vector2;

/// The lower left and the upper right corner of the smallest box that holds these points.
pub fn corners(points: impl IntoIterator<Item = Vector2<f64>>) -> [Vector2<f64>; 2] {
    let nowhere = [f64::INFINITY, f64::NEG_INFINITY].map(Vector2::repeat);
    points.into_iter().fold(nowhere, |[low, high], x| [low.inf(&x), high.sup(&x)])
}
