//! From amplitudes at successive steps to ω and γ of continuous time, without the error of the time
//! step.
//!
//! A mode obeys p' = -ω v, v' = ω p - γ v with p = -c₀ ρ̂/ρ₀, and one step is a matrix M of (p, v):
//!
//! - leapfrog, v at half steps: tr M = 2 - γ dt - (ω dt)², det M = 1 - γ dt;
//! - the same with super-time-stepping, whose factor of a wave that decays is an exponential up to second
//!   order in dt: det M = exp(-γ dt), tr M = 1 + det M - (ω dt)² (1 - det M)/(γ dt);
//! - explicit midpoint: M = 1 + Z + Z²/2 with Z = A dt, so each eigenvalue ξ of M belongs to
//!   z = (2ξ - 1)^(1/2) - 1, and Σz = -γ dt, Πz = (ω dt)²;
//! - forward Euler: M = 1 + Z.
//!
//! A transverse velocity v' = -γ v is the same with numbers for matrices.

use nalgebra::{Complex, Matrix2, Vector2};

use base::functions::{complex_sqrt, exp, ln};
use maths::{exact::damped_mode::DampedMode, theory::time_step::Integrator};

/// The matrix of one step of (p, v).
pub fn step(mode: &DampedMode, integrator: Integrator, dt: f64) -> Matrix2<f64> {
    step_with_diffusion(mode, 0.0, integrator, dt)
}

/// The same where density decays by itself too, p' = -ω v - γ_ρ p, γ_ρ = `diffusion` \[1/s\].
pub fn step_with_diffusion(
    mode: &DampedMode,
    diffusion: f64,
    integrator: Integrator,
    dt: f64,
) -> Matrix2<f64> {
    let (w, g, d) = (mode.omega * dt, mode.gamma * dt, diffusion * dt);
    let z = Matrix2::new(-d, -w, w, -g);
    match integrator {
        Integrator::Leapfrog => {
            let kick = Matrix2::new(1.0, 0.0, w, 1.0 - g);
            let drift = Matrix2::new(1.0 - d, -w, 0.0, 1.0);
            drift * kick
        }
        Integrator::SuperLeapfrog => {
            let left = exp(-g);
            let kick = if g > 0.0 { (1.0 - left) / g } else { 1.0 };
            let kick = Matrix2::new(1.0, 0.0, w * kick, left);
            Matrix2::new(1.0 - d, -w, 0.0, 1.0) * kick
        }
        Integrator::PredictorCorrector => Matrix2::identity() + z + z * z * 0.5,
        Integrator::Euler => Matrix2::identity() + z,
    }
}

/// The factor of one step of a transverse velocity that decays at the rate γ.
pub fn shear_step(gamma: f64, integrator: Integrator, dt: f64) -> f64 {
    let z = -gamma * dt;
    match integrator {
        Integrator::PredictorCorrector => 1.0 + z + 0.5 * z * z,
        Integrator::SuperLeapfrog => exp(z),
        Integrator::Leapfrog | Integrator::Euler => 1.0 + z,
    }
}

/// ω and γ of the matrix of one step.
pub fn mode_of_step(m: &Matrix2<f64>, integrator: Integrator, dt: f64) -> DampedMode {
    let (trace, determinant) = (m.trace(), m.determinant());
    if integrator == Integrator::Leapfrog {
        let gamma = 1.0 - determinant;
        let square = 2.0 - gamma - trace;
        return DampedMode { omega: square.max(0.0).sqrt() / dt, gamma: gamma / dt };
    }
    if integrator == Integrator::SuperLeapfrog {
        let gamma = -ln(determinant);
        let kick = if gamma > 0.0 { (1.0 - determinant) / gamma } else { 1.0 };
        let square = (1.0 + determinant - trace) / kick;
        return DampedMode { omega: square.max(0.0).sqrt() / dt, gamma: gamma / dt };
    }
    let half = Complex::new(0.5 * trace, 0.0);
    let root = complex_sqrt(half * half - determinant);
    let z = [half + root, half - root].map(|xi| match integrator {
        Integrator::PredictorCorrector => complex_sqrt(xi * 2.0 - 1.0) - 1.0,
        _ => xi - 1.0,
    });
    let square = (z[0] * z[1]).re.max(0.0);
    DampedMode { omega: square.sqrt() / dt, gamma: -(z[0] + z[1]).re / dt }
}

