//! One run of a periodic lattice with velocity noise of 1e-8 c₀: every wave of the box at once, too small
//! to be anything but linear.

use std::marker::PhantomData;

use nalgebra::{Complex, Vector2};
use solver::terms::Always;
use solver::{
    ArtificialViscosity, Compose, Continuity, DensityDiffusion, Domain, EquationOfState, Flow,
    Integrator, Kernel, Limits, Numbers, Observer, Open, Particle, Pressure, Scene, Scheme,
    Stepper, Tait, Viscosity,
};

use super::{BoxSettings, ENERGY, GREW, RESTING_BOX, WAVE_ANGLE, WAVE_GROWTH};
use base::{
    number,
    random::Random,
    record::{Cost, Record, Status},
};
use harness::{
    bisect::{Bracket, Growth, largest_stable},
    case::{Rules, RunError},
    runner::{self, Context},
};
use maths::theory::{
    Stepping,
    lattice::{SquareLattice, wave_vectors},
    time_step::{self, Medium, Mode},
};

/// The guard of the viscous and the artificial term, as the seed has it.
pub const ETA2: f64 = 0.01;
/// Initial velocity noise, standard deviation of each component \[c₀\].
pub const NOISE: f64 = 1e-8;
/// Resolution of the bisection, relative to the theoretical limit.
pub const RESOLUTION: f64 = 0.004;
/// A growth that theory gives at this much beyond the limit must be seen, so it sets the number of
/// steps; the number has no other influence on the limit that is found.
const SEEN_FROM: f64 = 1.005;
/// Fewest and most steps of a run.
const STEPS: [f64; 2] = [300.0, 12_000.0];

type Plain<K, I> = Compose<K, (Pressure<Tait>, Viscosity), Continuity, Open, I>;
type Damping = ArtificialViscosity<Tait, Always>;
type Damped<K, I> =
    Compose<K, (Pressure<Tait>, Viscosity, Damping), (Continuity, DensityDiffusion), Open, I>;

/// A box of `n` × `n` particles, side 1 m, ρ₀ = 1 kg/m³, c₀ = 1 m/s.
#[derive(Clone, Copy, Debug)]
pub struct NoisyBox<K> {
    /// Particles along each side.
    pub n: usize,
    /// h/dx.
    pub h_over_dx: f64,
    /// c₀h/ν, infinite without viscosity.
    pub stiffness: f64,
    /// α of the artificial viscosity, on every pair.
    pub alpha: f64,
    /// δ of the density diffusion.
    pub delta: f64,
    /// The kernel.
    pub kernel: PhantomData<K>,
}

/// What theory says of a box and an integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Theory {
    /// [`time_step::time_step_limit`] \[h/c₀\].
    pub limit: f64,
    /// Steps after which growth just beyond the limit is seen.
    pub steps: usize,
}

/// A measured limit and its theory, both as c₀ dt/h.
#[derive(Clone, Copy, Debug)]
pub struct Limit {
    /// By bisection; `None` if there is none near the theory.
    pub measured: Option<Bracket>,
    /// Theory of the same box.
    pub theory: Theory,
}

impl Limit {
    /// Measured over theoretical; NaN if nothing was measured.
    pub fn ratio(&self) -> f64 {
        self.middle() / self.theory.limit
    }

    /// The measured limit; NaN if nothing was measured.
    pub fn middle(&self) -> f64 {
        self.measured.map_or(f64::NAN, |bracket| bracket.middle())
    }
}

/// What came of a run.
pub struct Measured {
    /// How it ended: that of a run which is over early because its energy grew beyond doubt is completed.
    pub status: Status,
    /// What it took.
    pub cost: Cost,
    /// Did the energy grow, or did the run diverge?
    pub grew: bool,
    /// Energy at the end over that at the start.
    energy: f64,
    /// Growth a step of the amplitude of the stiffest sound wave, of a run with all its steps.
    wave_growth: Option<f64>,
    /// Places, velocities, densities at the end.
    state: String,
}

struct Watch {
    growth: Growth,
    to_the_end: bool,
    stopped: bool,
}

/// Kinetic and acoustic energy, ½ m v² + ½ m (ρ/ρ₀ - 1)² with c₀ = 1.
fn energy<X: Numbers>(simulation: &dyn Stepper<X>) -> f64 {
    let of = |(mass, e): (f64, &solver::Evolved<X>)| {
        0.5 * mass * (e.velocity.norm_squared() + (e.density - 1.0) * (e.density - 1.0))
    };
    simulation.fluid().map(of).sum()
}

impl<X: Numbers> Observer<X> for Watch {
    fn after_step(&mut self, simulation: &dyn Stepper<X>) -> Flow {
        self.stopped = self.growth.see(energy(simulation)) && !self.to_the_end;
        if self.stopped { Flow::Stop } else { Flow::Continue }
    }
}

