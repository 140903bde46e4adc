//! The settings of the channel flows, and from them to numbers: the rules for sound speed, time step and
//! arrangement, each stated once.

use std::ops::ControlFlow;

use nalgebra::Vector2;
use touchstone_base::{random::Random, record::Status};
use touchstone_harness::prelude::*;
use touchstone_harness::{case::Step, method::FirstRow, snapshot::Snapshot};
use touchstone_maths::exact::StartUp;
use touchstone_solver::{DivergenceBounds, PlaneWall, Role, Tait};

use super::{COUETTE, ChannelCase, POISEUILLE, TIMES, measure};
use crate::{fluids::unit_flow::LIMIT_BOX, stabilisation::Stabilisation};

touchstone_base::settings! {
    /// Settings of a flow between two plates. Lengths by the width L, times by L²/ν.
    pub struct ChannelSettings {
        /// Reynolds number V L/ν, V the speed of the plate or of the centre line
        re: f64 ["-"] in 1e-9..=1e6 = 0.5,
        /// rows of particles between the plates: spacing dx = L/rows
        rows: usize ["-"] in 4..=2000 = 20,
        /// particles along the channel; 0: the fewest that the kernel allows, because the flow does not
        /// depend on x
        columns: usize ["-"] in 0..=100000 = 0,
        /// distance of the plates L (inferred)
        width: f64 ["m"] in 1e-9..=1e3 = 1e-3,
        /// kinematic viscosity, water
        nu: f64 ["m^2/s"] in 1e-12..=1e3 = 1e-6,
        /// initial density, water
        rho: f64 ["kg/m^3"] in 1e-6..=1e6 = 1000.0,
        /// end of the run
        end: f64 ["L^2/nu"] in 1e-6..=100.0 = 1.0,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.8..=5.0 = 1.2,
        /// guard against 0/0 in the viscous term; the seed's 0.01 lowers the viscosity by about 1 %
        eta2_over_h2: f64 ["-"] in 1e-12..=0.1 = 0.01,
        /// sound speed; auto: the larger one of Morris' rule and c0_viscous ν/h
        c0: Option<f64> ["m/s"] in 1e-12..=1e6 = None,
        /// density variation δ that Morris' rule allows: c0² = max(V², ν V/L, F L)/δ
        density_variation: f64 ["-"] in 1e-8..=1.0 = 0.01,
        /// minimum c0 in units of ν/h; sound at the viscous limit does not shorten the time step
        c0_viscous: f64 ["nu/h"] in 0.0..=100.0 = 0.0,
        /// exponent of the Tait equation
        gamma: usize ["-"] in 1..=20 = 7,
        /// background pressure p0
        background: f64 ["rho c0^2"] in 0.0..=10.0 = 0.0,
        /// time step; auto: the minimum of courant h/(c0 + V), viscous h²/ν (or of limit_share), √(h/F)/4
        dt: Option<f64> ["s"] in 1e-15..=1e3 = None,
        /// Courant number of the time step
        courant: f64 ["-"] in 1e-6..=100.0 = 0.25,
        /// viscous number of the time step
        viscous: f64 ["-"] in 1e-6..=100.0 = 0.125,
        /// time step over its theoretical limit, instead of both numbers; auto: not used
        limit_share: Option<f64> ["-"] in 0.01..=1.0 = None,
        /// minimum number of time steps between two times of comparison
        least_steps: usize ["-"] in 1..=100000 = 1,
        /// ghosts include the curvature -F/ν of the velocity at the wall
        wall_curvature: bool = false,
        /// stabilising terms of the paper
        stabilisation: Stabilisation = Stabilisation::default(),
        /// density diffusion δ
        diffusion: f64 ["-"] in 0.0..=10.0 = 0.1,
        /// particle shifting, amplitude
        shift: f64 ["-"] in 0.0..=10.0 = 0.5,
        /// random displacement of the initial lattice, standard deviation
        jitter: f64 ["dx"] in 0.0..=0.5 = 0.0,
        /// Verlet skin: reach of neighbour lists beyond the support radius
        skin: f64 ["h"] in 0.0..=2.0 = 0.15,
        /// record the lowest pressure mode over the last 60 L/c0; profiles are then compared only at the end
        watch_mode: bool = false,
    }
}

