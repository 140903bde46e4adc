//! Images (mirror particles and periodic copies): extra columns, each computed before each sweep from an
//! earlier column, mirrored at a wall or shifted by a period. So the loop over pairs treats neither walls nor
//! periodicity.

use nalgebra::Vector2;

use super::PlaneWall;
use crate::{numbers::Numbers, particles::SweptParticle};

/// The map from a particle, or from an image of it, to an image.
#[derive(Clone, Copy, Debug)]
pub enum Map {
    /// The mirror particle across a wall: x' = x − 2dn, v' = 2U − v + d² ∂²v/∂n², with the depth d of the
    /// source in the fluid; where the fluid slips v' = v − 2(v·n)n.
    Mirror(PlaneWall),
    /// The mirror particle across both walls of a corner at c \[m\]: x' = 2c − x, v' = v; with slip −v.
    Corner([PlaneWall; 2], Vector2<f64>),
    /// The copy a period away: x' = x + s \[m\].
    Shift(Vector2<f64>),
}

impl Map {
    /// The mirror particle across two walls at a right angle: half a turn about their corner.
    pub fn corner([a, b]: [&PlaneWall; 2]) -> Self {
        Self::Corner([*a, *b], a.point - b.normal * b.depth(a.point))
    }

    /// The place of the image of a point \[m\].
    #[inline(always)]
    pub fn place(&self, point: Vector2<f64>) -> Vector2<f64> {
        match self {
            Self::Mirror(wall) => point - wall.normal * (2.0 * wall.depth(point)),
            Self::Corner(_, corner) => corner * 2.0 - point,
            Self::Shift(by) => point + by,
        }
    }

    /// The walls of this mirror or corner.
    #[inline(always)]
    pub(crate) fn walls(&self) -> &[PlaneWall] {
        match self {
            Self::Mirror(wall) => std::slice::from_ref(wall),
            Self::Corner(walls, _) => walls,
            Self::Shift(_) => &[],
        }
    }

    /// The image of a column, `slip` being [`super::Walls::SLIPS`]. Density and pressure are equal to the
    /// source's. If the source has crossed the wall, its image would be in the fluid: it has no mass and no
    /// volume, and acts on nothing. `motion` is 1, or 0 where velocities are differences of two states: U and
    /// ∂²v/∂n² are then 0.
    #[inline(always)]
    pub fn apply<S: Numbers>(
        &self,
        source: &SweptParticle<S>,
        slip: bool,
        motion: f64,
    ) -> SweptParticle<S> {
        let velocity = self.velocity(source, slip, motion);
        let mut image =
            SweptParticle { position: self.place(source.position), velocity, ..*source };
        if self.walls().iter().any(|wall| wall.depth(source.position) < 0.0) {
            (image.common.mass, image.common.volume) = (0.0, 0.0);
        }
        image
    }

    /// The velocity of the image of a column \[m/s\], see [`Map::apply`].
    #[inline(always)]
    pub(crate) fn velocity<S>(
        &self,
        source: &SweptParticle<S>,
        slip: bool,
        motion: f64,
    ) -> Vector2<f64> {
        let v = source.velocity;
        match self {
            Self::Mirror(wall) if slip => v - wall.normal * v.dot(&wall.normal) * 2.0,
            Self::Mirror(wall) => {
                let depth = wall.depth(source.position);
                wall.velocity * (2.0 * motion) - v + wall.curvature * (depth * depth * motion)
            }
            Self::Corner(..) if slip => -v,
            Self::Corner(..) | Self::Shift(_) => v,
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
        let source =
            SweptParticle { position, velocity: Vector2::new(1.0, 7.0), common, derived: 9.0 };
        let ghost = map.apply(&source, false, 1.0);
        assert!((ghost.position - (point + along * 5.0 - normal * 0.25)).norm() < 1e-14);
        let expected = velocity * 2.0 - source.velocity + Vector2::new(0.0, 3.0) * 0.0625;
        assert!((ghost.velocity - expected).norm() < 1e-14);
        assert_eq!((ghost.common.density, ghost.derived), (2.0, 9.0));
        let mirrored = map.apply(&source, true, 1.0).velocity - source.velocity;
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
        let source =
            SweptParticle { position: Vector2::new(1.3, 2.9), velocity, common, derived: 9.0 };
        let corner_map = Map::corner([&walls[0], &walls[1]]);
        for slip in [false, true] {
            let ghost = corner_map.apply(&source, slip, 1.0);
            let [a, b] =
                [a, b].map(|map| move |column: &SweptParticle<f64>| map.apply(column, slip, 1.0));
            for twice in [a(&b(&source)), b(&a(&source))] {
                assert!((ghost.position - twice.position).norm() < 1e-14);
                assert!((ghost.velocity - twice.velocity).norm() < 1e-14);
            }
        }
        let ghost = corner_map.apply(&source, false, 1.0);
        assert!((ghost.position + source.position - corner * 2.0).norm() < 1e-14, "half a turn");
    }

    /// The image had the mass of its source, and pushed the water from inside.
    #[test]
    fn the_image_of_a_particle_that_has_crossed_a_wall_lay_in_the_fluid() {
        let wall = |n: Vector2<f64>| PlaneWall::new(Vector2::zeros(), n, Vector2::zeros());
        let walls = [wall(Vector2::y()), wall(Vector2::x())];
        let common = Common { mass: 1.0, density: 2.0, volume: 0.5 };
        let maps =
            [Map::Mirror(walls[0]), Map::Mirror(walls[1]), Map::corner([&walls[0], &walls[1]])];
        for (place, seen) in [
            (Vector2::new(0.3, 0.1), [true, true, true]),
            (Vector2::new(0.3, 0.0), [true, true, true]),
            (Vector2::new(0.3, -0.1), [false, true, false]),
            (Vector2::new(-0.3, 0.1), [true, false, false]),
            (Vector2::new(-0.3, -0.1), [false, false, false]),
        ] {
            let source =
                SweptParticle { position: place, velocity: Vector2::y(), common, derived: 9.0 };
            for (map, seen) in maps.iter().zip(seen) {
                let Common { mass, volume, density } = map.apply(&source, true, 1.0).common;
                let expected = if seen { (1.0, 0.5, 2.0) } else { (0.0, 0.0, 2.0) };
                assert_eq!((mass, volume, density), expected, "{map:?} of {place:?}");
            }
        }
    }
}
