//! One run: scene, stepping with the controller between stretches, record.

use solver::{EquationOfState, Integrator, Kernel, Limits, Scene, Scheme, Simulation};

use super::{
    HillSettings,
    control::{Controller, Driven},
    measure::{self, Window},
    setup::{HillWall, Setup},
};
use crate::fluid::{self, Ingredient};
use base::record::{Profile, Record, Status};
use harness::{
    case::RunError,
    runner::{self, Context},
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

/// Times at equal intervals.
struct Schedule {
    next: f64,
    every: f64,
}

impl Schedule {
    /// Has the next time come?
    fn has_come(&mut self, time: f64) -> bool {
        let has_come = time >= self.next - 1e-9;
        if has_come {
            self.next = self.every * ((time + 1e-9) / self.every + 1.0).floor();
        }
        has_come
    }
}

/// Holds the flux and samples the flow through time.
struct Monitor<'a> {
    setup: &'a Setup,
    area: f64,
    controller: Controller,
    windows: [Window; 3],
    entry: Schedule,
    sample: Schedule,
    /// t, force, flux, kinetic energy.
    series: Vec<[f64; 4]>,
}

impl Monitor<'_> {
    /// The window of a time: 3 before the first.
    fn window(&mut self, time: f64) -> Option<&mut Window> {
        let s = &self.setup.settings;
        let left = (s.end - time) / (s.average * s.end);
        // The last stretch ends at the end itself.
        let k = 2 - (left - 1e-9).max(0.0).floor().min(3.0) as isize;
        usize::try_from(k).ok().map(|k| &mut self.windows[k])
    }

    /// After a stretch: the controller acts, and the flow is sampled if it is time.
    fn look<S>(&mut self, simulation: &mut Simulation<S>, stretch: f64)
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
        if self.entry.has_come(time) {
            let energy: f64 =
                simulation.fluid().map(|(m, p)| 0.5 * m * p.velocity.norm_squared()).sum();
            self.series.push([time, force, flux, energy]);
        }
        if self.sample.has_come(time) {
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
    let stretches = (s.end / (STRETCH * setup.dt)).ceil().max(1.0) as usize;
    let stretch = s.end / stretches as f64;
    let times: Vec<f64> = (1..=stretches).map(|k| stretch * k as f64).collect();
    let area = setup.area();
    let wanted = setup.flux() * setup.hill.period() / area;
    let last = measure::mean_velocity(&simulation, area);
    let controller = Controller { wanted, response: s.response, force: s.force, last };
    let (windows, series) = (Default::default(), Vec::new());
    let entry = Schedule { next: 0.0, every: ENTRY };
    let sample = Schedule { next: 0.0, every: s.average * s.end / SAMPLES };
    let mut monitor = Monitor { setup, area, controller, windows, entry, sample, series };
    let pressure = |density| setup.fluid.eos.pressure(density);
    let mut look = |simulation: &mut Simulation<S>, _| monitor.look(simulation, stretch);
    let (status, cost) =
        runner::drive(&mut simulation, setup.dt, &times, context, &mut (), &pressure, &mut look)?;
    if status == Status::Completed {
        measure::measure(setup, &monitor.windows, area, &mut record);
        let (particles, outside) = measure::particles(setup, &simulation);
        record.put(measure::OUTSIDE, outside as f64);
        record.put(measure::WALL_OFFSET, measure::wall_offset(setup, &simulation, S::Walls::FIRST));
        if context.keep_particles {
            record.profiles.insert("particles".into(), particles);
        }
    }
    record.profiles.insert("series".into(), profile(&monitor.series));
    record.state = Some(harness::simulate::state(&simulation.particles()));
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
    fluid::describe(&numbers, &words, record);
}

fn profile(series: &[[f64; 4]]) -> Profile {
    let column = |k: usize| series.iter().map(|row| row[k]).collect();
    Profile::default()
        .with("t", "H/U_b", column(0))
        .with("force", "U_b^2/H", column(1))
        .with("flux", "U_b H", column(2))
        .with("kinetic energy", "rho U_b^2 H^2", column(3))
}
