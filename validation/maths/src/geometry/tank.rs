//! An open rectangular tank: a bottom, two sides, and no lid.

use nalgebra::Vector2;
use touchstone_solver::{PlaneWall, Role};

/// The inside of a tank, from its lower left corner at the origin.
///
/// Particles are on a square lattice with the walls as lattice lines, so bottom, sides and corners are rows
/// of one lattice, without gap or overlap.
#[derive(Clone, Copy, Debug)]
pub struct Tank {
    /// Spacings across the tank.
    pub columns: usize,
    /// Spacings up to its rim.
    pub rows: usize,
    /// Spacing \[m\].
    pub dx: f64,
}

impl Tank {
    /// Width of the inside \[m\].
    pub fn width(&self) -> f64 {
        self.columns as f64 * self.dx
    }

    /// For [`touchstone_solver::InterfaceWall`]: interface particles on bottom and sides, up to the rim, then
    /// wall particles behind them, out to the `support` \[m\]. The first row of the fluid is at dx, see
    /// [`Tank`].
    pub fn interface_walls(&self, support: f64) -> Vec<(Vector2<f64>, Role)> {
        let (mut walls, mut behind_them) = (Vec::new(), Vec::new());
        let behind = (support / self.dx - 1e-9).floor() as i32;
        let (columns, rows) = (self.columns as i32, self.rows as i32);
        // Rows of the inside end at the sides: their middles are water, and may be a million times the walls.
        let row = |j: i32| {
            let [left, right] = if j > 0 { [0, columns] } else { [columns, columns + 1] };
            (-behind..=left).chain(right..=columns + behind).map(move |i| (i, j))
        };
        for (i, j) in (-behind..=rows).flat_map(row) {
            let (across, up) = (0..=columns, 0..=rows);
            let is_inside = across.contains(&i) && up.contains(&j);
            let is_surface = is_inside && (i == 0 || i == columns || j == 0);
            let point = Vector2::new(f64::from(i), f64::from(j)) * self.dx;
            if is_surface {
                walls.push((point, Role::Interface));
            } else if !is_inside {
                behind_them.push((point, Role::Wall));
            }
        }
        walls.append(&mut behind_them);
        walls
    }

    /// For [`touchstone_solver::ExtrapolatingWall`]: rows from half a spacing behind bottom and sides on, up
    /// to the rim, out to the `support` \[m\]. The fluid's first row is at dx/2.
    pub fn rows_behind(&self, support: f64) -> Vec<Vector2<f64>> {
        let behind = (support / self.dx + 0.5 - 1e-9).floor() as usize;
        let first = Vector2::repeat((0.5 - behind as f64) * self.dx);
        let (inside, all) = (behind + self.columns, 2 * behind + self.columns);
        let row = |j: usize| {
            let left = if j < behind { inside } else { behind };
            (0..left).chain(inside..all).map(move |i| (i, j))
        };
        let place = |(i, j)| first + Vector2::new(i as f64, j as f64) * self.dx;
        (0..self.rows + behind).flat_map(row).map(place).collect()
    }

    /// Walls that mirror the fluid: bottom, left and right side, of infinite height.
    pub fn mirrors(&self) -> Vec<PlaneWall> {
        let wall = |point, normal| PlaneWall::new(point, normal, Vector2::zeros());
        let (origin, right) = (Vector2::zeros(), Vector2::new(self.width(), 0.0));
        vec![wall(origin, Vector2::y()), wall(origin, Vector2::x()), wall(right, -Vector2::x())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TANK: Tank = Tank { columns: 9, rows: 7, dx: 0.1 };

    /// Each lattice point outside of the fluid, once, out to the support and not beyond.
    fn check(walls: &[Vector2<f64>], first: f64, [behind, columns, rows]: [i32; 3]) {
        let cell = |p: &Vector2<f64>| p.map(|x| (x / TANK.dx - first).round() as i32);
        let mut cells: Vec<_> = walls.iter().map(|p| (cell(p).x, cell(p).y)).collect();
        cells.sort_unstable();
        let is_water = |i: i32, j: i32| (0..columns).contains(&i) && j >= 0;
        let all = (-behind..columns + behind).flat_map(|i| (-behind..rows).map(move |j| (i, j)));
        let expected: Vec<_> = all.filter(|(i, j)| !is_water(*i, *j)).collect();
        assert_eq!(cells, expected);
        for p in walls {
            let off = p / TANK.dx - Vector2::repeat(first) - cell(p).map(f64::from);
            assert!(off.amax() < 1e-12, "{p} is off the lattice");
        }
    }

    #[test]
    fn walls_and_water_fill_one_lattice_without_gap_or_overlap() {
        for (support, behind) in [(0.31, 3), (0.25, 2), (0.24, 2), (0.26, 3)] {
            check(&TANK.rows_behind(support), 0.5, [behind, 9, 7]);
        }
        let walls = TANK.interface_walls(0.3);
        // Water from column 1 to 8 and row 1 up; the walls reach the rim at row 7, behind it row -2.
        let moved: Vec<_> = walls.iter().map(|(p, _)| p - Vector2::repeat(TANK.dx)).collect();
        check(&moved, 0.0, [3, 8, 7]);
        let (surface, behind) = walls.split_at(10 + 2 * 7);
        let width = TANK.width();
        let on_wall = |p: &Vector2<f64>| p.x == 0.0 || (p.x - width).abs() < 1e-12 || p.y == 0.0;
        assert!(
            surface
                .iter()
                .all(|(p, role)| { *role == Role::Interface && on_wall(p) && p.y >= 0.0 })
        );
        assert!(behind.iter().all(|(_, role)| *role == Role::Wall));
    }

    /// The inside of this tank has 10^10 places, 160 GB.
    #[test]
    fn walls_of_a_large_tank_take_no_memory_for_its_inside() {
        let tank = Tank { columns: 100_000, rows: 100_000, ..TANK };
        assert_eq!(tank.rows_behind(0.31).len(), 3 * (100_006 + 2 * 100_000));
        assert_eq!(tank.interface_walls(0.21).len(), 2 * 100_005 + 100_005 + 6 * 100_000);
    }

    #[test]
    fn mirrors_face_the_water() {
        let middle = Vector2::new(0.5 * TANK.width(), 0.3);
        for wall in TANK.mirrors() {
            assert!((middle - wall.point).dot(&wall.normal) > 0.0);
        }
    }
}
