//! Fits of one factor.

use nalgebra::Vector2;

use touchstone_solver::Tait;

use super::{Factor, code::Moment};

/// The factor s that makes Σ (found − s expected)² least, with its standard error.
pub fn factor(pairs: impl Iterator<Item = [f64; 2]> + Clone) -> Factor {
    let (mut both, mut square, mut count) = (0.0, 0.0, 0.0);
    for [found, expected] in pairs.clone() {
        both += found * expected;
        square += expected * expected;
        count += 1.0;
    }
    let value = both / square;
    let off = pairs.fold(0.0, |sum, [found, expected]| sum + (found - value * expected).powi(2));
    Factor { value, uncertainty: (off / square / f64::max(count - 1.0, 1.0)).sqrt() }
}

/// The factor in the limit of fine spacing, from the factors at two spacings dx: with an error c dx²,
/// g(dx) = g0 − c dx² gives g0. Its uncertainty is what remains of the fourth order, (g0 − g)² of the finer
/// one.
pub fn limit([coarse, fine]: [Factor; 2], spacings: [f64; 2]) -> Factor {
    let ratio = (spacings[0] / spacings[1]).powi(2);
    let value = fine.value + (fine.value - coarse.value) / (ratio - 1.0);
    let uncertainty = (value - fine.value).powi(2) + fine.uncertainty;
    Factor { value, uncertainty }
}

/// Value at x = 0 and slope of the straight line through points (x, y) by least squares.
pub fn line(points: &[[f64; 2]]) -> (f64, f64) {
    let n = points.len() as f64;
    let [x, y] = [0, 1].map(|k| points.iter().fold(0.0, |sum, of| sum + of[k]) / n);
    let (both, square) = points.iter().fold((0.0, 0.0), |(both, square), [at, value]| {
        (both + (at - x) * (value - y), square + (at - x).powi(2))
    });
    let slope = both / square;
    (y - slope * x, slope)
}

/// Components of two lists of vectors, pair by pair.
pub fn components<'a>(
    pairs: impl Iterator<Item = [Vector2<f64>; 2]> + Clone + 'a,
) -> impl Iterator<Item = [f64; 2]> + Clone + 'a {
    pairs.flat_map(|[a, b]| [[a.x, b.x], [a.y, b.y]])
}

/// The rms of lengths.
pub fn rms(lengths: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = lengths.fold((0.0, 0.0), |(sum, count), of| (sum + of * of, count + 1.0));
    f64::sqrt(sum / f64::max(count, 1.0))
}

/// Total momentum per unit depth \[kg/s\].
pub fn momentum(at: &Moment) -> Vector2<f64> {
    at.states.iter().fold(Vector2::zeros(), |sum, of| sum + of.velocity * of.mass)
}

/// Kinetic energy per unit depth \[J/m\].
pub fn kinetic(at: &Moment) -> f64 {
    at.states.iter().fold(0.0, |sum, of| sum + 0.5 * of.mass * of.velocity.norm_squared())
}

/// Elastic energy per unit depth, to second order in the change of density \[J/m\]; 0 without densities.
pub fn elastic(at: &Moment, eos: &Tait) -> f64 {
    at.states.iter().fold(0.0, |sum, of| {
        let change = of.density.map_or(0.0, |density| density / eos.density - 1.0);
        sum + 0.5 * of.mass * (eos.sound_speed * change).powi(2)
    })
}
