//! One run: from settings to particles, stepping with the controller between stretches, record.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::record::Status;
use touchstone_harness::prelude::*;
use touchstone_harness::snapshot::{Snapshot, kinetic};
use touchstone_maths::{
    control::Controller,
    geometry::{Curve, Hill},
};
use touchstone_schemes::hill::{Driving, HillMethod};
use touchstone_solver::Role;

use super::{
    HillSettings, columns,
    measure::{Drive, Window, mean_velocity, measure, particles},
    reference::{HillReference, KNOWN_SETTINGS},
};
use crate::fluids::unit_flow::{FlowScales, UnitFlow};

/// Gap over the crest of the reference \[H\]: with U_b = 1 the flux per depth.
pub const FLUX: f64 = 2.035;

/// The numbers of one run, H = U_b = ρ = 1.
pub struct HillSetup {
    /// The settings they follow from.
    pub settings: HillSettings,
    /// The method that they are for.
    pub method: HillMethod,
    /// The channel.
    pub hill: Hill,
    /// Medium, time step, sound speed.
    pub flow: UnitFlow,
    /// Depth of the first row of wall particles \[dx\].
    pub first: f64,
    /// The reference, if there is one.
    pub reference: Option<&'static HillReference>,
}

impl HillSetup {
    /// Follows the rules for a method.
    ///
    /// # Errors
    /// If the settings make no run, or the reference cannot be read.
    pub fn new(method: &HillMethod, s: &HillSettings) -> Result<Self, RunError> {
        // The largest speed, over the crest, is below 1.6 U_b.
        let HillSettings { re, n, h_over_dx, c0, end, force, .. } = *s;
        let scales =
            FlowScales { re, n, h_over_dx, c0, end, speed: 1.6, force, area: 27.0, dt: None };
        let flow = UnitFlow::new(&method.properties, &s.numerics, scales);
        let hill = Hill::new(1.0).map_err(|e| RunError::Reference(e.to_string()))?;
        let reference = HillReference::of(s).map_err(|e| RunError::Reference(e.to_string()))?;
        if s.from_reference && reference.is_none() {
            return Err(RunError::Combination {
                key: "from_reference",
                value: "true".into(),
                allowed: format!("{KNOWN_SETTINGS}, the flows that have a reference"),
            });
        }
        let (settings, method) = (s.clone(), method.clone());
        let first = method.properties.first_row.depth();
        Ok(Self { settings, method, hill, flow, first, reference })
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

    /// Fluid in columns dx apart, each with the number of particles nearest to a spacing of dx between floor
    /// and lid, and with volumes that fill the column; behind floor and lid rows along them.
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
                let velocity = match self.reference {
                    Some(reference) if self.settings.from_reference => {
                        reference.velocity(x, (y - floor) / gap, gap)
                    }
                    _ => Vector2::zeros(),
                };
                particles.push(Particle::fluid(place, velocity, 1.0, width * spacing));
            }
        }
        for curve in self.curves() {
            let first = particles.len();
            for row in curve.rows_behind(dx, self.first, self.flow.support) {
                particles.extend(row.particles(dx, 1.0, |_| Vector2::zeros()));
            }
            // Eight in sequence share a list, which is shorter if they are behind the same fluid.
            particles[first..].sort_by(|a, b| a.position.x.total_cmp(&b.position.x));
        }
        particles
    }

    /// Floor and lid, the fluid on their left.
    fn curves(&self) -> [Curve; 2] {
        let (dx, period, lid) = (self.flow.medium.dx, self.hill.period(), self.hill.lid());
        let floor = Curve::new(|x| Vector2::new(x, self.floor(x)), [0.0, period], dx);
        [floor, Curve::new(|x| Vector2::new(x, lid), [period, 0.0], dx)]
    }
}

/// Steps between looks of the controller.
const STRETCH: f64 = 10.0;
/// Time between entries of the history \[H/U_b\].
const ENTRY: f64 = 0.5;
/// Samples of the field in the last part of the run, at most one for each action of the controller.
const SAMPLES: f64 = 40.0;

/// Whether a look is the first in an interval of the length `every`, if looks are a stretch apart.
fn is_first(time: f64, stretch: f64, every: f64) -> bool {
    let interval = |time: f64| ((time + 1e-9) / every).floor();
    time < 1.5 * stretch || interval(time) > interval(time - stretch)
}

/// Is a time in the last part of a run, which has this length?
fn is_last(time: f64, end: f64, length: f64) -> bool {
    (end - time) / length - 1e-9 < 1.0
}

/// The flow at a time.
#[derive(Serialize, Deserialize)]
struct FlowSample {
    /// \[s\].
    time: f64,
    drive: Drive,
    /// Kinetic energy \[J/m\].
    kinetic: f64,
}

/// Holds the flux and samples the flow through time.
#[derive(Serialize, Deserialize)]
pub struct Monitor {
    controller: Controller,
    window: Window,
    series: Vec<FlowSample>,
    /// Area of the fluid \[m²\].
    area: f64,
    /// Time between looks \[s\].
    stretch: f64,
    /// Mean velocity along x at the last look \[m/s\].
    mean: f64,
}

