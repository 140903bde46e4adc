//! From settings to the water and its tank.

use nalgebra::Vector2;
use solver::{Domain, Particle, Tait, lattice};

use super::HydrostaticSettings;
use crate::water::{self, WaterMethod};
use base::random::Random;
use harness::{
    case::{Rules, RunError, Step},
    context::Context,
    method::{FirstRow, Medium, Parts},
    simulate,
};
use maths::{exact, geometry};

/// Spacings from the surface of the water to the rim of the tank.
const FREEBOARD: usize = 4;
/// Particles of the box whose waves give the limit of dt.
const LIMIT_BOX: usize = 32;
/// The settings on which time and memory of a run depend.
const DECISIVE: &str = "end, courant, rows or columns";

/// The numbers of one run, SI units.
pub struct Column {
    /// The settings.
    pub settings: HydrostaticSettings,
    /// The exact solution.
    pub exact: exact::Hydrostatic,
    /// Water, gravity, smoothing length.
    pub medium: Medium,
    /// Time step and its theoretical limit.
    pub rules: Rules,
    /// Where its first row is, from bottom and sides \[dx\].
    first: f64,
}

impl Column {
    /// The numbers for a method, or why they are refused.
    pub fn new(
        s: &HydrostaticSettings,
        method: &WaterMethod,
        context: &Context,
    ) -> Result<Self, RunError> {
        let c0 = (s.g * s.depth / s.compressibility).sqrt();
        let gamma = s.gamma as i32;
        let exact = exact::Hydrostatic {
            density: s.rho,
            sound_speed: c0,
            gamma: f64::from(gamma),
            gravity: s.g,
        };
        let dx = s.depth / s.rows as f64;
        let h = s.h_over_dx * dx;
        let down = Vector2::new(0.0, -s.g);
        let medium = Medium {
            acceleration: down,
            wall_acceleration: down * s.wall_gravity,
            alpha: s.alpha,
            beta: s.beta,
            xsph: s.xsph,
            xi: s.xi,
            exponent: s.exponent as u32,
            diffusion: s.diffusion,
            ..method.medium(Tait { gamma, ..Tait::new(s.rho, c0) }, [dx, h])
        };
        let fastest = exact.sound_speed(s.depth);
        let limits = water::limits(method, &medium, [s.h_over_dx, fastest], LIMIT_BOX);
        let (limits, step) =
            (limits.moving(h, 0.0, s.g), Step::courant(s.courant, h, [fastest, 0.0]));
        let period = 4.0 * s.depth / c0;
        let rules = Rules { step, limits, sound_speed: c0, end: s.end * period };
        let first = method.first_row.fluid();
        let column = Self { settings: s.clone(), exact, medium, rules, first };
        let particles = s.rows as f64 * s.columns as f64;
        simulate::check(method, &medium, &rules, particles, DECISIVE, context)?;
        Ok(column)
    }

    /// The acoustic period 4 H/c₀ \[s\].
    pub fn period(&self) -> f64 {
        4.0 * self.settings.depth / self.medium.eos.sound_speed
    }

    /// End of the run \[s\].
    pub fn end(&self) -> f64 {
        self.rules.end
    }

    /// The tank.
    pub fn tank(&self) -> geometry::Tank {
        let s = &self.settings;
        geometry::Tank { columns: s.columns, rows: s.rows + FREEBOARD, dx: self.medium.dx }
    }

    /// Height of the surface \[m\], half a spacing above the highest row.
    fn level(&self) -> f64 {
        (self.settings.rows as f64 + 0.5 - self.first) * self.medium.dx
    }

    /// The exact pressure at the place of a particle \[Pa\].
    pub fn exact_pressure(&self, p: &Particle) -> f64 {
        self.exact.pressure(self.level() - p.position.y)
    }

    /// A particle that does not move, with the density that is exact at its place, or that of the
    /// surface.
    fn at_rest(&self, place: Vector2<f64>) -> Particle {
        let depth = if self.settings.uniform { 0.0 } else { self.level() - place.y };
        let (density, dx) = (self.exact.density(depth), self.medium.dx);
        Particle::fluid(place, Vector2::zeros(), density, dx * dx)
    }

    /// The water.
    fn water(&self, walls: FirstRow) -> Vec<Particle> {
        let (s, dx) = (&self.settings, self.medium.dx);
        // Rows between rows on the walls are one less than spacings.
        let fewer = usize::from(walls == FirstRow::OnSurface);
        let first = Vector2::repeat(self.first * dx);
        let mut random = Random::new(1);
        let mut jitter = || (2.0 * random.uniform() - 1.0) * s.jitter * dx;
        lattice(first, dx, s.columns - fewer, s.rows - fewer)
            .map(|x| self.at_rest(x + Vector2::new(jitter(), jitter())))
            .collect()
    }

    /// The scene. Particles of walls have the density of the water that would be in their place: that of the
    /// interface is frozen, and what others push with is their mass by p/ρ², so that with the mass of the
    /// surface a compressed column would sink into the bottom.
    pub fn parts(&self, method: &WaterMethod, context: &Context) -> Parts {
        let (medium, tank) = (self.medium, self.tank());
        let mut particles = self.water(method.first_row);
        let walls = water::wall_particles(method.first_row, &tank, method.support * medium.h);
        let at_rest = |(place, role)| self.at_rest(place).with_role(role);
        particles.extend(walls.into_iter().map(at_rest));
        let parts = Parts::new(medium, Domain::open(), particles, context);
        Parts { mirrors: tank.mirrors(), ..parts }
    }
}
