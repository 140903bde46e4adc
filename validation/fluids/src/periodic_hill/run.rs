//! One run: scene, stepping with the controller between stretches, record.

use solver::{Integrator, Kernel, Limits, Scene, Scheme};

use super::{
    HillSettings,
    control::{Controller, Driven},
    measure::{self, Window},
    setup::{HillWall, Setup},
};
use crate::{channel, fluid::Ingredient};
use base::{
    number,
    record::{self, Metric, Profile, Record, Status},
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
    S::Walls: HillWall,
{
    let fluid = &setup.fluid;
    let particles = setup.particles::<S::Kernel, S::Walls>();
    let (forces, drift) = (S::Forces::new(fluid), S::Drift::new(fluid));
    let mut scene =
        Scene::new(fluid.h, setup.domain(), particles, forces, drift, S::Walls::walls(setup));
    scene.skin = setup.settings.skin * fluid.h;
    // 30 % compression or twice the speed of sound is not a weakly compressible fluid any more.
    scene.limits = Limits { density: [0.7, 1.3], speed: 2.0 * (1.6 + fluid.eos.sound_speed) };
    scene
}

/// Runs the scheme `S` and measures.
pub fn run<S>(variant: &str, settings: &HillSettings, context: &Context) -> Result<Record, RunError>
where
    S: Scheme<Extra = ()>,
    S::Forces: Ingredient + Driven,
    S::Drift: Ingredient,
    S::Walls: HillWall,
    S::Integrator: Stepping,
{
    let setup = Setup::new::<S>(settings, context.allow_unstable)?;
    run_scene(&setup, variant, scene::<S>(&setup), context)
}

/// Steps between looks of the controller.
const STRETCH: f64 = 10.0;
/// Time between entries of the history \[H/U_b\].
const ENTRY: f64 = 0.5;
/// Samples of the field in a window, as far as the controller looks that often: disorder, and not the
/// decay, is what moves a mean of few.
const SAMPLES: f64 = 40.0;

/// Something due once in a while.
struct Due {
    next: f64,
    every: f64,
}

impl Due {
    fn at(&mut self, time: f64) -> bool {
        let due = time >= self.next - 1e-9;
        if due {
            self.next = self.every * ((time + 1e-9) / self.every + 1.0).floor();
        }
        due
    }
}

/// What is seen through time.
struct Seen<'a> {
    setup: &'a Setup,
    area: f64,
    controller: Controller,
    windows: [Window; 3],
    entry: Due,
    sample: Due,
    /// t, force, flux, kinetic energy.
    series: Vec<[f64; 4]>,
}

impl Seen<'_> {
    /// The window of a time: 3 before the first.
    fn window(&mut self, time: f64) -> Option<&mut Window> {
        let s = &self.setup.settings;
        let left = (s.end - time) / (s.average * s.end);
        // The last stretch ends at the end itself.
        let k = 2 - (left - 1e-9).max(0.0).floor().min(3.0) as isize;
        usize::try_from(k).ok().map(|k| &mut self.windows[k])
    }

    /// After a stretch: the controller acts, and the flow is sampled if it is time.
    fn look<S>(&mut self, simulation: &mut solver::Simulation<S>, stretch: f64)
    where
        S: Scheme<Extra = ()>,
        S::Forces: Driven,
    {
        let time = simulation.time();
        let mean = measure::mean_velocity(simulation, self.area);
        let flux = mean * self.area / self.setup.hill.period();
        let force = self.controller.force;
        if let Some(window) = self.window(time) {
            window.force(force, flux);
        }
        self.controller.look(mean, stretch);
        simulation.forces_mut().drive(self.controller.force);
        if self.entry.at(time) {
            let energy: f64 =
                simulation.fluid().map(|(m, p)| 0.5 * m * p.velocity.norm_squared()).sum();
            self.series.push([time, force, flux, energy]);
        }
        if self.sample.at(time) {
            let setup = self.setup;
            if let Some(window) = self.window(time) {
                window.sample(setup, simulation);
            }
        }
    }
}

