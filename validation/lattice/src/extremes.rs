//! Settings far outside of the usual, each with its own criterion.
//!
//! Common to all: nothing hangs, nothing panics, and a run that leaves its bounds ends as
//! [`solver::Outcome::Diverged`] with step, time, particle and quantity. What is not a scene is refused with
//! its reason; `tests/tests/extremes.rs` shows that, and particles without neighbours.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use solver::{
    Compose, Continuity, CubicSpline, DensityDiffusion, Domain, EquationOfState, Leapfrog, Limits,
    Open, Particle, Pressure, QuinticSpline, Shifting, Stepper, Tait, Viscosity, WendlandC2,
};

use crate::{torus, wave::plain};
use base::{
    functions::{cos, exp, sin},
    gate::{Bound, Evidence, Gate},
    random::Random,
    record::{MetricKey, Record, Status},
    settings::Settings,
};
use harness::{
    case::{Planned, RunError, Tier},
    composed::{self, Best, Composed, Composition},
    context::Context,
    declare::Declaration,
    method::{Medium, Method, Parts},
    rules::PLANNED_DT,
    runner::Drive,
    simulate::{self, momentum},
    table::{Row, Table},
};

base::settings! {
    /// Settings of the experiments; each uses some of them.
    pub struct ExtremeSettings {
        /// particles along each side of the periodic box
        n: usize ["-"] in 4..=400 = 10,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.5..=5.0 = 1.2,
        /// number of time steps
        steps: usize ["-"] in 10..=100000000 = 400,
        /// time step
        dt: f64 ["dx/c0"] in 1e-9..=100.0 = 0.6,
        /// pressure at rest
        background: f64 ["rho0 c0^2"] in 0.0..=1.0 = 0.0,
        /// distance of the two particles that are too close
        distance: f64 ["dx"] in 0.0..=1.0 = 0.0,
        /// speed of the moving block
        speed: f64 ["c0"] in 0.0..=1e6 = 1000.0,
        /// Mach number of the vortex
        mach: f64 ["-"] in 1e-6..=10.0 = 0.1,
        /// Reynolds number of the vortex
        re: f64 ["-"] in 1e-3..=1e6 = 100.0,
        /// standard deviation of the initial displacements
        jitter: f64 ["dx"] in 0.0..=0.5 = 0.0,
        /// end of the run of the vortex, in units of its side over its speed
        end: f64 ["-"] in 1e-6..=100.0 = 0.5,
    }
}

/// Settings far outside of the usual.
pub static EXTREMES: Composed<ExtremeSettings> = Composed {
    name: "extremes",
    problem: "Extreme settings and scenes: does the program stay sound?",
    best: Best {
        variant: "rest",
        because: "each variant is an experiment of its own, and this one is the plainest",
        papers: None,
    },
    about: "Extreme scenes and settings must end well. They are a lattice at rest for very long, particles \
            on top of each other, a block at a thousand times the speed of sound, and vortices with sound \
            too slow and too fast and on a disturbed lattice. Each variant is an experiment of its own.",
    variants,
    is_stable: composed::completed,
    declaration: |_| Declaration::default(),
    plan,
    studies: composed::no_studies,
};

base::metrics! {
    HEAT = "heat" ["c0^2"] "largest v^2/2 of a particle at the end";
    CLOCK_ERROR = "clock_error" ["dx/c0"]
        "largest |t - n dt| at ten times, infinite if the steps are not n";
    MOMENTUM_ERROR = "momentum_error" ["-"] "|change of sum m v|/sum m |v| of the moving particles";
    FASTEST = "fastest" ["c0"] "largest speed at the end";
    VELOCITY_ERROR = "l2" ["-"] "rms(v - v_exact)/rms(v_exact) over the particles at the end";
    PEAK_ENERGY = "peak_energy" ["-"] "largest kinetic energy at 20 times/that of the start";
    ENERGY_RATIO = "energy_ratio" ["-"] "kinetic energy at the end/the exact one";
}

