//! Rows of particles along and parallel to a smooth curve, each with even spacing in its own arc length.

use nalgebra::Vector2;
use touchstone_base::functions::{cos, sin};
use touchstone_solver::{Particle, Role};

type Point = Vector2<f64>;

/// Samples of the curve a spacing of particles. A chord of 1/32 of a spacing is shorter than its arc by
/// 4e-5 of itself even where the radius of curvature is one spacing.
const SAMPLES: f64 = 32.0;
/// A point at a depth is kept if no part of the curve is nearer than this fraction of the depth: the margin
/// for the error of a sampled curve.
const NEARER: f64 = 1.0 - 1e-4;

/// A plane curve with the fluid on its left, sampled so finely that it counts as smooth.
///
/// The curve is closed or continues in the next period. Parts that are near each other must be near along the
/// curve as well: rows on two sides of a thin wall would overlap.
pub struct Curve {
    points: Vec<Point>,
    /// From the first point to the one after the last; 0 for a closed curve \[m\].
    period: Vector2<f64>,
}

/// A row of particles at one distance from a curve.
#[derive(Clone, Debug)]
pub struct ParticleRow {
    /// Distance behind the curve, on its right \[m\]; negative in the fluid.
    pub depth: f64,
    /// Arc length between neighbours \[m\]: length of the row over its number of particles.
    pub spacing: f64,
    /// The particles, in the direction of the curve.
    pub points: Vec<Point>,
}

impl ParticleRow {
    /// Its particles, each with its part of the area of a row of width `dx` \[m\]: fluid before the curve,
    /// interface on the curve, wall behind it.
    pub fn particles(
        &self,
        dx: f64,
        density: f64,
        velocity: impl Fn(Point) -> Vector2<f64>,
    ) -> impl Iterator<Item = Particle> {
        let volume = self.spacing * dx;
        let role = match self.depth {
            0.0 => Role::Interface,
            depth if depth < 0.0 => Role::Fluid,
            _ => Role::Wall,
        };
        self.points
            .iter()
            .map(move |&x| Particle::fluid(x, velocity(x), density, volume).with_role(role))
    }
}

impl Curve {
    /// The curve `at(t)` from t = `from` to t = `to`, where it must be `at(from)`, shifted by a period,
    /// for particles at the distance `dx` \[m\].
    ///
    /// The parameter need not be the arc length, but its speed must not come near 0.
    ///
    /// # Panics
    /// If the length of the curve is not finite and at least 3 `dx`: no row could be placed.
    pub fn new(at: impl Fn(f64) -> Point, [from, to]: [f64; 2], dx: f64) -> Self {
        let sample = |count: usize| -> Vec<Point> {
            (0..count).map(|k| at(from + (to - from) * (k as f64 / count as f64))).collect()
        };
        let period = at(to) - at(from);
        // 1e-9: a closed curve need not come back to the last bit.
        let period = if period.norm() < 1e-9 * dx { Vector2::zeros() } else { period };
        let rough = Self { points: sample(1024), period };
        let length = rough.length();
        assert!(length >= 3.0 * dx && length.is_finite(), "{length} m is no curve for {dx} m");
        Self { points: sample((SAMPLES * length / dx).ceil().max(1024.0) as usize), period }
    }

    /// The circle about `centre` with the fluid outside, on the convex side, or inside.
    pub fn circle(centre: Point, radius: f64, fluid_outside: bool, dx: f64) -> Self {
        let turn = if fluid_outside { -1.0 } else { 1.0 };
        let full = 2.0 * std::f64::consts::PI;
        let at = |t: f64| centre + Vector2::new(cos(t), turn * sin(t)) * radius;
        Self::new(at, [0.0, full], dx)
    }

    /// Arc length \[m\].
    pub fn length(&self) -> f64 {
        self.chords(&self.points).map(|chord| chord.norm()).sum()
    }

