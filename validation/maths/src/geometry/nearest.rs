//! The least distance of two particles.

use nalgebra::Vector2;
use touchstone_base::functions::hypot;

/// The least distance of two particles of the periodic unit square \[m\].
pub fn nearest(particles: impl Iterator<Item = Vector2<f64>>) -> f64 {
    let mut places: Vec<_> = particles.map(|x| x.map(|x| x.rem_euclid(1.0))).collect();
    let count = places.len();
    places.sort_by(|a, b| a.x.total_cmp(&b.x));
    let across: Vec<_> = places.iter().map(|place| place + Vector2::x()).collect();
    places.extend(across);
    let mut least = f64::INFINITY;
    for (k, a) in places[..count].iter().enumerate() {
        let ahead = places[k + 1..].iter().take_while(|b| b.x - a.x < least);
        let apart = |b: &Vector2<f64>| {
            let y = b.y - a.y;
            hypot(b.x - a.x, y - y.round())
        };
        least = ahead.map(apart).fold(least, f64::min);
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pairs across an edge were left out, which let particles pair there.
    #[test]
    fn particles_are_near_each_other_across_an_edge_too() {
        let of = |places: [[f64; 2]; 3]| nearest(places.into_iter().map(Vector2::from));
        let third = [0.4, 0.7];
        for pair in [[[0.999, 0.5], [0.001, 0.5]], [[0.1, 0.999], [0.1, 0.001]]] {
            assert!((of([pair[0], pair[1], third]) - 0.002).abs() < 1e-12, "{pair:?}");
            assert!((of([third, pair[1], pair[0]]) - 0.002).abs() < 1e-12, "{pair:?}");
        }
        let beyond = of([[-0.001, 0.001], [0.001, 0.999], third]);
        assert!((beyond - 8e-6_f64.sqrt()).abs() < 1e-12, "{beyond}");
    }
}
