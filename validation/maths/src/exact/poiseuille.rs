//! Start-up Poiseuille flow: a body force along a channel is switched on at t = 0.
//!
//! u_t = ν u_yy + F,  u(0, t) = u(L, t) = 0,  u(y, 0) = 0,  F = 8νV/L². With τ = νt/L², η = y/L,
//!
//! u/V = 4η(1-η) - Σ_{n≥0} 32/(π³m³) sin(mπη) exp(-m²π²τ), m = 2n+1 (Morris, Fox & Zhu 1997),
//! and, as an image sum, u/V = 8τ (1 - 4 Σ_{n≥0} (-1)ⁿ [i²erfc((n+η)/(2√τ)) +
//! i²erfc((n+1-η)/(2√τ))]) (after Carslaw & Jaeger).

use super::{IMAGES_BELOW, alternating, terms_for};
use base::functions::{erfc, exp, exp_m1, sin};
use std::f64::consts::PI;

/// A channel of width `l` \[m\] with a fluid of kinematic viscosity `nu` \[m²/s\], at rest until
/// the body force that ends in the centre-line velocity `v` \[m/s\] starts. `l` and `nu` are
/// positive.
#[derive(Clone, Copy, Debug)]
pub struct Poiseuille {
    /// Centre-line velocity for t → ∞ \[m/s\].
    pub v: f64,
    /// Width of the channel \[m\].
    pub l: f64,
    /// Kinematic viscosity \[m²/s\].
    pub nu: f64,
}

impl Poiseuille {
    /// νt/L².
    fn tau(&self, t: f64) -> f64 {
        self.nu * t / (self.l * self.l)
    }

    /// u(y, t) \[m/s\] for 0 ≤ y ≤ L, to about 1e-14 V: the images for νt/L² < 0.1, else the
    /// series. 0 for t ≤ 0.
    pub fn velocity(&self, y: f64, t: f64) -> f64 {
        match self.tau(t) {
            tau if tau <= 0.0 => 0.0,
            tau if tau < IMAGES_BELOW => self.velocity_by_images(y, t),
            _ => self.velocity_by_series(y, t, self.terms(t)),
        }
    }

    /// The number of series terms whose tail bound is below 1e-14 V at time `t` > 0 \[s\]: with
    /// m = 2N + 1 the first omitted wave number,
    ///
    /// Σ 32/(π³m³) exp(-m²π²τ) ≤ 32/(π³m³) exp(-m²π²τ) / (1 - exp(-4mπ²τ)).
    pub fn terms(&self, t: f64) -> usize {
        let decay = PI * PI * self.tau(t);
        terms_for(|n| {
            let m = 2.0 * n + 1.0;
            32.0 / (PI * m).powi(3) * exp(-m * m * decay) / -exp_m1(-4.0 * m * decay)
        })
    }

    /// The first `terms` terms of the series \[m/s\], however many the tail would need.
    pub fn velocity_by_series(&self, y: f64, t: f64, terms: usize) -> f64 {
        let (eta, decay) = (y / self.l, PI * PI * self.tau(t));
        let mut sum = 0.0;
        for n in (0..terms).rev() {
            let m = (2 * n + 1) as f64;
            sum += 32.0 / (PI * m).powi(3) * sin(m * PI * eta) * exp(-m * m * decay);
        }
        self.v * (4.0 * eta * (1.0 - eta) - sum)
    }

    /// The image sum \[m/s\]; t > 0. Its terms alternate and fall, so the first one left out bounds
    /// the tail: 16τ exp(-n²/(4τ)), because i²erfc(x) ≤ exp(-x²)/4.
    pub fn velocity_by_images(&self, y: f64, t: f64) -> f64 {
        let (eta, tau) = (y / self.l, self.tau(t));
        let width = 2.0 * tau.sqrt();
        let images = terms_for(|n| 16.0 * tau * exp(-n * n / (4.0 * tau)));
        let mut sum = 0.0;
        for n in (0..images).rev() {
            let m = n as f64;
            sum += alternating(n) * (i2erfc((m + eta) / width) + i2erfc((m + 1.0 - eta) / width));
        }
        8.0 * self.v * tau * (1.0 - 4.0 * sum)
    }
}

