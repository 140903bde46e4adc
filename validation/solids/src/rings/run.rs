//! One run of the rings: scene, stepping, record.

use solver::{
    ArtificialViscosity, CauchyStress, Compose, Continuity, CubicSpline, JaumannRate, Linear, Open,
    Particle, Scene, Scheme, Simulation, Symmetric, Xsph,
};

use super::{
    RingSettings, Rings, Tensile,
    budget::{self, Budget},
    measure::{self, Series},
    reference::Reference,
};
use base::{
    number,
    record::{self, Metric, Profile, Record, Status},
};
use harness::{
    case::RunError,
    runner::{self, Context, Frames},
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
    let frames = Frames::of(context)?;
    let mut series = Series::new(rings);
    let mut budget = Budget::default();
    simulation.advance(0.0, rings.dt, &mut ());
    budget.sample(rings, &simulation, &powers(rings, &simulation));
    keep(rings, &simulation, 0.0, context, &mut record);
    let stops = stops(rings, context);
    let times: Vec<f64> = stops.iter().map(|s| s.0).collect();
    let mut failed_frame = None;
    let (status, cost) =
        runner::drive(&mut simulation, rings.dt, &times, context, &mut series, &mut |s, k| {
            match (stops[k].1, &frames) {
                (Due::Frame, Some(frames)) => {
                    failed_frame = failed_frame.take().or(frames.write(s, &rings.eos).err());
                }
                (Due::Budget, _) => budget.sample(rings, s, &powers(rings, s)),
                _ => {}
            }
            keep(rings, s, times[k], context, &mut record);
        });
    if let Some(error) = failed_frame {
        return Err(error.into());
    }
    let particles = measure::seen(rings, &simulation);
    if status == Status::Completed {
        series.sample(simulation.time(), &particles);
        series.measure(&mut record);
        budget.measure(rings, &mut record);
        if let Some(reference) = Reference::of(&rings.settings) {
            reference.compare(&series, &mut record);
        }
        let momentum = measure::momentum_error(rings, &particles);
        let formula = "|sum m v| at the end/momentum of one ring, exactly 0";
        record.metrics.insert("momentum".into(), Metric::new(momentum, "-", formula));
        let courant = rings.dt * (rings.cp + rings.v) / rings.h;
        let formula = "dt (c_p + V)/h, c_p = ((K + 4 mu/3)/rho)^(1/2)";
        record.metrics.insert("courant".into(), Metric::new(courant, "-", formula));
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

/// What is due at a stop, beside pictures.
#[derive(Clone, Copy)]
enum Due {
    Nothing,
    Frame,
    Budget,
}

/// (time \[s\], what is due), ascending.
fn stops(rings: &Rings, context: &Context) -> Vec<(f64, Due)> {
    let end = rings.settings.end / rings.c0;
    let pictures = pictures(context).into_iter().filter(|share| *share > 0.0);
    let mut stops: Vec<(f64, Due)> = pictures.map(|share| (share * end, Due::Nothing)).collect();
    let sample = |k: usize| (end * k as f64 / budget::SAMPLES as f64, Due::Budget);
    stops.extend((1..=budget::SAMPLES).map(sample));
    if let Some((_, count)) = context.frames {
        stops.extend((1..=count).map(|k| (end * k as f64 / count as f64, Due::Frame)));
    }
    stops.sort_by(|a, b| a.0.total_cmp(&b.0));
    stops
}

/// Keeps x, y and the largest principal stress at the times of pictures.
fn keep<S: Scheme<Extra = Symmetric>>(
    rings: &Rings,
    simulation: &Simulation<S>,
    time: f64,
    context: &Context,
    record: &mut Record,
) {
    let end = rings.settings.end / rings.c0;
    let is_due = pictures(context).into_iter().find(|share| share * end == time);
    let (true, Some(share)) = (context.keep_particles, is_due) else { return };
    let all = measure::seen(rings, simulation);
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
