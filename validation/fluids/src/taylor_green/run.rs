//! One run of the vortices: scene, stepping, record.

use nalgebra::Vector2;
use solver::{
    Domain, EquationOfState, Integrator, Kernel, Limits, Open, Particle, Scene, Scheme, Simulation,
    Stepper, Tait,
};

use super::VortexSettings;
use crate::fluid::{self, Fluid, Ingredient, MOST_STEPS, at_most};
use base::{
    random::Random,
    record::{Profile, Record, Status},
};
use harness::{
    case::{Rules, RunError},
    runner::{self, Context},
};
use maths::{exact::TaylorGreen, theory::Stepping};

/// The numbers of one run, L = U = ρ = 1.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The settings they follow from.
    pub settings: VortexSettings,
    /// The flow.
    pub exact: TaylorGreen,
    /// What terms are made from.
    pub fluid: Fluid,
    /// Time step \[s\].
    pub dt: f64,
    /// Its theoretical limit on a lattice at rest \[s\].
    pub dt_limit: f64,
}

base::metrics! {
    L2 = "l2" ["-"] "(sum |v - v_exact|^2/sum |v_exact|^2)^(1/2) over particles at the end";
    L2_WORST = "l2_worst" ["-"] "largest l2 over 40 times";
    ENERGY = "energy" ["-"] "kinetic energy over the exact one at the end, less 1";
    NU_EFF = "nu_eff" ["-"] "log of the fall of kinetic energy over that of the exact one";
    MOMENTUM = "momentum" ["-"]
        "|sum m v|/(sum m U) at the end: that of a disturbed start, and what the run added";
    MOMENTUM_ADDED = "momentum_added" ["-"]
        "|sum m v at the end - sum m v at the start|/(sum m U), exactly 0";
    PRESSURE_L2 = "pressure_l2" ["-"] "(sum (p - mean - p_exact)^2/sum p_exact^2)^(1/2) at the end";
    VOLUME_DRIFT = "volume_drift" ["-"] "sum(m/rho)/L^2 - 1 at the end";
    NEAREST = "nearest" ["-"] "least distance of two particles over dx";
}

impl Setup {
    /// Follows the rules for the scheme `S`.
    pub fn new<S>(settings: &VortexSettings, allow_unstable: bool) -> Result<Self, RunError>
    where
        S: Scheme<Extra = ()>,
        S::Drift: Ingredient,
        S::Integrator: Stepping,
    {
        let s = settings;
        let (dx, nu) = (1.0 / s.n as f64, 1.0 / s.re);
        let h = s.h_over_dx * dx;
        let eos = Tait {
            gamma: s.gamma as i32,
            background: s.background * s.c0 * s.c0,
            ..Tait::new(1.0, s.c0)
        };
        let w_at_spacing = Fluid::w_at_spacing::<S::Kernel>(h, dx);
        let fluid = Fluid {
            nu,
            eos,
            dx,
            h,
            eta2_over_h2: s.eta2_over_h2,
            diffusion: s.diffusion,
            shift: s.shift,
            force: 0.0,
            w_at_spacing,
        };
        let dt = s.dt.unwrap_or((s.courant * h / (s.c0 + 1.0)).min(s.viscous * h * h / nu));
        let is_diffused = S::Drift::uses().contains(&"diffusion");
        let dt_limit = fluid.time_step_limit::<S::Kernel, S::Integrator>(is_diffused);
        if dt > dt_limit && !allow_unstable {
            let (limit, integrator) = (dt_limit, S::Integrator::NAME);
            return Err(RunError::TimeStep { dt, limit, integrator });
        }
        let setting = "end, dt, c0 or n";
        at_most("the number of time steps", s.end / dt, MOST_STEPS, setting)?;
        let exact = TaylorGreen { speed: 1.0, length: 1.0, nu, rho: 1.0 };
        Ok(Self { settings: s.clone(), exact, fluid, dt, dt_limit })
    }

    /// What the rules chose.
    pub fn rules(&self) -> Rules {
        let Self { dt, dt_limit, .. } = *self;
        Rules { dt, dt_limit, sound_speed: self.fluid.eos.sound_speed }
    }

