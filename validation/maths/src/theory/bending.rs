//! Bending of a total Lagrangian plate of few layers.
//!
//! A plate of n layers of a square lattice of spacing 1, infinite along x, is bent to the curvature 1:
//! its displacements are u = (x y, w(y) − x²/2) with the displacement w across the plate of least energy.
//! In the notation of `touchstone_solver::lagrangian`, the displacement gradient of a particle is exact
//! for linear fields but not for x y: at a face, where neighbours are on one side, it is the gradient a
//! little inside. H and the residuals E are linear in w, so the energy of a column of particles is a sum
//! of squares, λ (tr H)²/2 + μ H:H + ¼ c Σ_b g |E|² a particle, with the minimum of half the bending
//! stiffness. Frequencies are proportional to its root, deflections under a load to its inverse.

use nalgebra::{DMatrix, DVector, Vector2};
use touchstone_solver::kernel::Kernel;
use touchstone_solver::lagrangian::body::hourglass;

use super::{
    lagrangian::HOURGLASS,
    lattice::{SquareLattice, near},
};

/// Σ a (l·w + m)²/2 with a vector w of unknowns.
struct Squares {
    /// Σ a l ⊗ l.
    matrix: DMatrix<f64>,
    /// Σ a m l.
    vector: DVector<f64>,
    /// Σ a m².
    constant: f64,
}

impl Squares {
    fn add(&mut self, a: f64, l: &DVector<f64>, m: f64) {
        self.matrix.ger(a, l, l, 1.0);
        self.vector.axpy(a * m, l, 1.0);
        self.constant += a * m * m;
    }

    /// The minimum, with the first unknown 0: the sum depends only on differences of unknowns.
    fn least(self) -> f64 {
        let matrix = self.matrix.remove_row(0).remove_column(0);
        let vector = self.vector.remove_row(0);
        let found = matrix.cholesky().map(|matrix| matrix.solve(&vector));
        found.map_or(f64::NAN, |w| 0.5 * (self.constant - vector.dot(&w)))
    }
}

/// The bending stiffness of a plate of at least 2 layers over the stiffness of an elastic plate, E H³/(12 (1
/// − ν²)), with the hourglass modulus c = 8/3 χ μ/G₁.
pub fn stiffness<K: Kernel>(h_over_dx: f64, layers: usize, poisson: f64) -> f64 {
    // E = 1.
    let mu = 0.5 / (1.0 + poisson);
    let lambda = 2.0 * mu * poisson / (1.0 - 2.0 * poisson);
    let factor = SquareLattice::of::<K>(h_over_dx, 0.0).gradient_factor();
    let c = hourglass(mu, HOURGLASS, factor);
    let (matrix, vector) = (DMatrix::zeros(layers, layers), DVector::zeros(layers));
    let mut squares = Squares { matrix, vector, constant: 0.0 };
    let none = DVector::zeros(layers);
    let height = |row: usize| row as f64 - 0.5 * (layers as f64 - 1.0);
    let points = near::<K>(h_over_dx);
    for row in 0..layers {
        let in_plate = |&(x, g): &(Vector2<f64>, f64)| {
            let other = row.checked_add_signed(x.y as isize).filter(|other| *other < layers);
            other.map(|row| Neighbour { row, x, g })
        };
        let near: Vec<Neighbour> = points.iter().filter_map(in_plate).collect();
        let moment =
            |axis: usize| near.iter().fold(0.0, |sum, n| sum + n.g * n.x[axis] * n.x[axis]);
        let [along, across] = [0, 1].map(moment);
        // H_xx, and H_yy = l·w + m.
        let (mut h_xx, mut l, mut m) = (0.0, none.clone(), 0.0);
        for n in &near {
            h_xx += n.g * n.x[0] * n.x[0] * height(n.row) / along;
            let share = n.g * n.x[1] / across;
            l[n.row] += share;
            l[row] -= share;
            m -= 0.5 * share * n.x[0] * n.x[0];
        }
        squares.add(lambda, &l, h_xx + m);
        squares.add(2.0 * mu, &l, m);
        squares.add(2.0 * mu, &none, h_xx);
        for n in &near {
            let a = 0.5 * c * n.g;
            let mut residual = &l * -n.x[1];
            residual[n.row] += 1.0;
            residual[row] -= 1.0;
            squares.add(a, &residual, -0.5 * n.x[0] * n.x[0] - m * n.x[1]);
            squares.add(a, &none, n.x[0] * (height(n.row) - h_xx));
        }
    }
    24.0 * (1.0 - poisson * poisson) * squares.least() / (layers as f64).powi(3)
}

/// A neighbour: its row, the vector to it, and its weight F.
struct Neighbour {
    row: usize,
    x: Vector2<f64>,
    g: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_solver::kernel::{CubicSpline, WendlandC2};

    /// Compared with an independent program, which eliminates in another order.
    #[test]
    fn plates_of_few_layers_have_the_stiffness_of_an_elastic_plate_unless_they_hardly_change_their_volume()
     {
        for (layers, poisson, excess) in [
            (5, 0.4, 0.006_390),
            (10, 0.4, -0.000_463),
            (20, 0.4, -0.000_381),
            (5, 0.3, 0.003_494),
            (10, 0.45, 0.001_088),
            (10, 0.0, 0.007_609),
            (10, 0.4999, 0.403_310),
        ] {
            let found = stiffness::<WendlandC2>(1.0, layers, poisson) - 1.0;
            assert!((found - excess).abs() < 2e-6, "{layers} {poisson}: {found}");
        }
    }

    /// With many layers, for every kernel.
    #[test]
    fn a_plate_of_many_layers_has_the_stiffness_of_an_elastic_plate() {
        assert!((stiffness::<WendlandC2>(1.0, 60, 0.3) - 1.0).abs() < 1e-4);
        assert!((stiffness::<CubicSpline>(1.3, 60, 0.3) - 1.0).abs() < 2e-3);
    }
}
