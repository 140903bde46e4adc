//! Start-up Couette flow: the upper of two plates is set in motion at t = 0.
//!
//! u_t = ν u_yy,  u(0, t) = 0,  u(L, t) = V₀,  u(y, 0) = 0. With τ = νt/L² and η = y/L,
//!
//! u/V₀ = η + Σ_{n≥1} 2/(nπ) (-1)ⁿ sin(nπη) exp(-n²π²τ)  (Morris, Fox & Zhu 1997), and, as
//! an image sum, u/V₀ = Σ_{m≥0} erfc((2m+1-η)/(2√τ)) - erfc((2m+1+η)/(2√τ))
//! (after Carslaw & Jaeger, Conduction of Heat in Solids).

use super::{IMAGES_BELOW, alternating, terms_for};
use base::functions::{erfc, exp, exp_m1, sin};
use std::f64::consts::PI;

/// Two plates a distance `l` \[m\] apart in a fluid of kinematic viscosity `nu` \[m²/s\], at rest
/// until the upper one moves at `v0` \[m/s\]. `l` and `nu` must be positive.
#[derive(Clone, Copy, Debug)]
pub struct Couette {
    /// Speed of the upper plate \[m/s\].
    pub v0: f64,
    /// Distance of the plates \[m\].
    pub l: f64,
    /// Kinematic viscosity \[m²/s\].
    pub nu: f64,
}

impl Couette {
    /// νt/L².
    fn tau(&self, t: f64) -> f64 {
        self.nu * t / (self.l * self.l)
    }

    /// u(y, t) \[m/s\] for 0 ≤ y ≤ L, to about 1e-14 V₀: the images for νt/L² < 0.1, else the
    /// series. At t ≤ 0 only the plate itself moves.
    pub fn velocity(&self, y: f64, t: f64) -> f64 {
        match self.tau(t) {
            tau if tau <= 0.0 && y >= self.l => self.v0,
            tau if tau <= 0.0 => 0.0,
            tau if tau < IMAGES_BELOW => self.velocity_by_images(y, t),
            _ => self.velocity_by_series(y, t, self.terms(t)),
        }
    }

    /// The number of series terms whose tail bound is below 1e-14 V₀ at time `t` > 0 \[s\]: with
    /// m = N + 1 the first omitted index,
    ///
    /// Σ_{n≥m} 2/(nπ) exp(-n²π²τ) ≤ 2/(mπ) exp(-m²π²τ) / (1 - exp(-2mπ²τ)),
    ///
    /// because n² - m² ≥ 2m(n - m).
    pub fn terms(&self, t: f64) -> usize {
        let decay = PI * PI * self.tau(t);
        terms_for(|n| {
            let m = n + 1.0;
            2.0 / (m * PI) * exp(-m * m * decay) / -exp_m1(-2.0 * m * decay)
        })
    }

    /// The first `terms` terms of the series \[m/s\], however many the tail would need.
    pub fn velocity_by_series(&self, y: f64, t: f64, terms: usize) -> f64 {
        let (eta, decay) = (y / self.l, PI * PI * self.tau(t));
        let mut sum = 0.0;
        for n in (1..=terms).rev() {
            let m = n as f64;
            sum += alternating(n) * 2.0 / (m * PI) * sin(m * PI * eta) * exp(-m * m * decay);
        }
        self.v0 * (eta + sum)
    }

