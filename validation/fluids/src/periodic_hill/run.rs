//! One run: from settings to particles, stepping with the controller between stretches, record.

use base::record::{Profile, Record, Status};
use harness::{
    case::RunError, composed::Program, context::Context, method::Parts, runner::Drive, simulate,
};
use maths::geometry::{Curve, Hill};
use nalgebra::Vector2;
use solver::{Domain, EquationOfState, Particle};

use super::{
    HillMethod, HillSettings, NAME,
    control::{Controller, Driving},
    measure::{self, Window},
    reference::{KNOWN_SETTINGS, Reference},
};
use crate::unit_flow::{Scales, UnitFlow};

/// Gap over the crest of the reference \[H\]: with U_b = 1 the flux per depth.
pub const FLUX: f64 = 2.035;

/// The numbers of one run, H = U_b = ρ = 1.
pub struct Setup {
    /// The settings they follow from.
    pub settings: HillSettings,
    /// The channel.
    pub hill: Hill,
    /// Medium, time step, sound speed.
    pub flow: UnitFlow,
    /// Depth of the first row of wall particles \[dx\].
    pub first: f64,
    /// What to compare with, where there is something.
    pub reference: Option<&'static Reference>,
}

impl Setup {
    /// Follows the rules for a method.
    ///
    /// # Errors
    /// If the settings make no run, or the reference cannot be read.
    pub fn new(s: &HillSettings, method: &HillMethod, context: &Context) -> Result<Self, RunError> {
        // The largest speed, over the crest, is below 1.6 U_b.
        let scales = Scales { speed: 1.6, force: s.force, area: 27.0, dt: None };
        let flow = s.flow(method, scales, context)?;
        let hill = Hill::new(1.0).map_err(|e| RunError::Reference(e.to_string()))?;
        let reference = Reference::of(s).map_err(|e| RunError::Reference(e.to_string()))?;
        if s.from_reference && reference.is_none() {
            return Err(RunError::Combination {
                key: "from_reference",
                value: "true".into(),
                allowed: format!("{KNOWN_SETTINGS}, the flows that have a reference"),
            });
        }
        let first = method.first_row.depth();
        Ok(Self { settings: s.clone(), hill, flow, first, reference })
    }

    /// The scene. Walls extrapolate the pressure without the body force: over a spacing it is 1 % of the
    /// pressure of the flow and less.
    pub fn parts(&self, context: &Context) -> Parts {
        self.flow.parts(Domain::channel(self.hill.period()), self.particles(), context)
    }

    /// Height of the floor at x \[m\].
    pub fn floor(&self, x: f64) -> f64 {
        self.settings.crest * self.hill.wall(x)
    }

    /// Slope of the floor at x, by a difference over 2e-5 H.
    pub fn slope(&self, x: f64) -> f64 {
        (self.floor(x + 1e-5) - self.floor(x - 1e-5)) / 2e-5
    }

    /// The flux wanted \[m²/s\].
    pub fn flux(&self) -> f64 {
        self.settings.flux * FLUX
    }

    /// Area of the fluid \[m²\], midpoint rule.
    pub fn area(&self) -> f64 {
        let (count, lid, period) = (9000, self.hill.lid(), self.hill.period());
        let cell = period / f64::from(count);
        (0..count).map(|k| (lid - self.floor((f64::from(k) + 0.5) * cell)) * cell).sum()
    }

    /// Fluid in columns dx apart, each with as many particles as come nearest to a spacing of dx between
    /// floor and lid, and of such a volume that they fill it; behind floor and lid rows along them.
    fn particles(&self) -> Vec<Particle> {
        let (dx, lid) = (self.flow.medium.dx, self.hill.lid());
        let columns = (self.hill.period() / dx).round() as usize;
        let width = self.hill.period() / columns as f64;
        let mut particles = Vec::new();
        for i in 0..columns {
            let x = (i as f64 + 0.5) * width;
            let (floor, gap) = (self.floor(x), lid - self.floor(x));
            let count = (gap / dx).round().max(2.0);
            let spacing = gap / count;
            let lowest = usize::from(self.first == 0.0);
            for k in lowest..count as usize {
                let y = floor + (k as f64 + self.first) * spacing;
                let place = Vector2::new(x, y);
                let velocity = self.start(place, (y - floor) / gap, gap);
                particles.push(Particle::fluid(place, velocity, 1.0, width * spacing));
            }
        }
        for curve in self.curves() {
            for row in curve.rows_behind(dx, self.first, self.flow.support) {
                particles.extend(row.particles(dx, 1.0, |_| Vector2::zeros()));
            }
        }
        particles
    }

