//! One run of the collapse: scene, stepping, record.

use std::collections::BTreeMap;

use solver::{EquationOfState, Integrator, Kernel, Particle, Role, Scene, Scheme, Stepper};

use super::{
    Dam, DamSettings, NAME, Vessel,
    measure::{Gauge, Samples},
    metrics, reference,
};
use crate::water::{self, Ledger, WaterScheme};
use base::record::{Profile, Record, Status};
use harness::{
    case::{Rules, RunError},
    runner::{self, Context},
    simulate::state,
};
use maths::metrics::budget::Itemised;

/// Times at which particles are kept for pictures, shares of the run.
pub const PICTURES: [f64; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];

/// Those, or as many at equal intervals as the context asks for; none if no picture needs them.
fn pictures(context: &Context) -> Vec<f64> {
    match context.pictures {
        Some(count) => (0..count).map(|k| share(k, count)).collect(),
        None if context.keep_particles => PICTURES.to_vec(),
        None => Vec::new(),
    }
}

/// The share of the run at which one of so many pictures is taken.
pub fn share(k: usize, count: usize) -> f64 {
    k as f64 / (count.max(2) - 1) as f64
}

/// Time between samples \[h/(c0 + v)\], rounded to whole steps: powers and forces are summed over them,
/// and those of an impact last as long as sound takes across a few smoothing lengths. With 0.015
/// (H/g)^(1/2) at any spacing the impact alone left 1e-3 of the energy unaccounted for, whatever the step.
const SAMPLE: f64 = 4.0;
/// At most so many samples.
const MOST_SAMPLES: f64 = 2e4;

/// The observers of a run, for a scene that has the types of a variant or of a spoiled one.
pub trait Watched: Scheme<Extra = (), Forces: Itemised<()>, Drift: Itemised<()>> {}
impl<S: Scheme<Extra = (), Forces: Itemised<()>, Drift: Itemised<()>>> Watched for S {}

/// What the rules choose.
pub fn rules<S: WaterScheme>(settings: &DamSettings) -> Result<Rules, RunError> {
    let Dam { dt, dt_limit, medium, .. } = Dam::new::<S>(settings, true)?;
    Ok(Rules { dt, dt_limit, sound_speed: medium.eos.sound_speed })
}

/// Runs and measures.
pub fn run<S>(variant: &str, settings: &DamSettings, context: &Context) -> Result<Record, RunError>
where
    S: WaterScheme<Walls: Vessel>,
{
    let dam = Dam::new::<S>(settings, context.allow_unstable)?;
    run_scene::<S>(&dam, variant, S::Walls::NAME, dam.scene::<S>(), context)
}

/// Runs a scene and measures it against the setup: the same measuring for a scene that is not what
/// its settings say.
pub fn run_scene<S: Watched>(
    dam: &Dam,
    variant: &str,
    walls: &str,
    mut scene: Scene<S>,
    context: &Context,
) -> Result<Record, RunError> {
    if context.threads <= 1 {
        scene.parallel_from = usize::MAX;
    }
    let mut record = begin::<S>(dam, variant, walls, context);
    let mut ledger = Ledger::new(dam.medium.water(), &scene.forces, &scene.drift);
    let mut samples = Samples::new(dam, &scene.forces);
    let mut gauge = Gauge::<S::Kernel>::new(dam);
    let filled = water_mass(&scene.particles);
    let mut simulation = scene.build()?;
    let (times, pictures) = stops(dam, context);
    let pressure = |density| dam.medium.eos.pressure(density);
    let (status, cost) = runner::drive(
        &mut simulation,
        dam.dt,
        &times,
        context,
        &mut gauge,
        &pressure,
        &mut |s, k| {
            samples.sample(s);
            ledger.sample(s);
            if let Some(share) = pictures.get(&k) {
                record.profiles.insert(format!("particles@{share}"), picture(dam, s));
            }
        },
    )?;
    let particles = simulation.particles();
    let mass = water_mass(&particles);
    samples.measure(mass, &mut record);
    record.put(metrics::MASS_ERROR, (mass / filled - 1.0).abs());
    let fall = 0.5 * mass * dam.settings.gravity * dam.settings.height;
    ledger.measure(fall, "M g H/2, the potential energy of the column", &mut record);
    if status == Status::Completed
        && let Err(error) = reference::compare(dam, &samples, &gauge, &mut record)
    {
        // Packages are embedded and checked by a test.
        record.numerics.insert("reference".into(), error.to_string().into());
    }
    record.state = Some(state(&particles));
    (record.status, record.cost) = (status, cost);
    Ok(record)
}

/// Mass of the water \[kg/m\], added in the order of the scene: in that of storage, which changes, its
/// last bits would.
fn water_mass(particles: &[Particle]) -> f64 {
    particles.iter().filter(|p| p.role == Role::Fluid).map(|p| p.mass).sum()
}

/// A record with what the run chose.
fn begin<S: Scheme>(dam: &Dam, variant: &str, walls: &str, context: &Context) -> Record {
    let numbers = [
        ("h/dx", dam.settings.h_over_dx),
        ("dx [m]", dam.medium.dx),
        ("c0 [m/s]", dam.medium.eos.sound_speed),
        ("dt [s]", dam.dt),
        ("dt/limit", dam.dt / dam.dt_limit),
    ];
    let words =
        [("kernel", S::Kernel::NAME), ("integrator", S::Integrator::NAME), ("walls", walls)];
    water::begin((NAME, variant), &dam.settings, numbers, words, context)
}

/// Times of samples \[s\], ascending, a whole number of steps apart, so that none is shortened; and the
/// samples that are pictures, by their share of the run.
fn stops(dam: &Dam, context: &Context) -> (Vec<f64>, BTreeMap<usize, f64>) {
    let (end, dt) = (dam.settings.end * dam.unit_time(), dam.dt);
    let (h, eos) = (dam.medium.h, dam.medium.eos);
    let crossing = SAMPLE * h / (eos.sound_speed + dam.medium.speed);
    let every = (crossing.max(end / MOST_SAMPLES) / dt).round().max(1.0) * dt;
    let count = (end / every - 0.5).floor().max(0.0) as usize;
    let mut times: Vec<f64> = (0..=count).map(|k| k as f64 * every).collect();
    times.push(end);
    let last = times.len() - 1;
    let nearest = |share: f64| ((share * end / every).round() as usize).min(last);
    (times, pictures(context).into_iter().map(|share| (nearest(share), share)).collect())
}

/// x, y and the pressure.
fn picture(dam: &Dam, simulation: &dyn Stepper<()>) -> Profile {
    let fluid: Vec<_> = simulation.fluid().map(|(_, p)| *p).collect();
    let unit = dam.settings.height;
    let pressure = |density: f64| dam.medium.eos.pressure(density) / dam.unit_pressure();
    Profile::default()
        .with("x", "H", fluid.iter().map(|p| p.position.x / unit).collect())
        .with("y", "H", fluid.iter().map(|p| p.position.y / unit).collect())
        .with("p", "rho g H", fluid.iter().map(|p| pressure(p.density)).collect())
}