/// Beyond this erfc(x) < 5e-324.
const ERFC_VANISHES: f64 = 27.3;

/// i²erfc(x) = ∫ₓ^∞ ierfc = ((1 + 2x²) erfc(x) - 2x exp(-x²)/√π)/4 (Abramowitz & Stegun 7.2.5).
fn i2erfc(x: f64) -> f64 {
    if x > ERFC_VANISHES {
        return 0.0;
    }
    0.25 * ((1.0 + 2.0 * x * x) * erfc(x) - 2.0 * x * exp(-x * x) / PI.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    /// Re = VL/ν = 0.5, L²/ν = 1 s.
    const SEED: Poiseuille = Poiseuille { v: 5e-4, l: 1e-3, nu: 1e-6 };
    const FORCE: f64 = 8.0 * SEED.nu * SEED.v / (SEED.l * SEED.l);
    const TIMES: [f64; 7] = [0.003, 0.02, 0.05, 0.0999, 0.1, 0.5, 1.5];

    #[test]
    fn satisfies_the_forced_diffusion_equation() {
        let u = |y, t| SEED.velocity(y, t);
        for t in [0.02, 0.05, 0.2, 0.5] {
            for k in 2..=18 {
                let y = k as f64 * 0.05 * SEED.l;
                let (dy, dt) = (0.004 * SEED.l, 0.002 * t);
                let u_t = (8.0 * (u(y, t + dt) - u(y, t - dt))
                    - (u(y, t + 2.0 * dt) - u(y, t - 2.0 * dt)))
                    / (12.0 * dt);
                let u_yy = (16.0 * (u(y + dy, t) + u(y - dy, t))
                    - (u(y + 2.0 * dy, t) + u(y - 2.0 * dy, t))
                    - 30.0 * u(y, t))
                    / (12.0 * dy * dy);
                let residual = u_t - SEED.nu * u_yy - FORCE;
                assert_abs_diff_eq!(residual, 0.0, epsilon = 1e-6 * FORCE);
            }
        }
    }

    #[test]
    fn walls_are_at_rest() {
        for t in TIMES {
            for y in [0.0, SEED.l] {
                assert_abs_diff_eq!(SEED.velocity(y, t), 0.0, epsilon = 1e-15 * SEED.v);
            }
        }
        assert_eq!(SEED.velocity(0.5e-3, 0.0), 0.0);
    }

    #[test]
    fn ends_in_the_parabola() {
        for k in 0..=10 {
            let eta = k as f64 * 0.1;
            let (y, steady) = (eta * SEED.l, 4.0 * SEED.v * eta * (1.0 - eta));
            assert_abs_diff_eq!(SEED.velocity(y, 4.0), steady, epsilon = 1e-18);
        }
    }

    /// Away from the walls the fluid first falls freely, u = Ft, to the last bit of the images.
    #[test]
    fn begins_with_free_fall() {
        let t = 1e-5;
        let fall = FORCE * t;
        assert_abs_diff_eq!(SEED.velocity(0.5e-3, t), fall, epsilon = 1e-14 * fall);
    }

    #[test]
    fn series_and_images_agree() {
        for t in [1e-4, 0.002, 0.01, 0.05, 0.1, 0.3, 1.0] {
            for k in 0..=40 {
                let y = k as f64 / 40.0 * SEED.l;
                let series = SEED.velocity_by_series(y, t, SEED.terms(t));
                let images = SEED.velocity_by_images(y, t);
                assert_abs_diff_eq!(series, images, epsilon = 1e-13 * SEED.v);
            }
        }
    }

    #[test]
    fn more_terms_are_needed_early() {
        let terms = [1e-6, 1e-4, 1e-2, 1.0].map(|t| SEED.terms(t));
        assert!(terms.windows(2).all(|w| w[0] > w[1]), "{terms:?}");
        let coarse = SEED.velocity_by_series(0.5e-3, 1e-3, 2) - SEED.velocity(0.5e-3, 1e-3);
        assert!(coarse.abs() > 1e-3 * SEED.v, "two terms must show");
    }
}
