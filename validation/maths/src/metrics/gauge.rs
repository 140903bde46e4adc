//! Gauges of water: probes of its depth, and sensors of the pressure on a wall.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// Depth of water at x: Σ V hat((x_i − x)/w)/w with the hat function 1 − |ξ| of half-width w.
///
/// The gauge sums the wet part and does not search for the topmost drop. Exact for columns of a lattice at
/// any position, if w is a whole number of spacings.
pub fn depth(water: &[[f64; 2]], x: f64, w: f64) -> f64 {
    water.iter().fold(0.0, |sum, [place, volume]| {
        let hat = (1.0 - ((place - x) / w).abs()).max(0.0);
        sum + volume * hat / w
    })
}

/// The position of a probe at x, and half of its width: this number of spacings, or up to a nearer wall,
/// behind which there is no water \[m\].
pub fn probe(x: f64, spacings: f64, dx: f64, width: f64) -> (f64, f64) {
    let place = x.max(dx);
    // A rounding error must not take away a spacing.
    let room = (place.min(width - place) / dx + 1e-9).floor();
    (place, dx * spacings.min(room).max(1.0))
}

/// The kernel W(r) \[1/m²\] of r² \[m²\].
pub type Weight<'a> = &'a dyn Fn(f64) -> f64;

/// A point of a sensor: place, part of the sensor, and the part of the kernel inside the tank.
#[derive(Serialize, Deserialize)]
pub struct Spot {
    /// Place on the wall \[m\].
    pub place: Vector2<f64>,
    /// Its share of the sensor.
    pub share: f64,
    inside: f64,
}

/// The points of a round sensor on the wall x = `wall`, with the height of its middle and its diameter \[m\],
/// weighted by the chords of its disk; with the support \[m\] of the kernel.
pub fn sensor(kernel: (f64, Weight), wall: f64, [height, diameter]: [f64; 2]) -> Vec<Spot> {
    const POINTS: usize = 5;
    let offset = |k: usize| (k as f64 + 0.5) / POINTS as f64 * 2.0 - 1.0;
    let chord = |k: usize| (1.0 - offset(k) * offset(k)).sqrt();
    let all: f64 = (0..POINTS).map(chord).sum();
    let spot = |k: usize| {
        let y = height + 0.5 * diameter * offset(k);
        let place = Vector2::new(wall, y);
        Spot { place, share: chord(k) / all, inside: inside(kernel, y) }
    };
    (0..POINTS).map(spot).collect()
}

/// The integral of a kernel with this support \[m\] about a point of a wall at this height over the
/// quarter-plane of water.
fn inside((support, weight): (f64, Weight), height: f64) -> f64 {
    const CELLS: i32 = 40;
    let cell = support / f64::from(CELLS);
    let middle = |k: i32| (f64::from(k) + 0.5) * cell;
    let columns = (0..CELLS).map(middle);
    columns
        .flat_map(|x| (-CELLS..CELLS).map(move |j| (x, middle(j))))
        .filter(|(_, y)| height + y > 0.0)
        .fold(0.0, |sum, (x, y)| sum + cell * cell * weight(x * x + y * y))
}

/// The pressure on a sensor \[Pa\] from the places \[m\], volumes \[m²\] and pressures of the particles near
/// it. At a point of the wall p = Σ V p W/max(Σ V W, φ/2), φ the part of the kernel inside of the tank: the
/// mean of the water that is near, falling to 0 where less than half of the place is wet.
pub fn pressure<'a>(
    sensor: &[Spot],
    near: impl Iterator<Item = &'a (Vector2<f64>, f64, f64)> + Clone,
    weight: Weight,
) -> f64 {
    let at = |spot: &Spot| {
        let (mut wet, mut sum) = (0.0, 0.0);
        for (place, volume, pressure) in near.clone() {
            let w = volume * weight((place - spot.place).norm_squared());
            wet += w;
            sum += w * pressure;
        }
        spot.share * sum / wet.max(0.5 * spot.inside)
    };
    sensor.iter().map(at).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_solver::{Smoothing, WendlandC2};

    #[test]
    fn depth_is_exact_for_a_lattice_wherever_the_probe_is() {
        let dx = 0.1;
        let water: Vec<_> = touchstone_solver::lattice(Vector2::new(0.05, 0.05), dx, 20, 7)
            .map(|p| [p.x, dx * dx])
            .collect();
        for x in [0.2, 0.73, 1.111, 1.8] {
            assert!((depth(&water, x, 2.0 * dx) - 0.7).abs() < 1e-12);
        }
        assert!((depth(&water, 2.0, 2.0 * dx) - 0.35).abs() < 1e-12, "half of the probe is dry");
        assert_eq!(depth(&water, 3.0, 2.0 * dx), 0.0);
    }

    /// With two spacings to either side at n = 6 it reached behind the back wall, where there is no water,
    /// and the column began 0.925 H high.
    #[test]
    fn a_height_gauge_that_reaches_behind_the_wall_is_narrowed() {
        for n in 1..=40 {
            let dx = 1.0 / n as f64;
            let (place, w) = probe(0.2, (0.05 / dx).round().max(2.0), dx, 8.5);
            for first in [0.5, 1.0] {
                let corner = Vector2::new(first * dx, 0.5 * dx);
                let water: Vec<_> = touchstone_solver::lattice(corner, dx, 3 * n, 2 * n)
                    .map(|p| [p.x, dx * dx])
                    .collect();
                let height = depth(&water, place, w);
                assert!(
                    (height - 2.0).abs() < 1e-12,
                    "n = {n}, first column at {first} dx: {height}"
                );
            }
            assert!(n < 10 || (place, w) == (0.2, dx * (0.05 / dx).round().max(2.0)));
        }
        assert_eq!(
            probe(9.0, 2.0, 0.1, 8.5),
            (9.0, 0.1),
            "beyond the tank there is nothing to read"
        );
    }

    #[test]
    fn half_of_a_kernel_is_in_front_of_a_wall_and_a_quarter_in_a_corner() {
        let smoothing = Smoothing::<WendlandC2>::new(0.1);
        let weight = |r2| smoothing.w(r2);
        let kernel: (f64, Weight) = (smoothing.support(), &weight);
        for (height, expected) in [(0.5, 0.5), (0.0, 0.25)] {
            let part = inside(kernel, height);
            assert!((part - expected).abs() < 1e-3, "{height}: {part}");
        }
        let all: f64 = sensor(kernel, 1.0, [0.3, 0.0042]).iter().map(|s| s.share).sum();
        assert!((all - 1.0).abs() < 1e-12);
    }
}
