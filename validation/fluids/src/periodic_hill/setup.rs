//! From settings to numbers and particles.

use nalgebra::Vector2;
use solver::{
    Domain, ExtrapolatingWall, Integrator, InterfaceWall, Kernel, NoSlip, Particle, Role, Scheme,
    Tait, walls::Walls,
};

use super::{HillSettings, reference::Reference};
use crate::fluid::{Fluid, Ingredient, MOST_STEPS, at_most};
use harness::case::{Rules, RunError};
use maths::{
    geometry::{Curve, Hill},
    theory::Stepping,
};

/// Gap over the crest of the reference \[H\]: with U_b = 1 the flux per depth.
pub const FLUX: f64 = 2.035;

/// The numbers of one run, H = U_b = ρ = 1.
pub struct Setup {
    /// The settings they follow from.
    pub settings: HillSettings,
    /// The channel.
    pub hill: Hill,
    /// What terms are made from.
    pub fluid: Fluid,
    /// Time step \[s\].
    pub dt: f64,
    /// Its theoretical limit on a lattice at rest \[s\].
    pub dt_limit: f64,
    /// What to compare with, where there is something.
    pub reference: Option<Reference>,
}

/// The most that h' is, rounded up: sets the least height of a column.
const MOST_PARTICLES: f64 = 1e7;

impl Setup {
    /// Follows the rules for the scheme `S`.
    pub fn new<S>(settings: &HillSettings, allow_unstable: bool) -> Result<Self, RunError>
    where
        S: Scheme<Extra = ()>,
        S::Drift: Ingredient,
        S::Integrator: Stepping,
    {
        let s = settings;
        let (dx, nu) = (1.0 / s.n as f64, 1.0 / s.re);
        let h = s.h_over_dx * dx;
        let background = s.background * s.c0 * s.c0;
        let eos = Tait { gamma: s.gamma as i32, background, ..Tait::new(1.0, s.c0) };
        let w_at_spacing = Fluid::w_at_spacing::<S::Kernel>(h, dx);
        let (eta2_over_h2, diffusion, shift, force) =
            (s.eta2_over_h2, s.diffusion, s.shift, s.force);
        let fluid = Fluid { nu, eos, dx, h, eta2_over_h2, diffusion, shift, force, w_at_spacing };
        // The largest speed, over the crest, is below 1.6 U_b.
        let dt = (s.courant * h / (s.c0 + 1.6)).min(s.viscous * h * h / nu);
        let is_diffused = S::Drift::uses().contains(&"diffusion");
        let dt_limit = fluid.time_step_limit::<S::Kernel, S::Integrator>(is_diffused);
        let hill = Hill::new(1.0).map_err(|e| RunError::Reference(e.to_string()))?;
        let reference = Reference::of(s).map_err(|e| RunError::Reference(e.to_string()))?;
        let setup = Self { settings: s.clone(), hill, fluid, dt, dt_limit, reference };
        setup.check::<S::Integrator>(allow_unstable)?;
        Ok(setup)
    }

    fn check<I: Integrator<()>>(&self, allow_unstable: bool) -> Result<(), RunError> {
        let (dt, limit) = (self.dt, self.dt_limit);
        if dt > limit && !allow_unstable {
            return Err(RunError::TimeStep { dt, limit, integrator: I::NAME });
        }
        let particles = 27.0 / (self.fluid.dx * self.fluid.dx);
        let steps = self.settings.end / dt;
        at_most("the number of time steps", steps, MOST_STEPS, "end, c0 or n")?;
        at_most("the number of particles", particles, MOST_PARTICLES, "n")
    }

    /// What the rules chose.
    pub fn rules(&self) -> Rules {
        let Self { dt, dt_limit, .. } = *self;
        Rules { dt, dt_limit, sound_speed: self.fluid.eos.sound_speed }
    }

    /// Height of the floor at x \[m\].
    pub fn floor(&self, x: f64) -> f64 {
        self.settings.crest * self.hill.wall(x)
    }

