//! Odd sets of particles: at rest for long, on top of each other, alone, as fast as bullets, or not
//! particles at all.

use nalgebra::Vector2;
use solver::{
    CubicSpline, Domain, Kernel, Leapfrog, Particle, SceneError, Tait, WendlandC2, scene::Part,
};

use super::{
    EXTREMES, Experiment, ExtremeSettings, Simulation, drive,
    experiment::{completed, measured, sci},
    record_of,
};
use crate::wave::plain;
use base::{
    gate::{Bound, Evidence},
    random::Random,
    record::{MetricKey, Record},
};
use harness::{
    case::{RunError, Tier},
    context::Context,
    extremes::Entry,
    method::{Medium, Method, Parts},
    simulate::momentum,
};

const HEAT: MetricKey = MetricKey::new("heat", "c0^2", "largest v^2/2 of a particle at the end");
const CLOCK_ERROR: MetricKey = MetricKey::new(
    "clock_error",
    "dx/c0",
    "largest |t - n dt| at ten times, infinite if the steps are not n",
);
const MOMENTUM_ERROR: MetricKey =
    MetricKey::new("momentum_error", "-", "|change of sum m v|/sum m |v| of the moving particles");
const FASTEST: MetricKey = MetricKey::new("fastest", "c0", "largest speed at the end");
const GAP: MetricKey = MetricKey::new("gap", "dx", "distance of the two particles at the end");
const FLIGHT_ERROR: MetricKey = MetricKey::new(
    "flight_error",
    "-",
    "largest |x - x0 - v t|/|v t| + |rho/rho0 - 1| of a particle",
);
const REFUSALS: MetricKey =
    MetricKey::new("refusals", "-", "impossible scenes, of six, that are refused for their reason");

/// ρ₀ = c₀ = dx = 1.
fn fluid(background: f64) -> Tait {
    Tait { background, ..Tait::new(1.0, 1.0) }
}

/// ν = 0.1.
fn parts(
    method: &Method,
    h: f64,
    background: f64,
    (domain, particles): (Domain, Vec<Particle>),
) -> Parts {
    let medium = method.medium(fluid(background), [1.0, h]);
    let medium = Medium { nu: 0.1, eta2_over_h2: 1e-6, ..medium };
    Parts::new(medium, domain, particles, &Context::default())
}

fn resting(place: Vector2<f64>) -> Particle {
    Particle::fluid(place, Vector2::zeros(), 1.0, 1.0)
}

fn torus(n: usize) -> (Domain, Vec<Particle>) {
    let places = solver::lattice(Vector2::repeat(0.5), 1.0, n, n);
    (Domain::torus(n as f64, n as f64), places.map(resting).collect())
}

/// Kinetic energy per mass of the fastest particle \[c₀²\]; NaN stays.
fn fastest(particles: &[Particle]) -> f64 {
    let all = particles.iter().map(|p| 0.5 * p.velocity.norm_squared());
    all.fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a })
}

/// Steps a scene of a cubic spline by all steps.
fn drive_to_end(
    (variant, settings): (&str, &ExtremeSettings),
    particles: (Domain, Vec<Particle>),
    context: &Context,
) -> Result<(Record, Box<Simulation>), RunError> {
    let method = plain::<CubicSpline, Leapfrog>();
    let ExtremeSettings { dt, steps, .. } = *settings;
    let (run, times) = ((&method, variant, settings), [dt * steps as f64]);
    let mut simulation = (method.build)(parts(&method, 1.2, 0.0, particles))?;
    let stepping = (dt, &times[..], fluid(0.0));
    let record = drive(run, &mut *simulation, stepping, context, &mut (), &|_, _, _| ())?;
    Ok((record, simulation))
}

/// A lattice at rest for very many steps.
pub fn rest(
    method: &Method,
    variant: &str,
    settings: &ExtremeSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let ExtremeSettings { n, h_over_dx, steps, dt, background, .. } = *settings;
    let done = |k: usize| (k + 1) * steps / 10;
    let times: Vec<f64> = (0..10).map(|k| done(k) as f64 * dt).collect();
    let mut late = 0.0f64;
    let look = |late: &mut f64, simulation: &mut Simulation, k: usize| {
        let is_on_time = simulation.work().steps == done(k) as u64;
        let off = (simulation.time() - times[k]).abs();
        *late = late.max(if is_on_time { off } else { f64::INFINITY });
    };
    let (run, eos) = ((method, variant, settings), fluid(background));
    let mut simulation = (method.build)(parts(method, h_over_dx, background, torus(n)))?;
    let mut record = drive(run, &mut *simulation, (dt, &times, eos), context, &mut late, &look)?;
    record.put(HEAT, fastest(&simulation.particles()));
    record.put(CLOCK_ERROR, late);
    Ok(record)
}