    /// Floor and lid, the fluid on their left.
    fn curves(&self) -> [Curve; 2] {
        let (dx, period, lid) = (self.flow.medium.dx, self.hill.period(), self.hill.lid());
        let floor = Curve::new(|x| Vector2::new(x, self.floor(x)), [0.0, period], dx);
        [floor, Curve::new(|x| Vector2::new(x, lid), [period, 0.0], dx)]
    }

    /// The velocity at the start \[m/s\], s the height over that of the section, which is `gap`.
    fn start(&self, place: Vector2<f64>, s: f64, gap: f64) -> Vector2<f64> {
        match self.reference {
            Some(reference) if self.settings.from_reference => reference.velocity(place.x, s, gap),
            _ => Vector2::zeros(),
        }
    }
}

/// Runs of the flow over hills.
pub const PROGRAM: Program<HillSettings, HillMethod> =
    Program { run, rules: |method, s| Ok(Setup::new(s, method, &Context::of_rules())?.flow.rules) };

/// Steps between looks of the controller.
const STRETCH: f64 = 10.0;
/// Time between entries of the history \[H/U_b\].
const ENTRY: f64 = 0.5;
/// Samples of the field in the last part of the run, as far as the controller looks that often.
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

/// Is a time in the last part of a run, which has this length?
fn is_last(time: f64, end: f64, length: f64) -> bool {
    (end - time) / length - 1e-9 < 1.0
}

/// Holds the flux and samples the flow through time.
struct Monitor<'a> {
    setup: &'a Setup,
    area: f64,
    controller: Controller,
    window: Window,
    entry: Schedule,
    sample: Schedule,
    /// t, force, flux, kinetic energy.
    series: Vec<[f64; 4]>,
}

harness::observed! {
    Monitor<'_>: changes(controller, window, entry, sample, series), parts(), stays(setup, area)
}

impl Monitor<'_> {
    /// After a stretch: the controller acts, and the flow is sampled if it is time.
    fn look(&mut self, simulation: &mut dyn Driving, stretch: f64) {
        let (setup, time, force) = (self.setup, simulation.time(), self.controller.force);
        let mean = measure::mean_velocity(simulation, self.area);
        let flux = mean * self.area / setup.hill.period();
        let (is_due, s) = (self.sample.has_come(time), &setup.settings);
        if is_last(time, s.end, s.average * s.end) {
            self.window.forces.push([force, flux]);
            if is_due {
                self.window.sample(setup, simulation);
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
    let (window, series) = (Window::default(), vec![start]);
    let entry = Schedule { next: 0.0, every: ENTRY };
    let sample = Schedule { next: 0.0, every: s.average * s.end / SAMPLES };
    let mut monitor = Monitor { setup, area, controller, window, entry, sample, series };
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
        measure::measure(setup, &monitor.window, area, &mut record);
        measure::particles(setup, &*simulation, context.keep_particles, &mut record);
    }
    let (force, flux) = (("force", "U_b^2/H"), ("flux", "U_b H"));
    let columns = [("t", "H/U_b"), force, flux, ("kinetic energy", "rho U_b^2 H^2")];
    record.profiles.insert("series".into(), Profile::of_rows(&columns, &monitor.series));
    record.state = Some(simulate::state(&simulation.particles()));
    Ok(record)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::periodic_hill::CASE;
    use harness::case::Case;

    /// Clocks that were off by a part of a window passed every test.
    #[test]
    fn samples_come_at_their_times_and_in_the_last_part() {
        let is_last = |time| is_last(time, 40.0, 8.0);
        assert!(![0.0, 16.1, 31.9].into_iter().any(is_last));
        assert!([32.0, 32.1, 40.0].into_iter().all(is_last));
        let mut schedule = Schedule { next: 0.0, every: 0.5 };
        let looks = (1..=1000).map(|k| f64::from(k) * 0.01);
        let times: Vec<f64> = looks.filter(|time| schedule.has_come(*time)).collect();
        let exact = (0..=20).map(|k| 0.5 * f64::from(k)).map(|t| t.max(0.01));
        assert!(times.len() == 21 && times.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    /// Runs that have no reference started from rest without a word.
    #[test]
    fn a_start_from_a_reference_that_does_not_exist_is_refused() {
        let rules = |set: fn(&mut HillSettings)| {
            let spec = CASE.spec("carried", |s| {
                s.from_reference = true;
                set(s);
            });
            CASE.rules(&spec).map(|_| ()).map_err(|error| error.to_string())
        };
        assert_eq!(rules(|_| {}), Ok(()));
        let others: [fn(&mut HillSettings); 3] =
            [|s| s.re = 30.0, |s| s.crest = 0.5, |s| s.flux = 0.5];
        for refused in others.map(rules) {
            let words = refused.expect_err("refused");
            assert!(
                words.contains("from_reference is true") && words.contains("re = 10"),
                "{words}"
            );
        }
    }
}