/// The sound wave of a box with the highest frequency.
struct StiffestWave {
    /// Side of the box in particles.
    n: usize,
    /// Phase from one particle to the next.
    theta: Vector2<f64>,
    /// Unit vector along the gradient symbol.
    along: Vector2<f64>,
    /// Angular frequency \[c₀/h\].
    omega: f64,
}

impl StiffestWave {
    fn of<K: Kernel>(fluid: &NoisyBox<K>) -> Self {
        let lattice = fluid.lattice();
        let omega = |theta: &Vector2<f64>| Mode::new(&lattice, *theta, &fluid.medium()).omega;
        let stiffest = wave_vectors(fluid.n).max_by(|a, b| omega(a).total_cmp(&omega(b)));
        let theta = stiffest.unwrap_or_else(Vector2::zeros);
        let along = lattice.gradient(theta).normalize();
        Self { n: fluid.n, theta, along, omega: omega(&theta) }
    }

    /// Its energy, which is the same at every phase of the wave, so that two looks are enough.
    fn energy(&self, particles: &[Particle]) -> f64 {
        let labels = solver::lattice(Vector2::zeros(), 1.0, self.n, self.n);
        let (mut p, mut v) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
        for (particle, label) in particles.iter().zip(labels) {
            let wave = Complex::<f64>::cis(-self.theta.dot(&label));
            p += wave * (particle.density - 1.0);
            v += wave * particle.velocity.dot(&self.along);
        }
        p.norm_sqr() + v.norm_sqr()
    }
}

impl<K: Kernel> NoisyBox<K> {
    /// The box of these settings, seen through its kernel.
    pub fn new(settings: &BoxSettings) -> Self {
        let BoxSettings { n, h_over_dx, stiffness, alpha, delta, .. } = *settings;
        let stiffness = stiffness.unwrap_or(f64::INFINITY);
        Self { n, h_over_dx, stiffness, alpha, delta, kernel: PhantomData }
    }

    /// Smoothing length \[m\].
    fn h(&self) -> f64 {
        self.h_over_dx / self.n as f64
    }

    /// The lattice of the theory.
    pub fn lattice(&self) -> SquareLattice<K> {
        SquareLattice::new(self.h_over_dx, ETA2)
    }

    /// The fluid of the theory, in units of c₀ and h.
    pub fn medium(&self) -> Medium {
        let Self { alpha, delta, stiffness, .. } = *self;
        Medium { c0: 1.0, h: 1.0, nu: 1.0 / stiffness, alpha, delta }
    }

    /// The waves of the box, in units of c₀ and h.
    pub fn modes(&self) -> Vec<Mode> {
        time_step::modes(&self.lattice(), self.n, &self.medium())
    }

    /// The limit of an integrator, and how many steps show growth beyond it.
    pub fn theory(&self, integrator: time_step::Integrator) -> Theory {
        let modes = self.modes();
        let limit = time_step::time_step_limit(&modes, integrator);
        let growth = time_step::growth_per_step(&modes, integrator, SEEN_FROM * limit);
        Theory { limit, steps: (0.5 / growth).clamp(STEPS[0], STEPS[1]) as usize }
    }

    fn scene<S: Scheme<Kernel = K>>(
        &self,
        forces: S::Forces,
        drift: S::Drift,
        walls: S::Walls,
    ) -> Scene<S> {
        let dx = 1.0 / self.n as f64;
        let mut random = Random::new(7);
        let mut noise = || NOISE * random.normal();
        let particles = solver::lattice(Vector2::repeat(0.5 * dx), dx, self.n, self.n)
            .map(|x| Particle::fluid(x, Vector2::new(noise(), noise()), 1.0, dx * dx))
            .collect();
        let mut scene =
            Scene::new(self.h(), Domain::torus(1.0, 1.0), particles, forces, drift, walls);
        scene.parallel_from = usize::MAX;
        scene.limits = Limits { density: [0.7, 1.3], speed: 2.0 };
        scene
    }

    fn viscosity(&self) -> Viscosity {
        let h = self.h();
        Viscosity { mu: h / self.stiffness, eta2: ETA2 * h * h }
    }

    /// The scene with viscosity alone; [`NoisyBox::alpha`] and [`NoisyBox::delta`] are ignored.
    pub fn plain<I: Stepping>(&self) -> Scene<Plain<K, I>> {
        let forces = (Pressure::new(Tait::new(1.0, 1.0)), self.viscosity());
        self.scene(forces, Continuity, Open)
    }

    /// The scene with artificial viscosity and density diffusion too.
    pub fn damped<I: Stepping>(&self) -> Scene<Damped<K, I>> {
        let (eos, h) = (Tait::new(1.0, 1.0), self.h());
        let damping = Damping::new(self.alpha, 0.0, h, eos);
        let diffusion = DensityDiffusion::new(self.delta * h);
        let forces = (Pressure::new(eos), self.viscosity(), damping);
        self.scene(forces, (Continuity, diffusion), Open)
    }

