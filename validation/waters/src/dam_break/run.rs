//! One run of the collapse: scene, stepping, record.

use solver::{EquationOfState, Integrator, Kernel, Particle, Role, Scene, Scheme, Simulation};

use super::{
    Dam, DamSettings, NAME, Vessel,
    measure::{Gauge, Seen},
    reference,
};
use crate::water::{Ingredient, Ledger};
use base::{
    number,
    record::{self, Metric, Profile, Record, Status},
};
use harness::{
    case::RunError,
    runner::{self, Context, Frames},
};
use maths::{metrics::budget::Itemised, theory::Stepping};

/// Times at which particles are kept for pictures, shares of the run.
pub const PICTURES: [f64; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
/// Those, or as many at equal intervals as the context asks for.
fn pictures(context: &Context) -> Vec<f64> {
    match context.pictures {
        Some(count) => (0..count).map(|k| k as f64 / (count.max(2) - 1) as f64).collect(),
        None => PICTURES.to_vec(),
    }
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

/// Runs and measures.
pub fn run<S>(variant: &str, settings: &DamSettings, context: &Context) -> Result<Record, RunError>
where
    S: Scheme<Extra = ()>,
    S::Forces: Ingredient,
    S::Drift: Ingredient,
    S::Walls: Vessel,
    S::Integrator: Stepping,
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
    let mut seen = Seen::new(dam, &scene.forces);
    let mut gauge = Gauge::<S::Kernel>::new(dam);
    let frames = Frames::of(context)?;
    let filled = water_mass(&scene.particles);
    let mut simulation = scene.build()?;
    let stops = stops(dam, context);
    let times: Vec<f64> = stops.iter().map(|s| s.time).collect();
    let mut failed = None;
    let (status, cost) =
        runner::drive(&mut simulation, dam.dt, &times, context, &mut gauge, &mut |s, k| {
            seen.sample(s);
            ledger.sample(s);
            if let (true, Some(frames)) = (stops[k].frame, &frames) {
                failed = failed.take().or(frames.write(s, &dam.medium.eos).err());
            }
            if let (true, Some(share)) = (context.keep_particles, stops[k].picture) {
                record.profiles.insert(format!("particles@{share}"), picture(dam, s));
            }
        });
    if let Some(error) = failed {
        return Err(error.into());
    }
    let particles = simulation.particles();
    let mass = water_mass(&particles);
    seen.measure(mass, &mut record);
    let formula =
        "|mass of the water at the end/that at the start - 1|, of all particles, lost ones too";
    let error = Metric::new((mass / filled - 1.0).abs(), "-", formula);
    record.metrics.insert("mass_error".into(), error);
    let fall = 0.5 * mass * dam.settings.gravity * dam.settings.height;
    ledger.measure(fall, "M g H/2, the potential energy of the column", &mut record);
    if status == Status::Completed
        && let Err(error) = reference::compare(dam, &seen, &gauge, &mut record)
    {
        // Packages are embedded and checked by a test.
        record.numerics.insert("reference".into(), error.to_string().into());
    }
    record.state = Some(record::digest(&state(&particles)));
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
    let json = serde_json::to_value(&dam.settings).unwrap_or_default();
    let mut record = Record::new(NAME, variant, json, context.threads.max(1));
    let numbers = [
        ("h/dx", dam.settings.h_over_dx),
        ("dx [m]", dam.medium.dx),
        ("c0 [m/s]", dam.medium.eos.sound_speed),
        ("dt [s]", dam.dt),
        ("dt/limit", dam.dt / dam.dt_limit),
    ];
    let numerics = &mut record.numerics;
    numerics.extend(numbers.map(|(name, value)| (name.to_string(), number::json(value))));
    numerics.insert("kernel".into(), S::Kernel::NAME.into());
    numerics.insert("integrator".into(), S::Integrator::NAME.into());
    numerics.insert("walls".into(), walls.into());
    record
}

/// A time at which the run stops to be looked at.
struct Stop {
    /// \[s\].
    time: f64,
    /// Whether a frame is due.
    frame: bool,
    /// The picture that is due, by its share of the run.
    picture: Option<f64>,
}

/// Stops, ascending: a whole number of steps apart, so that none is shortened.
fn stops(dam: &Dam, context: &Context) -> Vec<Stop> {
    let (end, dt) = (dam.settings.end * dam.unit_time(), dam.dt);
    let (h, eos) = (dam.medium.h, dam.medium.eos);
    let crossing = SAMPLE * h / (eos.sound_speed + dam.medium.speed);
    let every = (crossing.max(end / MOST_SAMPLES) / dt).round().max(1.0) * dt;
    let count = (end / every - 0.5).floor().max(0.0) as usize;
    let at = |k: usize| Stop { time: k as f64 * every, frame: false, picture: None };
    let mut stops: Vec<Stop> = (0..=count).map(at).collect();
    stops.push(Stop { time: end, frame: false, picture: None });
    for share in pictures(context) {
        let nearest = (share * end / every).round() as usize;
        let last = stops.len() - 1;
        stops[nearest.min(last)].picture = Some(share);
    }
    if let Some((_, count)) = context.frames {
        let frame = |k: usize| end * (k as f64 / count as f64);
        stops.extend((1..=count).map(|k| Stop { time: frame(k), frame: true, picture: None }));
        stops.sort_by(|a, b| a.time.total_cmp(&b.time));
    }
    stops
}

/// x, y and the pressure.
fn picture<S: Scheme<Extra = ()>>(dam: &Dam, simulation: &Simulation<S>) -> Profile {
    let fluid: Vec<_> = simulation.fluid().map(|(_, p)| *p).collect();
    let unit = dam.settings.height;
    let pressure = |density: f64| dam.medium.eos.pressure(density) / dam.unit_pressure();
    Profile::default()
        .with("x", "H", fluid.iter().map(|p| p.position.x / unit).collect())
        .with("y", "H", fluid.iter().map(|p| p.position.y / unit).collect())
        .with("p", "rho g H", fluid.iter().map(|p| pressure(p.density)).collect())
}

/// All of the state, in the order of the scene.
fn state(particles: &[Particle]) -> Vec<f64> {
    let numbers = |p: &Particle| {
        let (x, v) = (p.position, p.velocity);
        [x.x, x.y, v.x, v.y, p.density]
    };
    particles.iter().flat_map(numbers).collect()
}