impl ChannelSettings {
    /// V = Re ν/L \[m/s\].
    pub fn speed(&self) -> f64 {
        self.re * self.nu / self.width
    }

    /// L²/ν, the unit of times \[s\].
    pub fn unit_of_time(&self) -> f64 {
        self.width.powi(2) / self.nu
    }

    /// νt/L² at which a run compares its profile with the exact one: [`TIMES`] before its end, and the end.
    pub fn compared(&self) -> Vec<f64> {
        let before = TIMES.into_iter().filter(|tau| *tau < self.end && !self.watch_mode);
        before.chain([self.end]).collect()
    }
}

/// Drive of the fluid.
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

    /// The exact velocity at height y and time t.
    pub fn exact(self, plates: &StartUp, y: f64, t: f64) -> f64 {
        match self {
            Flow::Couette => plates.couette(y, t),
            Flow::Poiseuille => plates.poiseuille(y, t),
        }
    }
}

/// The numbers of one run, SI units.
#[derive(Clone)]
pub struct ChannelSetup {
    /// The settings they follow from.
    pub settings: ChannelSettings,
    /// The method that they are for.
    pub method: Method,
    /// Drive of the fluid.
    pub flow: Flow,
    /// V = Re ν/L \[m/s\].
    pub v: f64,
    /// Body force along the channel \[m/s²\].
    pub force: f64,
    /// Constants of the terms.
    pub medium: Medium,
    /// Particles along the channel.
    pub columns: usize,
    /// Time step, its limits, sound speed, end.
    pub rules: Rules,
}

/// The settings on which time and memory of a run depend.
const DECISIVE: &str = "end, dt, c0, rows or columns";
/// Largest sound speed \[m/s\] that follows from the settings.
const MOST_SOUND: f64 = 1e6;

impl ChannelSetup {
    /// Follows the rules for a method.
    pub fn new(flow: Flow, s: &ChannelSettings, method: &Method) -> Result<Self, RunError> {
        let v = s.speed();
        let force = match flow {
            Flow::Couette => 0.0,
            Flow::Poiseuille => 8.0 * s.nu * v / (s.width * s.width),
        };
        let dx = s.width / s.rows as f64;
        let h = s.h_over_dx * dx;
        // A period of at least two supports.
        let fewest = (2.0 * method.properties.support * s.h_over_dx - 1e-9).floor() as usize + 1;
        let columns = if s.columns == 0 { fewest } else { s.columns };
        if columns < fewest {
            let allowed = format!("a narrower kernel; with this one it is 0 or {fewest} to 100000");
            let (key, value) = ("columns", columns.to_string());
            return Err(RunError::Combination { key, value, allowed });
        }
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
            ..method.properties.medium(eos, dx, h).set_by(s)
        };
        let limits = method.properties.limits_in(&medium, s.h_over_dx, LIMIT_BOX);
        let both = || Step::courant(s.courant, h, [sound_speed, v]).viscous(s.viscous, h, s.nu);
        let stable = s.limit_share.map_or_else(both, |share| Step::share(share, &limits));
        let step = stable.forced(0.25, h, force).or_given(s.dt);
        let (limits, end) = (limits.moving(h, v, force), s.end * s.unit_of_time());
        let rules = Rules { step, limits, sound_speed, end };
        let (settings, method) = (s.clone(), method.clone());
        Ok(Self { settings, method, flow, v, force, medium, columns, rules })
    }

    /// Fluid, then both plates. Rows of the fluid at (j + 1/2) dx, which the walls mirror into each other, or
    /// at j dx between interface rows on the plates, which are rows of the same lattice. Rows of plates
    /// extend to the support, all with the velocity of the plate.
    fn particles(&self, method: &Method) -> Vec<Particle> {
        let (dx, rows, width) = (self.medium.dx, self.settings.rows, self.settings.width);
        let (mut particles, first) = match method.properties.first_row {
            FirstRow::Nowhere => return self.rows(0.5 * dx, rows),
            FirstRow::OnSurface => (self.rows(dx, rows - 1), 0.0),
            FirstRow::Behind => (self.rows(0.5 * dx, rows), 0.5),
        };
        let last = (method.properties.support * self.medium.h / dx - first - 1e-9).floor() as usize;
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
        self.flow.exact(&StartUp { v, l, nu }, y, t)
    }

    /// Particles of the section, `count` rows from height `first` \[m\] up, at rest.
    pub fn rows(&self, first: f64, count: usize) -> Vec<Particle> {
        let dx = self.medium.dx;
        touchstone_solver::lattice(Vector2::new(0.5 * dx, first), dx, self.columns, count)
            .map(|x| Particle::fluid(x, Vector2::zeros(), self.settings.rho, dx * dx))
            .collect()
    }
}

