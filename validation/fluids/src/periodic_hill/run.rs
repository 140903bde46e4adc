//! One run: scene, stepping with the controller between stretches, record.

use base::{functions::exp, record::*};
use harness::{case::RunError, context::Context, runner::Drive, simulate};
use schemes::hill::{Driving, HillMethod};

use super::{HillSettings, Setup, measure::*};

/// Steps between looks of the controller.
const STRETCH: f64 = 10.0;
/// Time between entries of the history \[H/U_b\].
const ENTRY: f64 = 0.5;
/// Samples of the field in the last part of the run, as far as the controller looks that often.
const SAMPLES: f64 = 40.0;

/// Is a look the first in an interval of the length `every`, if looks are a stretch apart?
fn is_first([time, stretch]: [f64; 2], every: f64) -> bool {
    let interval = |time: f64| ((time + 1e-9) / every).floor();
    time < 1.5 * stretch || interval(time) > interval(time - stretch)
}

/// Is a time in the last part of a run, which has this length?
fn is_last(time: f64, end: f64, length: f64) -> bool {
    (end - time) / length - 1e-9 < 1.0
}

/// The force that holds the flux: f' = \[(u* − u)/T − u'\]/t, u the mean velocity along x over the fluid, u*
/// the one wanted.
///
/// As u' = f − d with the drag d of the walls, f follows d within t, and u goes to u* within T. At rest
/// f = d whatever d is.
///
/// With t = T/4 both roots are −2/T: the fastest without overshoot.
#[derive(Clone, Copy, Debug)]
struct Controller {
    /// u* \[m/s\].
    wanted: f64,
    /// T \[s\]; 0 keeps the force.
    response: f64,
    /// The force now \[m/s²\].
    force: f64,
    /// u at the last look \[m/s\].
    last: f64,
}

harness::observed! { Controller: changes(wanted, response, force, last), stays() }

impl Controller {
    /// Looks at the mean velocity after `dt` \[s\].
    fn look(&mut self, mean: f64, dt: f64) {
        if self.response > 0.0 {
            let settle = 0.25 * self.response;
            // Exact for a constant right-hand side: never more than the whole way.
            let share = 1.0 - exp(-dt / settle);
            self.force += share * ((self.wanted - mean) / self.response - (mean - self.last) / dt);
        }
        self.last = mean;
    }
}

/// Holds the flux and samples the flow through time.
struct Monitor {
    controller: Controller,
    window: Window,
    /// t, force, flux, kinetic energy.
    series: Vec<[f64; 4]>,
}

harness::observed! { Monitor: changes(controller, window, series), stays() }

impl Monitor {
    /// After a stretch: the controller acts, and the flow is sampled if it is time.
    fn look(&mut self, setup: &Setup, area: f64, simulation: &mut dyn Driving, stretch: f64) {
        let (time, force) = (simulation.time(), self.controller.force);
        let mean = mean_velocity(simulation, area);
        let flux = mean * area / setup.hill.period();
        let HillSettings { end, average, .. } = setup.settings;
        if is_last(time, end, average * end) {
            self.window.forces.push([force, flux]);
            if is_first([time, stretch], average * end / SAMPLES) {
                self.window.sample(setup, simulation);
            }
        }
        self.controller.look(mean, stretch);
        simulation.drive(self.controller.force);
        if is_first([time, stretch], ENTRY) {
            self.series.push([time, force, flux, kinetic_energy(simulation)]);
        }
    }
}

/// Σ m v²/2 of the fluid.
fn kinetic_energy(simulation: &dyn Driving) -> f64 {
    simulation.data().fluid().map(|(m, p)| 0.5 * m * p.velocity.norm_squared()).sum()
}

/// One run of the flow over hills.
pub fn run(method: &HillMethod, s: &HillSettings, context: &Context) -> Result<Record, RunError> {
    let setup = &Setup::new(s, method, context)?;
    let mut simulation = (method.build)(setup.parts(context))?;
    let flow = &setup.flow;
    let numbers = flow.rules.numbers([s.h_over_dx, flow.medium.dx]);
    let mut record = simulate::begin(method, &numbers, context);
    let stretches = (s.end / (STRETCH * flow.rules.dt())).ceil().max(1.0) as usize;
    let stretch = s.end / stretches as f64;
    let times: Vec<f64> = (1..=stretches).map(|k| stretch * k as f64).collect();
    let area = setup.area();
    let wanted = setup.flux() * setup.hill.period() / area;
    let last = mean_velocity(&*simulation, area);
    let controller = Controller { wanted, response: s.response, force: s.force, last };
    let start = [0.0, s.force, last * area / setup.hill.period(), kinetic_energy(&*simulation)];
    let mut monitor = Monitor { controller, window: Window::default(), series: vec![start] };
    Drive::new(&mut *simulation, flow.rules.dt(), &times, flow.medium.eos, &mut monitor)
        .at("controller and samples", &|monitor, s, _| monitor.look(setup, area, s, stretch))
        .resumed(&|monitor, simulation| {
            // Until its first look the force is that of the scene, which may have a deliberate error.
            if !monitor.series.is_empty() {
                simulation.drive(monitor.controller.force);
            }
        })
        .run(context)?
        .put(&mut record);
    if record.status == Status::Completed {
        measure(setup, &monitor.window, area, &mut record);
        particles(setup, &*simulation, context.spec.keep.particles, &mut record);
    }
    let (force, flux) = (("force", "U_b^2/H"), ("flux", "U_b H"));
    let columns = [("t", "H/U_b"), force, flux, ("kinetic energy", "rho U_b^2 H^2")];
    record.profiles.insert("series".into(), Profile::of_rows(&columns, &monitor.series));
    Ok(record)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body with a drag that grows with its speed.
    #[test]
    fn the_flux_is_met_and_the_force_is_the_drag() {
        let (mut speed, dt, rate) = (0.0, 0.02, 0.3);
        let mut controller = Controller { wanted: 0.8, response: 1.0, force: 0.0, last: 0.0 };
        let mut largest = 0.0_f64;
        for _ in 0..2000 {
            speed += dt * (controller.force - rate * speed);
            controller.look(speed, dt);
            largest = largest.max(speed);
        }
        assert!((speed - 0.8).abs() < 1e-9 && (controller.force - 0.24).abs() < 1e-9);
        assert!(largest < 0.82, "{largest}");
    }

    #[test]
    fn without_response_the_force_stays() {
        let mut controller = Controller { wanted: 1.0, response: 0.0, force: 0.3, last: 0.0 };
        controller.look(0.1, 0.1);
        assert_eq!(controller.force, 0.3);
    }

    /// Clocks that were off by a part of a window passed every test.
    #[test]
    fn samples_come_at_their_times_and_in_the_last_part() {
        let is_last = |time| is_last(time, 40.0, 8.0);
        assert!(![0.0, 16.1, 31.9].into_iter().any(is_last));
        assert!([32.0, 32.1, 40.0].into_iter().all(is_last));
        let looks = (1..=1000).map(|k| f64::from(k) * 0.01);
        let times: Vec<f64> = looks.filter(|time| is_first([*time, 0.01], 0.5)).collect();
        let exact = (0..=20).map(|k| 0.5 * f64::from(k)).map(|t| t.max(0.01));
        assert!(times.len() == 21 && times.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}
