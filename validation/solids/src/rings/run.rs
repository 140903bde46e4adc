//! One run of the rings: scene, stepping, record.

use solver::{
    ArtificialViscosity, CauchyStress, Compose, Continuity, CubicSpline, EquationOfState,
    JaumannRate, Linear, Open, Particle, Scene, Scheme, Simulation, Stepper, Symmetric, Xsph,
};

use super::{
    RingSettings, Rings, Tensile,
    budget::{self, Budget},
    measure::{self, Series},
    metrics::{COURANT, MOMENTUM},
    reference::Reference,
};
use base::{
    number,
    record::{self, Profile, Record, Status},
};
use harness::{
    case::{Rules, RunError},
    runner::{self, Context},
};
use maths::{metrics::budget::Items, theory::Stepping};

/// Stress and artificial viscosity; density, deviator and XSPH; nothing else.
pub type Rubber<R, I> = Compose<
    CubicSpline,
    (CauchyStress<Linear, R>, ArtificialViscosity<Linear>),
    (Continuity, JaumannRate, Xsph),
    Open,
    I,
    Symmetric,
>;

/// Times at which particles are kept for pictures, shares of the run.
pub const PICTURES: [f64; 6] = [0.0, 0.16, 0.3, 0.4, 0.6, 1.0];

/// Those times, or as many as were asked for.
fn pictures(context: &Context) -> Vec<f64> {
    match context.pictures {
        Some(count) => (0..count).map(|k| k as f64 / (count - 1).max(1) as f64).collect(),
        None => PICTURES.to_vec(),
    }
}

/// Runs and measures.
pub fn run<R, I>(
    variant: &str,
    settings: &RingSettings,
    context: &Context,
) -> Result<Record, RunError>
where
    R: Tensile,
    I: Stepping<Symmetric>,
{
    let rings = Rings::new::<I>(settings, context.allow_unstable)?;
    run_scene(&rings, variant, I::NAME, rings.scene::<R, I>(), &budget::powers::<R, _>, context)
}

/// What the rules choose.
pub fn rules<I: Stepping<Symmetric>>(settings: &RingSettings) -> Result<Rules, RunError> {
    let Rings { dt, dt_limit, c0: sound_speed, .. } = Rings::new::<I>(settings, true)?;
    Ok(Rules { dt, dt_limit, sound_speed })
}

/// What the terms of a scene do to its energy \[W/m\].
pub type Powers<'a, S> = &'a dyn Fn(&Rings, &Simulation<S>) -> Items;

/// Runs a scene and measures it against the setup: the same measuring for a scene that is not what
/// its settings say.
pub fn run_scene<S: Scheme<Extra = Symmetric>>(
    rings: &Rings,
    variant: &str,
    integrator: &str,
    mut scene: Scene<S>,
    powers: Powers<S>,
    context: &Context,
) -> Result<Record, RunError> {
    if context.threads <= 1 {
        scene.parallel_from = usize::MAX;
    }
    let mut simulation = scene.build()?;
    let mut record = begin(rings, variant, integrator, context);
    let mut series = Series::new(rings);
    let mut budget = Budget::default();
    simulation.advance(0.0, rings.dt, &mut ());
    budget.sample(rings, &simulation, &powers(rings, &simulation));
    keep(rings, &simulation, 0.0, context, &mut record);
    let stops = stops(rings, context);
    let times: Vec<f64> = stops.iter().map(|stop| stop.time).collect();
    let pressure = |density| rings.eos.pressure(density);
    let (status, cost) = runner::drive(
        &mut simulation,
        rings.dt,
        &times,
        context,
        &mut series,
        &pressure,
        &mut |s, k| {
            if stops[k].is_sample {
                budget.sample(rings, s, &powers(rings, s));
            }
            keep(rings, s, times[k], context, &mut record);
        },
    )?;
    let particles = measure::along_flight(rings, &simulation);
    if status == Status::Completed {
        series.sample(simulation.time(), &particles);
        series.measure(&mut record);
        budget.measure(rings, &mut record);
        if let Some(reference) = Reference::of(&rings.settings) {
            reference.compare(&series, &mut record);
        }
        record.put(MOMENTUM, measure::momentum_error(rings, &particles));
        record.put(COURANT, rings.dt * (rings.cp + rings.v) / rings.h);
    }
    record.profiles.insert("series".into(), series.profile());
    record.state = Some(record::digest(&state(&simulation.particles())));
    (record.status, record.cost) = (status, cost);
    Ok(record)
}