/// γ of the factor of one step of a transverse velocity.
pub fn shear_of_step(factor: f64, integrator: Integrator, dt: f64) -> f64 {
    match integrator {
        Integrator::PredictorCorrector => (1.0 - (2.0 * factor - 1.0).sqrt()) / dt,
        Integrator::SuperLeapfrog => -ln(factor) / dt,
        Integrator::Leapfrog | Integrator::Euler => (1.0 - factor) / dt,
    }
}

/// The matrix M of least squares |yₙ₊₁ - M yₙ|; `None` for fewer than three states or states on
/// one line.
pub fn matrix_between(states: &[Vector2<f64>]) -> Option<Matrix2<f64>> {
    let (mut forward, mut square) = (Matrix2::zeros(), Matrix2::zeros());
    for pair in states.windows(2) {
        forward += pair[1] * pair[0].transpose();
        square += pair[0] * pair[0].transpose();
    }
    if states.len() < 3 {
        return None;
    }
    square.try_inverse().map(|inverse| forward * inverse)
}

/// The factor of least squares |yₙ₊₁ - f yₙ|.
pub fn factor_between(values: &[f64]) -> Option<f64> {
    let pairs = values.windows(2).map(|pair| (pair[0], pair[1]));
    let (forward, square) = pairs.fold((0.0, 0.0), |(f, s), (a, b)| (f + a * b, s + a * a));
    (square > 0.0).then(|| forward / square)
}

/// ω and γ of a sound wave from its amplitudes (p, v along, v across) after each step.
pub fn mode_of(series: &[[f64; 3]], integrator: Integrator, dt: f64) -> Option<DampedMode> {
    let states: Vec<Vector2<f64>> = series.iter().map(|a| Vector2::new(a[0], a[1])).collect();
    Some(mode_of_step(&matrix_between(&states)?, integrator, dt))
}

/// γ of a shear wave from its amplitudes after each step.
pub fn decay_of(series: &[[f64; 3]], integrator: Integrator, dt: f64) -> Option<f64> {
    let values: Vec<f64> = series.iter().map(|a| a[2]).collect();
    Some(shear_of_step(factor_between(&values)?, integrator, dt))
}

#[cfg(test)]
mod tests {
    use super::*;
    use Integrator::{Euler, Leapfrog, PredictorCorrector, SuperLeapfrog};
    use approx::assert_relative_eq;

    /// States of exact steps give back ω and γ: under- and overdamped, for each integrator.
    #[test]
    fn steps_give_back_the_mode() {
        for integrator in [Leapfrog, SuperLeapfrog, PredictorCorrector, Euler] {
            for (omega, gamma) in [(3.0, 0.0), (3.0, 0.5), (1.0, 5.0)] {
                let (mode, dt) = (DampedMode { omega, gamma }, 0.05);
                let m = step(&mode, integrator, dt);
                let mut states = vec![Vector2::new(0.3, 1.0)];
                for k in 0..40 {
                    states.push(m * states[k]);
                }
                let fitted = matrix_between(&states).expect("enough states");
                let found = mode_of_step(&fitted, integrator, dt);
                assert_relative_eq!(found.omega, omega, max_relative = 1e-9);
                assert_relative_eq!(found.gamma, gamma, epsilon = 1e-8);
                let factor = shear_step(gamma, integrator, dt);
                let decay: Vec<f64> = (0..20).map(|k| factor.powi(k)).collect();
                let fitted = factor_between(&decay).expect("not zero");
                let found = shear_of_step(fitted, integrator, dt);
                assert_relative_eq!(found, gamma, epsilon = 1e-12);
            }
        }
    }

    /// A small step is close to continuous time, so the matrix is that of the equations.
    #[test]
    fn a_step_tends_to_the_exact_solution() {
        let mode = DampedMode { omega: 2.0, gamma: 0.7 };
        for integrator in [PredictorCorrector, Euler] {
            let m = step(&mode, integrator, 1e-4);
            let next = m * Vector2::new(0.4, -0.2);
            let [p, v] = mode.state([0.4, -0.2], 1e-4);
            assert_relative_eq!(next, Vector2::new(p, v), epsilon = 3e-8);
        }
    }

    #[test]
    fn too_few_states_have_no_matrix() {
        let y = Vector2::new(1.0, 0.0);
        assert!(matrix_between(&[y, y]).is_none() && matrix_between(&[y, y, y, y]).is_none());
        assert!(factor_between(&[0.0, 0.0]).is_none());
    }
}