    /// Runs a scene of this box for its number of steps of `courant` h/c₀.
    fn run_scene<S: Scheme<Extra = ()>>(
        &self,
        scene: Scene<S>,
        (courant, steps): (f64, usize),
        to_the_end: bool,
        context: &Context,
    ) -> Result<Measured, RunError> {
        let mut simulation = scene.build()?;
        let dt = courant * self.h();
        let wave = StiffestWave::of(self);
        let (start, wave_start) = (energy(&simulation), wave.energy(&simulation.particles()));
        let growth = Growth::new(start, steps as u64);
        let mut watch = Watch { growth, to_the_end, stopped: false };
        let mut wave_growth = None;
        let (mut status, cost) = runner::drive(
            &mut simulation,
            dt,
            &[dt * steps as f64],
            context,
            &mut watch,
            &|density| Tait::new(1.0, 1.0).pressure(density),
            &mut |simulation, _| {
                let ratio = wave.energy(&simulation.particles()) / wave_start;
                wave_growth = Some(0.5 * ratio.ln() / steps as f64);
            },
        )?;
        if watch.stopped {
            status = Status::Completed;
        }
        let grew = matches!(status, Status::Diverged { .. }) || watch.growth.grew();
        let (energy, state) =
            (energy(&simulation) / start, harness::simulate::state(&simulation.particles()));
        Ok(Measured { status, cost, grew, energy, wave_growth, state })
    }

    /// The limit of any scene of this box, beside the theory of the box: how the bisection of the plan goes
    /// for a scene that is not what its settings say.
    pub fn limit_of<S: Scheme<Extra = ()>>(&self, scene: impl Fn() -> Scene<S>) -> Limit
    where
        S::Integrator: Stepping,
    {
        let theory = self.theory(S::Integrator::THEORY);
        let is_stable = |courant| {
            let run = self.run_scene(scene(), (courant, theory.steps), false, &Context::default());
            run.is_ok_and(|run| !run.grew)
        };
        Limit { measured: largest_stable(theory.limit, RESOLUTION, is_stable), theory }
    }

    /// Growth a step of the amplitude of the stiffest wave of any scene of this box, and ω dt of theory.
    pub fn stiffest_wave_of<S: Scheme<Extra = ()>>(
        &self,
        scene: Scene<S>,
        courant: f64,
        steps: usize,
    ) -> [f64; 2] {
        let run = self.run_scene(scene, (courant, steps), true, &Context::default());
        let growth = run.ok().and_then(|run| run.wave_growth).unwrap_or(f64::NAN);
        [growth, StiffestWave::of(self).omega * courant]
    }
}

/// One run of the case.
pub fn run<K: Kernel, I: Stepping>(
    variant: &str,
    settings: &BoxSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let fluid = NoisyBox::<K>::new(settings);
    let &BoxSettings { courant, steps, to_the_end, .. } = settings;
    let Rules { dt, dt_limit, sound_speed } = rules::<K, I>(settings)?;
    let integrator = <I as Integrator<()>>::NAME;
    if dt > dt_limit && !context.allow_unstable {
        return Err(RunError::TimeStep { dt, limit: dt_limit, integrator });
    }
    let measured = if fluid.alpha == 0.0 && fluid.delta == 0.0 {
        fluid.run_scene(fluid.plain::<I>(), (courant, steps), to_the_end, context)?
    } else {
        fluid.run_scene(fluid.damped::<I>(), (courant, steps), to_the_end, context)?
    };
    let json = serde_json::to_value(settings).unwrap_or_default();
    let mut record = Record::new(RESTING_BOX.name, variant, json, 1);
    let numbers = [
        ("h/dx", fluid.h_over_dx),
        ("c0 [m/s]", sound_speed),
        ("c0 h/nu", fluid.stiffness),
        ("dt [s]", dt),
        ("dt/limit", dt / dt_limit),
    ];
    record.numerics.extend(numbers.map(|(name, value)| (name.to_string(), number::json(value))));
    record.numerics.insert("kernel".into(), K::NAME.into());
    record.numerics.insert("integrator".into(), integrator.into());
    record.put(GREW, f64::from(u8::from(measured.grew)));
    record.put(ENERGY, measured.energy);
    record.put(WAVE_ANGLE, StiffestWave::of(&fluid).omega * courant);
    if let Some(growth) = measured.wave_growth {
        record.put(WAVE_GROWTH, growth);
    }
    record.state = Some(measured.state);
    (record.status, record.cost) = (measured.status, measured.cost);
    Ok(record)
}

/// What the settings say, and theory.
pub fn rules<K: Kernel, I: Stepping>(settings: &BoxSettings) -> Result<Rules, RunError> {
    let fluid = NoisyBox::<K>::new(settings);
    let limit = time_step::time_step_limit(&fluid.modes(), I::THEORY);
    let (dt, dt_limit) = (settings.courant * fluid.h(), limit * fluid.h());
    Ok(Rules { dt, dt_limit, sound_speed: 1.0 })
}
