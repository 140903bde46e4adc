//! What free faces take from the stiffness of an elastic body in bending.

use solver::{CubicSpline, kernel::Smoothing};

/// Period of bending of a body of so many layers over that of one whose gradients are exact, less 1 \[-\].
///
/// Gradients (11) and forces (9) are sums over neighbours that are not corrected. Where neighbours are
/// missing, both are too small along the face, by the factor f = Σ V F x² over the layers that there are. A
/// layer at the distance y from the middle therefore counts with f² y² in the stiffness, whose sum is 1/12
/// of the cube of the thickness if f = 1; the period goes with the inverse root of the stiffness.
pub fn period_excess(layers: usize, h_over_dx: f64) -> f64 {
    excess(layers, h_over_dx, |[factor, _], y| factor * y)
}

/// The same of corrected gradients. They are exact for linear fields alone: where a body bends, a layer has
/// the mean strain of the layers that it sees, weighted by Σ V F x², and at a face these lie to one side.
pub fn corrected_period_excess(layers: usize, h_over_dx: f64) -> f64 {
    excess(layers, h_over_dx, |[factor, moment], _| moment / factor)
}

/// The excess of a body whose layer at the distance y from the middle \[dx\] has the strain of
/// `strain(sums, y)` times the curvature; the sums are Σ V F x² of the layers that there are, and the same
/// weighted with their distances from the middle.
fn excess(layers: usize, h_over_dx: f64, strain: impl Fn([f64; 2], f64) -> f64) -> f64 {
    let kernel = Smoothing::<CubicSpline>::new(h_over_dx);
    let reach = kernel.support().ceil() as i32;
    let of_row = |y: f64| {
        let of_place = |x: f64| kernel.f(x * x + y * y) * x * x;
        (-reach..=reach).fold(0.0, |sum, x| sum + of_place(f64::from(x)))
    };
    let rows = || (0..layers).map(|row| row as f64 - 0.5 * (layers as f64 - 1.0));
    let stiffness = rows().fold(0.0, |sum, y| {
        let sums = rows().fold([0.0, 0.0], |[factor, moment], other| {
            let weight = of_row(other - y);
            [factor + weight, moment + weight * other]
        });
        sum + strain(sums, y).powi(2)
    });
    ((layers as f64).powi(3) / (12.0 * stiffness)).sqrt() - 1.0
}

/// How much longer periods of bending are known to be than those of an elastic body: by what faces take, and
/// by 7 % more, as published SPH of a plate with many layers has it.
pub fn known_excess(layers: usize, h_over_dx: f64) -> f64 {
    1.07 * (1.0 + period_excess(layers, h_over_dx)) - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use maths::theory::lattice::SquareLattice;

    /// By an independent sum in another language; of second order in dx/H.
    #[test]
    fn corrected_gradients_leave_an_error_of_second_order() {
        for (layers, excess) in [(5, 0.240), (10, 0.058), (20, 0.015), (40, 0.004)] {
            let found = corrected_period_excess(layers, 1.5);
            assert!((found - excess).abs() < 6e-4, "{layers}: {found}");
        }
    }

    /// By an independent sum: 30, 15 and 7 %; far from faces there is the factor of the lattice squared.
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
