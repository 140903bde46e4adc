//! One run of a periodic lattice with velocity noise of 1e-8 c₀: every wave of the box at once, too small
//! to be anything but linear.

use nalgebra::{Complex, Vector2};
use solver::{
    ArtificialViscosity, Compose, Continuity, CubicSpline, DensityDiffusion, Domain,
    EquationOfState, Flow, Integrator, Kernel, Leapfrog, Limits, Observer, Open, Particle,
    PredictorCorrector, Pressure, QuinticSpline, SceneError, Split, Stepper, SuperSteps, Tait,
    Viscosity, WendlandC2, terms::Always,
};

use super::{BoxSettings, ENERGY, GREW, RESTING_BOX, WAVE_ANGLE, WAVE_GROWTH};
use base::functions::{cis, ln};
use base::{
    random::Random,
    record::{Cost, Record, Status},
};
use harness::{
    bisect::{Bracket, Growth, largest_stable},
    case::{Rules, RunError, Step},
    context::Context,
    limits,
    method::{Medium, Method, Parts},
    rules::{PLANNED_DT, PLANNED_DT_OVER_LIMIT},
    runner::Drive,
    simulate,
};
use maths::theory::{
    Stepping,
    lattice::wave_vectors,
    time_step::{self, Mode},
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

/// With viscosity alone.
pub type Plain<K, I> = Compose<K, (Pressure<Tait>, Viscosity), Continuity, Open, I>;
/// With artificial viscosity and density diffusion too.
type Damped<K, I> = Compose<
    K,
    (Pressure<Tait>, Viscosity, ArtificialViscosity<Tait, Always>),
    (Continuity, DensityDiffusion),
    Open,
    I,
>;

/// The same by super-time-stepping of viscosity.
type SuperPlain<K> =
    Compose<K, Split<Pressure<Tait>, Viscosity>, Continuity, Open, Leapfrog<SuperSteps>>;
/// With artificial viscosity and density diffusion too.
type SuperDamped<K> = Compose<
    K,
    Split<(Pressure<Tait>, ArtificialViscosity<Tait, Always>), Viscosity>,
    (Continuity, DensityDiffusion),
    Open,
    Leapfrog<SuperSteps>,
>;

/// A kernel and an integrator: a variant, with and without what damps beside viscosity.
pub struct Pair {
    /// Name of the variant.
    pub name: &'static str,
    /// h/dx unless set.
    pub h_over_dx: f64,
    plain: Method,
    damped: Method,
}

impl Pair {
    fn of<K: Kernel, I>(name: &'static str, h_over_dx: f64) -> Self
    where
        I: Stepping + Integrator<Plain<K, ()>> + Integrator<Damped<K, ()>>,
    {
        let (plain, damped) = (Method::of::<Plain<K, I>>(), Method::of::<Damped<K, I>>());
        Self { name, h_over_dx, plain, damped }
    }

    /// The cubic spline and the leapfrog.
    pub fn cubic_leapfrog() -> Self {
        Self::of::<CubicSpline, Leapfrog>("cubic-leapfrog", 1.3)
    }

    /// The cubic spline and the predictor-corrector.
    pub fn cubic_pc() -> Self {
        Self::of::<CubicSpline, PredictorCorrector>("cubic-pc", 1.3)
    }

    /// The cubic spline and the leapfrog with super-time-stepping.
    pub fn cubic_super() -> Self {
        let plain = Method::of::<SuperPlain<CubicSpline>>();
        let damped = Method::of::<SuperDamped<CubicSpline>>();
        Self { name: "cubic-super", h_over_dx: 1.3, plain, damped }
    }

    /// The quintic spline with both.
    pub fn quintic() -> [Self; 2] {
        [
            Self::of::<QuinticSpline, Leapfrog>("quintic-leapfrog", 1.0),
            Self::of::<QuinticSpline, PredictorCorrector>("quintic-pc", 1.0),
        ]
    }

    /// Wendland's function with both.
    pub fn wendland() -> [Self; 2] {
        [
            Self::of::<WendlandC2, Leapfrog>("wendland-leapfrog", 2.0),
            Self::of::<WendlandC2, PredictorCorrector>("wendland-pc", 2.0),
        ]
    }

    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        let cubic = [Self::cubic_leapfrog(), Self::cubic_pc(), Self::cubic_super()];
        cubic.into_iter().chain(Self::quintic()).chain(Self::wendland())
    }

    /// Without artificial viscosity and density diffusion; theory is the same for both.
    pub fn plain(&self) -> &Method {
        &self.plain
    }

    /// The method of a box: what it lacks is not in its types.
    fn method(&self, fluid: &NoisyBox) -> &Method {
        if fluid.alpha == 0.0 && fluid.delta == 0.0 { &self.plain } else { &self.damped }
    }
}

/// A box of `n` × `n` particles, side 1 m, ρ₀ = 1 kg/m³, c₀ = 1 m/s.
#[derive(Clone, Copy, Debug)]
pub struct NoisyBox {
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

harness::observed! { Watch: changes(growth, stopped), parts(), stays(to_the_end) }

/// Kinetic and acoustic energy, ½ m v² + ½ m (ρ/ρ₀ - 1)² with c₀ = 1.
fn energy(simulation: &dyn Stepper<()>) -> f64 {
    let of = |(mass, e): (f64, &solver::Evolved<()>)| {
        0.5 * mass * (e.velocity.norm_squared() + (e.density - 1.0) * (e.density - 1.0))
    };
    simulation.fluid().map(of).sum()
}

impl Observer<()> for Watch {
    fn after_step(&mut self, simulation: &dyn Stepper<()>) -> Flow {
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
    fn of(fluid: &NoisyBox, method: &Method) -> Self {
        let modes = fluid.modes(method).into_iter().zip(wave_vectors(fluid.n));
        let stiffest = modes.max_by(|(a, _), (b, _)| a.omega.total_cmp(&b.omega));
        let (along, omega, theta) = stiffest
            .map_or((Vector2::x(), 0.0, Vector2::zeros()), |(mode, theta)| {
                (mode.along, mode.omega, theta)
            });
        Self { n: fluid.n, theta, along, omega }
    }

    /// Its energy, which is the same at every phase of the wave, so that two looks are enough.
    fn energy(&self, particles: &[Particle]) -> f64 {
        let labels = solver::lattice(Vector2::zeros(), 1.0, self.n, self.n);
        let (mut p, mut v) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
        for (particle, label) in particles.iter().zip(labels) {
            let wave = cis(-self.theta.dot(&label));
            p += wave * (particle.density - 1.0);
            v += wave * particle.velocity.dot(&self.along);
        }
        p.norm_sqr() + v.norm_sqr()
    }
}

impl NoisyBox {
    /// The box of these settings.
    pub fn new(settings: &BoxSettings) -> Self {
        let BoxSettings { n, h_over_dx, stiffness, alpha, delta, .. } = *settings;
        Self { n, h_over_dx, stiffness: stiffness.unwrap_or(f64::INFINITY), alpha, delta }
    }

    /// Smoothing length \[m\].
    fn h(&self) -> f64 {
        self.h_over_dx / self.n as f64
    }

    /// The waves of the box in the lattice of a method, in units of c₀ and h.
    pub fn modes(&self, method: &Method) -> Vec<Mode> {
        let Self { n, h_over_dx, alpha, delta, stiffness } = *self;
        let medium = time_step::Medium { c0: 1.0, h: 1.0, nu: 1.0 / stiffness, alpha, delta };
        method.modes([h_over_dx, ETA2], n, &medium)
    }

    /// The limit of a method, and how many steps show growth beyond it.
    pub fn theory(&self, method: &Method) -> Theory {
        let modes = self.modes(method);
        let limit = time_step::time_step_limit(&modes, method.theory);
        let growth = time_step::growth_per_step(&modes, method.theory, SEEN_FROM * limit);
        Theory { limit, steps: (0.5 / growth).clamp(STEPS[0], STEPS[1]) as usize }
    }

    /// The scene.
    pub fn parts(&self, method: &Method) -> Parts {
        let (dx, h) = (1.0 / self.n as f64, self.h());
        let mut random = Random::new(7);
        let mut noise = || NOISE * random.normal();
        let particles = solver::lattice(Vector2::repeat(0.5 * dx), dx, self.n, self.n)
            .map(|x| Particle::fluid(x, Vector2::new(noise(), noise()), 1.0, dx * dx))
            .collect();
        let medium = Medium {
            nu: h / self.stiffness,
            eta2_over_h2: ETA2,
            alpha: self.alpha,
            diffusion: self.delta,
            ..method.medium(Tait::new(1.0, 1.0), [dx, h])
        };
        Parts {
            limits: Limits { density: [0.7, 1.3], speed: 2.0 },
            ..Parts::new(medium, Domain::torus(1.0, 1.0), particles, &Context::default())
        }
    }

    /// Runs a simulation of this box for its number of steps of `courant` h/c₀.
    fn run(
        &self,
        method: &Method,
        mut simulation: Box<dyn Stepper<()>>,
        (courant, steps): (f64, usize),
        to_the_end: bool,
        context: &Context,
    ) -> Result<Measured, RunError> {
        let dt = courant * self.h();
        let wave = StiffestWave::of(self, method);
        let (start, wave_start) = (energy(&*simulation), wave.energy(&simulation.particles()));
        let growth = Growth::new(start, steps as u64);
        let mut watch = Watch { growth, to_the_end, stopped: false };
        let mut wave_growth = None;
        let pressure = |density| Tait::new(1.0, 1.0).pressure(density);
        let (times, mut seen) = ([dt * steps as f64], (&mut watch, &mut wave_growth));
        let (mut status, cost) = Drive::new(&mut *simulation, dt, &times, &pressure, &mut seen)
            .after_step("energy", &|(watch, _), simulation| watch.after_step(simulation))
            .at("stiffest wave", &|(_, growth), simulation, _| {
                let ratio = wave.energy(&simulation.particles()) / wave_start;
                **growth = Some(0.5 * ln(ratio) / steps as f64);
            })
            .run(context)?;
        if watch.stopped {
            status = Status::Completed;
        }
        let grew = matches!(status, Status::Diverged { .. }) || watch.growth.grew();
        let energy = energy(&*simulation) / start;
        let state = simulate::state(&simulation.particles());
        Ok(Measured { status, cost, grew, energy, wave_growth, state })
    }

    /// The limit of any simulation of this box, beside the theory of the box: how the bisection of the plan
    /// goes for one that is not what its settings say.
    pub fn limit_of(
        &self,
        method: &Method,
        build: impl Fn() -> Result<Box<dyn Stepper<()>>, SceneError>,
    ) -> Limit {
        let theory = self.theory(method);
        let is_stable = |courant| {
            let stepping = (courant, theory.steps);
            let run =
                |simulation| self.run(method, simulation, stepping, false, &Context::default());
            let is_stable = |simulation| run(simulation).is_ok_and(|run| !run.grew);
            Ok::<_, SceneError>(build().is_ok_and(is_stable))
        };
        let measured = largest_stable(theory.limit, RESOLUTION, is_stable).unwrap_or_default();
        Limit { measured, theory }
    }

    /// Growth a step of the amplitude of the stiffest wave of any simulation of this box, and ω dt of theory.
    pub fn stiffest_wave_of(
        &self,
        method: &Method,
        simulation: Box<dyn Stepper<()>>,
        courant: f64,
        steps: usize,
    ) -> [f64; 2] {
        let run = self.run(method, simulation, (courant, steps), true, &Context::default());
        let growth = run.ok().and_then(|run| run.wave_growth).unwrap_or(f64::NAN);
        [growth, StiffestWave::of(self, method).omega * courant]
    }
}

/// One run of the case.
pub fn run(
    pair: &Pair,
    variant: &str,
    settings: &BoxSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let fluid = NoisyBox::new(settings);
    let method = pair.method(&fluid);
    let &BoxSettings { courant, steps, to_the_end, .. } = settings;
    let rules = rules(pair, settings)?;
    simulate::check_step(method.integrator, &rules, context)?;
    let (dt, dt_limit, sound_speed) = (rules.dt(), rules.dt_limit(), rules.sound_speed);
    let simulation = (method.build)(fluid.parts(method))?;
    let measured = fluid.run(method, simulation, (courant, steps), to_the_end, context)?;
    let numbers = [
        ("h/dx", fluid.h_over_dx),
        ("c0 [m/s]", sound_speed),
        ("c0 h/nu", fluid.stiffness),
        (PLANNED_DT, dt),
        (PLANNED_DT_OVER_LIMIT, dt / dt_limit),
    ];
    let serial = Context::default();
    let mut record =
        simulate::begin((RESTING_BOX.name, variant), settings, method, &numbers, &serial);
    record.put(GREW, f64::from(u8::from(measured.grew)));
    record.put(ENERGY, measured.energy);
    record.put(WAVE_ANGLE, StiffestWave::of(&fluid, method).omega * courant);
    if let Some(growth) = measured.wave_growth {
        record.put(WAVE_GROWTH, growth);
    }
    record.state = Some(measured.state);
    (record.status, record.cost) = (measured.status, measured.cost);
    Ok(record)
}

/// What the settings say, and theory.
pub fn rules(pair: &Pair, settings: &BoxSettings) -> Result<Rules, RunError> {
    let fluid = NoisyBox::new(settings);
    let (method, h) = (pair.plain(), fluid.h());
    let limits = limits::Limits::of(&fluid.modes(method), method.theory).times(h);
    let step = Step::courant(settings.courant, h, [1.0, 0.0]);
    let end = settings.steps as f64 * step.dt;
    Ok(Rules { step, limits, sound_speed: 1.0, end })
}