/// A record with what the run chose.
fn begin(rings: &Rings, variant: &str, integrator: &str, context: &Context) -> Record {
    let json = serde_json::to_value(&rings.settings).unwrap_or_default();
    let mut record = Record::new(super::NAME, variant, json, context.threads.max(1));
    let numbers = [
        ("h/dx", rings.settings.h_over_dx),
        ("dx [m]", rings.dx),
        ("V [m/s]", rings.v),
        ("c0 [m/s]", rings.c0),
        ("c_p [m/s]", rings.cp),
        ("dt [s]", rings.dt),
        ("dt/limit", rings.dt / rings.dt_limit),
    ];
    let numerics = &mut record.numerics;
    numerics.extend(numbers.map(|(name, value)| (name.to_string(), number::json(value))));
    numerics.insert("kernel".into(), "cubic spline".into());
    numerics.insert("integrator".into(), integrator.into());
    record
}

/// A stop of a run: for a picture, or for a sample of the energy budget.
struct Stop {
    /// \[s\].
    time: f64,
    is_sample: bool,
}

/// Ascending.
fn stops(rings: &Rings, context: &Context) -> Vec<Stop> {
    let end = rings.settings.end / rings.c0;
    let pictures = pictures(context).into_iter().filter(|share| *share > 0.0);
    let picture = |share: f64| Stop { time: share * end, is_sample: false };
    let count = rings.settings.samples;
    let sample = |k: usize| Stop { time: end * k as f64 / count as f64, is_sample: true };
    let samples = (1..=count).map(sample);
    let mut stops: Vec<Stop> = pictures.map(picture).chain(samples).collect();
    stops.sort_by(|a, b| a.time.total_cmp(&b.time));
    stops
}

/// Keeps x, y and the largest principal stress at the times of pictures.
fn keep(
    rings: &Rings,
    simulation: &dyn Stepper<Symmetric>,
    time: f64,
    context: &Context,
    record: &mut Record,
) {
    let end = rings.settings.end / rings.c0;
    let picture = pictures(context).into_iter().find(|share| share * end == time);
    let (true, Some(share)) = (context.keep_particles, picture) else { return };
    let all = measure::along_flight(rings, simulation);
    let column = |f: &dyn Fn(&Particle<Symmetric>) -> f64| all.iter().map(f).collect::<Vec<f64>>();
    let largest = |p: &Particle<Symmetric>| {
        let (m, d) = (0.5 * (p.extra.xx + p.extra.yy), 0.5 * (p.extra.xx - p.extra.yy));
        let pressure = rings.c0 * rings.c0 * (p.density - rings.settings.rho);
        m + d.hypot(p.extra.xy) - pressure
    };
    let profile = Profile::default()
        .with("x", "m", column(&|p| p.position.x))
        .with("y", "m", column(&|p| p.position.y))
        .with("stress", "Pa", column(&largest));
    record.profiles.insert(format!("particles@{share}"), profile);
}

/// All of the state, in the order of the scene.
fn state(particles: &[Particle<Symmetric>]) -> Vec<f64> {
    let numbers = |p: &Particle<Symmetric>| {
        let (x, v, s) = (p.position, p.velocity, p.extra);
        [x.x, x.y, v.x, v.y, p.density, s.xx, s.yy, s.xy]
    };
    particles.iter().flat_map(numbers).collect()
}