/// The modern composition of the channels, in a periodic box.
type Modern = Compose<
    QuinticSpline,
    (Pressure<Tait>, Viscosity),
    (Continuity, DensityDiffusion, Shifting),
    Open,
    Leapfrog,
>;

/// A variant that uses some of the settings.
fn variant(
    name: [&'static str; 2],
    uses: &[&str],
    adjust: fn(&mut ExtremeSettings),
    (method, experiment): (Method, Experiment),
) -> Composition<ExtremeSettings> {
    let rules = |_: &ExtremeSettings| Err(RunError::NoRules { case: EXTREMES.name.into() });
    let fields = ExtremeSettings::FIELDS.iter().map(|field| field.name);
    let lacks = fields.filter(|name| !uses.contains(name)).collect();
    let run = move |variant: &str, s: &ExtremeSettings, context: &Context| {
        run((&method, experiment), variant, s, context)
    };
    Composition::new(name.into(), adjust, run, rules, lacks)
}

fn variants() -> Vec<Composition<ExtremeSettings>> {
    const AT_REST: &[&str] = &["n", "h_over_dx", "steps", "dt", "background"];
    const VORTEX: &[&str] = &["n", "h_over_dx", "mach", "re", "jitter", "end"];
    let cubic = plain::<CubicSpline, Leapfrog>;
    vec![
        variant(
            ["rest", "does round-off heat a lattice at rest? cubic spline"],
            AT_REST,
            |s| (s.n, s.h_over_dx, s.steps, s.dt) = (5, 1.2, 100_000, 0.7),
            (cubic(), REST),
        ),
        // Positive pressure pairs particles of a cubic spline, not those of a Wendland function.
        variant(
            ["pressed", "does it under pressure? Wendland function"],
            AT_REST,
            |s| {
                (s.n, s.h_over_dx, s.steps, s.dt, s.background) = (7, 1.5, 10_000, 0.7, 0.05);
            },
            (plain::<WendlandC2, Leapfrog>(), REST),
        ),
        variant(
            [
                "coincident",
                "are two particles at one place harmless, in a lattice stirred at 0.05 c0?",
            ],
            &["distance", "steps", "dt"],
            |_| (),
            (cubic(), COINCIDENT),
        ),
        variant(
            ["bullet", "does a block that hits another keep the momentum?"],
            &["speed", "steps", "dt"],
            |s| (s.steps, s.dt) = (200, 0.3),
            (cubic(), BULLET),
        ),
        variant(
            ["vortex", "do vortices stay sound? the modern composition of the channels"],
            VORTEX,
            |s| (s.n, s.h_over_dx) = (32, 1.0),
            (Method::of::<Modern>(), VORTEX_BOX),
        ),
    ]
}

/// What a variant does: its scene, at how many times it looks, and what it measures.
#[derive(Clone, Copy)]
struct Experiment {
    scene: fn(&Method, &ExtremeSettings) -> Scene,
    looks: usize,
    measure: fn(&Ended, &ExtremeSettings, &mut Record),
}

/// What is stepped, for how long.
struct Scene {
    parts: Parts,
    dt: f64,
    /// The steps to the end, if all are equally long.
    steps: Option<usize>,
    end: f64,
}

/// A run that ended.
struct Ended {
    start: Vec<Particle>,
    particles: Vec<Particle>,
    time: f64,
    /// The largest distance of the clock from n dt \[dx/c₀\].
    late: f64,
    /// The largest kinetic energy over that of the start.
    peak: f64,
    /// Kinetic energy at the start and at the end.
    energies: [f64; 2],
}

const REST: Experiment = Experiment { scene: at_rest, looks: 10, measure: measure_rest };
const COINCIDENT: Experiment = Experiment { scene: stirred, looks: 1, measure: measure_momentum };
const BULLET: Experiment = Experiment { scene: blocks, looks: 1, measure: measure_momentum };
const VORTEX_BOX: Experiment = Experiment { scene: vortex, looks: 20, measure: measure_vortex };

/// A simulation of any experiment.
type Simulation = dyn Stepper<()>;

/// One run of any variant.
fn run(
    (method, experiment): (&Method, Experiment),
    variant: &str,
    s: &ExtremeSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let Scene { parts, dt, steps, end } = (experiment.scene)(method, s);
    let (start, eos, looks) = (parts.particles.clone(), parts.medium.eos, experiment.looks);
    let mut simulation = (method.build)(parts)?;
    let done = |look: usize| steps.map(|steps| (look + 1) * steps / looks);
    let time = |look| done(look).map_or(end * (look + 1) as f64 / looks as f64, |n| n as f64 * dt);
    let times: Vec<f64> = (0..looks).map(time).collect();
    let energy = |simulation: &Simulation| -> f64 {
        simulation.fluid().map(|(mass, e)| 0.5 * mass * e.velocity.norm_squared()).sum()
    };
    let (first, mut seen) = (energy(&*simulation), (0.0f64, 1.0f64));
    let look = |(late, peak): &mut (f64, f64), simulation: &mut Simulation, look: usize| {
        let is_on_time = done(look).is_none_or(|steps| simulation.work().steps == steps as u64);
        let off = (simulation.time() - times[look]).abs();
        *late = late.max(if is_on_time { off } else { f64::INFINITY });
        *peak = peak.max(energy(simulation) / first);
    };
    let (name, serial) = ((EXTREMES.name, variant), Context::default());
    let mut record = simulate::begin(name, s, method, &[(PLANNED_DT, dt)], &serial);
    let pressure = |density| eos.pressure(density);
    (record.status, record.cost) = Drive::new(&mut *simulation, dt, &times, &pressure, &mut seen)
        .at("samples", &look)
        .run(context)?;
    let (particles, time) = (simulation.particles(), simulation.time());
    let ((late, peak), energies) = (seen, [first, energy(&*simulation)]);
    record.state = Some(simulate::state(&particles));
    let ended = Ended { start, particles, time, late, peak, energies };
    (experiment.measure)(&ended, s, &mut record);
    Ok(record)
}

/// Kinetic energy per mass of the fastest particle \[c₀²\]; NaN stays.
fn fastest(particles: &[Particle]) -> f64 {
    let all = particles.iter().map(|p| 0.5 * p.velocity.norm_squared());
    all.fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a })
}

