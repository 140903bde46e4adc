//! One Fourier mode of a resting fluid: the damped oscillator behind a sound wave or a shear wave.
//!
//! p' = -ω v,  v' = ω p - γ v, with p the density or pressure amplitude (scaled so that both
//! coefficients are ω) and v the velocity amplitude along the wave vector. For the continuous
//! equations ω = c₀k and γ = νk² (Morris viscosity acts as ν∇²v); for particles on a lattice both
//! are the symbols of [`crate::theory::lattice`]. A shear wave has ω = 0 and decays as exp(-γt).

use base::functions::{cos, exp, sin};

/// Angular frequency and damping of a mode.
#[derive(Clone, Copy, Debug)]
pub struct DampedMode {
    /// Undamped angular frequency ω ≥ 0 \[1/s\].
    pub omega: f64,
    /// Damping of the velocity γ ≥ 0 \[1/s\].
    pub gamma: f64,
}

impl DampedMode {
    /// (p, v) at time `t` \[s\] from (p₀, v₀), in the units of the initial amplitudes. Under-,
    /// over- and critically damped: exp(-γt/2) \[C + (γ/2) S\] p₀ and so on with C = cos σt and S =
    /// sin(σt)/σ, σ² = ω² - γ²/4, or their hyperbolic forms.
    pub fn state(&self, [p, v]: [f64; 2], t: f64) -> [f64; 2] {
        let half = 0.5 * self.gamma;
        let square = self.omega * self.omega - half * half;
        let sigma = square.abs().sqrt();
        // exp(-γt/2) goes into both, for cosh alone overflows when a mode is strongly damped.
        let (c, s) = if sigma * t < 1e-8 {
            let decay = exp(-half * t);
            (decay, decay * t)
        } else if square > 0.0 {
            let decay = exp(-half * t);
            (decay * cos(sigma * t), decay * sin(sigma * t) / sigma)
        } else {
            let (slow, fast) = (exp((sigma - half) * t), exp((-sigma - half) * t));
            (0.5 * (slow + fast), 0.5 * (slow - fast) / sigma)
        };
        [p * c + (half * p - self.omega * v) * s, v * c + (self.omega * p - half * v) * s]
    }

    /// The frequency that is seen, (ω² - γ²/4)^(1/2) \[1/s\]; 0 when overdamped.
    pub fn frequency(&self) -> f64 {
        (self.omega * self.omega - 0.25 * self.gamma * self.gamma).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn satisfies_its_equations_in_every_regime() {
        for (omega, gamma) in [(3.0, 0.5), (3.0, 6.0), (1.0, 9.0), (0.0, 2.0), (2.0, 0.0)] {
            let mode = DampedMode { omega, gamma };
            let start = [0.7, -0.4];
            assert_eq!(mode.state(start, 0.0), start);
            for t in [0.1, 0.5, 2.0] {
                let d = 1e-4;
                let [p, v] = mode.state(start, t);
                let (after, before) = (mode.state(start, t + d), mode.state(start, t - d));
                let rate = [0, 1].map(|k| (after[k] - before[k]) / (2.0 * d));
                assert_relative_eq!(rate[0], -omega * v, epsilon = 1e-6);
                assert_relative_eq!(rate[1], omega * p - gamma * v, epsilon = 1e-6);
            }
        }
    }

    #[test]
    fn strong_damping_does_not_overflow() {
        let [p, v] = DampedMode { omega: 1.0, gamma: 1e6 }.state([1.0, 0.0], 10.0);
        assert!((p - exp(-10e-6)).abs() < 1e-9 && v.is_finite());
    }
}
