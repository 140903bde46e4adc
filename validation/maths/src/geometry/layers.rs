//! Particles of a ring.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use touchstone_base::functions::sin_cos;

/// Places and volumes \[m²\] of the particles of a ring between two radii, in concentric layers dx apart.
/// Their numbers are multiples of four, so that the volume is exact, the edge is smooth, and the ring is
/// its own mirror image to the last bit.
pub fn layers([inner, outer]: [f64; 2], dx: f64) -> Vec<(Vector2<f64>, f64)> {
    let mut places = Vec::new();
    for k in 0..((outer - inner) / dx).round() as usize {
        let r = inner + (k as f64 + 0.5) * dx;
        let quarter = (TAU * r / (4.0 * dx)).round().max(1.0) as usize;
        let volume = TAU * r * dx / (4 * quarter) as f64;
        places.extend((0..4 * quarter).map(|j| (r * quadrant_point(j, quarter), volume)));
    }
    places
}

/// The unit vector number j of 4 `quarter`, which begin half a step above the x axis; the four
/// quadrants are mirror images of the first to the last bit.
fn quadrant_point(j: usize, quarter: usize) -> Vector2<f64> {
    let (quadrant, k) = (j / quarter, j % quarter);
    let k = if quadrant % 2 == 0 { k } else { quarter - 1 - k };
    let (sin, cos) = sin_cos(TAU * (k as f64 + 0.5) / (4 * quarter) as f64);
    let x = if quadrant == 0 || quadrant == 3 { cos } else { -cos };
    Vector2::new(x, if quadrant < 2 { sin } else { -sin })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_volume_is_exact_and_a_ring_is_its_own_mirror_image() {
        let ring = layers([3.0, 4.0], 0.1);
        let volume: f64 = ring.iter().map(|(_, volume)| volume).sum();
        assert!((volume / (0.5 * TAU * 7.0) - 1.0).abs() < 1e-12, "{volume}");
        let has = |place: Vector2<f64>| ring.iter().any(|(other, _)| *other == place);
        assert!(
            ring.iter().all(|(x, _)| has(Vector2::new(-x.x, x.y)) && has(Vector2::new(x.x, -x.y)))
        );
    }
}
