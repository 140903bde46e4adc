//! From settings to the numbers that terms are made of, and to the time step.

use nalgebra::Vector2;
use solver::{Integrator, Kernel, Smoothing, Tait};

use super::WaterScheme;
use harness::case::RunError;
use maths::{
    metrics::energy::Water,
    theory::{
        Stepping,
        lattice::SquareLattice,
        time_step::{self, Medium as Waves},
    },
};

/// Side of the periodic box whose waves give the limit of the time step.
const LIMIT_BOX: usize = 24;

/// The settings that every case of water has, see [`water_settings!`](crate::water_settings!).
#[derive(Clone, Copy, Debug)]
pub struct Numerics {
    /// ⁰ρ \[kg/m³\].
    pub rho: f64,
    /// h over the spacing.
    pub h_over_dx: f64,
    /// α of (16).
    pub alpha: f64,
    /// β of (16).
    pub beta: f64,
    /// ε of (22).
    pub xsph: f64,
    /// ξ of (19).
    pub xi: f64,
    /// n of (14).
    pub exponent: u32,
    /// δ of the density diffusion.
    pub diffusion: f64,
    /// Courant number.
    pub courant: f64,
    /// Time step, if given \[s\].
    pub dt: Option<f64>,
}

/// Water at a spacing.
#[derive(Clone, Copy, Debug)]
pub struct Medium {
    /// As given.
    pub numerics: Numerics,
    /// Spacing \[m\].
    pub dx: f64,
    /// Smoothing length \[m\].
    pub h: f64,
    /// Equation of state.
    pub eos: Tait,
    /// g \[m/s²\].
    pub gravity: Vector2<f64>,
    /// The largest speed expected \[m/s\].
    pub speed: f64,
}

impl Medium {
    /// Water with this spacing \[m\], sound speed \[m/s\], gravity \[m/s²\] and largest speed \[m/s\].
    pub fn new(numerics: Numerics, dx: f64, c0: f64, gravity: Vector2<f64>, speed: f64) -> Self {
        let (h, eos) = (numerics.h_over_dx * dx, Tait::new(numerics.rho, c0));
        Self { numerics, dx, h, eos, gravity, speed }
    }

    /// W at the initial spacing \[1/m²\].
    pub fn w_at_spacing<K: Kernel>(&self) -> f64 {
        Smoothing::<K>::new(self.h).w(self.dx * self.dx)
    }

    /// δ h ⁰c of the density diffusion \[m²/s\].
    pub fn diffusivity(&self) -> f64 {
        self.numerics.diffusion * self.h * self.eos.sound_speed
    }

    /// What the energy depends on.
    pub fn water(&self) -> Water {
        Water { eos: self.eos, gravity: self.gravity }
    }

    /// Time step and its theoretical limit \[s\]: a resting lattice with artificial viscosity on every
    /// pair and the terms of the scheme. A longer step is refused unless asked for.
    pub fn time_step<S: WaterScheme>(&self, allow_unstable: bool) -> Result<[f64; 2], RunError> {
        let uses = S::uses();
        let Numerics { alpha, diffusion, courant, h_over_dx, .. } = self.numerics;
        let used = |key: &str, value: f64| if uses.contains(&key) { value } else { 0.0 };
        let (alpha, delta) = (used("alpha", alpha), used("diffusion", diffusion));
        let lattice = SquareLattice::<S::Kernel>::new(h_over_dx, 0.01);
        let waves = Waves { c0: self.eos.sound_speed, h: self.h, nu: 0.0, alpha, delta };
        let modes = time_step::modes(&lattice, LIMIT_BOX, &waves);
        let limit = time_step::time_step_limit(&modes, S::Integrator::THEORY);
        let dt = self.numerics.dt.unwrap_or(courant * self.h / (self.eos.sound_speed + self.speed));
        if dt > limit && !allow_unstable {
            let integrator = S::Integrator::NAME;
            return Err(RunError::TimeStep { dt, limit, integrator });
        }
        Ok([dt, limit])
    }
}