/// ρ₀ = c₀ = dx = 1, ν = 0.1.
fn medium(method: &Method, s: &ExtremeSettings) -> Medium {
    let eos = Tait { background: s.background, ..Tait::new(1.0, 1.0) };
    Medium { nu: 0.1, eta2_over_h2: 1e-6, ..method.medium(eos, [1.0, s.h_over_dx]) }
}

fn all_steps(parts: Parts, s: &ExtremeSettings) -> Scene {
    Scene { parts, dt: s.dt, steps: Some(s.steps), end: s.dt * s.steps as f64 }
}

/// A lattice at rest, for very many steps.
fn at_rest(method: &Method, s: &ExtremeSettings) -> Scene {
    let resting = |_, place| (place, Vector2::zeros());
    let parts = torus((s.n as f64, s.n), medium(method, s), &Context::default(), resting);
    all_steps(parts, s)
}

fn measure_rest(ended: &Ended, _: &ExtremeSettings, record: &mut Record) {
    record.put(HEAT, fastest(&ended.particles));
    record.put(CLOCK_ERROR, ended.late);
}

/// Two particles at one place, or all but, in a lattice stirred at 0.05 c₀.
fn stirred(method: &Method, s: &ExtremeSettings) -> Scene {
    let mut random = Random::new(5);
    let start = |_, place| (place, Vector2::new(random.normal(), random.normal()) * 0.05);
    let mut parts = torus((10.0, 10), medium(method, s), &Context::default(), start);
    let Particle { position, velocity, .. } = parts.particles[33];
    parts.particles[34].position = position + Vector2::new(s.distance, 0.0);
    parts.particles[34].velocity = velocity;
    all_steps(parts, s)
}