impl Monitor {
    /// After a stretch: the flow is sampled if it is time.
    fn look(&mut self, setup: &HillSetup, now: &Snapshot) {
        let (time, mean) = (now.time(), mean_velocity(now, self.area));
        self.mean = mean.clone().unwrap_or(self.mean);
        let flux = mean.map(|mean| mean * self.area / setup.hill.period());
        // The force of another code is not known.
        let force = now.simulation().map(|_| self.controller.force);
        let drive = Drive { force, flux };
        let HillSettings { end, average, .. } = setup.settings;
        if is_last(time, end, average * end) {
            self.window.drives.push(drive.clone());
            if is_first(time, self.stretch, average * end / SAMPLES) {
                self.window.sample(setup, now);
            }
        }
        if is_first(time, self.stretch, ENTRY) {
            self.series.push(FlowSample { time, drive, kinetic: kinetic(now.stored()) });
        }
    }
}

impl HillSetup {
    /// Looks of the controller.
    fn stretches(&self) -> f64 {
        (self.settings.end / (STRETCH * self.flow.rules.dt())).ceil().max(1.0)
    }
}

impl Problem for HillSetup {
    type Extra = ();
    type Simulation = dyn Driving;
    type Watch = Monitor;

    fn method(&self) -> &HillMethod {
        &self.method
    }

    fn brief(&self) -> Brief {
        Brief { samples: self.stretches(), ..self.flow.brief() }
    }

    fn times(&self) -> Vec<f64> {
        let stretches = self.stretches() as usize;
        let stretch = self.settings.end / stretches as f64;
        (1..=stretches).map(|k| stretch * k as f64).collect()
    }

    /// Walls extrapolate the pressure without the body force: over a spacing it is 1 % of the
    /// pressure of the flow and less.
    fn scene(&self) -> Result<Parts, RunError> {
        let domain = Domain::channel(self.hill.period());
        let parts = self.flow.parts(domain, self.particles());
        if !self.method.properties.has_feet {
            return Ok(parts);
        }
        let curves = self.curves();
        let [floor, lid] = curves.each_ref().map(Curve::nearest);
        let on_surface = |p: &Particle| match p.role {
            Role::Wall if p.position.y < self.hill.lid() => floor(p.position),
            Role::Wall => lid(p.position),
            _ => p.position,
        };
        Ok(Parts { surface: parts.particles.iter().map(on_surface).collect(), ..parts })
    }

    fn watch(&self, _: &Snapshot, start: &Snapshot) -> Monitor {
        let (s, area, period) = (&self.settings, self.area(), self.hill.period());
        let known = mean_velocity(start, area);
        let mean = known.clone().unwrap_or_default();
        let wanted = self.flux() * period / area;
        let controller = Controller::new(wanted, s.response, s.force, mean);
        let force = start.simulation().map(|_| s.force);
        let flux = known.map(|mean| mean * area / period);
        let (drive, kinetic) = (Drive { force, flux }, kinetic(start.stored()));
        let series = vec![FlowSample { time: 0.0, drive, kinetic }];
        let (window, stretch) = (Window::default(), s.end / self.stretches());
        Monitor { controller, window, series, area, stretch, mean }
    }

    fn calls(&self, calls: Calls<Self>, _: OptionalOutput) -> Calls<Self> {
        calls.at("samples", |setup, monitor, now, _, _| monitor.look(setup, now)).control(
            "controller",
            |_, monitor, simulation| {
                monitor.controller.look(monitor.mean, monitor.stretch);
                simulation.drive(monitor.controller.force);
            },
            |_, monitor, simulation| simulation.drive(monitor.controller.force),
        )
    }

    fn measure(
        &self,
        Monitor { window, series, area, .. }: Monitor,
        end: &Snapshot,
        record: &mut Record,
    ) {
        if record.status == Status::Completed {
            measure(self, &window, area, record);
            particles(self, end, OptionalOutput::of(&record.run).particles, record);
        }
        record.put_column(columns::TIME, &series, |at| at.time);
        record.put_known_column(columns::FORCE, &series, |at| at.drive.force.clone());
        record.put_known_column(columns::FLUX, &series, |at| at.drive.flux.clone());
        record.put_column(columns::KINETIC_ENERGY, &series, |at| at.kinetic);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fluids::periodic_hill::CASE;
    use touchstone_harness::case::Case;

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

    /// Clocks that were off by a part of a window passed every test.
    #[test]
    fn samples_come_at_their_times_and_in_the_last_part() {
        let is_last = |time| is_last(time, 40.0, 8.0);
        assert!(![0.0, 16.1, 31.9].into_iter().any(is_last));
        assert!([32.0, 32.1, 40.0].into_iter().all(is_last));
        let looks = (1..=1000).map(|k| f64::from(k) * 0.01);
        let times: Vec<f64> = looks.filter(|time| is_first(*time, 0.01, 0.5)).collect();
        let exact = (0..=20).map(|k| 0.5 * f64::from(k)).map(|t| t.max(0.01));
        assert!(times.len() == 21 && times.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}
