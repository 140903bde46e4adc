//! One run of a channel flow: scene, stepping, record.

use nalgebra::Vector2;
use solver::{Integrator, Kernel, Limits, Role, Scene, Scheme};

use super::{
    Arrangement, ChannelSettings, Drive, Flow, Ingredient, Setup, TIMES,
    measure::{self, Seen, Series},
};
use base::{
    number,
    random::Random,
    record::{self, Record},
};
use harness::{
    case::RunError,
    runner::{self, Context, Frames},
};
use maths::theory::Stepping;

/// The scene of a setup, in the scheme `S`.
pub fn scene<S>(setup: &Setup) -> Scene<S>
where
    S: Scheme<Extra = ()>,
    S::Forces: Ingredient,
    S::Drift: Ingredient,
    S::Walls: Arrangement,
{
    let s = &setup.settings;
    let mut particles = S::Walls::particles::<S::Kernel>(setup);
    let mut random = Random::new(1);
    for p in particles.iter_mut().filter(|p| p.role == Role::Fluid && s.jitter > 0.0) {
        let offset = Vector2::new(random.normal(), random.normal());
        p.position += offset * (s.jitter * setup.dx);
        // Gaussian tails must not put a particle behind a wall.
        p.position.y = p.position.y.clamp(0.1 * setup.dx, s.width - 0.1 * setup.dx);
    }
    let domain = solver::Domain::channel(setup.length());
    let (forces, drift) = (S::Forces::new(setup), S::Drift::new(setup));
    let mut scene = Scene::new(setup.h, domain, particles, forces, drift, S::Walls::walls(setup));
    // Half a period at most; one that is shorter than two supports is refused by the scene itself.
    scene.skin = (s.skin * setup.h).min(setup.length() - S::Kernel::SUPPORT * setup.h).max(0.0);
    // 30 % compression or twice the speed of sound is not a weakly compressible fluid any more.
    let speed = 2.0 * (setup.eos.sound_speed + setup.v);
    scene.limits = Limits { density: [0.7 * s.rho, 1.3 * s.rho], speed };
    scene
}

/// Runs the scheme `S` of the flow driven by `B` and measures.
pub fn run<B, S>(
    variant: &str,
    settings: &ChannelSettings,
    context: &Context,
) -> Result<Record, RunError>
where
    B: Drive,
    S: Scheme<Extra = ()>,
    S::Forces: Ingredient,
    S::Drift: Ingredient,
    S::Walls: Arrangement,
    S::Integrator: Stepping,
{
    run_scene::<S>(B::FLOW, variant, settings, &uses::<S>(), context, scene::<S>)
}

/// Optional settings that the types of `S` read.
pub fn uses<S>() -> Vec<&'static str>
where
    S: Scheme<Extra = ()>,
    S::Forces: Ingredient,
    S::Drift: Ingredient,
    S::Walls: Arrangement,
{
    [S::Forces::uses(), S::Drift::uses(), S::Walls::USES.to_vec()].concat()
}

/// Runs the scene that `scene` makes of the setup, and measures it against the setup: the same
/// measuring for a scene that is not what its settings say.
pub fn run_scene<S>(
    flow: Flow,
    variant: &str,
    settings: &ChannelSettings,
    uses: &[&str],
    context: &Context,
    scene: impl FnOnce(&Setup) -> Scene<S>,
) -> Result<Record, RunError>
where
    S: Scheme<Extra = ()>,
    S::Walls: Arrangement,
    S::Integrator: Stepping,
{
    let setup =
        Setup::new::<S::Kernel, S::Integrator>(flow, settings, uses, context.allow_unstable)?;
    let mut scene = scene(&setup);
    if context.threads <= 1 {
        scene.parallel_from = usize::MAX;
    }
    let mut simulation = scene.build()?;
    let json = serde_json::to_value(settings).unwrap_or_default();
    let case = if flow == Flow::Couette { "couette" } else { "poiseuille" };
    let mut record = Record::new(case, variant, json, context.threads.max(1));
    describe(&setup, [S::Kernel::NAME, S::Integrator::NAME, S::Walls::NAME], &mut record);

    let frames = Frames::of(context)?;
    let stops = stops(&setup, context);
    let times: Vec<f64> = stops.iter().map(|s| s.time).collect();
    let mut series = Series::new(&setup, simulation.fluid_count());
    let mut failed_frame = None;
    let (status, cost) = runner::drive(
        &mut simulation,
        setup.dt,
        &times,
        context,
        &mut series,
        &mut |simulation, k| {
            if let Some(tau) = stops[k].compare {
                measure::compare(&setup, &Seen::of(&setup, simulation), tau, &mut record);
            }
            if let (true, Some(frames)) = (stops[k].frame, &frames) {
                failed_frame = failed_frame.take().or(frames.write(simulation, &setup.eos).err());
            }
        },
    );
    if let Some(error) = failed_frame {
        return Err(error.into());
    }
    if status == record::Status::Completed {
        let seen = Seen::of(&setup, &simulation);
        measure::at_the_end(&setup, &seen, &mut record);
        if context.keep_particles {
            record.profiles.insert("particles".into(), measure::particles(&setup, &seen));
        }
    }
    record.profiles.insert("series".into(), series.into_profile());
    record.state = Some(record::digest(&measure::state(&simulation.particles())));
    (record.status, record.cost) = (status, cost);
    Ok(record)
}

/// What the run chose.
fn describe(setup: &Setup, [kernel, integrator, walls]: [&str; 3], record: &mut Record) {
    let numbers = [
        ("h/dx", setup.settings.h_over_dx),
        ("dx [m]", setup.dx),
        ("V [m/s]", setup.v),
        ("c0 [m/s]", setup.eos.sound_speed),
        ("c0/V", setup.eos.sound_speed / setup.v),
        ("c0 h/nu", setup.eos.sound_speed * setup.h / setup.settings.nu),
        ("dt [s]", setup.dt),
        ("dt/limit", setup.dt / setup.dt_limit),
    ];
    let words = [("kernel", kernel), ("integrator", integrator), ("walls", walls)];
    let numerics = &mut record.numerics;
    numerics.extend(numbers.map(|(name, value)| (name.to_string(), number::json(value))));
    numerics.extend(words.map(|(name, word)| (name.to_string(), word.into())));
    numerics.insert("columns".into(), setup.columns.into());
}

/// A time at which the run pauses.
struct Stop {
    time: f64,
    /// νt/L² where the profile is compared.
    compare: Option<f64>,
    frame: bool,
}

/// Times of comparison up to the end, the end itself, and the times of frames.
fn stops(setup: &Setup, context: &Context) -> Vec<Stop> {
    let end = setup.settings.end;
    let mut compared: Vec<f64> = TIMES.into_iter().filter(|tau| *tau < end).collect();
    compared.push(end);
    let stop = |tau: f64, compare, frame| Stop { time: setup.time(tau), compare, frame };
    let mut stops: Vec<Stop> = compared.iter().map(|&tau| stop(tau, Some(tau), false)).collect();
    if let Some((_, count)) = context.frames {
        stops.extend((1..=count).map(|k| stop(end * k as f64 / count as f64, None, true)));
    }
    stops.sort_by(|a, b| a.time.total_cmp(&b.time));
    stops
}
