//! The effect of free faces on the stiffness of an elastic body in bending, whose sums are not corrected.

use touchstone_solver::{CubicSpline, kernel::Smoothing};

/// Period of bending of a body of these layers over the period with exact gradients, minus 1 \[-\].
///
/// Gradients (11) and forces (9) are sums over neighbours that are not corrected. Where neighbours are
/// missing, both are too small along the face, by the factor f = Σ V F x² over the layers that there are. A
/// layer at the distance y from the middle therefore counts with f² y² in the stiffness, whose sum is 1/12
/// of the cube of the thickness if f = 1; the period goes with the inverse root of the stiffness.
pub fn period_excess(layers: usize, h_over_dx: f64) -> f64 {
    let kernel = Smoothing::<CubicSpline>::new(h_over_dx);
    let reach = kernel.support().ceil() as i32;
    let of_row = |y: f64| {
        let of_place = |x: f64| kernel.f(x * x + y * y) * x * x;
        (-reach..=reach).fold(0.0, |sum, x| sum + of_place(f64::from(x)))
    };
    let rows = || (0..layers).map(|row| row as f64 - 0.5 * (layers as f64 - 1.0));
    let stiffness = rows().fold(0.0, |sum, y| {
        let factor = rows().fold(0.0, |factor, other| factor + of_row(other - y));
        sum + (factor * y).powi(2)
    });
    ((layers as f64).powi(3) / (12.0 * stiffness)).sqrt() - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theory::lattice::SquareLattice;
    use approx::assert_relative_eq;

    /// From an independent sum: 30, 15 and 7 %; far from faces there is the factor of the lattice squared.
    #[test]
    fn a_body_of_few_layers_bends_slowly() {
        for (layers, excess) in [(5, 0.30061), (10, 0.15282), (20, 0.07315), (40, 0.03309)] {
            assert_relative_eq!(period_excess(layers, 1.5), excess, max_relative = 1e-4);
        }
        let inside = SquareLattice::of::<CubicSpline>(1.5, 0.01).gradient_factor();
        let many = period_excess(2000, 1.5);
        assert!((many - (1.0 / inside - 1.0)).abs() < 1e-3, "{many}");
    }
}