    /// The point of the curve, in any period, that is nearest to one less than half a period away.
    pub fn nearest(&self) -> impl Fn(Point) -> Point {
        const STRIDE: isize = 64;
        let half = self.points.len() as isize / 2;
        let (from, to) = (-half, self.points.len() as isize + half);
        // No point of these chords is farther from the first one than this.
        let reach = self.chords(&self.points).map(|chord| chord.norm()).fold(0.0, f64::max)
            * (1.01 * STRIDE as f64);
        let on_chord = |k: isize, x: Point| {
            let (start, chord) = (self.point(k), self.point(k + 1) - self.point(k));
            start + chord * ((x - start).dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0)
        };
        move |x: Point| {
            let firsts =
                (from..to).step_by(STRIDE as usize).map(|k| (k, (self.point(k) - x).norm()));
            let most = firsts.clone().map(|(_, away)| away).fold(f64::INFINITY, f64::min) + reach;
            let near = firsts.filter(|(_, away)| *away <= most);
            let all = near.flat_map(|(k, _)| (k..to.min(k + STRIDE)).map(|k| on_chord(k, x)));
            let distance2 = |point: &Point| (point - x).norm_squared();
            all.min_by(|a, b| distance2(a).total_cmp(&distance2(b))).unwrap_or(x)
        }
    }

    /// Rows behind the curve out to the `support` \[m\], dx apart, the first one `first` dx behind it: 0
    /// for interface particles on the curve and wall particles behind, 1/2 for walls that extrapolate.
    pub fn rows_behind(&self, dx: f64, first: f64, support: f64) -> Vec<ParticleRow> {
        let count = (support / dx - first - 1e-9).floor() as i32;
        (0..=count).map(|k| self.row((first + f64::from(k)) * dx, dx)).collect()
    }

    /// The row at a depth \[m\], as near to the spacing `dx` \[m\] as a whole number of particles is.
    ///
    /// Where the offset curve folds, deeper than its radius of curvature, points nearer to the curve than the
    /// depth are cut off: particles keep their distance on the concave side. On the convex side a row has
    /// more particles.
    pub fn row(&self, depth: f64, dx: f64) -> ParticleRow {
        let offset = self.offset(depth, dx);
        let chords: Vec<Vector2<f64>> = self.chords(&offset).collect();
        let length: f64 = chords.iter().map(|chord| chord.norm()).sum();
        let count = (length / dx).round().max(1.0);
        let spacing = length / count;
        let (mut points, mut so_far) = (Vec::new(), 0.0);
        for (start, chord) in offset.iter().zip(&chords) {
            let span = chord.norm();
            // Half a spacing from the start, so that a mirrored curve has mirrored particles.
            let next = |placed: &Vec<Point>| (placed.len() as f64 + 0.5) * spacing;
            while next(&points) <= so_far + span && (points.len() as f64) < count {
                points.push(start + chord * ((next(&points) - so_far) / span));
            }
            so_far += span;
        }
        ParticleRow { depth, spacing, points }
    }

    /// The samples moved to a depth \[m\], without the samples in folds.
    fn offset(&self, depth: f64, dx: f64) -> Vec<Point> {
        let count = self.points.len() as isize;
        let moved = |k: isize| {
            let along = self.point(k + 1) - self.point(k - 1);
            self.point(k) + Vector2::new(along.y, -along.x).normalize() * depth
        };
        let moved: Vec<Point> = (0..count).map(moved).collect();
        // A fold runs back; where none does nothing is too near, and the search below, which costs
        // samples times reach, is spared.
        let runs_back = |(along, offset): (Vector2<f64>, Vector2<f64>)| along.dot(&offset) <= 0.0;
        if !self.chords(&self.points).zip(self.chords(&moved)).any(runs_back) {
            return moved;
        }
        // A fold comes from within half a turn of radius `depth`.
        let reach = (SAMPLES * 4.0 * depth.abs() / dx) as isize;
        let reach = reach.min(count / 2);
        let nearest2 = (NEARER * depth) * (NEARER * depth);
        let is_kept = |(k, here): &(isize, Point)| {
            (-reach..=reach).all(|j| (self.point(k + j) - here).norm_squared() >= nearest2)
        };
        (0..count).zip(moved).filter(is_kept).map(|(_, here)| here).collect()
    }

    /// Sample k, of any period.
    fn point(&self, k: isize) -> Point {
        let count = self.points.len() as isize;
        self.points[k.rem_euclid(count) as usize] + self.period * k.div_euclid(count) as f64
    }

