//! One run of a channel flow: scene, stepping, record.

use nalgebra::Vector2;
use solver::{EquationOfState, Integrator, Kernel, Limits, Role, Scene, Scheme};

use super::{
    Arrangement, ChannelSettings, Drive, Flow, Ingredient, Setup,
    measure::{self, Sample, Series},
};
use base::{
    number,
    random::Random,
    record::{self, Record},
};
use harness::{
    case::{Rules, RunError},
    runner::{self, Context},
};
use maths::theory::Stepping;

/// A scheme whose terms and walls can be made from the settings of a channel.
pub trait ChannelScheme:
    Scheme<Extra = (), Forces: Ingredient, Drift: Ingredient, Walls: Arrangement>
{
}

impl<S> ChannelScheme for S where
    S: Scheme<Extra = (), Forces: Ingredient, Drift: Ingredient, Walls: Arrangement>
{
}

/// The scene of a setup, in the scheme `S`.
pub fn scene<S: ChannelScheme>(setup: &Setup) -> Scene<S> {
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
    S: ChannelScheme<Integrator: Stepping>,
{
    run_scene::<S>(B::FLOW, variant, settings, &uses::<S>(), context, scene::<S>)
}

/// What the rules choose for the scheme `S` of the flow driven by `B`.
pub fn rules<B, S>(settings: &ChannelSettings) -> Result<Rules, RunError>
where
    B: Drive,
    S: ChannelScheme<Integrator: Stepping>,
{
    let uses = uses::<S>();
    let setup = Setup::new::<S::Kernel, S::Integrator>(B::FLOW, settings, &uses, true)?;
    let Setup { dt, dt_limit, eos, .. } = setup;
    Ok(Rules { dt, dt_limit, sound_speed: eos.sound_speed })
}

/// Optional settings that the types of `S` read.
pub fn uses<S: ChannelScheme>() -> Vec<&'static str> {
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
    S: Scheme<Extra = (), Walls: Arrangement, Integrator: Stepping>,
{
    let setup =
        Setup::new::<S::Kernel, S::Integrator>(flow, settings, uses, context.allow_unstable)?;
    let mut scene = scene(&setup);
    if context.threads <= 1 {
        scene.parallel_from = usize::MAX;
    }
    let mut simulation = scene.build()?;
    let json = serde_json::to_value(settings).unwrap_or_default();
    let mut record = Record::new(flow.name(), variant, json, context.threads.max(1));
    describe(&setup, [S::Kernel::NAME, S::Integrator::NAME, S::Walls::NAME], &mut record);

    let compared = settings.compared();
    let times: Vec<f64> = compared.iter().map(|tau| setup.time(*tau)).collect();
    let mut series = Series::new(&setup, simulation.fluid_count());
    let (status, cost) = runner::drive(
        &mut simulation,
        setup.dt,
        &times,
        context,
        &mut series,
        &|density| setup.eos.pressure(density),
        &mut |simulation, k| {
            let sample = Sample::of(&setup, simulation);
            measure::compare(&setup, &sample, compared[k], &mut record);
        },
    )?;
    if status == record::Status::Completed {
        let sample = Sample::of(&setup, &simulation);
        measure::at_the_end(&setup, &sample, &mut record);
        if context.keep_particles {
            record.profiles.insert("particles".into(), measure::particles(&setup, &sample));
        }
    }
    let mode = series.mode_until(simulation.time());
    record.profiles.extend(mode.map(|mode| (measure::MODE.into(), mode)));
    record.profiles.insert("series".into(), series.into_profile());
    record.state = Some(record::digest(&measure::state(&simulation.particles())));
    (record.status, record.cost) = (status, cost);
    Ok(record)
}

/// Name of the kernel among what a run chose.
pub const KERNEL: &str = "kernel";

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
    let words = [(KERNEL, kernel), ("integrator", integrator), ("walls", walls)];
    let numerics = &mut record.numerics;
    numerics.extend(numbers.map(|(name, value)| (name.to_string(), number::json(value))));
    numerics.extend(words.map(|(name, word)| (name.to_string(), word.into())));
    numerics.insert("columns".into(), setup.columns.into());
}
