//! From amplitudes at successive steps to ω and γ of continuous time, without the error of the time
//! step.
//!
//! A mode obeys p' = -ω v, v' = ω p - γ v with p = -c₀ ρ̂/ρ₀, and one step is a matrix M of (p, v):
//!
//! - leapfrog, v at half steps: tr M = 2 - γ dt - (ω dt)², det M = 1 - γ dt;
//! - explicit midpoint: M = 1 + Z + Z²/2 with Z = A dt, so each eigenvalue ξ of M belongs to
//!   z = (2ξ - 1)^(1/2) - 1, and Σz = -γ dt, Πz = (ω dt)².
//!
//! No variant has another integrator; the numbers of one would be NaN, with which every gate fails.
//!
//! A transverse velocity v' = -γ v is the scalar case.

use nalgebra::{Complex, Matrix2, Vector2};
use serde::{Deserialize, Serialize};
use touchstone_base::functions::complex_sqrt;

use super::time_step::Integrator;

/// Angular frequency and damping of a mode.
#[derive(Clone, Copy, Debug)]
pub struct DampedMode {
    /// Undamped angular frequency ω ≥ 0 \[1/s\].
    pub omega: f64,
    /// Damping of the velocity γ ≥ 0 \[1/s\].
    pub gamma: f64,
}

/// The matrix of one step of (p, v), where density decays by itself too: p' = -ω v - γ_ρ p, γ_ρ = `diffusion`
/// \[1/s\]. With ω = 0 a velocity decays as a transverse one does.
pub fn step(mode: &DampedMode, diffusion: f64, integrator: Integrator, dt: f64) -> Matrix2<f64> {
    let (w, g, d) = (mode.omega * dt, mode.gamma * dt, diffusion * dt);
    match integrator {
        Integrator::Leapfrog => {
            let kick = Matrix2::new(1.0, 0.0, w, 1.0 - g);
            let drift = Matrix2::new(1.0 - d, -w, 0.0, 1.0);
            drift * kick
        }
        Integrator::PredictorCorrector => {
            let z = Matrix2::new(-d, -w, w, -g);
            Matrix2::identity() + z + z * z * 0.5
        }
        _ => Matrix2::repeat(f64::NAN),
    }
}

/// ω and γ of the matrix of one step.
fn mode_of_step(m: &Matrix2<f64>, integrator: Integrator, dt: f64) -> DampedMode {
    let (trace, determinant) = (m.trace(), m.determinant());
    let (gamma, square) = match integrator {
        Integrator::Leapfrog => (1.0 - determinant, 2.0 - (1.0 - determinant) - trace),
        Integrator::PredictorCorrector => {
            let half = Complex::new(0.5 * trace, 0.0);
            let root = complex_sqrt(half * half - determinant);
            let z = [half + root, half - root].map(|xi| complex_sqrt(xi * 2.0 - 1.0) - 1.0);
            (-(z[0] + z[1]).re, (z[0] * z[1]).re)
        }
        _ => (f64::NAN, f64::NAN),
    };
    DampedMode { omega: square.max(0.0).sqrt() / dt, gamma: gamma / dt }
}

/// γ of the factor of one step of a transverse velocity.
fn shear_of_step(factor: f64, integrator: Integrator, dt: f64) -> f64 {
    match integrator {
        Integrator::Leapfrog => (1.0 - factor) / dt,
        Integrator::PredictorCorrector => (1.0 - (2.0 * factor - 1.0).sqrt()) / dt,
        _ => f64::NAN,
    }
}

/// The matrix M of least squares |yₙ₊₁ - M yₙ|; `None` for fewer than three states or states on
/// one line.
fn matrix_between(states: &[Vector2<f64>]) -> Option<Matrix2<f64>> {
    let (mut forward, mut square) = (Matrix2::zeros(), Matrix2::zeros());
    for pair in states.windows(2) {
        forward += pair[1] * pair[0].transpose();
        square += pair[0] * pair[0].transpose();
    }
    if states.len() < 3 {
        return None;
    }
    // As nalgebra inverts it, whose function comes with that for four rows.
    let (a, b, c, d) = (square.m11, square.m12, square.m21, square.m22);
    let determinant = a * d - c * b;
    (determinant != 0.0).then(|| forward * (Matrix2::new(d, -b, -c, a) / determinant))
}

