//! From settings to numbers: the rules for sound speed, time step and arrangement, each stated once.

use nalgebra::Vector2;
use solver::{Kernel, Particle, Role, Smoothing, Tait};

use super::ChannelSettings;
use harness::case::RunError;
use maths::theory::Stepping;
use maths::{
    exact::{couette::Couette, poiseuille::Poiseuille},
    theory::{
        lattice::SquareLattice,
        time_step::{self, Medium},
    },
};

/// What drives the fluid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// The upper plate moves at V from t = 0.
    Couette,
    /// A body force F = 8 ν V/L² acts from t = 0.
    Poiseuille,
}

impl Flow {
    /// Name of its case.
    pub fn name(self) -> &'static str {
        match self {
            Flow::Couette => "couette",
            Flow::Poiseuille => "poiseuille",
        }
    }

    /// The exact velocity at height y and time t of a fluid of viscosity `nu`, where L, V and the viscosity
    /// that V is stated for are 1.
    pub fn exact(self, y: f64, t: f64, nu: f64) -> f64 {
        match self {
            Flow::Couette => Couette { v0: 1.0, l: 1.0, nu }.velocity(y, t),
            Flow::Poiseuille => Poiseuille { v: 1.0 / nu, l: 1.0, nu }.velocity(y, t),
        }
    }
}

/// The numbers of one run, SI units.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The settings they follow from.
    pub settings: ChannelSettings,
    /// What drives the fluid.
    pub flow: Flow,
    /// V = Re ν/L \[m/s\].
    pub v: f64,
    /// Body force along the channel \[m/s²\].
    pub force: f64,
    /// Spacing \[m\].
    pub dx: f64,
    /// Smoothing length \[m\].
    pub h: f64,
    /// Particles along the channel.
    pub columns: usize,
    /// Equation of state, with c0.
    pub eos: Tait,
    /// W(dx) \[1/m²\].
    pub w_at_spacing: f64,
    /// Time step \[s\].
    pub dt: f64,
    /// Its theoretical limit for sound, viscosity and what else damps \[s\].
    pub dt_limit: f64,
}

/// More steps than this are refused.
const MOST_STEPS: f64 = 1e9;
/// A sound speed above the range of the setting is refused, whatever it follows from \[m/s\].
const MOST_SOUND: f64 = 1e6;
/// More particles than this are refused.
const MOST_PARTICLES: f64 = 2e7;

impl Setup {
    /// Follows the rules for the kernel `K`, the integrator `I` and terms that read the optional settings
    /// `uses`.
    pub fn new<K: Kernel, I: Stepping>(
        flow: Flow,
        settings: &ChannelSettings,
        uses: &[&str],
        allow_unstable: bool,
    ) -> Result<Self, RunError> {
        let s = settings;
        let v = s.speed();
        let force = match flow {
            Flow::Couette => 0.0,
            Flow::Poiseuille => 8.0 * s.nu * v / (s.width * s.width),
        };
        let dx = s.width / s.rows as f64;
        let h = s.h_over_dx * dx;
        let columns = if s.columns == 0 { fewest_columns::<K>(s.h_over_dx) } else { s.columns };
        let sound_speed = s.c0.unwrap_or_else(|| sound_speed(s, v, force, h));
        let eos = Tait {
            density: s.rho,
            sound_speed,
            gamma: s.gamma as i32,
            background: s.background * s.rho * sound_speed * sound_speed,
        };
        let courant = s.courant * h / (sound_speed + v);
        let viscous = s.viscous * h * h / s.nu;
        let forced = if force > 0.0 { 0.25 * (h / force).sqrt() } else { f64::INFINITY };
        let dt = s.dt.unwrap_or(courant.min(viscous).min(forced));
        let used = |key: &str, value: f64| if uses.contains(&key) { value } else { 0.0 };
        let (alpha, delta) = (used("alpha", s.alpha), used("diffusion", s.diffusion));
        let medium = Medium { c0: sound_speed, h, nu: s.nu, alpha, delta };
        let lattice = SquareLattice::<K>::new(s.h_over_dx, s.eta2_over_h2);
        let dt_limit =
            time_step::time_step_limit(&time_step::modes(&lattice, LIMIT_BOX, &medium), I::THEORY);
        let w_at_spacing = Smoothing::<K>::new(h).w(dx * dx);
        let setup = Self {
            settings: s.clone(),
            flow,
            v,
            force,
            dx,
            h,
            columns,
            eos,
            w_at_spacing,
            dt,
            dt_limit,
        };
        setup.check::<I>(allow_unstable)?;
        Ok(setup)
    }

