//! The limits of the time step of a run: of each mechanism of its scene alone, and of all waves of the
//! lattice together.

use touchstone_maths::theory::time_step::{self, Integrator, Mode};

/// The advised fraction of the theoretical limit. The limit is for a lattice at rest; moving particles
/// approach each other and have higher rates. Over all variants with the coarsest settings of their plans,
/// steps of 0.85 of the limit were stable, and the first divergence was at 0.9, in the flow over hills.
pub const ADVISED_SHARE: f64 = 0.8;

/// A mechanism that limits the time step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mechanism {
    /// Sound in a fluid; in a solid longitudinal waves, whose speed is c_p.
    Waves,
    /// Shear waves in a solid, whose speed is (μ/ρ)^(1/2).
    ShearWaves,
    /// Viscosity of the fluid.
    Viscosity,
    /// Artificial viscosity, as if it acted on every pair.
    ArtificialViscosity,
    /// Density diffusion.
    Diffusion,
    /// Acoustic damper.
    Damper,
    /// The motion of the matter: the time h/V in which it crosses a smoothing length.
    Motion,
    /// A body force: the time (h/F)^(1/2).
    Force,
    /// Bodies that approach each other: the time in which they do so by a smoothing length.
    Contact,
}

impl Mechanism {
    /// All mechanisms, in the order of tables.
    pub const ALL: [Self; 9] = [
        Self::Waves,
        Self::ShearWaves,
        Self::Viscosity,
        Self::ArtificialViscosity,
        Self::Diffusion,
        Self::Damper,
        Self::Motion,
        Self::Force,
        Self::Contact,
    ];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Waves => "sound or elastic waves",
            Self::ShearWaves => "shear waves",
            Self::Viscosity => "viscosity",
            Self::ArtificialViscosity => "artificial viscosity",
            Self::Diffusion => "density diffusion",
            Self::Damper => "acoustic damper",
            Self::Motion => "motion",
            Self::Force => "body force",
            Self::Contact => "contact",
        }
    }

    /// Is it a part of the problem, and not only of the method?
    fn is_physical(self) -> bool {
        !matches!(self, Self::ArtificialViscosity | Self::Diffusion | Self::Damper)
    }
}

/// The limits of a time step \[s\]. The limits of waves, viscosity and diffusion are 2 over the largest rate
/// on the lattice at rest, from the waves of the combined limit. The limits of motion, force and contact are
/// times to which the rules of cases apply factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeStepLimits {
    /// The limit of all waves of the lattice at rest together: a longer step is refused, and at most
    /// [`ADVISED_SHARE`] of the limit is advised.
    pub together: f64,
    alone: [f64; Mechanism::ALL.len()],
    explicit: f64,
    integrator: Integrator,
}

impl TimeStepLimits {
    /// The limits of a refused run.
    pub const REFUSED: Self = Self {
        together: 1.0,
        alone: [f64::INFINITY; Mechanism::ALL.len()],
        explicit: f64::INFINITY,
        integrator: Integrator::Leapfrog,
    };

    /// The limits of the waves of a lattice.
    pub fn of(modes: &[Mode], integrator: Integrator) -> Self {
        let alone = |rate: fn(&Mode) -> f64| time_step::limit_alone(modes, rate);
        let together = time_step::time_step_limit(modes, integrator);
        let explicit = modes.iter().map(|mode| mode.explicit).fold(f64::INFINITY, f64::min);
        Self { together, explicit, integrator, ..Self::REFUSED }
            .with(Mechanism::Waves, alone(|mode| mode.omega))
            .with(Mechanism::Viscosity, alone(|mode| mode.viscous))
            .with(Mechanism::ArtificialViscosity, alone(Mode::artificial))
            .with(Mechanism::Diffusion, alone(|mode| mode.density))
            .with(Mechanism::Damper, alone(|mode| mode.damped))
    }

    /// The limits of a leapfrog without damping, with this limit of elastic waves \[s\].
    pub fn of_waves(limit: f64) -> Self {
        Self { together: limit, ..Self::REFUSED }.with(Mechanism::Waves, limit)
    }

    /// Replaces the limit of a mechanism alone \[s\].
    #[must_use]
    pub fn with(mut self, mechanism: Mechanism, limit: f64) -> Self {
        self.alone[mechanism as usize] = limit;
        self
    }

    /// Adds the limits of motion and force for this smoothing length \[m\], largest speed \[m/s\] and body
    /// force \[m/s²\].
    #[must_use]
    pub fn moving(self, h: f64, speed: f64, force: f64) -> Self {
        self.with(Mechanism::Motion, h / speed).with(Mechanism::Force, (h / force).sqrt())
    }

    /// The limits in another unit of time.
    #[must_use]
    pub fn times(self, unit: f64) -> Self {
        let (together, explicit) = (self.together * unit, self.explicit * unit);
        Self { together, explicit, alone: self.alone.map(|limit| limit * unit), ..self }
    }

    /// The limit of a mechanism alone \[s\]; infinite if the scene lacks it.
    pub fn alone(&self, mechanism: Mechanism) -> f64 {
        self.alone[mechanism as usize]
    }

    /// The mechanism that limits the step most. Super-time-stepping takes viscosity out of the contest.
    pub fn binding(&self) -> Mechanism {
        let limits = |mechanism: &Mechanism| {
            self.integrator != Integrator::SuperLeapfrog || *mechanism != Mechanism::Viscosity
        };
        let all = Mechanism::ALL.into_iter().filter(limits);
        let shorter = |a, b| if self.alone(b) < self.alone(a) { b } else { a };
        all.reduce(shorter).unwrap_or(Mechanism::Waves)
    }

    /// The limit of the slowest mechanism of the problem \[s\], and at most this time: a mechanism that is
    /// slower does not act within the run.
    pub fn slowest(&self, end: f64) -> f64 {
        let all = Mechanism::ALL.into_iter().filter(|mechanism| mechanism.is_physical());
        let limits = all.map(|mechanism| self.alone(mechanism)).filter(|limit| limit.is_finite());
        limits.fold(0.0, f64::max).min(end)
    }

    /// Pair sweeps of a step of `dt` \[s\].
    pub fn sweeps(&self, dt: f64) -> f64 {
        self.integrator.sweeps(dt / self.explicit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn viscosity_binds_unless_it_is_super_stepped() {
        let of = |integrator| {
            TimeStepLimits { integrator, ..TimeStepLimits::REFUSED }
                .with(Mechanism::Waves, 3.0)
                .with(Mechanism::Viscosity, 1.0)
                .with(Mechanism::Diffusion, 500.0)
                .moving(2.0, 0.02, 0.0)
        };
        let explicit = of(Integrator::Leapfrog);
        assert_eq!(explicit.binding(), Mechanism::Viscosity);
        assert_eq!(of(Integrator::SuperLeapfrog).binding(), Mechanism::Waves);
        // Motion at 100 s is the slowest of the problem; in a run of 7 s the run itself is.
        assert_eq!([1e3, 7.0].map(|end| explicit.slowest(end)), [100.0, 7.0]);
        assert_eq!(explicit.alone(Mechanism::Force), f64::INFINITY);
    }
}