/// Runs a scene and measures it against the setup: the same measuring for a scene that is not what
/// its settings say.
pub fn run_scene<S>(
    setup: &Setup,
    variant: &str,
    mut scene: Scene<S>,
    context: &Context,
) -> Result<Record, RunError>
where
    S: Scheme<Extra = ()>,
    S::Forces: Driven,
    S::Walls: HillWall,
{
    if context.threads <= 1 {
        scene.parallel_from = usize::MAX;
    }
    let mut simulation = scene.build()?;
    let s = &setup.settings;
    let json = serde_json::to_value(s).unwrap_or_default();
    let mut record = Record::new(super::NAME, variant, json, context.threads.max(1));
    describe(setup, [S::Kernel::NAME, S::Integrator::NAME, S::Walls::NAME], &mut record);
    let frames = Frames::of(context)?;
    let every = context.frames.as_ref().map_or(0, |(_, count)| *count);
    let stretches = (s.end / (STRETCH * setup.dt)).ceil().max(1.0) as usize;
    let stretch = s.end / stretches as f64;
    let times: Vec<f64> = (1..=stretches).map(|k| stretch * k as f64).collect();
    let area = setup.area();
    let wanted = setup.flux() * setup.hill.period() / area;
    let last = measure::mean_velocity(&simulation, area);
    let controller = Controller { wanted, response: s.response, force: s.force, last };
    let (windows, series) = (Default::default(), Vec::new());
    let entry = Due { next: 0.0, every: ENTRY };
    let sample = Due { next: 0.0, every: s.average * s.end / SAMPLES };
    let mut seen = Seen { setup, area, controller, windows, entry, sample, series };
    let mut failed = None;
    let (status, cost) =
        runner::drive(&mut simulation, setup.dt, &times, context, &mut (), &mut |sim, k| {
            seen.look(sim, stretch);
            let due = every > 0 && (k + 1) * every / stretches > k * every / stretches;
            if let (true, Some(frames)) = (due, &frames) {
                failed = failed.take().or(frames.write(sim, &setup.fluid.eos).err());
            }
        });
    if let Some(error) = failed {
        return Err(error.into());
    }
    if status == Status::Completed {
        measure::measure(setup, &seen.windows, area, &mut record);
        let (particles, outside) = measure::particles(setup, &simulation);
        let formula = "particles behind the walls at the end";
        record.metrics.insert("outside".into(), Metric::new(outside as f64, "-", formula));
        let offset = measure::wall_offset(setup, &simulation, S::Walls::FIRST);
        let formula = "largest distance of the first row of wall particles from its place";
        record.metrics.insert("wall_offset".into(), Metric::new(offset, "dx", formula));
        if context.keep_particles {
            record.profiles.insert("particles".into(), particles);
        }
    }
    record.profiles.insert("series".into(), profile(&seen.series));
    record.state = Some(record::digest(&channel::state(&simulation.particles())));
    (record.status, record.cost) = (status, cost);
    Ok(record)
}

/// What the run chose.
fn describe(setup: &Setup, [kernel, integrator, walls]: [&str; 3], record: &mut Record) {
    let fluid = &setup.fluid;
    let numbers = [
        ("h/dx", fluid.h / fluid.dx),
        ("dx [m]", fluid.dx),
        ("c0 [m/s]", fluid.eos.sound_speed),
        ("dt [s]", setup.dt),
        ("dt/limit", setup.dt / setup.dt_limit),
    ];
    let words = [("kernel", kernel), ("integrator", integrator), ("walls", walls)];
    let numerics = &mut record.numerics;
    numerics.extend(numbers.map(|(name, value)| (name.to_string(), number::json(value))));
    numerics.extend(words.map(|(name, word)| (name.to_string(), word.into())));
}

fn profile(series: &[[f64; 4]]) -> Profile {
    let column = |k: usize| series.iter().map(|row| row[k]).collect();
    Profile::default()
        .with("t", "H/U_b", column(0))
        .with("force", "U_b^2/H", column(1))
        .with("flux", "U_b H", column(2))
        .with("kinetic energy", "rho U_b^2 H^2", column(3))
}