/// A lattice at rest, without and with background pressure.
pub fn at_rest(tier: Tier) -> Vec<Experiment> {
    let pressed = if tier == Tier::Full { 1_000_000 } else { 10_000 };
    let specs = [
        (CubicSpline::NAME, 0.7, EXTREMES.spec("rest", |_| ())),
        (
            WendlandC2::NAME,
            1.5e-5 * pressed as f64,
            EXTREMES.spec("pressed", |s| s.steps = pressed),
        ),
    ];
    let experiment = |(kernel, seconds, spec)| {
        Experiment::new(vec![spec], seconds, move |records| rested(kernel, records[0]))
    };
    specs.map(experiment).into()
}

fn rested(kernel: &str, record: &Record) -> Vec<Entry> {
    let ExtremeSettings { h_over_dx, steps, background, dt, .. } = record.settings_as();
    let setting = format!("{steps} steps, p = {background} ρc₀², {kernel}, h/dx = {h_over_dx}");
    let name = |what: &str| format!("{}.{what}", record.variant);
    let what = |what: &str| [what.to_string(), setting.clone()];
    let cold = Bound::Below(1e-20);
    let energy = Entry::new(&name("energy"), what("lattice at rest"), "½v²/c₀²", cold)
        .because(Evidence::Invariant, "Round-off of forces that cancel must not heat the lattice.");
    let exact = Bound::Equals(0.0);
    let time = Entry::new(&name("time"), what("clock of a long run"), "|t - n dt| [dx/c0]", exact)
        .because(Evidence::Invariant, "Time is counted in whole steps, so it does not drift.");
    let clock = format!("; t = {} after {} steps", steps as f64 * dt, record.cost.steps);
    vec![measured(energy, record, HEAT, ""), measured(time, record, CLOCK_ERROR, &clock)]
}

/// Two particles at one place, or all but, in a lattice stirred at 0.05 c₀.
pub fn coincident(
    variant: &str,
    settings: &ExtremeSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let (domain, mut particles) = torus(10);
    let mut random = Random::new(5);
    for particle in &mut particles {
        particle.velocity = Vector2::new(random.normal(), random.normal()) * 0.05;
    }
    let [first, second] = [33, 34];
    particles[second].position = particles[first].position + Vector2::new(settings.distance, 0.0);
    particles[second].velocity = particles[first].velocity;
    let initial = momentum(&particles);
    let scale: f64 = particles.iter().map(|p| p.mass * p.velocity.norm()).sum();
    let (mut record, simulation) = drive_to_end((variant, settings), (domain, particles), context)?;
    let particles = simulation.particles();
    record.put(MOMENTUM_ERROR, (momentum(&particles) - initial).norm() / scale);
    record.put(FASTEST, (2.0 * fastest(&particles)).sqrt());
    record.put(GAP, (particles[first].position - particles[second].position).norm());
    Ok(record)
}

/// Two particles at one place.
pub fn close() -> Vec<Experiment> {
    let at = |distance: f64| {
        let spec = EXTREMES.spec("coincident", |s| s.distance = distance);
        Experiment::of(spec, 0.1, move |record| {
            let setting = format!("distance {} dx", sci(distance));
            let what = ["two particles at one place".into(), setting];
            let name = format!("coincident.{distance:e}");
            let entry = Entry::new(&name, what, "momentum error/Σm|v|", Bound::Below(1e-12));
            let entry = entry.because(
                Evidence::Invariant,
                "The distance 0 must not be divided by. The run stays finite for 400 steps, and every pair \
                 force has its opposite.",
            );
            let [speed, gap] = [FASTEST, GAP].map(|key| completed(record, key));
            let more = format!("; fastest {} c₀, {} dx between them", sci(speed), sci(gap));
            match speed {
                Some(speed) if !speed.is_finite() => entry.found(f64::NAN, "not finite"),
                _ => measured(entry, record, MOMENTUM_ERROR, &more),
            }
        })
    };
    [0.0, 1e-14].map(at).into()
}

/// One particle, or several out of each other's reach.
pub fn alone(
    variant: &str,
    settings: &ExtremeSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let velocity = Vector2::new(0.3, -0.7);
    let place = |k: usize| Vector2::new(50.0 * k as f64, k as f64);
    let places: Vec<_> = (0..settings.count).map(place).collect();
    let particles = places.iter().map(|&x| Particle::fluid(x, velocity, 1.0, 1.0)).collect();
    let (mut record, simulation) =
        drive_to_end((variant, settings), (Domain::open(), particles), context)?;
    let flown = velocity * simulation.time();
    let off = |(p, x): (&Particle, &Vector2<f64>)| {
        (p.position - x - flown).norm() / flown.norm() + (p.density - 1.0).abs()
    };
    let particles = simulation.particles();
    record.put(FLIGHT_ERROR, particles.iter().zip(&places).map(off).fold(0.0, f64::max));
    Ok(record)
}