/// The factor of least squares |yₙ₊₁ - f yₙ|; NaN for zeros.
fn factor_between(values: &[f64]) -> f64 {
    let pairs = values.windows(2).map(|pair| (pair[0], pair[1]));
    let (forward, square) = pairs.fold((0.0, 0.0), |(f, s), (a, b)| (f + a * b, s + a * a));
    forward / square
}

/// Amplitudes of a wave \[c₀\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WaveAmplitudes {
    /// Pressure, p = -c₀ ρ̂/ρ₀.
    pub pressure: f64,
    /// Velocity along the wave vector.
    pub along: f64,
    /// Velocity across it.
    pub across: f64,
}

impl WaveAmplitudes {
    /// All amplitudes.
    pub fn all(&self) -> [f64; 3] {
        [self.pressure, self.along, self.across]
    }
}

/// ω and γ of a sound wave from its amplitudes after each step; NaN for too few.
pub fn mode_of(series: &[WaveAmplitudes], integrator: Integrator, dt: f64) -> DampedMode {
    let states: Vec<Vector2<f64>> =
        series.iter().map(|of| Vector2::new(of.pressure, of.along)).collect();
    let unknown = DampedMode { omega: f64::NAN, gamma: f64::NAN };
    matrix_between(&states).map_or(unknown, |matrix| mode_of_step(&matrix, integrator, dt))
}

/// γ of a shear wave from its amplitudes after each step; NaN for too few.
pub fn decay_of(series: &[WaveAmplitudes], integrator: Integrator, dt: f64) -> f64 {
    let values: Vec<f64> = series.iter().map(|of| of.across).collect();
    shear_of_step(factor_between(&values), integrator, dt)
}

#[cfg(test)]
mod tests {
    use super::*;
    use Integrator::{Leapfrog, PredictorCorrector};
    use approx::assert_relative_eq;
    use touchstone_base::functions::{cos, exp, sin};

    /// States of exact steps give back ω and γ: under- and overdamped, for each integrator.
    #[test]
    fn steps_give_back_the_mode() {
        for integrator in [Leapfrog, PredictorCorrector] {
            for (omega, gamma) in [(3.0, 0.0), (3.0, 0.5), (1.0, 5.0)] {
                let (mode, dt) = (DampedMode { omega, gamma }, 0.05);
                let m = step(&mode, 0.0, integrator, dt);
                let mut states = vec![Vector2::new(0.3, 1.0)];
                for k in 0..40 {
                    states.push(m * states[k]);
                }
                let fitted = matrix_between(&states).expect("enough states");
                let found = mode_of_step(&fitted, integrator, dt);
                assert_relative_eq!(found.omega, omega, max_relative = 1e-9);
                assert_relative_eq!(found.gamma, gamma, epsilon = 1e-8);
                let shear = step(&DampedMode { omega: 0.0, gamma }, 0.0, integrator, dt);
                let decay: Vec<f64> = (0..20).map(|k| shear.m22.powi(k)).collect();
                let found = shear_of_step(factor_between(&decay), integrator, dt);
                assert_relative_eq!(found, gamma, epsilon = 1e-12);
            }
        }
    }

    /// A small step is close to continuous time, so the matrix tends to the matrix of the equations.
    #[test]
    fn a_step_tends_to_the_exact_solution() {
        let mode = DampedMode { omega: 2.0, gamma: 0.7 };
        let next = step(&mode, 0.0, PredictorCorrector, 1e-4) * Vector2::new(0.4, -0.2);
        // exp(-γt/2) (cos σt + ...), the solution of p' = -ω v, v' = ω p - γ v.
        let ([p, v], t, half) = ([0.4, -0.2], 1e-4, 0.5 * mode.gamma);
        let (decay, sigma) = (exp(-half * t), (mode.omega.powi(2) - half.powi(2)).sqrt());
        let (c, s) = (decay * cos(sigma * t), decay * sin(sigma * t) / sigma);
        let exact = [p * c + (half * p - 2.0 * v) * s, v * c + (2.0 * p - half * v) * s];
        assert_relative_eq!(next, Vector2::from(exact), epsilon = 3e-8);
    }

    #[test]
    fn too_few_states_have_no_matrix() {
        let y = Vector2::new(1.0, 0.0);
        assert!(matrix_between(&[y, y]).is_none() && matrix_between(&[y, y, y, y]).is_none());
        assert!(factor_between(&[0.0, 0.0]).is_nan());
    }
}