    /// Particles of equal volume with the velocity and the pressure of the flow at their places.
    fn particles(&self) -> Vec<Particle> {
        let (s, dx) = (&self.settings, self.fluid.dx);
        let mut random = Random::new(s.seed as u64);
        let mut shake = || s.perturb * dx * (2.0 * random.uniform() - 1.0);
        solver::lattice(Vector2::repeat(0.5 * dx), dx, s.n, s.n)
            .map(|x| x + Vector2::new(shake(), shake()))
            .map(|x| {
                let pressure = self.exact.pressure(x, 0.0) + self.fluid.eos.background;
                let density = self.fluid.eos.density(pressure);
                Particle::fluid(x, self.exact.velocity(x, 0.0), density, dx * dx)
            })
            .collect()
    }
}

/// The scene of a setup, in the scheme `S`.
pub fn scene<S>(setup: &Setup) -> Scene<S>
where
    S: Scheme<Extra = (), Walls = Open>,
    S::Forces: Ingredient,
    S::Drift: Ingredient,
{
    let fluid = &setup.fluid;
    let (forces, drift) = (S::Forces::new(fluid), S::Drift::new(fluid));
    let domain = Domain::torus(1.0, 1.0);
    let mut scene = Scene::new(fluid.h, domain, setup.particles(), forces, drift, Open);
    scene.skin = setup.settings.skin * fluid.h;
    // 30 % compression or twice the speed of sound is not a weakly compressible fluid any more.
    scene.limits = Limits { density: [0.7, 1.3], speed: 2.0 * (1.0 + fluid.eos.sound_speed) };
    scene
}

/// Runs the scheme `S` and measures.
pub fn run<S>(
    variant: &str,
    settings: &VortexSettings,
    context: &Context,
) -> Result<Record, RunError>
where
    S: Scheme<Extra = (), Walls = Open>,
    S::Forces: Ingredient,
    S::Drift: Ingredient,
    S::Integrator: Stepping,
{
    let setup = Setup::new::<S>(settings, context.allow_unstable)?;
    run_scene(&setup, variant, scene::<S>(&setup), context)
}

/// Samples of the series.
const SAMPLES: usize = 40;

/// Runs a scene and measures it against the setup: the same measuring for a scene that is not what
/// its settings say.
pub fn run_scene<S: Scheme<Extra = ()>>(
    setup: &Setup,
    variant: &str,
    mut scene: Scene<S>,
    context: &Context,
) -> Result<Record, RunError> {
    if context.threads <= 1 {
        scene.parallel_from = usize::MAX;
    }
    let mut simulation = scene.build()?;
    let json = serde_json::to_value(&setup.settings).unwrap_or_default();
    let mut record = Record::new(super::NAME, variant, json, context.threads.max(1));
    describe(setup, [S::Kernel::NAME, S::Integrator::NAME], &mut record);
    let end = setup.settings.end;
    let times: Vec<f64> = (1..=SAMPLES).map(|k| end * k as f64 / SAMPLES as f64).collect();
    let mut series = vec![Sample::of(setup, &simulation)];
    let pressure = |density| setup.fluid.eos.pressure(density);
    let mut sample = |simulation: &mut Simulation<S>, _| {
        series.push(Sample::of(setup, simulation));
    };
    let (status, cost) =
        runner::drive(&mut simulation, setup.dt, &times, context, &mut (), &pressure, &mut sample)?;
    if status == Status::Completed {
        measure(setup, &simulation, &series, &mut record);
        if context.keep_particles {
            record.profiles.insert("particles".into(), particles(setup, &simulation));
        }
    }
    record.profiles.insert("series".into(), profile(&series));
    record.state = Some(harness::simulate::state(&simulation.particles()));
    (record.status, record.cost) = (status, cost);
    Ok(record)
}

/// What the run chose.
fn describe(setup: &Setup, [kernel, integrator]: [&str; 2], record: &mut Record) {
    let Fluid { dx, h, eos, .. } = setup.fluid;
    let numbers = [
        ("h/dx", h / dx),
        ("dx [m]", dx),
        ("c0 [m/s]", eos.sound_speed),
        ("dt [s]", setup.dt),
        ("dt/limit", setup.dt / setup.dt_limit),
    ];
    let words = [("kernel", kernel), ("integrator", integrator)];
    fluid::describe(&numbers, &words, record);
}

