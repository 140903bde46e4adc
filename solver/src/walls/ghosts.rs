//! Ghost particles (section 4.1 of the paper): the fluid mirrored across straight walls.

use nalgebra::Vector2;

use super::Walls;

/// A straight wall of infinite length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneWall {
    /// A point of the wall \[m\].
    pub point: Vector2<f64>,
    /// Unit normal into the fluid.
    pub normal: Vector2<f64>,
    /// Velocity U of the wall, along itself \[m/s\].
    pub velocity: Vector2<f64>,
    /// ∂²v/∂n² at the wall \[1/(m s)\], 0 for the plain mirror.
    ///
    /// From the momentum equation at a no-slip wall, 0 = f + ν ∂²v/∂n² for a parallel flow driven
    /// by f (Basa, Quinlan & Lastiwka 2009): −f/ν. The mirror alone has it 0.
    pub curvature: Vector2<f64>,
}

impl PlaneWall {
    /// A wall through `point` with unit `normal` into the fluid, moving with `velocity`.
    pub fn new(point: Vector2<f64>, normal: Vector2<f64>, velocity: Vector2<f64>) -> Self {
        Self { point, normal, velocity, curvature: Vector2::zeros() }
    }

    /// How deep in the fluid a point is \[m\], negative behind the wall.
    #[inline(always)]
    pub fn depth(&self, point: Vector2<f64>) -> f64 {
        (point - self.point).dot(&self.normal)
    }
}

/// |cos| of an angle that counts as a right one, at most.
pub(crate) const RIGHT_ANGLE: f64 = 1e-12;

/// The pairs of walls that make a corner.
pub(crate) fn corners(walls: &[PlaneWall]) -> impl Iterator<Item = [&PlaneWall; 2]> {
    let pairs = walls.iter().enumerate().flat_map(|(k, b)| walls[..k].iter().map(move |a| [a, b]));
    pairs.filter(|[a, b]| a.normal.dot(&b.normal).abs() <= RIGHT_ANGLE)
}

/// Walls represented by ghosts: each particle within reach has an image across the wall with the
/// density and pressure of its original (inferred) and the velocity 2U − v + d² ∂²v/∂n².
///
/// Where two walls meet at a right angle, the fluid between them, a particle within reach of both has an
/// image across both as well: the mirror of its mirror, turned by half a turn about the corner, with
/// the velocity v. (One wall after the other gives v ± 2(U₁ − U₂), by the order; v is the mean.) Other
/// angles are refused, because their images of images never end. Walls are of infinite length: a tank
/// has a bottom and two sides, and is open at the top because there is no wall.
#[derive(Clone, Debug, Default)]
pub struct Ghosts {
    /// The walls.
    pub walls: Vec<PlaneWall>,
}

impl<X> Walls<X> for Ghosts {
    type Rows = ();
    fn rows(&self) {}
    fn mirrors(&self) -> &[PlaneWall] {
        &self.walls
    }
}
