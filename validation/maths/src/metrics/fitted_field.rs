//! A field between particles: moving least squares.

use nalgebra::{Matrix3, Vector2, Vector3};
use touchstone_solver::inverse::{Inverse, of_three};

/// A particle of a field.
#[derive(Clone, Copy, Debug)]
pub struct FieldPoint {
    /// \[m\].
    pub position: Vector2<f64>,
    /// \[m²\].
    pub volume: f64,
    /// \[m/s\].
    pub velocity: Vector2<f64>,
    /// \[Pa\].
    pub pressure: f64,
}

/// Velocity and pressure at any point: a linear field fitted to the particles in reach, walls included, with
/// the weights V W (moving least squares).
pub struct FittedField<'a> {
    /// W \[1/m²\] of r² \[m²\], and where it ends \[m\].
    weight: &'a dyn Fn(f64) -> f64,
    reach: f64,
    /// Particles in the order of x, in bands as high as the kernel reaches.
    bands: Vec<Vec<FieldPoint>>,
}

impl<'a> FittedField<'a> {
    /// The field of these particles, with the kernel W \[1/m²\] of r² \[m²\] and its support \[m\], for
    /// places up to the height `lid` \[m\].
    pub fn new(
        (weight, reach): (&'a dyn Fn(f64) -> f64, f64),
        mut points: Vec<FieldPoint>,
        lid: f64,
    ) -> Self {
        points.sort_by(|a, b| a.position.x.total_cmp(&b.position.x));
        let mut field = Self { weight, reach, bands: Vec::new() };
        // One band more than the lid needs: particles farther out are in the first and the last.
        field.bands.resize(field.band(lid) + 2, Vec::new());
        for point in points {
            let band = field.band(point.position.y).min(field.bands.len() - 1);
            field.bands[band].push(point);
        }
        field
    }

    /// The band of a height; the second begins at 0. A float below 0 becomes 0.
    fn band(&self, y: f64) -> usize {
        (y / self.reach + 1.0) as usize
    }

    /// Particles that may be in reach of a place.
    fn near(&self, place: Vector2<f64>) -> impl Iterator<Item = &FieldPoint> {
        let (reach, band, last) = (self.reach, self.band(place.y), self.bands.len() - 1);
        let bands = &self.bands[band.saturating_sub(1).min(last)..=(band + 1).min(last)];
        bands.iter().flat_map(move |band| {
            let first = band.partition_point(|p| p.position.x < place.x - reach);
            band[first..].iter().take_while(move |p| p.position.x <= place.x + reach)
        })
    }

    /// The value at a point of the values of the particles in reach: they are fitted to a basis with the
    /// weights V W, and the first coefficient is the result. The basis is a function of a particle and of its
    /// distance.
    fn fit<const N: usize>(
        &self,
        place: Vector2<f64>,
        basis: impl Fn(&FieldPoint, Vector2<f64>) -> Vector3<f64>,
        values: impl Fn(&FieldPoint) -> [f64; N],
    ) -> [f64; N] {
        let (mut moments, mut sums) = (Matrix3::zeros(), [Vector3::zeros(); N]);
        for p in self.near(place) {
            let r = p.position - place;
            let r2 = r.norm_squared();
            if r2 < self.reach * self.reach {
                let (weight, basis) = (p.volume * (self.weight)(r2), basis(p, r));
                moments += basis * basis.transpose() * weight;
                for (sum, value) in sums.iter_mut().zip(values(p)) {
                    *sum += basis * (weight * value);
                }
            }
        }
        let Inverse { determinant, matrix } = of_three(&moments);
        match determinant {
            0.0 => [f64::NAN; N],
            _ => sums.map(|sum| matrix.row(0).transpose().dot(&sum)),
        }
    }

    /// Velocity \[m/s\] and pressure \[Pa\] at a place.
    pub fn at(&self, place: Vector2<f64>) -> (Vector2<f64>, f64) {
        let linear = |_: &_, r: Vector2<f64>| Vector3::new(1.0, r.x / self.reach, r.y / self.reach);
        let [u, v, p] = self.fit(place, linear, |p| [p.velocity.x, p.velocity.y, p.pressure]);
        (Vector2::new(u, v), p)
    }

    /// The derivative along `g` of the velocity in the direction `along` at a point of a wall where the
    /// velocity is 0; `g` is the height above the wall (negative behind it). g (a + b s + c g), with the
    /// distance s along x, is fitted to the fluid particles in reach, and a is the derivative. Every smooth
    /// field that is 0 on the wall is g times a smooth field, so the error of the fit is of second order in
    /// the reach, for any shape of the wall.
    pub fn slope_at(
        &self,
        place: Vector2<f64>,
        g: impl Fn(Vector2<f64>) -> f64,
        along: Vector2<f64>,
    ) -> f64 {
        // Particles behind the wall have no part in it.
        let basis = |p: &FieldPoint, r: Vector2<f64>| {
            let g = (g(p.position) / self.reach).max(0.0);
            Vector3::new(g, g * r.x / self.reach, g * g)
        };
        let [slope] = self.fit(place, basis, |p| [p.velocity.dot(&along)]);
        slope / self.reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_base::{
        functions::{cos, sin},
        random::Random,
    };
    use touchstone_solver::{QuinticSpline, Smoothing};

    /// The largest error of the slope at a wall y = c x²/2 turned by `angle`, with `n` disordered particles a
    /// length and the velocity `u` of distance along the wall and height above it, whose slope there is 1 +
    /// s.
    fn error_of_slope(n: f64, angle: f64, c: f64, u: fn(f64, f64) -> f64) -> f64 {
        let (dx, mut random) = (1.0 / n, Random::new(7));
        let along = Vector2::new(cos(angle), sin(angle));
        let across = Vector2::new(-along.y, along.x);
        let kernel = Smoothing::<QuinticSpline>::new(dx);
        let mut points = Vec::new();
        for place in
            touchstone_solver::lattice(Vector2::new(-1.0, 0.5 * dx), dx, 2 * n as usize, n as usize)
        {
            let mut moved = || 0.4 * dx * (random.uniform() - 0.5);
            let (s, g) = (place.x + moved(), place.y + moved());
            let velocity = along * u(s, g);
            let position = along * s + across * (g + 0.5 * c * s * s) + Vector2::new(0.0, 2.0);
            points.push(FieldPoint { position, volume: dx * dx, velocity, pressure: 0.0 });
        }
        let weight = |r2: f64| kernel.w(r2);
        let field = FittedField::new((&weight, kernel.support()), points, 4.0);
        let above = |place: Vector2<f64>| {
            let p = place - Vector2::new(0.0, 2.0);
            p.dot(&across) - 0.5 * c * p.dot(&along).powi(2)
        };
        let off = |k: i32| {
            let s = 0.05 * f64::from(k);
            let foot = along * s + across * (0.5 * c * s * s) + Vector2::new(0.0, 2.0);
            (field.slope_at(foot, above, along) - (1.0 + s)).abs()
        };
        (-6..=6).map(off).fold(0.0, f64::max)
    }

    /// A line fitted to the field made the slope at a wall wrong by 0.41 h u'', 0.15 H of the place where the
    /// flow comes back at ten spacings, and 0.04 H at 40.
    #[test]
    fn the_slope_at_a_wall_is_exact_for_parabolas_and_else_of_second_order() {
        let parabola = |s: f64, g: f64| g * (1.0 + s - 3.0 * g);
        for (angle, c) in [(0.0, 0.0), (0.4, 0.0), (0.0, 1.5), (-0.3, -2.0)] {
            let off = error_of_slope(20.0, angle, c, |_, g| g) - 0.3;
            assert!(off.abs() < 1e-12, "a linear field, slope 1: {off:e}");
            let off = error_of_slope(20.0, angle, c, parabola);
            // Along a wall that is both curved and inclined x is not the distance along it.
            let exact = angle == 0.0 || c == 0.0;
            assert!(off < if exact { 1e-12 } else { 1e-3 }, "{angle}, curvature {c}: {off:e}");
            let smooth = |s: f64, g: f64| sin(g) * (1.0 + sin(s) + s.powi(3) / 6.0) - 3.0 * g * g;
            let [coarse, fine] = [20.0, 40.0].map(|n| error_of_slope(n, angle, c, smooth));
            assert!(fine < 0.35 * coarse && coarse < 0.02, "{coarse:e} {fine:e}");
        }
    }

    #[test]
    fn a_field_misses_no_particle_in_reach() {
        let (kernel, lid, mut random) = (Smoothing::<QuinticSpline>::new(0.1), 3.0, Random::new(7));
        let mut number = |low: f64, high: f64| low + (high - low) * random.uniform();
        let point = |_| {
            let position = Vector2::new(number(0.0, 2.0), number(-0.4, lid + 0.4));
            let velocity = Vector2::new(number(-1.0, 1.0), number(-1.0, 1.0));
            FieldPoint { position, volume: 0.01, velocity, pressure: number(-1.0, 1.0) }
        };
        let points: Vec<FieldPoint> = (0..6000).map(point).collect();
        let weight = |r2: f64| kernel.w(r2);
        let reach = kernel.support();
        let field = FittedField::new((&weight, reach), points.clone(), lid);
        assert!(field.bands.len() > 10);
        let mut all = FittedField { weight: &weight, reach, bands: vec![points] };
        all.bands[0].sort_by(|a, b| a.position.x.total_cmp(&b.position.x));
        for y in [-0.05, 0.0, 1e-9, 0.299, 0.3, 0.301, 1.5, lid - 0.1, lid, lid + 0.05] {
            let [some, every] = [&field, &all].map(|field| field.at(Vector2::new(1.0, y)));
            assert!((some.0 - every.0).amax() < 1e-10, "{some:?} {every:?} at {y}");
            assert!((some.1 - every.1).abs() < 1e-10, "{some:?} {every:?} at {y}");
        }
    }
}