    /// Slope of the floor at x, by a difference over 2e-5 H.
    pub fn slope(&self, x: f64) -> f64 {
        (self.floor(x + 1e-5) - self.floor(x - 1e-5)) / 2e-5
    }

    /// The flux wanted \[m²/s\].
    pub fn flux(&self) -> f64 {
        self.settings.flux * FLUX
    }

    /// Area of the fluid \[m²\], midpoint rule.
    pub fn area(&self) -> f64 {
        let (count, lid, period) = (9000, self.hill.lid(), self.hill.period());
        let cell = period / f64::from(count);
        (0..count).map(|k| (lid - self.floor((f64::from(k) + 0.5) * cell)) * cell).sum()
    }

    /// The period along x.
    pub fn domain(&self) -> Domain {
        Domain::channel(self.hill.period())
    }

    /// Fluid in columns dx apart, each with as many particles as come nearest to a spacing of dx between
    /// floor and lid, and of such a volume that they fill it; behind floor and lid rows along them.
    pub fn particles<K: Kernel, W: HillWall>(&self) -> Vec<Particle> {
        let (dx, lid) = (self.fluid.dx, self.hill.lid());
        let columns = (self.hill.period() / dx).round() as usize;
        let width = self.hill.period() / columns as f64;
        let mut particles = Vec::new();
        for i in 0..columns {
            let x = (i as f64 + 0.5) * width;
            let (floor, gap) = (self.floor(x), lid - self.floor(x));
            let count = (gap / dx).round().max(2.0);
            let spacing = gap / count;
            let first = if W::FIRST == 0.0 { 1 } else { 0 };
            for k in first..count as usize {
                let y = floor + (k as f64 + W::FIRST) * spacing;
                let place = Vector2::new(x, y);
                let velocity = self.start(place, (y - floor) / gap, gap);
                particles.push(Particle::fluid(place, velocity, 1.0, width * spacing));
            }
        }
        let support = K::SUPPORT * self.fluid.h;
        for curve in self.curves() {
            for row in curve.rows_behind(dx, W::FIRST, support) {
                let role = if row.depth == 0.0 { Role::Interface } else { Role::Wall };
                let volume = row.spacing * dx;
                let particle = |x: &Vector2<f64>| {
                    Particle::fluid(*x, Vector2::zeros(), 1.0, volume).with_role(role)
                };
                particles.extend(row.points.iter().map(particle));
            }
        }
        particles
    }

    /// Floor and lid, the fluid on their left.
    fn curves(&self) -> [Curve; 2] {
        let (dx, period, lid) = (self.fluid.dx, self.hill.period(), self.hill.lid());
        let floor = Curve::new(|x| Vector2::new(x, self.floor(x)), [0.0, period], dx);
        [floor, Curve::new(|x| Vector2::new(x, lid), [period, 0.0], dx)]
    }

    /// The velocity at the start \[m/s\], s the height over that of the section, which is `gap`.
    fn start(&self, place: Vector2<f64>, s: f64, gap: f64) -> Vector2<f64> {
        match &self.reference {
            Some(reference) if self.settings.from_reference => reference.velocity(place.x, s, gap),
            _ => Vector2::zeros(),
        }
    }
}

/// Walls that can follow a curve.
pub trait HillWall: Walls<()> {
    /// The name in reports.
    const NAME: &'static str;
    /// Depth of the first row \[dx\]: 0 for interface particles on the wall.
    const FIRST: f64;
    /// The walls.
    fn walls(setup: &Setup) -> Self;
}

impl HillWall for InterfaceWall {
    const NAME: &'static str = "interface-wall";
    const FIRST: f64 = 0.0;
    fn walls(_: &Setup) -> Self {
        Self
    }
}

impl HillWall for ExtrapolatingWall<Tait, NoSlip> {
    const NAME: &'static str = "extrapolating-wall";
    const FIRST: f64 = 0.5;
    /// Without the body force: over a spacing it is 1 % of the pressure of the flow and less.
    fn walls(setup: &Setup) -> Self {
        Self::no_slip(setup.fluid.eos, Vector2::zeros())
    }
}
