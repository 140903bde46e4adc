//! Common parts of the cases of water with a free surface: settings, the rule of the time step, and the
//! particles of a tank's walls.

pub mod ledger;

use nalgebra::Vector2;
use touchstone_base::settings::SettingError;
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::Step,
    limits::TimeStepLimits,
    method::{FirstRow, Properties},
};
use touchstone_maths::{exact, geometry::Tank};
use touchstone_schemes::water::WaterMethod;
use touchstone_solver::{Role, Tait};

pub use ledger::Ledger;

/// η²/h² of the lattice whose waves give the limit of the time step.
const ETA2: f64 = 0.01;

/// The limits of the time step on a resting lattice of n × n particles with artificial viscosity on every
/// pair and the terms of the method. `c0` is the largest sound speed \[m/s\].
pub fn limits(
    method: &Properties,
    medium: &Medium,
    h_over_dx: f64,
    c0: f64,
    n: usize,
) -> TimeStepLimits {
    let waves =
        touchstone_maths::theory::time_step::WaveMedium { c0, ..medium.waves(&method.uses) };
    method.limits(&method.square(h_over_dx, ETA2), n, &waves)
}

/// Water of a medium at rest under its gravity.
pub fn at_rest(medium: &Medium) -> exact::Hydrostatic {
    exact::Hydrostatic { eos: medium.eos, gravity: -medium.acceleration.y }
}

/// Refuses a scene with wall particles at a height y above the surface at which water at rest has no density,
/// (γ − 1) g y/c₀² ≥ 1. From the largest y \[m\] `setting` returns the setting to change, its value and the
/// allowed values.
///
/// # Errors
/// The error from `setting`.
pub fn check_above(
    particles: &[Particle],
    surface: f64,
    setting: impl FnOnce(f64) -> (&'static str, f64, String),
) -> Result<(), RunError> {
    if particles.iter().all(|p| p.density > 0.0) {
        return Ok(());
    }
    let highest = particles.iter().map(|p| p.position.y).fold(surface, f64::max);
    let (name, value, allowed) = setting(highest - surface);
    let why = "otherwise wall particles far above the surface would have no density";
    let words =
        format!("setting {name} is {value:?}; allowed with these settings is {allowed}; {why}");
    Err(SettingError(words).into())
}

/// Places and roles of the particles of a tank's walls, out to the support.
pub fn wall_particles(of: &Properties, tank: &Tank, medium: &Medium) -> Vec<(Vector2<f64>, Role)> {
    let support = of.support * medium.h;
    match of.first_row {
        FirstRow::Nowhere => Vec::new(),
        FirstRow::OnSurface => tank.interface_walls(support),
        FirstRow::Behind => {
            tank.rows_behind(support).into_iter().map(|place| (place, Role::Wall)).collect()
        }
    }
}

touchstone_base::settings! {
    /// The settings that cases of water have in common.
    pub struct WaterSettings {
        /// density at rest
        rho: f64 ["kg/m^3"] in 1e-6..=1e6 = 1000.0,
        /// smoothing length over spacing: 1.5 as in the rings; at 1.2 artificial stress adds more energy than
        /// viscosity can dissipate
        h_over_dx: f64 ["-"] in 0.8..=3.0 = 1.5,
        /// artificial viscosity: linear part
        alpha: f64 ["-"] in 0.0..=10.0 = 0.1,
        /// artificial viscosity: quadratic part
        beta: f64 ["-"] in 0.0..=20.0 = 0.0,
        /// XSPH: weight ε of the neighbours' mean velocity
        xsph: f64 ["-"] in -0.99..=0.99 = 0.5,
        /// artificial stress: strength
        xi: f64 ["-"] in 0.0..=10.0 = 0.3,
        /// artificial stress: exponent
        exponent: usize ["-"] in 1..=12 = 4,
        /// density diffusion, in h c0
        diffusion: f64 ["-"] in 0.0..=1.0 = 0.1,
        /// acoustic damper: bulk viscosity, in rho h c0
        damper: f64 ["-"] in 0.0..=10.0 = 1.0,
        /// Courant number dt (c0 + v)/h, v the largest speed expected
        courant: f64 ["-"] in 1e-6..=10.0 = 0.25,
        /// time step; auto: by the Courant number
        dt: Option<f64> ["s"] in 1e-15..=1e6 = None,
    }
}

/// The scales of a flow of water.
#[derive(Clone, Copy, Debug)]
pub struct WaterScales {
    /// Spacing \[m\].
    pub dx: f64,
    /// Sound speed \[m/s\].
    pub c0: f64,
    /// Gravity, downwards \[m/s²\].
    pub gravity: f64,
    /// Largest speed expected \[m/s\].
    pub speed: f64,
    /// End of the run \[s\].
    pub end: f64,
}

impl WaterSettings {
    /// The medium and the rules of the time step of a flow with these scales.
    pub fn medium(&self, method: &WaterMethod, scales: WaterScales) -> (Medium, Rules) {
        let WaterScales { dx, c0, gravity, speed, end } = scales;
        let (h, eos) = (self.h_over_dx * dx, Tait::new(self.rho, c0));
        let down = Vector2::new(0.0, -gravity);
        let medium = Medium {
            acceleration: down,
            wall_acceleration: down,
            ..method.properties.medium(eos, dx, h).set_by(self)
        };
        let step = Step::courant(self.courant, h, [c0, speed]);
        let limits = limits(&method.properties, &medium, self.h_over_dx, c0, 24);
        let (step, limits) = (step.or_given(self.dt), limits.moving(h, speed, gravity));
        (medium, Rules { step, limits, sound_speed: c0, end })
    }
}
