//! Images: extra columns copied from a source particle before each sweep, shifted by a period or
//! mirrored at a wall, so that no pair pays for a wrap or a wall.

use nalgebra::{Matrix2, Vector2};

use super::PlaneWall;
use crate::{numbers::Numbers, particles::Column};

/// What turns a particle into its image: x' = A x + b, v' = s v + w + c d².
#[derive(Clone, Copy, Debug)]
pub struct Map {
    linear: Matrix2<f64>,
    offset: Vector2<f64>,
    sign: f64,
    velocity: Vector2<f64>,
    curvature: Vector2<f64>,
    wall: (Vector2<f64>, Vector2<f64>),
}

impl Map {
    /// The particle itself.
    pub fn identity() -> Self {
        Self {
            linear: Matrix2::identity(),
            offset: Vector2::zeros(),
            sign: 1.0,
            velocity: Vector2::zeros(),
            curvature: Vector2::zeros(),
            wall: (Vector2::zeros(), Vector2::zeros()),
        }
    }

    /// The ghost across a no-slip wall.
    pub fn mirror(wall: &PlaneWall) -> Self {
        let n = wall.normal;
        Self {
            linear: Matrix2::identity() - n * n.transpose() * 2.0,
            offset: n * (2.0 * wall.point.dot(&n)),
            sign: -1.0,
            velocity: wall.velocity * 2.0,
            curvature: wall.curvature,
            wall: (wall.point, n),
        }
    }

    /// The ghost across two walls at a right angle.
    pub fn corner([a, b]: [&PlaneWall; 2]) -> Self {
        let (a, b) = (Self::mirror(a), Self::mirror(b));
        let offset = a.linear * b.offset + a.offset;
        Self { linear: a.linear * b.linear, offset, ..Self::identity() }
    }

    /// The same image, shifted.
    pub fn shifted(self, by: Vector2<f64>) -> Self {
        Self { offset: self.offset + by, ..self }
    }

    /// Where the image of a point is \[m\].
    #[inline(always)]
    pub fn place(&self, point: Vector2<f64>) -> Vector2<f64> {
        self.linear * point + self.offset
    }

    /// The image of a column. Scalars (density, pressure) are those of the source.
    #[inline(always)]
    pub fn apply<S: Numbers>(&self, source: &Column<S>) -> Column<S> {
        let depth = (source.position - self.wall.0).dot(&self.wall.1);
        Column {
            position: self.place(source.position),
            velocity: source.velocity * self.sign
                + self.velocity
                + self.curvature * (depth * depth),
            ..*source
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
        let map = Map::mirror(&wall);
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

    #[test]
    fn a_ghost_across_a_corner_is_the_mirror_of_the_mirror() {
        let corner = Vector2::new(1.0, 2.0);
        let wall = |n: Vector2<f64>| PlaneWall::new(corner, n, Vector2::zeros());
        let walls = [wall(Vector2::new(-0.6, 0.8)), wall(Vector2::new(0.8, 0.6))];
        let [a, b] = [Map::mirror(&walls[0]), Map::mirror(&walls[1])];
        let common = Common { mass: 1.0, density: 2.0, volume: 0.5 };
        let velocity = Vector2::new(1.0, 7.0);
        let source = Column { position: Vector2::new(1.3, 2.9), velocity, common, shows: 9.0 };
        let ghost = Map::corner([&walls[0], &walls[1]]).apply(&source);
        for twice in [a.apply(&b.apply(&source)), b.apply(&a.apply(&source))] {
            assert!((ghost.position - twice.position).norm() < 1e-14);
            assert!((ghost.velocity - twice.velocity).norm() < 1e-14);
        }
        assert!((ghost.position + source.position - corner * 2.0).norm() < 1e-14, "half a turn");
    }
}
