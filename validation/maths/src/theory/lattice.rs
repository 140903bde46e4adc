//! Symbols of the SPH sums on an infinite square lattice: the error floor of everything laminar.
//!
//! With V = dx², F = -W'/r, r = (x, y) over the lattice points and θ = k dx the phase of a wave
//! from one particle to the next:
//!
//! - G₁ = Σ V F x², the factor of every gradient, 1 in the continuum;
//! - L₁ = Σ V F y² r²/(r²+η²), the factor of Morris' Laplacian (6), so ν_eff = ν L₁;
//! - g(k) = Σ V F r sin(k·r) for gradient and divergence, λ(k) = Σ 2 V F r²/(r²+η²) (1 - cos k·r)
//!   for Morris viscosity, P(k) = Σ V F r rᵀ/(r²+η²) (1 - cos k·r) for the artificial viscosity in
//!   its always-on form, dv/dt = -α c h P v, and λ₀ = λ at η = 0 for the density diffusion of
//!   Molteni & Colagrossi, dρ/dt = -δ h c λ₀ ρ.
//!
//! All numbers are dimensionless: in units of the spacing inside, of h at the surface.

use nalgebra::{Matrix2, Vector2};
use std::{f64::consts::PI, iter::Sum};
use touchstone_base::functions::sin;
use touchstone_solver::kernel::{Kernel, Smoothing};

/// A lattice point other than the origin, in units of dx.
struct Site {
    r: Vector2<f64>,
    /// V F \[1/dx²\].
    vf: f64,
    /// r²/(r²+η²), 1 at η = 0.
    guard: f64,
}

/// The points of a square lattice of spacing 1 in reach of the origin, without it, row by row, each with V F
/// \[1/dx²\].
pub fn near<K: Kernel>(h_over_dx: f64) -> Vec<(Vector2<f64>, f64)> {
    let kernel = Smoothing::<K>::new(h_over_dx);
    let reach = kernel.support().ceil() as i32;
    let row = |y: i32| (-reach..=reach).map(move |x| Vector2::new(f64::from(x), f64::from(y)));
    let weighted = (-reach..=reach).flat_map(row).map(|r| (r, kernel.f(r.norm_squared())));
    weighted.filter(|(r, vf)| *vf > 0.0 && *r != Vector2::zeros()).collect()
}

/// Symbols of a square lattice with a kernel.
pub struct SquareLattice {
    /// h/dx.
    h: f64,
    /// Factor of gradients: 1, or 1/G₁.
    correction: f64,
    sites: Vec<Site>,
}

impl SquareLattice {
    /// The lattice with kernel `K`, smoothing length `h_over_dx` \[dx\] and η² = `eta2_over_h2` \[h²\]; both
    /// must be finite, the first positive, the second not negative.
    pub fn of<K: Kernel>(h_over_dx: f64, eta2_over_h2: f64) -> Self {
        let eta2 = eta2_over_h2 * h_over_dx * h_over_dx;
        let site = |(r, vf): (Vector2<f64>, f64)| {
            let r2 = r.norm_squared();
            Site { r, vf, guard: r2 / (r2 + eta2) }
        };
        let sites = near::<K>(h_over_dx).into_iter().map(site).collect();
        Self { h: h_over_dx, correction: 1.0, sites }
    }

    /// This lattice with gradients, and their conjugate forces, corrected by the inverse of the moments, on a
    /// lattice 1/G₁ times the unit matrix.
    #[must_use]
    pub fn corrected(self) -> Self {
        Self { correction: 1.0 / self.gradient_factor(), ..self }
    }

    /// The number of neighbours, without the particle itself.
    pub fn neighbours(&self) -> usize {
        self.sites.len()
    }

    fn sum<T: Sum>(&self, term: impl Fn(&Site) -> T) -> T {
        self.sites.iter().map(term).sum()
    }

    /// G₁ = Σ V F x²; 1 of corrected gradients.
    pub fn gradient_factor(&self) -> f64 {
        self.sum(|s| s.vf * s.r.x * s.r.x) * self.correction
    }

    /// g(k) h at phase θ = k dx \[rad\].
    pub fn gradient(&self, theta: Vector2<f64>) -> Vector2<f64> {
        let sum: Vector2<f64> = self.sum(|s| s.r * (s.vf * sin(theta.dot(&s.r))));
        sum * (self.h * self.correction)
    }

    /// λ(k) h² at phase θ = k dx \[rad\].
    pub fn laplacian(&self, theta: Vector2<f64>) -> f64 {
        self.sum(|s| 2.0 * s.vf * s.guard * one_minus_cos(theta.dot(&s.r))) * self.h * self.h
    }

    /// λ₀(k) h², the Laplacian without η, at phase θ = k dx \[rad\].
    pub fn diffusion(&self, theta: Vector2<f64>) -> f64 {
        self.sum(|s| 2.0 * s.vf * one_minus_cos(theta.dot(&s.r))) * self.h * self.h
    }

    /// P(k) h² at phase θ = k dx \[rad\]; symmetric, positive semi-definite.
    pub fn artificial(&self, theta: Vector2<f64>) -> Matrix2<f64> {
        let sum: Matrix2<f64> = self.sum(|s| {
            let factor = s.vf * s.guard / s.r.norm_squared() * one_minus_cos(theta.dot(&s.r));
            s.r * s.r.transpose() * factor
        });
        sum * (self.h * self.h)
    }

