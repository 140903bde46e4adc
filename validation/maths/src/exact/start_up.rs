//! Flow between two plates from rest, set in motion at t = 0. With τ = νt/L² and η = y/L:
//!
//! - Couette flow, where the upper plate moves at V: u_t = ν u_yy, u(0, t) = 0, u(L, t) = V, u(y, 0) = 0.
//!   u/V = η + Σ_{n≥1} 2/(nπ) (-1)ⁿ sin(nπη) exp(-n²π²τ)  (Morris, Fox & Zhu 1997), and, as an image sum,
//!   u/V = Σ_{m≥0} erfc((2m+1-η)/(2√τ)) - erfc((2m+1+η)/(2√τ))  (after Carslaw & Jaeger, Conduction of
//!   Heat in Solids).
//! - Poiseuille flow, along which a body force acts: u_t = ν u_yy + F, u(0, t) = u(L, t) = 0, u(y, 0) = 0,
//!   F = 8νV/L². u/V = 4η(1-η) - Σ_{n≥0} 32/(π³m³) sin(mπη) exp(-m²π²τ), m = 2n+1, and, as an image sum,
//!   u/V = 8τ (1 - 4 Σ_{n≥0} (-1)ⁿ [i²erfc((n+η)/(2√τ)) + i²erfc((n+1-η)/(2√τ))]).

use std::f64::consts::PI;
use touchstone_base::functions::{erfc, exp, exp_m1, sin};

/// A series is summed until the rigorous bound on its tail, relative to the velocity scale, is
/// below this.
const TAIL: f64 = 1e-14;

/// νt/L² below which the images converge faster than the series. At 0.1 both need fewer than seven
/// terms for [`TAIL`].
const IMAGES_BELOW: f64 = 0.1;

/// The smallest number of terms n ≥ 1 with `tail(n)` < [`TAIL`], where `tail` bounds the remainder after n
/// terms and falls with n.
fn terms_for(tail: impl Fn(f64) -> f64) -> usize {
    (1..).find(|n| tail(*n as f64) < TAIL).unwrap_or(1)
}

