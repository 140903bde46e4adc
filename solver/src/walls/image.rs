//! Images: extra columns copied from an earlier column before each sweep, mirrored at a wall or
//! shifted by a period, so that no pair pays for a wrap or a wall.

use nalgebra::Vector2;

use super::PlaneWall;
use crate::{numbers::Numbers, particles::Column};

/// What turns a particle, or an image of it, into an image.
#[derive(Clone, Copy, Debug)]
pub enum Map {
    /// The ghost across a no-slip wall: x' = x − 2dn, v' = 2U − v + d² ∂²v/∂n², at the depth d of
    /// the source in the fluid.
    Mirror(PlaneWall),
    /// The copy a period away: x' = x + s \[m\].
    Shift(Vector2<f64>),
}

impl Map {
    /// Where the image of a point is \[m\].
    #[inline(always)]
    pub fn place(&self, point: Vector2<f64>) -> Vector2<f64> {
        match self {
            Self::Mirror(wall) => point - wall.normal * (2.0 * wall.depth(point)),
            Self::Shift(by) => point + by,
        }
    }

    /// The image of a column. Scalars (density, pressure) are those of the source.
    #[inline(always)]
    pub fn apply<S: Numbers>(&self, source: &Column<S>) -> Column<S> {
        let position = self.place(source.position);
        match self {
            Self::Mirror(wall) => {
                let depth = wall.depth(source.position);
                let velocity =
                    wall.velocity * 2.0 - source.velocity + wall.curvature * (depth * depth);
                Column { position, velocity, ..*source }
            }
            Self::Shift(_) => Column { position, ..*source },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::Common;

    #[test]
    fn a_ghost_mirrors_place_and_velocity_about_a_moving_slanted_wall() {
        let normal = Vector2::new(-0.6, 0.8);
        let (point, velocity) = (Vector2::new(1.0, 2.0), Vector2::new(0.8, 0.6));
        let mut wall = PlaneWall::new(point, normal, velocity);
        wall.curvature = Vector2::new(0.0, 3.0);
        let map = Map::Mirror(wall);
        let common = Common { mass: 1.0, density: 2.0, volume: 0.5 };
        let along = Vector2::new(0.8, 0.6);
        let position = point + along * 5.0 + normal * 0.25;
        let source = Column { position, velocity: Vector2::new(1.0, 7.0), common, shows: 9.0 };
        let ghost = map.apply(&source);
        assert!((ghost.position - (point + along * 5.0 - normal * 0.25)).norm() < 1e-14);
        let expected = velocity * 2.0 - source.velocity + Vector2::new(0.0, 3.0) * 0.0625;
        assert!((ghost.velocity - expected).norm() < 1e-14);
        assert_eq!((ghost.common.density, ghost.shows), (2.0, 9.0));
        let back = map.place(ghost.position) - position;
        assert!(back.norm() < 1e-14, "mirroring twice is the identity");
    }
}
