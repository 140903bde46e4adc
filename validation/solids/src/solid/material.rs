//! The elastic material, and what a particle method makes of it: spacing, smoothing length, step.

use solver::{CubicSpline, Kernel, Linear, Smoothing};

use harness::{
    case::{Rules, RunError},
    runner::Context,
};
use maths::theory::{
    lattice::SquareLattice,
    time_step::{self, Medium},
};

/// An isotropic elastic solid: small-strain moduli, plane strain with the 1/3 of three dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Density ⁰ρ without stress \[kg/m³\].
    pub density: f64,
    /// K, the bulk modulus of three dimensions \[Pa\].
    pub bulk: f64,
    /// μ, the shear modulus \[Pa\].
    pub shear: f64,
}

impl Material {
    /// From Young's modulus E \[Pa\] and Poisson's ratio: K = E/(3(1 − 2ν)), μ = E/(2(1 + ν)).
    pub fn from_young(density: f64, young: f64, poisson: f64) -> Self {
        let (bulk, shear) =
            (young / (3.0 * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)));
        Self { density, bulk, shear }
    }

    /// (13) ⁰c = √(K/⁰ρ) \[m/s\].
    pub fn sound_speed(&self) -> f64 {
        (self.bulk / self.density).sqrt()
    }

    /// c_p = √((K + 4μ/3)/⁰ρ) \[m/s\]: the fastest wave, which limits the time step.
    pub fn p_wave_speed(&self) -> f64 {
        ((self.bulk + 4.0 / 3.0 * self.shear) / self.density).sqrt()
    }

    /// (12).
    pub fn eos(&self) -> Linear {
        Linear { density: self.density, sound_speed: self.sound_speed() }
    }
}

/// The settings that every solid case has, as numbers: what [`super::Method`] makes its terms from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// The material.
    pub material: Material,
    /// h/dx.
    pub h_over_dx: f64,
    /// α and β of the artificial viscosity.
    pub viscosity: [f64; 2],
    /// ξ of the artificial stress.
    pub xi: f64,
    /// Its exponent.
    pub exponent: u32,
    /// ε of XSPH.
    pub xsph: f64,
    /// dt \[s\], if it is given.
    pub dt: Option<f64>,
    /// Courant number dt (c_p + V)/h, if it is given.
    pub courant: Option<f64>,
}

impl Solid {
    /// Smoothing length \[m\] at this spacing \[m\].
    pub fn h(&self, dx: f64) -> f64 {
        self.h_over_dx * dx
    }

    /// W at the initial spacing \[1/m²\], for (18).
    pub fn w_at_spacing(&self, dx: f64) -> f64 {
        Smoothing::<CubicSpline>::new(self.h(dx)).w(dx * dx)
    }

    /// The time step courant h/(c_p + V) \[s\] for speeds of V \[m/s\] unless it is given, and the limit of
    /// the undamped leapfrog on a lattice, about 1.87 h/c_p, and that of the artificial viscosity.
    pub fn rules(&self, dx: f64, speed: f64, courant: f64) -> Rules {
        let (h, c0) = (self.h(dx), self.material.p_wave_speed());
        let dt = self.dt.unwrap_or(self.courant.unwrap_or(courant) * h / (c0 + speed));
        let lattice = SquareLattice::<CubicSpline>::new(self.h_over_dx, 0.01);
        let medium = Medium { c0, h, nu: 0.0, alpha: self.viscosity[0], delta: 0.0 };
        let modes = time_step::modes(&lattice, 24, &medium);
        // The predictor-corrector amplifies undamped sound at every dt: what it does is measured.
        let dt_limit = time_step::time_step_limit(&modes, time_step::Integrator::Leapfrog);
        Rules { dt, dt_limit, sound_speed: self.material.sound_speed() }
    }

    /// The time step of these rules \[s\]; refused beyond their limit.
    pub fn time_step(&self, rules: Rules, context: &Context) -> Result<f64, RunError> {
        let Rules { dt, dt_limit: limit, .. } = rules;
        if dt > limit && !context.allow_unstable {
            return Err(RunError::TimeStep { dt, limit, integrator: "leapfrog" });
        }
        Ok(dt)
    }

    /// Rows of particles in a period that every support fits into twice.
    pub fn rows_of_a_period(&self) -> usize {
        (2.0 * CubicSpline::SUPPORT * self.h_over_dx - 1e-9).ceil() as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn rubber_has_the_moduli_and_wave_speeds_of_the_rings() {
        let rubber = Material::from_young(1000.0, 2e6, 0.3975);
        assert_relative_eq!(rubber.shear / rubber.bulk, 0.22, max_relative = 1e-3);
        let (c, cp) = (rubber.sound_speed(), rubber.p_wave_speed());
        assert_relative_eq!(cp / c, 1.137, max_relative = 1e-3);
        assert_relative_eq!(c, 57.02, max_relative = 1e-3);
        // K = E/(3(1-2nu)) and mu = E/(2(1+nu)) have 9 K mu/(3 K + mu) = E.
        let young = 9.0 * rubber.bulk * rubber.shear / (3.0 * rubber.bulk + rubber.shear);
        assert_relative_eq!(young, 2e6, max_relative = 1e-12);
    }
}