/// (-1)ⁿ.
fn alternating(n: usize) -> f64 {
    if n.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// Two plates a distance `l` \[m\] apart and a fluid of kinematic viscosity `nu` \[m²/s\] between them, both
/// positive.
#[derive(Clone, Copy, Debug)]
pub struct StartUp {
    /// Speed of the upper plate, or velocity at half the height for t → ∞ under a body force \[m/s\].
    pub v: f64,
    /// Distance of the plates \[m\].
    pub l: f64,
    /// Kinematic viscosity \[m²/s\].
    pub nu: f64,
}

impl StartUp {
    /// νt/L².
    fn tau(&self, t: f64) -> f64 {
        self.nu * t / (self.l * self.l)
    }

    /// u(y, t) of Couette flow \[m/s\] for 0 ≤ y ≤ L, to about 1e-14 V: the images for νt/L² < 0.1, else the
    /// series. At t ≤ 0 only the plate itself moves.
    pub fn couette(&self, y: f64, t: f64) -> f64 {
        match self.tau(t) {
            tau if tau <= 0.0 && y >= self.l => self.v,
            tau if tau <= 0.0 => 0.0,
            tau if tau < IMAGES_BELOW => self.couette_by_images(y, t),
            _ => self.couette_by_series(y, t, self.terms_of_couette(t)),
        }
    }

    /// The number of terms of its series whose tail bound is below 1e-14 V at time `t` > 0 \[s\]: with
    /// m = N + 1 the first omitted index,
    ///
    /// Σ_{n≥m} 2/(nπ) exp(-n²π²τ) ≤ 2/(mπ) exp(-m²π²τ) / (1 - exp(-2mπ²τ)),
    ///
    /// because n² - m² ≥ 2m(n - m).
    pub fn terms_of_couette(&self, t: f64) -> usize {
        let decay = PI * PI * self.tau(t);
        terms_for(|n| {
            let m = n + 1.0;
            2.0 / (m * PI) * exp(-m * m * decay) / -exp_m1(-2.0 * m * decay)
        })
    }

    /// The first `terms` terms of the series \[m/s\], however many the tail would need.
    pub fn couette_by_series(&self, y: f64, t: f64, terms: usize) -> f64 {
        let (eta, decay) = (y / self.l, PI * PI * self.tau(t));
        let mut sum = 0.0;
        for n in (1..=terms).rev() {
            let m = n as f64;
            sum += alternating(n) * 2.0 / (m * PI) * sin(m * PI * eta) * exp(-m * m * decay);
        }
        self.v * (eta + sum)
    }

    /// The image sum \[m/s\]; t > 0. M images leave out at most Σ_{m≥M} erfc(m/√τ) ≤
    /// exp(-M²/τ) / (1 - exp(-2M/τ)).
    pub fn couette_by_images(&self, y: f64, t: f64) -> f64 {
        let (eta, tau) = (y / self.l, self.tau(t));
        let width = 2.0 * tau.sqrt();
        let images = terms_for(|m| exp(-m * m / tau) / -exp_m1(-2.0 * m / tau));
        let mut sum = 0.0;
        for m in (0..images).rev() {
            let odd = (2 * m + 1) as f64;
            sum += erfc((odd - eta) / width) - erfc((odd + eta) / width);
        }
        self.v * sum
    }

    /// u(y, t) of Poiseuille flow \[m/s\] for 0 ≤ y ≤ L, to about 1e-14 V: the images for νt/L² < 0.1, else
    /// the series. 0 for t ≤ 0.
    pub fn poiseuille(&self, y: f64, t: f64) -> f64 {
        match self.tau(t) {
            tau if tau <= 0.0 => 0.0,
            tau if tau < IMAGES_BELOW => self.poiseuille_by_images(y, t),
            _ => self.poiseuille_by_series(y, t, self.terms_of_poiseuille(t)),
        }
    }

    /// The number of terms of its series whose tail bound is below 1e-14 V at time `t` > 0 \[s\]: with
    /// m = 2N + 1 the first omitted wave number,
    ///
    /// Σ 32/(π³m³) exp(-m²π²τ) ≤ 32/(π³m³) exp(-m²π²τ) / (1 - exp(-4mπ²τ)).
    pub fn terms_of_poiseuille(&self, t: f64) -> usize {
        let decay = PI * PI * self.tau(t);
        terms_for(|n| {
            let m = 2.0 * n + 1.0;
            32.0 / (PI * m).powi(3) * exp(-m * m * decay) / -exp_m1(-4.0 * m * decay)
        })
    }

    /// The first `terms` terms of the series \[m/s\], however many the tail would need.
    pub fn poiseuille_by_series(&self, y: f64, t: f64, terms: usize) -> f64 {
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
    pub fn poiseuille_by_images(&self, y: f64, t: f64) -> f64 {
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

    /// Case 1 of the seed: L = 1 mm, water, Re 0.5, so L²/ν = 1 s.
    const SEED: StartUp = StartUp { v: 5e-4, l: 1e-3, nu: 1e-6 };

    mod couette {
        use super::*;

        const TIMES: [f64; 7] = [0.003, 0.02, 0.05, 0.0999, 0.1, 0.5, 1.0];

        /// Fourth-order differences, which leave about 1e-8 of u_t at these steps.
        #[test]
        fn satisfies_the_diffusion_equation() {
            let u = |y, t| SEED.couette(y, t);
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
                    let scale = SEED.v * SEED.nu / (SEED.l * SEED.l) / t;
                    assert_abs_diff_eq!(u_t, SEED.nu * u_yy, epsilon = 2e-6 * scale);
                }
            }
        }

        #[test]
        fn walls_move_as_prescribed() {
            for t in TIMES {
                assert_eq!(SEED.couette(0.0, t), 0.0);
                assert_abs_diff_eq!(SEED.couette(SEED.l, t), SEED.v, epsilon = 2e-15 * SEED.v);
            }
            assert_eq!((SEED.couette(SEED.l, 0.0), SEED.couette(0.9e-3, 0.0)), (SEED.v, 0.0));
        }

        #[test]
        fn ends_in_the_linear_profile() {
            for k in 0..=10 {
                let y = k as f64 * 0.1 * SEED.l;
                assert_abs_diff_eq!(SEED.couette(y, 4.0), SEED.v * y / SEED.l, epsilon = 1e-18);
            }
        }

        #[test]
        fn series_and_images_agree() {
            for t in [0.002, 0.01, 0.05, 0.1, 0.3, 1.0] {
                for k in 0..=40 {
                    let y = k as f64 / 40.0 * SEED.l;
                    let series = SEED.couette_by_series(y, t, SEED.terms_of_couette(t));
                    let images = SEED.couette_by_images(y, t);
                    assert_abs_diff_eq!(series, images, epsilon = 1e-13 * SEED.v);
                }
            }
        }

        #[test]
        fn more_terms_are_needed_early() {
            let terms = [1e-6, 1e-4, 1e-2, 1.0].map(|t| SEED.terms_of_couette(t));
            assert_eq!(terms, [1677, 168, 17, 1]);
        }

        /// The remainder after n terms never exceeds the bound of the tail.
        #[test]
        fn truncation_error_is_visible_and_bounded() {
            let t = 1e-3;
            let error = |n| {
                (SEED.couette_by_series(0.93e-3, t, n) / SEED.v) - SEED.couette(0.93e-3, t) / SEED.v
            };
            assert!(error(10).abs() > 1e-3, "ten terms are too few at nu t = 1e-3 L^2");
            for n in [20, 40, SEED.terms_of_couette(t)] {
                let m = n as f64 + 1.0;
                let decay = PI * PI * t;
                let bound = 2.0 / (m * PI) * exp(-m * m * decay) / (1.0 - exp(-2.0 * m * decay));
                assert!(error(n).abs() <= bound + 2e-15, "{n}: {} > {bound}", error(n));
            }
        }
    }

    mod poiseuille {
        use super::*;

        const FORCE: f64 = 8.0 * SEED.nu * SEED.v / (SEED.l * SEED.l);
        const TIMES: [f64; 7] = [0.003, 0.02, 0.05, 0.0999, 0.1, 0.5, 1.5];

        #[test]
        fn satisfies_the_forced_diffusion_equation() {
            let u = |y, t| SEED.poiseuille(y, t);
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
                    assert_abs_diff_eq!(SEED.poiseuille(y, t), 0.0, epsilon = 1e-15 * SEED.v);
                }
            }
            assert_eq!(SEED.poiseuille(0.5e-3, 0.0), 0.0);
        }

        #[test]
        fn ends_in_the_parabola() {
            for k in 0..=10 {
                let eta = k as f64 * 0.1;
                let (y, steady) = (eta * SEED.l, 4.0 * SEED.v * eta * (1.0 - eta));
                assert_abs_diff_eq!(SEED.poiseuille(y, 4.0), steady, epsilon = 1e-18);
            }
        }

        /// Away from the walls the fluid first falls freely, u = Ft, to the last bit of the images.
        #[test]
        fn begins_with_free_fall() {
            let t = 1e-5;
            let fall = FORCE * t;
            assert_abs_diff_eq!(SEED.poiseuille(0.5e-3, t), fall, epsilon = 1e-14 * fall);
        }

        #[test]
        fn series_and_images_agree() {
            for t in [1e-4, 0.002, 0.01, 0.05, 0.1, 0.3, 1.0] {
                for k in 0..=40 {
                    let y = k as f64 / 40.0 * SEED.l;
                    let series = SEED.poiseuille_by_series(y, t, SEED.terms_of_poiseuille(t));
                    let images = SEED.poiseuille_by_images(y, t);
                    assert_abs_diff_eq!(series, images, epsilon = 1e-13 * SEED.v);
                }
            }
        }

        #[test]
        fn more_terms_are_needed_early() {
            let terms = [1e-6, 1e-4, 1e-2, 1.0].map(|t| SEED.terms_of_poiseuille(t));
            assert!(terms.windows(2).all(|w| w[0] > w[1]), "{terms:?}");
            let coarse = SEED.poiseuille_by_series(0.5e-3, 1e-3, 2) - SEED.poiseuille(0.5e-3, 1e-3);
            assert!(coarse.abs() > 1e-3 * SEED.v, "two terms must show");
        }
    }
}
