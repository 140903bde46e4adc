//! Images (mirror particles and periodic copies): extra columns, each computed before each sweep from an
//! earlier column, mirrored at a wall or shifted by a period. So the loop over pairs treats neither walls nor
//! periodicity.

use nalgebra::Vector2;

use super::PlaneWall;
use crate::{numbers::Numbers, particles::Column};

/// The map from a particle, or from an image of it, to an image.
#[derive(Clone, Copy, Debug)]
pub enum Map {
    /// The mirror particle across a wall: x' = x − 2dn, v' = 2U − v + d² ∂²v/∂n², with the depth d of the
    /// source in the fluid; where the fluid slips v' = v − 2(v·n)n.
    Mirror(PlaneWall),
    /// The mirror particle across both walls of a corner at c \[m\]: x' = 2c − x, v' = v; with slip −v.
    Corner(Vector2<f64>),
    /// The copy a period away: x' = x + s \[m\].
    Shift(Vector2<f64>),
}

impl Map {
    /// The mirror particle across two walls at a right angle: half a turn about their corner.
    pub fn corner([a, b]: [&PlaneWall; 2]) -> Self {
        Self::Corner(a.point - b.normal * b.depth(a.point))
    }

    /// Where the image of a point is \[m\].
    #[inline(always)]
    pub fn place(&self, point: Vector2<f64>) -> Vector2<f64> {
        match self {
            Self::Mirror(wall) => point - wall.normal * (2.0 * wall.depth(point)),
            Self::Corner(corner) => corner * 2.0 - point,
            Self::Shift(by) => point + by,
        }
    }

    /// The image of a column, `slip` being [`super::Walls::SLIPS`]. Scalars (density, pressure) are those
    /// of the source.
    #[inline(always)]
    pub fn apply<S: Numbers>(&self, source: &Column<S>, slip: bool) -> Column<S> {
        let position = self.place(source.position);
        match self {
            Self::Mirror(wall) if slip => {
                let across = wall.normal * source.velocity.dot(&wall.normal);
                Column { position, velocity: source.velocity - across * 2.0, ..*source }
            }
            Self::Corner(_) if slip => Column { position, velocity: -source.velocity, ..*source },
            Self::Mirror(wall) => {
                let depth = wall.depth(source.position);
                let velocity =
                    wall.velocity * 2.0 - source.velocity + wall.curvature * (depth * depth);
                Column { position, velocity, ..*source }
            }
            Self::Corner(_) | Self::Shift(_) => Column { position, ..*source },
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
        let source = Column { position, velocity: Vector2::new(1.0, 7.0), common, derived: 9.0 };
        let ghost = map.apply(&source, false);
        assert!((ghost.position - (point + along * 5.0 - normal * 0.25)).norm() < 1e-14);
        let expected = velocity * 2.0 - source.velocity + Vector2::new(0.0, 3.0) * 0.0625;
        assert!((ghost.velocity - expected).norm() < 1e-14);
        assert_eq!((ghost.common.density, ghost.derived), (2.0, 9.0));
        let mirrored = map.apply(&source, true).velocity - source.velocity;
        assert!((mirrored + normal * (2.0 * source.velocity.dot(&normal))).norm() < 1e-14);
        let back = map.place(ghost.position) - position;
        assert!(back.norm() < 1e-14, "mirroring twice is the identity");
    }

    #[test]
    fn a_ghost_across_a_corner_is_the_mirror_of_the_mirror() {
        let corner = Vector2::new(1.0, 2.0);
        let wall = |n: Vector2<f64>| PlaneWall::new(corner, n, Vector2::zeros());
        let walls = [wall(Vector2::new(-0.6, 0.8)), wall(Vector2::new(0.8, 0.6))];
        let [a, b] = walls.map(Map::Mirror);
        let common = Common { mass: 1.0, density: 2.0, volume: 0.5 };
        let velocity = Vector2::new(1.0, 7.0);
        let source = Column { position: Vector2::new(1.3, 2.9), velocity, common, derived: 9.0 };
        let corner_map = Map::corner([&walls[0], &walls[1]]);
        for slip in [false, true] {
            let ghost = corner_map.apply(&source, slip);
            let [a, b] = [a, b].map(|map| move |column: &Column<f64>| map.apply(column, slip));
            for twice in [a(&b(&source)), b(&a(&source))] {
                assert!((ghost.position - twice.position).norm() < 1e-14);
                assert!((ghost.velocity - twice.velocity).norm() < 1e-14);
            }
        }
        let ghost = corner_map.apply(&source, false);
        assert!((ghost.position + source.position - corner * 2.0).norm() < 1e-14, "half a turn");
    }
}