    /// The image sum \[m/s\]; t > 0. M images leave out at most Σ_{m≥M} erfc(m/√τ) ≤
    /// exp(-M²/τ) / (1 - exp(-2M/τ)).
    pub fn velocity_by_images(&self, y: f64, t: f64) -> f64 {
        let (eta, tau) = (y / self.l, self.tau(t));
        let width = 2.0 * tau.sqrt();
        let images = terms_for(|m| exp(-m * m / tau) / -exp_m1(-2.0 * m / tau));
        let mut sum = 0.0;
        for m in (0..images).rev() {
            let odd = (2 * m + 1) as f64;
            sum += erfc((odd - eta) / width) - erfc((odd + eta) / width);
        }
        self.v0 * sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    /// Case 1 of the seed: L = 1 mm, water, Re 0.5, so L²/ν = 1 s.
    const SEED: Couette = Couette { v0: 5e-4, l: 1e-3, nu: 1e-6 };
    const TIMES: [f64; 7] = [0.003, 0.02, 0.05, 0.0999, 0.1, 0.5, 1.0];

    /// Fourth-order differences, which leave about 1e-8 of u_t at these steps.
    #[test]
    fn satisfies_the_diffusion_equation() {
        let u = |y, t| SEED.velocity(y, t);
        for t in [0.02, 0.05, 0.2, 0.5] {
            for k in 2..=18 {
                let y = k as f64 * 0.05 * SEED.l;
                let (dy, dt) = (0.004 * SEED.l, 0.002 * t);
                let first = |f: &dyn Fn(f64) -> f64, d: f64| {
                    (8.0 * (f(d) - f(-d)) - (f(2.0 * d) - f(-2.0 * d))) / (12.0 * d)
                };
                let second = |f: &dyn Fn(f64) -> f64, d: f64| {
                    (16.0 * (f(d) + f(-d)) - (f(2.0 * d) + f(-2.0 * d)) - 30.0 * f(0.0))
                        / (12.0 * d * d)
                };
                let u_t = first(&|s| u(y, t + s), dt);
                let u_yy = second(&|s| u(y + s, t), dy);
                let scale = SEED.v0 * SEED.nu / (SEED.l * SEED.l) / t;
                assert_abs_diff_eq!(u_t, SEED.nu * u_yy, epsilon = 2e-6 * scale);
            }
        }
    }

    #[test]
    fn walls_move_as_prescribed() {
        for t in TIMES {
            assert_eq!(SEED.velocity(0.0, t), 0.0);
            assert_abs_diff_eq!(SEED.velocity(SEED.l, t), SEED.v0, epsilon = 2e-15 * SEED.v0);
        }
        assert_eq!((SEED.velocity(SEED.l, 0.0), SEED.velocity(0.9e-3, 0.0)), (SEED.v0, 0.0));
    }

    #[test]
    fn ends_in_the_linear_profile() {
        for k in 0..=10 {
            let y = k as f64 * 0.1 * SEED.l;
            assert_abs_diff_eq!(SEED.velocity(y, 4.0), SEED.v0 * y / SEED.l, epsilon = 1e-18);
        }
    }

    #[test]
    fn series_and_images_agree() {
        for t in [0.002, 0.01, 0.05, 0.1, 0.3, 1.0] {
            for k in 0..=40 {
                let y = k as f64 / 40.0 * SEED.l;
                let series = SEED.velocity_by_series(y, t, SEED.terms(t));
                let images = SEED.velocity_by_images(y, t);
                assert_abs_diff_eq!(series, images, epsilon = 1e-13 * SEED.v0);
            }
        }
    }

    #[test]
    fn more_terms_are_needed_early() {
        let terms = [1e-6, 1e-4, 1e-2, 1.0].map(|t| SEED.terms(t));
        assert_eq!(terms, [1677, 168, 17, 1]);
    }

    /// The tail bound is one: what n terms leave out is never larger.
    #[test]
    fn truncation_error_is_visible_and_bounded() {
        let t = 1e-3;
        let error = |n| {
            (SEED.velocity_by_series(0.93e-3, t, n) / SEED.v0) - SEED.velocity(0.93e-3, t) / SEED.v0
        };
        assert!(error(10).abs() > 1e-3, "ten terms are too few at nu t = 1e-3 L^2");
        for n in [20, 40, SEED.terms(t)] {
            let m = n as f64 + 1.0;
            let decay = PI * PI * t;
            let bound = 2.0 / (m * PI) * exp(-m * m * decay) / (1.0 - exp(-2.0 * m * decay));
            assert!(error(n).abs() <= bound + 2e-15, "{n}: {} > {bound}", error(n));
        }
    }
}