impl Problem for ChannelSetup {
    type Extra = ();
    type Simulation = dyn Stepper<()>;
    /// Time and amplitude of the pressure mode after every step, if requested.
    type Watch = Vec<[f64; 2]>;

    fn method(&self) -> &Method {
        &self.method
    }

    fn brief(&self) -> Brief {
        let (s, Medium { eos, h, dx, .. }) = (&self.settings, self.medium);
        let c0 = eos.sound_speed;
        let own = [("V [m/s]", self.v), ("c0/V", c0 / self.v), ("c0 h/nu", c0 * h / s.nu)];
        let particles = s.rows as f64 * self.columns as f64;
        let mut brief = Brief::new(self.medium, self.rules, particles, DECISIVE)
            .numbers(&self.rules.numbers(s.h_over_dx, dx))
            .numbers(&own);
        brief.numbers.push(("columns", self.columns.into()));
        Brief { least_steps: s.least_steps, ..brief }
    }

    fn times(&self) -> Vec<f64> {
        self.settings.compared().iter().map(|tau| self.time(*tau)).collect()
    }

    fn scene(&self) -> Result<Parts, RunError> {
        let (s, method) = (&self.settings, &self.method);
        let Medium { dx, h, eos, .. } = &self.medium;
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
        let skin = (s.skin * h).min(length - method.properties.support * h).max(0.0);
        // 30 % compression or twice the speed of sound is not a weakly compressible fluid any more.
        let speed = 2.0 * (eos.sound_speed + self.v);
        Ok(Parts {
            mirrors: self.mirrors(),
            skin: Some(skin),
            limits: DivergenceBounds { density: [0.7 * s.rho, 1.3 * s.rho], speed },
            ..Parts::new(self.medium, Domain::channel(length), particles)
        })
    }

    fn watch(&self, _: &Snapshot, _: &Snapshot) -> Self::Watch {
        Vec::new()
    }

    fn calls(&self, calls: Calls<Self>, _: OptionalOutput) -> Calls<Self> {
        calls
            .when(self.settings.watch_mode, |calls| {
                calls.after_step("pressure mode", |setup, mode, now| {
                    mode.extend(measure::pressure_mode(setup, now).map(|p| [now.time(), p]));
                    ControlFlow::Continue(())
                })
            })
            .at("profiles and errors", |setup, _, now, k, record| {
                let tau = setup.settings.compared()[k];
                measure::compare(setup, &now.moving(), tau, record);
            })
    }

    fn measure(&self, mode: Self::Watch, end: &Snapshot, record: &mut Record) {
        if record.status == Status::Completed {
            measure::at_the_end(self, end, record);
        }
        if self.settings.watch_mode {
            measure::last_of_mode(self, &mode, end.time(), record);
        }
    }
}

/// Morris' rule (Morris, Fox & Zhu 1997), and not below `c0_viscous` ν/h.
fn sound_speed(s: &ChannelSettings, v: f64, force: f64, h: f64) -> f64 {
    let driven = (v * v).max(s.nu * v / s.width).max(force * s.width);
    (driven / s.density_variation).sqrt().max(s.c0_viscous * s.nu / h)
}
