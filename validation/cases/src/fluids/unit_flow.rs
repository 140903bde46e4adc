//! Flows whose length, velocity and density are 1: the settings, methods and rules that the flow over hills
//! and the vortices have in common.

use nalgebra::Vector2;
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::Step,
    method::{FirstRow, Properties},
};
use touchstone_solver::{DivergenceBounds, PlaneWall, Role, Tait};

touchstone_base::settings! {
    /// The numerical settings that all these flows have.
    pub struct Numerics {
        /// guard against 0/0 in the viscous term
        eta2_over_h2: f64 ["-"] in 1e-12..=0.1 = 1e-6,
        /// exponent of the Tait equation
        gamma: usize ["-"] in 1..=20 = 7,
        /// background pressure p0
        background: f64 ["rho c0^2"] in 0.0..=10.0 = 0.0,
        /// Courant number of the time step: two thirds of the theoretical limit
        courant: f64 ["-"] in 1e-6..=100.0 = 1.5,
        /// viscous number of the time step
        viscous: f64 ["-"] in 1e-6..=100.0 = 0.25,
        /// density diffusion δ
        diffusion: f64 ["-"] in 0.0..=10.0 = 0.1,
        /// particle shifting, amplitude
        shift: f64 ["-"] in 0.0..=10.0 = 0.5,
        /// Verlet skin: reach of neighbour lists beyond the support radius
        skin: f64 ["h"] in 0.0..=2.0 = 0.6,
    }
}

/// The scales of a flow: additions of a case to the numerical settings.
#[derive(Clone, Copy, Debug)]
pub struct FlowScales {
    /// Reynolds number, 1/ν.
    pub re: f64,
    /// Spacings per unit length.
    pub n: usize,
    /// Smoothing length over spacing.
    pub h_over_dx: f64,
    /// Sound speed \[m/s\].
    pub c0: f64,
    /// End of the run \[s\].
    pub end: f64,
    /// Largest speed of the flow \[m/s\].
    pub speed: f64,
    /// Body force along x \[m/s²\].
    pub force: f64,
    /// Area of the flow, which gives the number of particles \[m²\].
    pub area: f64,
    /// Time step, unless it follows from the settings \[s\].
    pub dt: Option<f64>,
}

/// The numbers of one run.
#[derive(Clone, Debug)]
pub struct UnitFlow {
    /// Constants of the terms.
    pub medium: Medium,
    /// Support radius \[m\].
    pub support: f64,
    /// Time step, its theoretical limit on a lattice at rest, sound speed.
    pub rules: Rules,
    /// About how many particles there are.
    pub particles: f64,
    /// h/dx as it is set: h over dx differs from it by round-off.
    h_over_dx: f64,
    speed: f64,
    skin: f64,
}

/// The settings on which time and memory of a run depend.
pub const DECISIVE: &str = "end, courant, c0 or n";
/// Particles of the box whose waves give the limit of dt: even, so that it has the stiffest ones.
pub const LIMIT_BOX: usize = 32;

impl UnitFlow {
    /// Follows the rules for a method.
    pub fn new(method: &Properties, numerics: &Numerics, scales: FlowScales) -> Self {
        let FlowScales { re, n, h_over_dx, c0, end, speed, force, area, dt } = scales;
        let (dx, nu) = (1.0 / n as f64, 1.0 / re);
        let h = h_over_dx * dx;
        let background = numerics.background * c0 * c0;
        let eos = Tait { gamma: numerics.gamma as i32, background, ..Tait::new(1.0, c0) };
        let acceleration = Vector2::new(force, 0.0);
        let medium = Medium { nu, acceleration, ..method.medium(eos, dx, h).set_by(numerics) };
        let step = Step::courant(numerics.courant, h, [c0, speed]).viscous(numerics.viscous, h, nu);
        let limits = method.limits_in(&medium, h / dx, LIMIT_BOX).moving(h, speed, force);
        let step = step.or_given(dt);
        let rules = Rules { step, limits, sound_speed: c0, end };
        let particles = area / (dx * dx);
        let (support, skin) = (method.support * h, numerics.skin * h);
        Self { medium, support, rules, particles, h_over_dx, speed, skin }
    }

    /// Data of its run that need no particles.
    pub fn brief(&self) -> Brief {
        let dx = self.medium.dx;
        Brief::new(self.medium, self.rules, self.particles, DECISIVE)
            .numbers(&self.rules.numbers(self.h_over_dx, dx))
    }

    /// A square of fluid between plane walls at rest at y = 0 and y = 1, periodic along x: `of` makes the
    /// particle at a place, also on and behind walls of particles.
    pub fn between_walls(
        &self,
        first_row: FirstRow,
        of: impl Fn(Vector2<f64>) -> Particle,
    ) -> Parts {
        let dx = self.medium.dx;
        let count = (1.0 / dx).round() as usize;
        let row = |y: f64, role: Role| {
            let places = touchstone_solver::lattice(Vector2::new(0.5 * dx, y), dx, count, 1);
            places.map(|x| of(x).with_role(role)).collect::<Vec<Particle>>()
        };
        let (first, depth) = (first_row.fluid(), first_row.depth());
        let rows = count + 1 - (2.0 * first) as usize;
        let fluid = (0..rows).flat_map(|k| row((first + k as f64) * dx, Role::Fluid));
        let behind = match first_row {
            FirstRow::Nowhere => 0,
            _ => (self.support / dx - depth - 1e-9).floor() as usize + 1,
        };
        let wall = (0..behind).map(|k| depth + k as f64).flat_map(|behind| {
            let role = if behind == 0.0 { Role::Interface } else { Role::Wall };
            [-behind * dx, 1.0 + behind * dx].map(|y| row(y, role)).concat()
        });
        let mirror = |y, normal| PlaneWall::new(Vector2::new(0.0, y), normal, Vector2::zeros());
        let mirrors = vec![mirror(0.0, Vector2::y()), mirror(1.0, -Vector2::y())];
        Parts { mirrors, ..self.parts(Domain::channel(1.0), fluid.chain(wall).collect()) }
    }

    /// The scene of these particles.
    pub fn parts(&self, domain: Domain, particles: Vec<Particle>) -> Parts {
        // 30 % compression or twice the speed of sound is not a weakly compressible fluid any more.
        let speed = 2.0 * (self.speed + self.rules.sound_speed);
        let limits = DivergenceBounds { density: [0.7, 1.3], speed };
        let parts = Parts::new(self.medium, domain, particles);
        Parts { skin: Some(self.skin), limits, ..parts }
    }
}