/// A block that hits another.
fn blocks(method: &Method, s: &ExtremeSettings) -> Scene {
    let block = |first, velocity| {
        let places = solver::lattice(Vector2::new(first, 0.0), 1.0, 10, 10);
        places.map(move |place| Particle::fluid(place, velocity, 1.0, 1.0))
    };
    let moving = block(-12.0, Vector2::new(s.speed, 0.0));
    let particles = block(0.0, Vector2::zeros()).chain(moving).collect();
    let medium = medium(method, s);
    all_steps(Parts::new(medium, Domain::open(), particles, &Context::default()), s)
}

fn measure_momentum(ended: &Ended, _: &ExtremeSettings, record: &mut Record) {
    let scale: f64 = ended.start.iter().map(|p| p.mass * p.velocity.norm()).sum();
    let change = (momentum(&ended.particles) - momentum(&ended.start)).norm();
    record.put(MOMENTUM_ERROR, if scale > 0.0 { change / scale } else { change });
    record.put(FASTEST, (2.0 * fastest(&ended.particles)).sqrt());
}

/// Velocity of Taylor-Green vortices of U = L = ρ = 1.
fn exact(s: &ExtremeSettings, place: Vector2<f64>, t: f64) -> Vector2<f64> {
    let (x, y) = (TAU * place.x, TAU * place.y);
    Vector2::new(-cos(x) * sin(y), sin(x) * cos(y)) * exp(-2.0 * TAU * TAU / s.re * t)
}

fn vortex(method: &Method, s: &ExtremeSettings) -> Scene {
    let dx = 1.0 / s.n as f64;
    let h = s.h_over_dx * dx;
    let medium = method.medium(Tait::new(1.0, 1.0 / s.mach), [dx, h]);
    let medium =
        Medium { nu: 1.0 / s.re, eta2_over_h2: 1e-6, diffusion: 0.1, shift: 0.5, ..medium };
    let mut random = Random::new(3);
    let start = |_, place: Vector2<f64>| {
        let place = place + Vector2::new(random.normal(), random.normal()) * (s.jitter * dx);
        (place, exact(s, place, 0.0))
    };
    let limits = Limits { density: [0.1, 10.0], speed: 10.0 * (1.0 + 1.0 / s.mach) };
    let parts = torus((1.0, s.n), medium, &Context::default(), start);
    let dt = (h / (1.0 + 1.0 / s.mach)).min(0.25 * h * h * s.re);
    Scene { parts: Parts { limits, ..parts }, dt, steps: None, end: s.end }
}

fn measure_vortex(ended: &Ended, s: &ExtremeSettings, record: &mut Record) {
    if record.status != Status::Completed {
        return;
    }
    let (mut difference, mut scale) = (0.0, 0.0);
    for particle in &ended.particles {
        let exact = exact(s, particle.position, ended.time);
        difference += (particle.velocity - exact).norm_squared();
        scale += exact.norm_squared();
    }
    let decay = exp(-4.0 * TAU * TAU / s.re * ended.time);
    record.put(VELOCITY_ERROR, (difference / scale).sqrt());
    record.put(PEAK_ENERGY, ended.peak);
    record.put(ENERGY_RATIO, ended.energies[1] / (ended.energies[0] * decay));
}

/// What a run is for.
#[derive(Clone, Copy, PartialEq)]
enum Group {
    /// A lattice at rest.
    Rest,
    /// Particles at one place.
    Coincident,
    /// A block at 1000 c₀, with steps for sound and with steps for its speed.
    Bullet,
    /// Sound too slow: not weakly compressible any more.
    Slow,
    /// Sound a thousand times faster than needed.
    Stiff,
    /// A disturbed lattice.
    Disturbed,
}

