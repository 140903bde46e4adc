//! One run: scene, stepping with the controller between stretches, record.

use solver::EquationOfState;

use super::{
    HillMethod, HillSettings, NAME, Setup,
    control::{Controller, Driving},
    measure::{self, Window},
};
use base::record::{Profile, Record, Status};
use harness::{case::RunError, composed::Program, context::Context, runner::Drive, simulate};

/// Runs of the flow over hills.
pub const PROGRAM: Program<HillSettings, HillMethod> =
    Program { run, rules: |method, s| Ok(Setup::new(s, method, &Context::of_rules())?.flow.rules) };

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

base::bits! { Schedule { next, every } }

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

/// The number of the window of a time, of three of a `length` that end at `end`; none before the first. A
/// time between two belongs to the later one.
fn window_of(time: f64, end: f64, length: f64) -> Option<usize> {
    let left = (end - time) / length;
    usize::try_from(2 - (left - 1e-9).max(0.0).floor().min(3.0) as isize).ok()
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

harness::observed! {
    Monitor<'_>: changes(controller, windows, entry, sample, series), parts(), stays(setup, area)
}

impl Monitor<'_> {
    /// After a stretch: the controller acts, and the flow is sampled if it is time.
    fn look(&mut self, simulation: &mut dyn Driving, stretch: f64) {
        let (setup, time, force) = (self.setup, simulation.time(), self.controller.force);
        let mean = measure::mean_velocity(simulation, self.area);
        let flux = mean * self.area / setup.hill.period();
        let is_due = self.sample.has_come(time);
        let end = setup.settings.end;
        if let Some(k) = window_of(time, end, setup.settings.average * end) {
            self.windows[k].force(force, flux);
            if is_due {
                self.windows[k].sample(setup, simulation);
            }
        }
        self.controller.look(mean, stretch);
        simulation.drive(self.controller.force);
        if self.entry.has_come(time) {
            self.series.push([time, force, flux, kinetic_energy(simulation)]);
        }
    }
}

/// Σ m v²/2 of the fluid.
fn kinetic_energy(simulation: &dyn Driving) -> f64 {
    simulation.fluid().map(|(m, p)| 0.5 * m * p.velocity.norm_squared()).sum()
}

fn run(
    method: &HillMethod,
    variant: &str,
    settings: &HillSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let setup = &Setup::new(settings, method, context)?;
    let mut simulation = (method.build)(setup.parts(context))?;
    let (s, flow) = (&setup.settings, &setup.flow);
    let numbers = flow.rules.numbers([s.h_over_dx, flow.medium.dx]);
    let mut record = simulate::begin((NAME, variant), s, method, &numbers, context);
    let stretches = (s.end / (STRETCH * flow.rules.dt())).ceil().max(1.0) as usize;
    let stretch = s.end / stretches as f64;
    let times: Vec<f64> = (1..=stretches).map(|k| stretch * k as f64).collect();
    let area = setup.area();
    let wanted = setup.flux() * setup.hill.period() / area;
    let last = measure::mean_velocity(&*simulation, area);
    let controller = Controller { wanted, response: s.response, force: s.force, last };
    let start = [0.0, s.force, last * area / setup.hill.period(), kinetic_energy(&*simulation)];
    let (windows, series) = (Default::default(), vec![start]);
    let entry = Schedule { next: 0.0, every: ENTRY };
    let sample = Schedule { next: 0.0, every: s.average * s.end / SAMPLES };
    let mut monitor = Monitor { setup, area, controller, windows, entry, sample, series };
    let pressure = |density| flow.medium.eos.pressure(density);
    (record.status, record.cost) =
        Drive::new(&mut *simulation, flow.rules.dt(), &times, &pressure, &mut monitor)
            .at("controller and samples", &|monitor, s, _| monitor.look(s, stretch))
            .resumed(&|monitor, simulation| {
                // Until its first look the force is that of the scene, which may have a deliberate error.
                if !monitor.series.is_empty() {
                    simulation.drive(monitor.controller.force);
                }
            })
            .run(context)?;
    if record.status == Status::Completed {
        measure::measure(setup, &monitor.windows, area, &mut record);
        let (particles, outside) = measure::particles(setup, &*simulation);
        record.put(measure::OUTSIDE, outside as f64);
        record.put(measure::WALL_OFFSET, measure::wall_offset(setup, &*simulation));
        if context.keep_particles {
            record.profiles.insert("particles".into(), particles);
        }
    }
    record.profiles.insert("series".into(), profile(&monitor.series));
    record.state = Some(simulate::state(&simulation.particles()));
    Ok(record)
}

fn profile(series: &[[f64; 4]]) -> Profile {
    let column = |k: usize| series.iter().map(|row| row[k]).collect();
    Profile::default()
        .with("t", "H/U_b", column(0))
        .with("force", "U_b^2/H", column(1))
        .with("flux", "U_b H", column(2))
        .with("kinetic energy", "rho U_b^2 H^2", column(3))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Clocks that were off by a part of a window passed every test.
    #[test]
    fn samples_come_at_their_times_and_in_their_windows() {
        let window = |time| window_of(time, 40.0, 8.0);
        assert_eq!([0.0, 15.9].map(window), [None; 2]);
        assert_eq!([16.1, 23.9].map(window), [Some(0); 2]);
        assert_eq!([24.1, 31.9].map(window), [Some(1); 2]);
        assert_eq!([32.0, 32.1, 40.0].map(window), [Some(2); 3]);
        let mut schedule = Schedule { next: 0.0, every: 0.5 };
        let looks = (1..=1000).map(|k| f64::from(k) * 0.01);
        let times: Vec<f64> = looks.filter(|time| schedule.has_come(*time)).collect();
        let exact = (0..=20).map(|k| 0.5 * f64::from(k)).map(|t| t.max(0.01));
        assert!(times.len() == 21 && times.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}
