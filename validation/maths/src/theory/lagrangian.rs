//! Waves of the total Lagrangian solid on a square lattice without stress.
//!
//! With the symbol q = g/G₁ of the corrected gradient and the symbol s = λ₀/2 of the sum Σ V F (1 − cos k·X),
//! the displacement u satisfies ρ ω² u = (K + μ/3) q (q·u) + μ q² u + c (s − G₁ q²/2) u, where c = 8/3 χ μ/G₁
//! is the hourglass modulus (documentation of `touchstone_solver::lagrangian`). Longitudinal waves are the
//! fastest of a lattice without faces; the leapfrog is stable up to dt = 2/ω.
//!
//! At faces and corners particles have fewer neighbours, and M⁻¹ is larger: a body has faster modes there
//! than any wave inside, at a corner by a factor of 1.4 with Poisson's ratio 0.4 and of 1.8 with 0.4999.
//! [`fastest_of_block`] finds them by power iteration.

use nalgebra::{Matrix2, Vector2};
use touchstone_base::functions::sin;
use touchstone_solver::lagrangian::{Moduli, body::hourglass};
use touchstone_solver::{
    inverse::{Inverse, of_two},
    kernel::{Kernel, Smoothing},
};

use super::lattice::SquareLattice;

/// χ, the strength of the resistance to hourglass modes, which deform no particle. With 1 the error of long
/// shear waves is of fourth order, but plates of few layers are too soft, because the gradient at a face is
/// the gradient a little inside. With 4/3 the two errors nearly cancel: with a Poisson ratio of 0.4 the error
/// of the stiffness in bending is +0.6, -0.05 and -0.04 % with 5, 10 and 20 layers (χ = 1: -3.4, -1.15 and
/// -0.32 %), see [`bending`](super::bending), and shear waves have a third of their error without the
/// resistance.
pub const HOURGLASS: f64 = 4.0 / 3.0;

/// Neighbours of a particle of the block: index, vector, and weight F.
type Neighbours = Vec<(usize, Vector2<f64>, f64)>;

/// A square block of a lattice of spacing 1 without stress, all of whose faces are free.
struct LatticeBlock {
    neighbours: Vec<Neighbours>,
    /// M⁻¹.
    inverse: Vec<Matrix2<f64>>,
    /// λ.
    lambda: f64,
    /// μ.
    mu: f64,
    /// The hourglass modulus c.
    c: f64,
}

impl LatticeBlock {
    fn new<K: Kernel>(h_over_dx: f64, side: usize, moduli: &Moduli) -> Self {
        let kernel = Smoothing::<K>::new(h_over_dx);
        let place = |k: usize| Vector2::new((k % side) as f64, (k / side) as f64);
        let near = |k: usize| -> Neighbours {
            let to = |other: usize| (other, place(other) - place(k));
            let others = (0..side * side).filter(|other| *other != k).map(to);
            let weighted = others.map(|(other, x)| (other, x, kernel.f(x.norm_squared())));
            weighted.filter(|(_, _, g)| *g > 0.0).collect()
        };
        let neighbours: Vec<Neighbours> = (0..side * side).map(near).collect();
        let moments = |near: &Neighbours| {
            near.iter().fold(Matrix2::zeros(), |sum, (_, x, g)| sum + x * x.transpose() * *g)
        };
        let inverse = |near: &Neighbours| {
            let Inverse { determinant, matrix } = of_two(&moments(near));
            if determinant == 0.0 { Matrix2::zeros() } else { matrix }
        };
        let inverse = neighbours.iter().map(inverse);
        let factor = SquareLattice::of::<K>(h_over_dx, 0.0).gradient_factor();
        let (mu, c) = (moduli.shear, hourglass(moduli.shear, HOURGLASS, factor));
        let lambda = moduli.longitudinal() - 2.0 * mu;
        Self { inverse: inverse.collect(), neighbours, lambda, mu, c }
    }

    /// Forces against small displacements.
    fn resist(&self, u: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
        let Self { lambda, mu, c, .. } = *self;
        let tensor = |(k, near): (usize, &Neighbours)| {
            let sum = near.iter().fold(Matrix2::zeros(), |sum, (other, x, g)| {
                sum + (u[*other] - u[k]) * x.transpose() * *g
            });
            let h = sum * self.inverse[k];
            let spread = Matrix2::identity() * (lambda * h.trace());
            (spread + (h + h.transpose()) * mu) * self.inverse[k] - h * (0.5 * c)
        };
        let tensors: Vec<_> = self.neighbours.iter().enumerate().map(tensor).collect();
        let force = |(k, near): (usize, &Neighbours)| {
            near.iter().fold(Vector2::zeros(), |sum, (other, x, g)| {
                sum - ((tensors[k] + tensors[*other]) * x + (u[*other] - u[k]) * c) * *g
            })
        };
        self.neighbours.iter().enumerate().map(force).collect()
    }
}