/// The flow at one time.
#[derive(Clone, Copy, Debug)]
struct Sample {
    time: f64,
    /// Relative L2 error of the velocity vector.
    error: f64,
    /// Kinetic energy over the exact one.
    energy: f64,
    /// Total momentum over total mass \[U\].
    momentum: Vector2<f64>,
}

impl Sample {
    fn of(setup: &Setup, simulation: &dyn Stepper<()>) -> Self {
        let time = simulation.time();
        let (mut difference, mut scale, mut energy, mut mass) = (0.0, 0.0, 0.0, 0.0);
        for p in simulation.particles() {
            let exact = setup.exact.velocity(p.position, time);
            difference += (p.velocity - exact).norm_squared();
            scale += exact.norm_squared();
            energy += 0.5 * p.mass * p.velocity.norm_squared();
            mass += p.mass;
        }
        let error = (difference / scale).sqrt();
        let energy = energy / setup.exact.kinetic_energy(time);
        Self { time, error, energy, momentum: simulation.momentum() / mass }
    }
}

fn profile(series: &[Sample]) -> Profile {
    let column = |f: fn(&Sample) -> f64| series.iter().map(f).collect();
    Profile::default()
        .with("t", "L/U", column(|s| s.time))
        .with("error", "-", column(|s| s.error))
        .with("energy", "of the exact", column(|s| s.energy))
        .with("momentum", "U", column(|s| s.momentum.norm()))
}

fn measure(setup: &Setup, simulation: &dyn Stepper<()>, series: &[Sample], record: &mut Record) {
    let (first, last) = (series[0], series[series.len() - 1]);
    record.put(L2, last.error);
    let worst = series.iter().map(|s| s.error).fold(0.0, f64::max);
    record.put(L2_WORST, worst);
    record.put(ENERGY, last.energy - 1.0);
    let exact = (setup.exact.kinetic_energy(0.0) / setup.exact.kinetic_energy(last.time)).ln();
    let found = exact - (last.energy / first.energy).ln();
    record.put(NU_EFF, found / exact);
    record.put(MOMENTUM, last.momentum.norm());
    record.put(MOMENTUM_ADDED, (last.momentum - first.momentum).norm());
    let particles = simulation.particles();
    let fluid = setup.fluid;
    let pressure = |p: &Particle| fluid.eos.pressure(p.density) - fluid.eos.background;
    let mean = particles.iter().map(pressure).sum::<f64>() / particles.len() as f64;
    let (mut difference, mut scale) = (0.0, 0.0);
    for p in &particles {
        let exact = setup.exact.pressure(p.position, last.time);
        difference += (pressure(p) - mean - exact).powi(2);
        scale += exact.powi(2);
    }
    record.put(PRESSURE_L2, (difference / scale).sqrt());
    let volume: f64 = particles.iter().map(|p| p.mass / p.density).sum();
    record.put(VOLUME_DRIFT, volume - 1.0);
    record.put(NEAREST, nearest(&particles) / fluid.dx);
}

/// The least distance of two particles, those across an edge left out \[m\].
fn nearest(particles: &[Particle]) -> f64 {
    let mut places: Vec<Vector2<f64>> = particles.iter().map(|p| p.position).collect();
    places.sort_by(|a, b| a.x.total_cmp(&b.x));
    let mut least = f64::INFINITY;
    for (k, a) in places.iter().enumerate() {
        let ahead = places[k + 1..].iter().take_while(|b| b.x - a.x < least);
        least = ahead.map(|b| (b - a).norm()).fold(least, f64::min);
    }
    least
}

/// The particles themselves: x, y, speed, error.
fn particles(setup: &Setup, simulation: &dyn Stepper<()>) -> Profile {
    let (all, t) = (simulation.particles(), simulation.time());
    let column = |f: &dyn Fn(&Particle) -> f64| all.iter().map(f).collect();
    let wrapped = |x: f64| x.rem_euclid(1.0);
    let scale = setup.exact.decay(t);
    let error = |p: &Particle| (p.velocity - setup.exact.velocity(p.position, t)).norm() / scale;
    Profile::default()
        .with("x", "m", column(&|p| wrapped(p.position.x)))
        .with("y", "m", column(&|p| wrapped(p.position.y)))
        .with("speed", "U exp(bt)", column(&|p| p.velocity.norm() / scale))
        .with("error", "U exp(bt)", column(&error))
}