/// Particles without neighbours.
pub fn far() -> Vec<Experiment> {
    let of = |count: usize| {
        Experiment::of(EXTREMES.spec("alone", |s| s.count = count), 0.1, move |record| {
            let setting = format!("{count} in an open domain");
            let what = ["particles without neighbours".to_string(), setting];
            let (name, metric) = (format!("alone.{count}"), "distance from x₀ + v t over |v t|");
            let because = "Particles out of reach fly freely, and nothing changes their density.";
            let entry = Entry::new(&name, what, metric, Bound::Below(1e-12))
                .because(Evidence::Analytic, because);
            measured(entry, record, FLIGHT_ERROR, " after 1000 steps")
        })
    };
    [1, 4].map(of).into()
}

/// A block that hits another.
pub fn bullet(
    variant: &str,
    settings: &ExtremeSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let velocity = Vector2::new(settings.speed, 0.0);
    let at_rest = solver::lattice(Vector2::zeros(), 1.0, 10, 10).map(resting);
    let moving = solver::lattice(Vector2::new(-12.0, 0.0), 1.0, 10, 10)
        .map(|place| Particle { velocity, ..resting(place) });
    let particles: Vec<Particle> = at_rest.chain(moving).collect();
    let initial = momentum(&particles);
    let (mut record, simulation) =
        drive_to_end((variant, settings), (Domain::open(), particles), context)?;
    let particles = simulation.particles();
    let total = particles.iter().fold(-initial, |sum, p| sum + p.velocity * p.mass);
    let scale: f64 = particles.iter().map(|p| p.mass * p.velocity.norm()).sum();
    let error = if scale > 0.0 { total.norm() / scale } else { total.norm() };
    record.put(MOMENTUM_ERROR, error);
    record.put(FASTEST, (2.0 * fastest(&particles)).sqrt());
    Ok(record)
}

/// A block at 1000 c₀, with steps for sound and with steps for its speed.
pub fn fast_blocks() -> Vec<Experiment> {
    let of = |(name, dt, steps): (&'static str, f64, usize)| {
        let spec = EXTREMES.spec("bullet", |s| (s.dt, s.steps) = (dt, steps));
        Experiment::of(spec, 0.2, move |record| {
            let what = ["block at 1000 c₀".to_string(), format!("open domain, dt for {name}")];
            let metric = "momentum error/Σm|v|";
            let entry = Entry::new(&format!("bullet.{name}"), what, metric, Bound::Below(1e-12));
            let entry = entry.because(
                Evidence::Invariant,
                "The run stays finite with exact momentum. With time steps for sound the blocks pass \
                 through each other without a force, so there only finiteness is judged.",
            );
            let speed = completed(record, FASTEST);
            match speed {
                Some(speed) if !speed.is_finite() => entry.found(f64::NAN, "not finite"),
                _ => {
                    let more = speed.map_or(String::new(), |v| format!(", fastest {v:.0} c₀"));
                    measured(entry, record, MOMENTUM_ERROR, &more)
                }
            }
        })
    };
    [("sound", 0.3, 200), ("its speed", 1e-4, 2000)].map(of).into()
}

/// What is not a particle is refused before the first step, and the reason names it.
pub fn refused(
    variant: &str,
    settings: &ExtremeSettings,
    _context: &Context,
) -> Result<Record, RunError> {
    let method = plain::<CubicSpline, Leapfrog>();
    let build = |particles: Vec<Particle>, domain| {
        (method.build)(parts(&method, 1.2, 0.0, (domain, particles))).err()
    };
    let odd = |change: fn(&mut Particle)| {
        let (domain, mut particles) = torus(10);
        change(&mut particles[7]);
        build(particles, domain)
    };
    let is_seventh = |error: &Option<SceneError>| {
        error.as_ref().is_some_and(|error| error.of == Part::Particle(7))
    };
    let is_about = |error: Option<SceneError>, quantity: &str| {
        error.is_some_and(|error| (error.of, error.quantity) == (Part::Scene, quantity))
    };
    let [narrow, few] = [torus(10).1, Vec::new()];
    let refusals = [
        is_seventh(&odd(|p| p.position.x = f64::NAN)),
        is_seventh(&odd(|p| p.velocity.y = f64::INFINITY)),
        is_seventh(&odd(|p| p.mass = -1.0)),
        is_seventh(&odd(|p| p.density = 0.0)),
        is_about(build(narrow, Domain::torus(4.0, 10.0)), "period along x in m"),
        is_about(build(few, Domain::open()), "number of fluid particles"),
    ];
    let mut record = record_of(variant, settings);
    record.put(REFUSALS, refusals.iter().filter(|refused| **refused).count() as f64);
    Ok(record)
}

/// Scenes that are none.
pub fn no_scenes() -> Vec<Experiment> {
    let judge = |record: &Record| {
        let setting =
            "NaN place, infinite speed, negative mass, no density, period of 4 dx, no particle";
        let what = ["what is not a scene".to_string(), setting.into()];
        let because = "Each scene is refused for its own reason, by type, before the first step.";
        let entry = Entry::new("refused", what, "refusals", Bound::Equals(6.0))
            .because(Evidence::Invariant, because);
        measured(entry, record, REFUSALS, " of 6 refused")
    };
    vec![Experiment::of(EXTREMES.spec("refused", |_| ()), 0.1, judge)]
}
