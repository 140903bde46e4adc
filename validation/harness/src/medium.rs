//! The parameters from which terms and walls are constructed.

use nalgebra::Vector2;
use touchstone_base::settings::{Field, Value, Values};
use touchstone_maths::theory::time_step;
use touchstone_solver::Tait;

/// The parameters of a material at a particle spacing. Parameters that a case does not use are 0. A new one
/// needs a unit in [`crate::relation::View::medium`] and a place in [`mutate`](fn@crate::method::mutate):
/// both name every parameter.
#[derive(Clone, Copy, Debug)]
pub struct Medium {
    /// Equation of state, with density at rest and sound speed; a solid takes these two of it.
    pub eos: Tait,
    /// Initial density \[kg/m³\], equal to the density of the equation of state unless compressed.
    pub density: f64,
    /// Sound speed at that density \[m/s\].
    pub sound_speed: f64,
    /// Spacing \[m\].
    pub dx: f64,
    /// Smoothing length \[m\].
    pub h: f64,
    /// W(dx) \[1/m²\].
    pub w_at_spacing: f64,
    /// Largest eigenvalue of the viscous term on a square lattice \[ν/h²\].
    pub stiffest: f64,
    /// Kinematic viscosity ν \[m²/s\].
    pub nu: f64,
    /// Shear modulus μ of (11) \[Pa\].
    pub shear_modulus: f64,
    /// Body force \[m/s²\].
    pub acceleration: Vector2<f64>,
    /// The acceleration with which walls extrapolate the pressure \[m/s²\].
    pub wall_acceleration: Vector2<f64>,
    /// η² \[h²\].
    pub eta2_over_h2: f64,
    /// α of (16).
    pub alpha: f64,
    /// β of (16).
    pub beta: f64,
    /// ε of (22).
    pub xsph: f64,
    /// ξ of (19).
    pub xi: f64,
    /// n of (14) and (18).
    pub exponent: u32,
    /// δ of the density diffusion.
    pub diffusion: f64,
    /// α₂ of the acoustic damper.
    pub damper: f64,
    /// Amplitude of the shifting.
    pub shift: f64,
}

impl Medium {
    /// With the values that settings have by the names of [`MediumSetting`]s.
    #[must_use]
    pub fn set_by(mut self, settings: &dyn Values) -> Self {
        for (field, value) in settings.fields().iter().zip(settings.values()) {
            let setting = MediumSetting::ALL.iter().find(|(_, name, _)| *name == field.name);
            match (setting, value) {
                (Some((.., set)), Value::Real(value)) => set(&mut self, value),
                (Some((.., set)), Value::Count(value)) => set(&mut self, value as f64),
                _ => {}
            }
        }
        self
    }

    /// δ h c0 of the density diffusion \[m²/s\].
    pub fn diffusivity(&self) -> f64 {
        self.diffusion * self.h * self.sound_speed
    }

    /// The bulk viscosity α₂ ρ0 c0 h of the acoustic damper \[Pa s\].
    pub fn bulk_viscosity(&self) -> f64 {
        self.damper * self.density * self.sound_speed * self.h
    }

    /// The longest step of forward Euler for the viscous term alone \[s\].
    pub fn explicit_limit(&self) -> f64 {
        time_step::explicit_limit(self.stiffest, self.h, self.nu)
    }

    /// The parameters on which waves in the medium depend, for terms that read these settings.
    pub fn waves(&self, uses: &[MediumSetting]) -> time_step::WaveMedium {
        let used = |setting, value| if uses.contains(&setting) { value } else { 0.0 };
        time_step::WaveMedium {
            c0: self.sound_speed,
            h: self.h,
            nu: self.nu,
            alpha: used(MediumSetting::Alpha, self.alpha),
            delta: used(MediumSetting::Diffusion, self.diffusion),
            damper: used(MediumSetting::Damper, self.damper),
        }
    }
}

/// A setting that only some terms or walls read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MediumSetting {
    /// η² of the viscous term.
    Eta2,
    /// α of the artificial viscosity.
    Alpha,
    /// β of the artificial viscosity.
    Beta,
    /// ε of XSPH.
    Xsph,
    /// ξ of the artificial stress.
    Xi,
    /// Exponent of the artificial stress.
    Exponent,
    /// δ of the density diffusion.
    Diffusion,
    /// α₂ of the acoustic damper.
    Damper,
    /// Amplitude of the shifting.
    Shift,
    /// Whether mirror particles use the curvature of the velocity profile at their wall.
    WallCurvature,
    /// Share of gravity that an extrapolating wall uses.
    WallGravity,
}

/// Puts a number where a medium has it.
type Set = fn(&mut Medium, f64);

impl MediumSetting {
    /// All settings with their names, and the setters of a medium.
    const ALL: &[(Self, &'static str, Set)] = &[
        (Self::Eta2, "eta2_over_h2", |medium, value| medium.eta2_over_h2 = value),
        (Self::Alpha, "alpha", |medium, value| medium.alpha = value),
        (Self::Beta, "beta", |medium, value| medium.beta = value),
        (Self::Xsph, "xsph", |medium, value| medium.xsph = value),
        (Self::Xi, "xi", |medium, value| medium.xi = value),
        (Self::Exponent, "exponent", |medium, value| medium.exponent = value as u32),
        (Self::Diffusion, "diffusion", |medium, value| medium.diffusion = value),
        (Self::Damper, "damper", |medium, value| medium.damper = value),
        (Self::Shift, "shift", |medium, value| medium.shift = value),
        (Self::WallCurvature, "wall_curvature", |_, _| {}),
        (Self::WallGravity, "wall_gravity", |_, _| {}),
    ];

    /// The names of the settings of this kind in a case, except the used ones.
    pub fn others(uses: &[Self], fields: &[Field]) -> Vec<&'static str> {
        let others = Self::ALL.iter().filter(|(setting, ..)| !uses.contains(setting));
        let names = others.map(|(_, name, _)| *name);
        names.filter(|name| fields.iter().any(|field| field.name == *name)).collect()
    }
}
