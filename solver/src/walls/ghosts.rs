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

/// Walls represented by ghosts: each particle within reach has an image across the wall with the
/// density and pressure of its original (inferred) and the velocity 2U − v + d² ∂²v/∂n².
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
