//! From settings to numbers: the rules for sound speed, time step and arrangement, each stated once.

use base::random::Random;
use harness::{case::*, context::Context, method::*, simulate};
use maths::exact::StartUp;
use nalgebra::Vector2;
use solver::{Domain, Limits, Particle, PlaneWall, Role, Tait};

use crate::unit_flow::LIMIT_BOX;

use super::{COUETTE, ChannelCase, ChannelSettings, POISEUILLE};

/// What drives the fluid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// The upper plate moves at V from t = 0.
    Couette,
    /// A body force F = 8 ν V/L² acts from t = 0.
    Poiseuille,
}

impl Flow {
    /// Its case.
    pub fn case(self) -> &'static ChannelCase {
        match self {
            Flow::Couette => &COUETTE,
            Flow::Poiseuille => &POISEUILLE,
        }
    }

    /// νt/L² of the error that ladders are judged by.
    pub fn compared_at(self) -> f64 {
        if self == Flow::Couette { 0.1 } else { 1.0 }
    }

    /// The exact velocity at height y and time t where V, the width and ν are these.
    pub fn exact(self, y: f64, t: f64, [v, l, nu]: [f64; 3]) -> f64 {
        let flow = StartUp { v, l, nu };
        match self {
            Flow::Couette => flow.couette(y, t),
            Flow::Poiseuille => flow.poiseuille(y, t),
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
    /// What terms are made from.
    pub medium: Medium,
    /// Particles along the channel.
    pub columns: usize,
    /// Time step, its limits, sound speed, end.
    pub rules: Rules,
}

/// The settings on which time and memory of a run depend.
const DECISIVE: &str = "end, dt, c0, rows or columns";
/// A sound speed above the range of the setting is refused, whatever it follows from \[m/s\].
const MOST_SOUND: f64 = 1e6;

impl Setup {
    /// Follows the rules for a method.
    pub fn new(
        flow: Flow,
        s: &ChannelSettings,
        method: &Method,
        context: &Context,
    ) -> Result<Self, RunError> {
        let v = s.speed();
        let force = match flow {
            Flow::Couette => 0.0,
            Flow::Poiseuille => 8.0 * s.nu * v / (s.width * s.width),
        };
        let dx = s.width / s.rows as f64;
        let h = s.h_over_dx * dx;
        // A period of at least two supports.
        let fewest = (2.0 * method.support * s.h_over_dx - 1e-9).floor() as usize + 1;
        let columns = if s.columns == 0 { fewest } else { s.columns };
        let sound_speed = s.c0.unwrap_or_else(|| sound_speed(s, v, force, h));
        if sound_speed > MOST_SOUND {
            let (what, setting) = ("the sound speed", "c0, re, nu or width");
            return Err(RunError::TooMuch { what, value: sound_speed, most: MOST_SOUND, setting });
        }
        let background = s.background * s.rho * sound_speed * sound_speed;
        let eos = Tait { gamma: s.gamma as i32, background, ..Tait::new(s.rho, sound_speed) };
        let along = Vector2::new(force, 0.0);
        let medium = Medium {
            nu: s.nu,
            acceleration: along,
            wall_acceleration: along,
            ..method.medium(eos, [dx, h]).set_by(s)
        };
        let waves = medium.waves(&method.uses);
        let limits = method.limits([s.h_over_dx, s.eta2_over_h2], LIMIT_BOX, &waves);
        let both = || Step::courant(s.courant, h, [sound_speed, v]).viscous(s.viscous, h, s.nu);
        let stable = s.limit_share.map_or_else(both, |share| Step::share(share, &limits));
        let step = stable.forced(0.25, h, force).or_given(s.dt);
        let (limits, end) = (limits.moving(h, v, force), s.end * s.unit_of_time());
        let rules = Rules { step, limits, sound_speed, end };
        let particles = s.rows as f64 * columns as f64;
        simulate::check(method, &medium, &rules, particles, DECISIVE, context)?;
        Ok(Self { settings: s.clone(), flow, v, force, medium, columns, rules })
    }

    /// The scene.
    pub fn parts(&self, method: &Method, context: &Context) -> Parts {
        let (s, Medium { dx, h, eos, .. }) = (&self.settings, &self.medium);
        let mut particles = self.particles(method);
        let mut random = Random::new(1);
        for p in particles.iter_mut().filter(|p| p.role == Role::Fluid && s.jitter > 0.0) {
            let offset = Vector2::new(random.normal(), random.normal());
            p.position += offset * (s.jitter * dx);
            // Gaussian tails must not put a particle behind a wall.
            p.position.y = p.position.y.clamp(0.1 * dx, s.width - 0.1 * dx);
        }
        let length = self.columns as f64 * dx;
        // Half a period at most; one that is shorter than two supports is refused by the scene itself.
        let skin = (s.skin * h).min(length - method.support * h).max(0.0);
        // 30 % compression or twice the speed of sound is not a weakly compressible fluid any more.
        let speed = 2.0 * (eos.sound_speed + self.v);
        Parts {
            mirrors: self.mirrors(),
            skin: Some(skin),
            limits: Limits { density: [0.7 * s.rho, 1.3 * s.rho], speed },
            ..Parts::new(self.medium, Domain::channel(length), particles, context)
        }
    }

    /// Fluid, then both plates. Rows of the fluid at (j + 1/2) dx, mirrored by the walls into themselves, or
    /// at j dx between interface rows on the plates, which are rows of the same lattice. Rows of plates reach
    /// out to the support, all with the velocity of the plate.
    fn particles(&self, method: &Method) -> Vec<Particle> {
        let (dx, rows, width) = (self.medium.dx, self.settings.rows, self.settings.width);
        let (mut particles, first) = match method.first_row {
            FirstRow::Nowhere => return self.rows(0.5 * dx, rows),
            FirstRow::OnSurface => (self.rows(dx, rows - 1), 0.0),
            FirstRow::Behind => (self.rows(0.5 * dx, rows), 0.5),
        };
        let last = (method.support * self.medium.h / dx - first - 1e-9).floor() as usize;
        for (y, outwards, speed) in [(0.0, -1.0, 0.0), (width, 1.0, self.plate_speed())] {
            for behind in (0..=last).map(|k| first + k as f64) {
                let role = if behind == 0.0 { Role::Interface } else { Role::Wall };
                let velocity = Vector2::new(speed, 0.0);
                let row = self.rows(y + outwards * behind * dx, 1).into_iter();
                particles.extend(row.map(|p| Particle { velocity, ..p }.with_role(role)));
            }
        }
        particles
    }

    fn mirrors(&self) -> Vec<PlaneWall> {
        let s = &self.settings;
        let along = |speed| Vector2::new(speed, 0.0);
        let mut lower = PlaneWall::new(Vector2::zeros(), Vector2::y(), along(0.0));
        let top = Vector2::new(0.0, s.width);
        let mut upper = PlaneWall::new(top, -Vector2::y(), along(self.plate_speed()));
        if s.wall_curvature {
            lower.curvature = along(-self.force / s.nu);
            upper.curvature = lower.curvature;
        }
        vec![lower, upper]
    }

    /// t \[s\] of νt/L² = `tau`.
    pub fn time(&self, tau: f64) -> f64 {
        tau * (self.settings.width * self.settings.width / self.settings.nu)
    }

    /// Speed of the upper plate \[m/s\].
    pub fn plate_speed(&self) -> f64 {
        if self.flow == Flow::Couette { self.v } else { 0.0 }
    }

    /// The exact velocity \[m/s\] at height y \[m\] and time t \[s\].
    pub fn exact(&self, y: f64, t: f64) -> f64 {
        let (l, nu) = (self.settings.width, self.settings.nu);
        let v = match self.flow {
            Flow::Couette => self.v,
            Flow::Poiseuille => self.force * l * l / (8.0 * nu),
        };
        self.flow.exact(y, t, [v, l, nu])
    }

    /// Particles of the section, `count` rows from height `first` \[m\] up, at rest.
    pub fn rows(&self, first: f64, count: usize) -> Vec<Particle> {
        let dx = self.medium.dx;
        solver::lattice(Vector2::new(0.5 * dx, first), dx, self.columns, count)
            .map(|x| Particle::fluid(x, Vector2::zeros(), self.settings.rho, dx * dx))
            .collect()
    }
}

/// Morris' rule (Morris, Fox & Zhu 1997), and not below `c0_viscous` ν/h.
fn sound_speed(s: &ChannelSettings, v: f64, force: f64, h: f64) -> f64 {
    let driven = (v * v).max(s.nu * v / s.width).max(force * s.width);
    (driven / s.density_variation).sqrt().max(s.c0_viscous * s.nu / h)
}
