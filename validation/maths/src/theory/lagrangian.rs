//! Waves of the total Lagrangian solid on a square lattice without stress.
//!
//! With q = g/G₁ the symbol of the corrected gradient and s = λ₀/2 that of the sum Σ V F (1 − cos k·X), the
//! displacement u obeys ρ ω² u = (K + μ/3) q (q·u) + μ q² u + c (s − G₁ q²/2) u, where c = 8/3 χ μ/G₁ is the
//! modulus against modes that deform no particle (page of the crate `lagrangian`). Longitudinal waves are
//! the fastest; the leapfrog is stable up to dt = 2/ω.

use nalgebra::Vector2;
use solver::kernel::Kernel;

use super::lattice::{SquareLattice, wave_vectors};

/// χ, the strength of what resists modes that deform no particle. With 1 the error of long shear waves is of
/// fourth order, but plates of few layers are too soft, because a face takes its strain from a little inside.
/// With 4/3 the two nearly cancel: with a Poisson ratio of 0.4 the stiffness in bending is wrong by +0.6, -0.05
/// and -0.04 % with 5, 10 and 20 layers (χ = 1: -3.4, -1.1 and -0.3 %), see [`bending`](super::bending), and
/// shear waves keep a third of the error that they have without it.
pub const HOURGLASS: f64 = 4.0 / 3.0;

/// ρ ω² dx² of the wave with these phases θ = k dx \[rad\] whose displacement is along q, or across it, for
/// which `modulus` is K + 4μ/3 or μ \[Pa\].
pub fn stiffness<K: Kernel>(
    lattice: &SquareLattice<K>,
    theta: Vector2<f64>,
    modulus: f64,
    shear: f64,
) -> f64 {
    let (factor, h) = (lattice.gradient_factor(), lattice.h_over_dx());
    let q2 = lattice.gradient(theta).norm_squared() / (factor * h).powi(2);
    let rest = 0.5 * (lattice.diffusion(theta) / (h * h) - factor * q2);
    modulus * q2 + 8.0 / 3.0 * HOURGLASS * shear / factor * rest
}

/// ρ ω² dx² of the fastest wave of a periodic box of `n` × `n` particles \[Pa\].
pub fn stiffest<K: Kernel>(
    lattice: &SquareLattice<K>,
    n: usize,
    [longitudinal, shear]: [f64; 2],
) -> f64 {
    let of = |theta| stiffness(lattice, theta, longitudinal, shear);
    wave_vectors(n).map(of).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use solver::kernel::WendlandC2;

    /// Long waves have the moduli, and shear waves along the axes a third of the error of the gradient, with
    /// the opposite sign, where longitudinal waves of a material without shear have all of it.
    #[test]
    fn long_waves_have_the_moduli_and_shear_waves_a_small_error() {
        let lattice = SquareLattice::<WendlandC2>::new(1.0, 0.0);
        let error = |k: f64, modulus: f64| {
            stiffness(&lattice, Vector2::new(k, 0.0), modulus, 0.22) / (modulus * k * k) - 1.0
        };
        assert!(error(0.01, 1.3).abs() < 1e-4);
        let plain = |k: f64| stiffness(&lattice, Vector2::new(k, 0.0), 1.0, 0.0) / (k * k) - 1.0;
        assert_relative_eq!(error(0.1, 0.22) / plain(0.1), 1.0 - HOURGLASS, max_relative = 0.02);
        assert_relative_eq!(error(0.2, 1.3) / error(0.1, 1.3), 4.0, max_relative = 0.02);
    }
}