    /// From each point to the next; from the last to the first, a period on.
    fn chords(&self, points: &[Point]) -> impl Iterator<Item = Vector2<f64>> {
        let next = points.iter().skip(1).copied();
        let last = points.first().map(|first| first + self.period);
        points.iter().zip(next.chain(last)).map(|(a, b)| b - a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Hill;
    use touchstone_base::functions::exp;
    use touchstone_solver::{Kernel, QuinticSpline, Smoothing, WendlandC2};

    /// Particles of a curve and of the fluid before it, with their areas.
    struct Fitted {
        points: Vec<(Point, f64)>,
        /// How many are the fluid's, the nearest rows first.
        fluid: usize,
        period: Vector2<f64>,
        dx: f64,
    }

    impl Fitted {
        /// Rows at depth `first` dx, and on, behind the curve; six rows of fluid before it.
        fn new(curve: &Curve, dx: f64, first: f64, support: f64) -> Self {
            // Interface particles replace the lattice row on the curve.
            let nearest = if first == 0.0 { 1.0 } else { first };
            let fluid = (0..6).map(|k| curve.row(-(nearest + f64::from(k)) * dx, dx));
            let mut rows: Vec<ParticleRow> = fluid.collect();
            let fluid = rows.iter().map(|row| row.points.len()).sum();
            rows.extend(curve.rows_behind(dx, first, support));
            for row in &rows {
                check_spacing(row, curve.period, dx);
            }
            let area = |row: &ParticleRow| row.spacing * dx;
            let of_row =
                |row: ParticleRow| row.points.clone().into_iter().map(move |p| (p, area(&row)));
            let points = rows.into_iter().flat_map(of_row).collect();
            Self { points, fluid, period: curve.period, dx }
        }

        /// Least distance of two particles \[dx\].
        fn nearest(&self) -> f64 {
            let mut least = f64::MAX;
            for (k, (a, _)) in self.points.iter().enumerate() {
                for (b, _) in &self.points[..k] {
                    for shift in [-1.0, 0.0, 1.0] {
                        least = least.min((a - b + self.period * shift).norm());
                    }
                }
            }
            least / self.dx
        }

        /// Least and largest Σ V W over the two rows of fluid at the curve.
        fn sums<K: Kernel>(&self, h: f64) -> [f64; 2] {
            let kernel = Smoothing::<K>::new(h);
            let shifts: &[f64] = if self.period.norm() > 0.0 { &[-1.0, 0.0, 1.0] } else { &[0.0] };
            let sum = |at: &Point| -> f64 {
                let seen = shifts.iter().flat_map(|s| {
                    let shift = self.period * *s;
                    self.points
                        .iter()
                        .map(move |(p, v)| v * kernel.w((at - p + shift).norm_squared()))
                });
                seen.sum()
            };
            let near = &self.points[..self.fluid / 3];
            let sums = near.iter().map(|(p, _)| sum(p));
            sums.fold([f64::MAX, f64::MIN], |[low, high], s| [low.min(s), high.max(s)])
        }
    }

    /// Neighbours of a row are one spacing apart along it. The spacing is dx within 1 %, or within the
    /// deviation that a whole number of particles on a short row implies.
    fn check_spacing(row: &ParticleRow, period: Vector2<f64>, dx: f64) {
        let next = row.points.iter().skip(1).copied().chain([row.points[0] + period]);
        for (a, b) in row.points.iter().zip(next) {
            let apart = (b - a).norm() / row.spacing;
            // A chord is shorter than the arc by (dx/R)²/24.
            assert!((0.99..1.0 + 1e-9).contains(&apart), "{apart} spacings at depth {}", row.depth);
        }
        let off = (row.spacing / dx - 1.0).abs();
        assert!(
            off < (0.5 / row.points.len() as f64).max(0.01),
            "a spacing of {} dx at depth {}",
            row.spacing / dx,
            row.depth
        );
    }

    fn check(name: &str, curve: &Curve, dx: f64) {
        for first in [0.0, 0.5] {
            let fitted = Fitted::new(curve, dx, first, 3.0 * dx);
            let nearest = fitted.nearest();
            assert!(nearest > 0.985, "{name}, first row {first}: {nearest} dx apart");
            let quintic = fitted.sums::<QuinticSpline>(dx);
            let wendland = fitted.sums::<WendlandC2>(1.5 * dx);
            for [low, high] in [quintic, wendland] {
                let name = format!("{name}, first row {first}: {low} to {high}");
                assert!(low > 0.99 && high < 1.01, "{name}");
            }
        }
    }

    /// A circle with a radius of 10 spacings: rows outside shorten with the depth, rows inside lengthen.
    #[test]
    fn rows_along_a_circle_leave_no_gap_and_do_not_overlap() {
        let (centre, dx) = (Vector2::new(0.3, -0.7), 0.1);
        for fluid_outside in [true, false] {
            let curve = Curve::circle(centre, 10.0 * dx, fluid_outside, dx);
            let length = 20.0 * std::f64::consts::PI * dx;
            assert!((curve.length() / length - 1.0).abs() < 1e-4);
            check(&format!("outside {fluid_outside}"), &curve, dx);
            let row = curve.row(2.0 * dx, dx);
            let radius = if fluid_outside { 8.0 } else { 12.0 } * dx;
            assert!(row.points.iter().all(|p| ((p - centre).norm() / radius - 1.0).abs() < 1e-4));
        }
    }

    #[test]
    fn rows_along_the_hill_leave_no_gap_and_do_not_overlap() {
        let hill = Hill::new(1.0).expect("a sound reference");
        for dx in [0.1, 0.05] {
            let floor = Curve::new(|x| Point::new(x, hill.wall(x)), [0.0, hill.period()], dx);
            check(&format!("dx {dx}"), &floor, dx);
            let lid = Curve::new(|x| Point::new(x, hill.lid()), [hill.period(), 0.0], dx);
            let lid = lid.row(0.5 * dx, dx);
            assert!(lid.points.iter().all(|p| (p.y - hill.lid() - 0.5 * dx).abs() < 1e-12));
        }
    }

    /// Behind a bump narrower than the depth of the row the offset curve folds over itself: points too near
    /// are cut off, and the others keep their distance from the curve.
    #[test]
    fn a_fold_is_cut_off() {
        let dx = 0.1;
        let bump = |x: f64| Vector2::new(x, 0.5 * exp(-x * x / 0.08));
        let curve = Curve::new(bump, [-2.0, 2.0], dx);
        let row = curve.row(3.0 * dx, dx);
        let distance = |p: &Point| {
            let to = |k: i32| (bump(f64::from(k) * 1e-3 * 2.0) - p).norm();
            (-1000..=1000).map(to).fold(f64::MAX, f64::min)
        };
        for p in &row.points {
            let distance = distance(p);
            assert!((distance / row.depth - 1.0).abs() < 2e-3, "{distance} m at {p}");
        }
        // Across the corner that is left the way is shorter than along it.
        let apart = row.points.windows(2).map(|w| (w[1] - w[0]).norm() / row.spacing);
        assert!(apart.fold(f64::MAX, f64::min) > 0.7);
    }

    /// On a circle it is as far as the circle is along the ray from the centre; on hills, in any period, no
    /// point of a fine sample is nearer.
    #[test]
    fn the_nearest_point_is_nearer_than_all_others() {
        let (dx, centre) = (0.1, Point::new(2.0, -1.0));
        let circle = Curve::circle(centre, 1.5, true, dx);
        let nearest = circle.nearest();
        for turn in 0..16 {
            let ray = Vector2::new(cos(0.4 * f64::from(turn)), sin(0.4 * f64::from(turn)));
            let away = (nearest(centre + ray * 1.2) - centre - ray * 1.2).norm();
            assert!((away - 0.3).abs() < 1e-5, "{turn}: {away}");
        }
        let hill = Hill::new(1.0).unwrap();
        let at = |x: f64| Point::new(x, hill.wall(x));
        let hills = Curve::new(at, [0.0, hill.period()], dx);
        let nearest = hills.nearest();
        for k in 0..90 {
            let x = at(0.1 * f64::from(k)) - Vector2::new(0.0, 0.25);
            let sampled = (-9000..18000).map(|k| (at(1e-3 * f64::from(k)) - x).norm());
            let least = sampled.fold(f64::INFINITY, f64::min);
            assert!((nearest(x) - x).norm() < least + 1e-5, "{k}");
        }
    }
}