/// ρ ω² dx² of the fastest mode of a block with free faces and corners \[Pa\].
pub fn fastest_of_block<K: Kernel>(h_over_dx: f64, moduli: &Moduli) -> f64 {
    // Corners three supports apart do not affect each other.
    let side = 3 * (K::SUPPORT * h_over_dx).ceil() as usize + 2;
    let block = LatticeBlock::new::<K>(h_over_dx, side, moduli);
    let mixed = |k: usize| sin(12.9898 * k as f64 + 1.0);
    let mut u: Vec<_> =
        (0..side * side).map(|k| Vector2::new(mixed(2 * k), mixed(2 * k + 1))).collect();
    let mut found = 0.0;
    for _ in 0..MOST_ITERATIONS {
        let forces = block.resist(&u);
        let product = |a: &[Vector2<f64>], b: &[Vector2<f64>]| {
            a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a.dot(b))
        };
        let (before, size) = (found, product(&u, &u));
        found = product(&u, &forces) / size;
        if (found - before).abs() < CONVERGED * found {
            break;
        }
        let norm = product(&forces, &forces).sqrt();
        u = forces.into_iter().map(|force| force / norm).collect();
    }
    found
}

/// Relative change of an eigenvalue from one iteration to the next at which it is taken, and the iterations
/// after which it is in any case.
const CONVERGED: f64 = 1e-7;
const MOST_ITERATIONS: usize = 1000;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theory::lattice::wave_vectors;
    use approx::assert_relative_eq;
    use touchstone_solver::kernel::WendlandC2;

    const H_OVER_DX: f64 = 1.0;

    /// ρ ω² dx² of the wave with these phases θ = k dx \[rad\] whose displacement is along q, or across it,
    /// for which `modulus` is K + 4μ/3 or μ \[Pa\].
    fn stiffness(lattice: &SquareLattice, theta: Vector2<f64>, modulus: f64, shear: f64) -> f64 {
        let (factor, h) = (lattice.gradient_factor(), H_OVER_DX);
        let q2 = lattice.gradient(theta).norm_squared() / (factor * h).powi(2);
        let rest = 0.5 * (lattice.diffusion(theta) / (h * h) - factor * q2);
        modulus * q2 + hourglass(shear, HOURGLASS, factor) * rest
    }

    /// Long waves have the moduli, and shear waves along the axes a third of the error of the gradient, with
    /// the opposite sign, where longitudinal waves of a material without shear have all of it.
    #[test]
    fn long_waves_have_the_moduli_and_shear_waves_a_small_error() {
        let lattice = SquareLattice::of::<WendlandC2>(H_OVER_DX, 0.0);
        let error = |k: f64, modulus: f64| {
            stiffness(&lattice, Vector2::new(k, 0.0), modulus, 0.22) / (modulus * k * k) - 1.0
        };
        assert!(error(0.01, 1.3).abs() < 1e-4);
        let plain = |k: f64| stiffness(&lattice, Vector2::new(k, 0.0), 1.0, 0.0) / (k * k) - 1.0;
        assert_relative_eq!(error(0.1, 0.22) / plain(0.1), 1.0 - HOURGLASS, max_relative = 0.02);
        assert_relative_eq!(error(0.2, 1.3) / error(0.1, 1.3), 4.0, max_relative = 0.02);
    }

    /// From an independent program after 1,500 iterations, over K + 4μ/3; its last digits still grow, as the
    /// modes of four corners differ little. A step that waves of the lattice allow made plates diverge within
    /// ten steps.
    #[test]
    fn corners_have_faster_modes_than_any_wave_of_the_lattice() {
        for (poisson, corner, wave) in [(0.3975, 3.62423, 1.77960), (0.4999, 3.88723, 1.15767)] {
            let shear = (1.0 - 2.0 * poisson) / (2.0 - 2.0 * poisson);
            let moduli = Moduli { bulk: 1.0 - 4.0 / 3.0 * shear, shear };
            let found = fastest_of_block::<WendlandC2>(H_OVER_DX, &moduli);
            assert_relative_eq!(found, corner, max_relative = 1e-4);
            let lattice = SquareLattice::of::<WendlandC2>(H_OVER_DX, 0.0);
            let of = |theta| stiffness(&lattice, theta, 1.0, shear);
            let fastest = wave_vectors(24).map(of).fold(0.0, f64::max);
            assert_relative_eq!(fastest, wave, max_relative = 1e-4);
        }
    }
}
