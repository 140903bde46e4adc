//! Properties of a method that need no simulation.

use nalgebra::Vector2;
use touchstone_maths::theory::{Stepping, lattice::SquareLattice, time_step};
use touchstone_solver::{
    Integrator as _, Kernel, Scheme, Smoothing, Tait, Term,
    walls::{Extrapolation as _, Walls},
};

use super::terms::{Boundary, FirstRow, FromMedium};
use crate::{
    limits::TimeStepLimits,
    medium::{Medium, MediumSetting},
    size::Storage,
};

/// A scheme whose terms and walls can be constructed from a medium.
pub trait Standard:
    Scheme<Forces: FromMedium, Drift: FromMedium, Walls: Boundary, Integrator: Stepping>
{
}

impl<S> Standard for S where
    S: Scheme<Forces: FromMedium, Drift: FromMedium, Walls: Boundary, Integrator: Stepping>
{
}

/// Properties of a method that need no simulation.
#[derive(Clone, Debug)]
pub struct Properties {
    /// Name of the kernel.
    pub kernel: &'static str,
    /// Name of the integrator.
    pub integrator: &'static str,
    /// Name of the walls.
    pub walls: &'static str,
    /// Whether its walls are mirrors to which a fluid sticks.
    pub has_no_slip_mirrors: bool,
    /// Position of the first row of boundary particles.
    pub first_row: FirstRow,
    /// Do its walls read [`Parts::surface`](super::Parts::surface)?
    pub has_feet: bool,
    /// The stored energy as an equation, of a method whose forces derive from one.
    pub law: Option<&'static str>,
    /// Support radius \[h\].
    pub support: f64,
    /// The theory of its time step.
    pub theory: time_step::Integrator,
    /// The largest stable step in a medium at rest \[s\], for a method whose waves do not follow from terms.
    pub limit: Option<fn(&Medium) -> f64>,
    /// Memory of a particle.
    pub storage: Storage,
    /// The settings that only its terms and walls read.
    pub uses: Vec<MediumSetting>,
    /// Its terms as equations.
    pub terms: Vec<&'static str>,
    /// W from h and r².
    weight: fn(f64, f64) -> f64,
    /// The symbols of the square lattice with its kernel, from h/dx and η²/h².
    lattice: fn(f64, f64) -> SquareLattice,
    /// Are gradients corrected by the inverse of the moments?
    pub is_corrected: bool,
}

impl Properties {
    /// The properties of a scheme.
    pub fn of<S: Standard>() -> Self {
        let mut uses = Vec::new();
        S::Forces::uses(&mut uses);
        S::Drift::uses(&mut uses);
        uses.extend(S::Walls::USES);
        let mut terms = Vec::new();
        S::Forces::state(&mut terms);
        S::Drift::state(&mut terms);
        Self {
            kernel: S::Kernel::NAME,
            integrator: S::Integrator::NAME,
            walls: S::Walls::NAME,
            has_no_slip_mirrors: S::Walls::NO_SLIP_MIRRORS,
            first_row: S::Walls::FIRST_ROW,
            has_feet: <S::Walls as Walls<S::Extra>>::Extrapolation::FEET,
            law: None,
            support: S::Kernel::SUPPORT,
            theory: S::Integrator::THEORY,
            limit: None,
            storage: Storage::LISTS,
            uses,
            terms,
            weight: |h, r2| Smoothing::<S::Kernel>::new(h).w(r2),
            lattice: SquareLattice::of::<S::Kernel>,
            is_corrected: S::Forces::NORMALISES,
        }
    }

    /// A medium with this equation of state, spacing \[m\] and smoothing length \[m\], and nothing else.
    pub fn medium(&self, eos: Tait, dx: f64, h: f64) -> Medium {
        Medium {
            eos,
            density: eos.density,
            sound_speed: eos.sound_speed,
            dx,
            h,
            w_at_spacing: (self.weight)(h, dx * dx),
            stiffest: self.square(h / dx, 0.0).stiffest(),
            nu: 0.0,
            shear_modulus: 0.0,
            acceleration: Vector2::zeros(),
            wall_acceleration: Vector2::zeros(),
            eta2_over_h2: 0.0,
            alpha: 0.0,
            beta: 0.0,
            xsph: 0.0,
            xi: 0.0,
            exponent: 1,
            diffusion: 0.0,
            damper: 0.0,
            shift: 0.0,
        }
    }

    /// The symbols of the square lattice with these h/dx and η²/h², for its forces.
    pub fn square(&self, h_over_dx: f64, eta2_over_h2: f64) -> SquareLattice {
        let lattice = (self.lattice)(h_over_dx, eta2_over_h2);
        if self.is_corrected { lattice.corrected() } else { lattice }
    }

    /// The limits of a step in a medium, by the waves of a periodic square lattice of n × n particles
    /// with this h/dx.
    pub fn limits_in(&self, medium: &Medium, h_over_dx: f64, n: usize) -> TimeStepLimits {
        let lattice = self.square(h_over_dx, medium.eta2_over_h2);
        self.limits(&lattice, n, &medium.waves(&self.uses))
    }

    /// The limits of a step by the waves of a periodic square lattice of n × n particles.
    pub fn limits(
        &self,
        lattice: &SquareLattice,
        n: usize,
        medium: &time_step::WaveMedium,
    ) -> TimeStepLimits {
        TimeStepLimits::of(&time_step::modes(lattice, n, medium), self.theory)
    }
}