    /// The largest λ₀(k) h² of all waves: for a wave with phase 0 or π along each axis.
    pub fn stiffest(&self) -> f64 {
        let along_y = Vector2::new(0.0, PI);
        self.diffusion(along_y).max(self.diffusion(Vector2::repeat(PI)))
    }
}

/// 1 - cos a = 2 sin²(a/2), without cancellation for long waves.
fn one_minus_cos(a: f64) -> f64 {
    let half = sin(0.5 * a);
    2.0 * half * half
}

/// The phases θ = 2π (i, j)/n of a periodic box of `n` × `n` particles with 0 ≤ j ≤ i ≤ n/2,
/// without 0: the square's symmetry makes the others equal to one of these.
pub fn wave_vectors(n: usize) -> impl Iterator<Item = Vector2<f64>> {
    let phase = move |i: usize| 2.0 * PI * i as f64 / n as f64;
    (1..=n / 2).flat_map(move |i| (0..=i).map(move |j| Vector2::new(phase(i), phase(j))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theory::tests::assert_rounds_to;
    use approx::assert_relative_eq;
    use touchstone_solver::kernel::{CubicSpline, QuinticSpline, WendlandC2};

    /// The largest values of the symbols over a set of wave vectors, made dimensionless with h.
    struct Maxima {
        /// |g| h.
        gradient: f64,
        /// λ h².
        laplacian: f64,
        /// The larger eigenvalue of P h².
        artificial: f64,
        /// λ₀ h².
        diffusion: f64,
    }

    /// The largest symbols among the wave vectors of a periodic box of `n` × `n` particles. The
    /// maximum over the whole Brillouin zone is the limit of large n; 120 gives four digits.
    fn maxima(of: &SquareLattice, n: usize) -> Maxima {
        let zero = Maxima { gradient: 0.0, laplacian: 0.0, artificial: 0.0, diffusion: 0.0 };
        wave_vectors(n).fold(zero, |max, theta| Maxima {
            gradient: max.gradient.max(of.gradient(theta).norm()),
            laplacian: max.laplacian.max(of.laplacian(theta)),
            artificial: max.artificial.max(of.artificial(theta).symmetric_eigenvalues().max()),
            diffusion: max.diffusion.max(of.diffusion(theta)),
        })
    }

    /// Table 2.1 of the design notes: |g|h, λh² at η² = 0.01 h² and 0, P h² at η² = 0.01 h².
    #[test]
    fn maxima_match_the_design_table() {
        fn check<K: Kernel>(ratio: f64, printed: [&str; 4]) {
            let guarded = maxima(&SquareLattice::of::<K>(ratio, 0.01), 120);
            let bare = maxima(&SquareLattice::of::<K>(ratio, 0.0), 120);
            let computed =
                [guarded.gradient, guarded.laplacian, bare.laplacian, guarded.artificial];
            assert_rounds_to(&format!("{} {ratio}", K::NAME), &printed, &computed);
            assert_eq!(bare.laplacian, guarded.diffusion);
        }
        check::<CubicSpline>(1.2, ["1.071", "5.68", "5.76", "1.94"]);
        check::<CubicSpline>(1.3, ["1.071", "5.67", "5.76", "1.97"]);
        check::<CubicSpline>(1.5, ["1.075", "5.60", "5.69", "1.93"]);
        check::<QuinticSpline>(1.0, ["0.865", "3.81", "3.84", "1.30"]);
        check::<WendlandC2>(1.5, ["1.127", "6.39", "6.52", "2.19"]);
        check::<WendlandC2>(2.0, ["1.136", "6.61", "6.81", "2.09"]);
    }

    /// Long waves have no error of the factor, and every wave has its share of it less.
    #[test]
    fn corrected_gradients_have_the_factor_one() {
        let plain = SquareLattice::of::<CubicSpline>(1.5, 0.01);
        let corrected = SquareLattice::of::<CubicSpline>(1.5, 0.01).corrected();
        assert_relative_eq!(corrected.gradient_factor(), 1.0, max_relative = 1e-15);
        let ratio = maxima(&plain, 24).gradient / maxima(&corrected, 24).gradient;
        assert_relative_eq!(ratio, plain.gradient_factor(), max_relative = 1e-14);
        assert_eq!(maxima(&plain, 24).artificial, maxima(&corrected, 24).artificial);
    }

    #[test]
    fn the_stiffest_wave_has_opposite_velocities_side_by_side() {
        fn check<K: Kernel>(ratios: &[f64]) {
            for ratio in ratios {
                let lattice = SquareLattice::of::<K>(*ratio, 0.0);
                let share = lattice.stiffest() / maxima(&lattice, 120).diffusion;
                assert!((0.97..=1.0 + 1e-12).contains(&share), "{} {ratio}: {share}", K::NAME);
            }
        }
        check::<CubicSpline>(&[1.2, 1.3, 1.5]);
        check::<QuinticSpline>(&[0.9, 1.0, 1.2]);
        check::<WendlandC2>(&[1.5, 2.0]);
    }

    #[test]
    fn a_box_has_few_wave_vectors() {
        assert_eq!(wave_vectors(20).count(), 65);
        assert!(wave_vectors(20).all(|k| k.norm() > 0.0 && k.amax() <= PI));
    }
}