    fn check<I: Stepping>(&self, allow_unstable: bool) -> Result<(), RunError> {
        let c0 = self.eos.sound_speed;
        if c0 > MOST_SOUND {
            let (what, setting) = ("the sound speed", "c0, re, nu or width");
            return Err(RunError::TooMuch { what, value: c0, most: MOST_SOUND, setting });
        }
        let (dt, limit) = (self.dt, self.dt_limit);
        if dt > limit && !allow_unstable {
            return Err(RunError::TimeStep { dt, limit, integrator: I::NAME });
        }
        let steps = self.time(self.settings.end) / dt;
        if steps > MOST_STEPS {
            let (what, setting) = ("the number of time steps", "end, dt, c0 or rows");
            return Err(RunError::TooMuch { what, value: steps, most: MOST_STEPS, setting });
        }
        let particles = self.settings.rows as f64 * self.columns as f64;
        if particles > MOST_PARTICLES {
            let (what, setting) = ("the number of particles", "rows or columns");
            return Err(RunError::TooMuch {
                what,
                value: particles,
                most: MOST_PARTICLES,
                setting,
            });
        }
        Ok(())
    }

    /// t \[s\] of νt/L² = `tau`.
    pub fn time(&self, tau: f64) -> f64 {
        tau * (self.settings.width * self.settings.width / self.settings.nu)
    }

    /// Length of the channel section \[m\].
    pub fn length(&self) -> f64 {
        self.columns as f64 * self.dx
    }

    /// Speed of the upper plate \[m/s\].
    pub fn plate_speed(&self) -> f64 {
        if self.flow == Flow::Couette { self.v } else { 0.0 }
    }

    /// The exact velocity \[m/s\] at height y \[m\] and time t \[s\].
    pub fn exact(&self, y: f64, t: f64) -> f64 {
        self.exact_with_viscosity(y, t, self.settings.nu)
    }

    /// The exact velocity \[m/s\] of a fluid of viscosity `nu` \[m²/s\] under the same force.
    pub fn exact_with_viscosity(&self, y: f64, t: f64, nu: f64) -> f64 {
        let (v, l) = (self.v, self.settings.width);
        match self.flow {
            Flow::Couette => Couette { v0: v, l, nu }.velocity(y, t),
            Flow::Poiseuille => {
                let v = self.force * l * l / (8.0 * nu);
                Poiseuille { v, l, nu }.velocity(y, t)
            }
        }
    }

    /// Particles of the section, `count` rows from height `first` \[m\] up, at rest.
    pub fn rows(&self, first: f64, count: usize) -> Vec<Particle> {
        let corner = Vector2::new(0.5 * self.dx, first);
        solver::lattice(corner, self.dx, self.columns, count)
            .map(|x| Particle::fluid(x, Vector2::zeros(), self.settings.rho, self.dx * self.dx))
            .collect()
    }

    /// Particles of both plates: rows out to the support, the first one `first` dx behind the surface,
    /// all with the velocity of the plate. On the surface, at 0, they are of the interface.
    pub fn wall_rows(&self, first: f64, support: f64) -> Vec<Particle> {
        let mut particles = self.rows_behind([0.0, -1.0], 0.0, first, support);
        let (top, speed) = (self.settings.width, self.plate_speed());
        particles.extend(self.rows_behind([top, 1.0], speed, first, support));
        particles
    }

    /// Those of the plate at y, with the fluid on the other side than `outwards`.
    fn rows_behind(
        &self,
        [y, outwards]: [f64; 2],
        speed: f64,
        first: f64,
        support: f64,
    ) -> Vec<Particle> {
        let last = (support / self.dx - first - 1e-9).floor() as usize;
        let mut particles = Vec::new();
        for behind in (0..=last).map(|k| first + k as f64) {
            let role = if behind == 0.0 { Role::Interface } else { Role::Wall };
            for p in self.rows(y + outwards * behind * self.dx, 1) {
                let velocity = Vector2::new(speed, 0.0);
                particles.push(Particle { velocity, ..p }.with_role(role));
            }
        }
        particles
    }
}

/// Particles of the box whose waves give the limit of dt: even, so that it has the stiffest ones.
const LIMIT_BOX: usize = 32;

/// Morris' rule (Morris, Fox & Zhu 1997), and not below `c0_viscous` ν/h.
fn sound_speed(s: &ChannelSettings, v: f64, force: f64, h: f64) -> f64 {
    let inertial = v * v;
    let viscous = s.nu * v / s.width;
    let forced = force * s.width;
    let morris = (inertial.max(viscous).max(forced) / s.density_variation).sqrt();
    morris.max(s.c0_viscous * s.nu / h)
}

/// The fewest particles along a period of at least two supports and the skin.
fn fewest_columns<K: Kernel>(h_over_dx: f64) -> usize {
    (2.0 * K::SUPPORT * h_over_dx - 1e-9).floor() as usize + 1
}