/// The runs of a tier.
fn plan(tier: Tier) -> Vec<Planned> {
    let mut table = Table::new(&EXTREMES, tier);
    table.one(Group::Rest, "rest", |_| ());
    table.over(Group::Rest, &["pressed"], [&[10_000], &[1_000_000]], |s, steps| s.steps = steps);
    table.over(Group::Coincident, &["coincident"], [&[0.0, 1e-14]; 2], |s, distance| {
        s.distance = distance;
    });
    table.over(Group::Bullet, &["bullet"], [&[(0.3, 200), (1e-4, 2000)]; 2], |s, of| {
        (s.dt, s.steps) = of;
    });
    table.one(Group::Slow, "vortex", |s| (s.mach, s.jitter) = (0.5, 0.1));
    table.over(Group::Stiff, &["vortex"], [&[0.002], &[0.02]], |s, end| {
        (s.mach, s.end) = (1e-4, end);
    });
    table.one(Group::Disturbed, "vortex", |s| s.jitter = 0.3);
    table.judge(gates);
    table.plan()
}

/// What is judged of a run, and why.
fn gates(Row { group, variant, settings: s, .. }: &Row<ExtremeSettings, Group>) -> Vec<Gate> {
    let gate = |id: &str, metric: MetricKey, bound, evidence, because: &str| {
        Gate::new(format!("extremes.{id}"), String::from(metric), bound, evidence, because)
    };
    let momentum = |id: &str, because| {
        gate(id, MOMENTUM_ERROR, Bound::Below(1e-12), Evidence::Invariant, because)
    };
    vec![match group {
        Group::Rest => {
            let [energy, time] = ["energy", "time"].map(|what| format!("{variant}.{what}"));
            let cold = "Round-off of forces that cancel must not heat the lattice.";
            let exact = "Time is counted in whole steps, so it does not drift.";
            return vec![
                gate(&energy, HEAT, Bound::Below(1e-20), Evidence::Invariant, cold),
                gate(&time, CLOCK_ERROR, Bound::Equals(0.0), Evidence::Invariant, exact),
            ];
        }
        Group::Coincident => momentum(
            &format!("coincident.{:e}", s.distance),
            "The distance 0 must not be divided by. The run stays finite for 400 steps, and every pair force \
             has its opposite.",
        ),
        Group::Bullet => momentum(
            if s.dt < 0.3 { "bullet.its speed" } else { "bullet.sound" },
            "The run stays finite with exact momentum. With time steps for sound the blocks pass through \
             each other without a force, so there only finiteness is judged.",
        ),
        Group::Slow => gate(
            "mach",
            VELOCITY_ERROR,
            Bound::Below(0.25),
            Evidence::Theory,
            "Compressibility adds an error proportional to the square of the Mach number, 0.5.",
        ),
        Group::Stiff => gate(
            "sound.vortex",
            VELOCITY_ERROR,
            Bound::Below(0.01),
            Evidence::Theory,
            "The incompressible flow does not depend on c0. After a few steps 1 % is noise.",
        ),
        Group::Disturbed => gate(
            &format!("jitter.{}", s.jitter),
            PEAK_ENERGY,
            Bound::Below(1.01),
            Evidence::Invariant,
            "Viscosity only takes energy, and pressure starts at 0.",
        ),
    }]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::judged;

    #[test]
    fn the_quick_tier_survives_its_extremes() {
        let judged = judged(&[&EXTREMES]);
        let gates: Vec<Gate> = judged.iter().map(|judged| judged.gate.clone()).collect();
        assert_eq!(base::gate::check_all(&gates), Ok(()));
        for judged in &judged {
            let (id, value) = (&judged.gate.id, judged.judgement.value);
            assert!(!judged.judgement.verdict.is_failure(), "{id}: {value:?}");
        }
    }
}
