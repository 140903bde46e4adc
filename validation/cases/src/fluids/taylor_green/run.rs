//! One run of the vortices: scene, stepping, record.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::{absent::Absent, random::Random, record::Status};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    pictures, rules,
    snapshot::{self, Point, Snapshot},
};
use touchstone_maths::{
    exact::TaylorGreen,
    geometry::nearest,
    metrics::norms::{largest, relative},
};
use touchstone_solver::EquationOfState;

use super::VortexSettings;
use crate::fluids::unit_flow::{FlowScales, UnitFlow};

/// The numbers of one run, L = U = ρ = 1.
pub struct VortexSetup {
    settings: VortexSettings,
    method: Method,
    exact: TaylorGreen,
    /// Medium, time step, sound speed.
    pub flow: UnitFlow,
}

touchstone_base::metrics! {
    all ALL;
    L2 = "l2" ["-"] "(sum |v - v_exact|^2/sum |v_exact|^2)^(1/2) over particles at the end";
    L2_WORST = "l2_worst" ["-"] "largest l2 over 40 times, while 1 % of the speed of the start is left";
    ENERGY = "energy" ["-"] "kinetic energy over the exact one at the end, minus 1";
    MOMENTUM_ADDED = "momentum_added" ["-"]
        "|sum m v at the end - sum m v at the start|/(sum m U), exactly 0";
    PRESSURE_L2 = "pressure_l2" ["-"] "(sum (p - mean - p_exact)^2/sum p_exact^2)^(1/2) at the end";
    NEAREST = "nearest" ["-"] "least distance of two particles over dx";
}

impl VortexSetup {
    /// Follows the rules for a method.
    pub fn new(method: &Method, s: &VortexSettings) -> Self {
        let VortexSettings { re, n, h_over_dx, c0, end, dt, .. } = *s;
        let scales =
            FlowScales { re, n, h_over_dx, c0, end, speed: 1.0, force: 0.0, area: 1.0, dt };
        let flow = UnitFlow::new(&method.properties, &s.numerics, scales);
        let exact = TaylorGreen { nu: flow.medium.nu };
        Self { settings: s.clone(), method: method.clone(), exact, flow }
    }

    /// Particles of equal volume with the velocity and the pressure of the flow at their places.
    fn particles(&self) -> Vec<Particle> {
        let (s, dx, eos) = (&self.settings, self.flow.medium.dx, self.flow.medium.eos);
        let mut random = Random::new(s.seed as u64);
        let mut shake = || s.perturb * dx * (2.0 * random.uniform() - 1.0);
        touchstone_solver::lattice(Vector2::repeat(0.5 * dx), dx, s.n, s.n)
            .map(|x| x + Vector2::new(shake(), shake()))
            .map(|x| {
                let density = eos.density(self.exact.pressure(x, 0.0) + eos.background);
                Particle::fluid(x, self.exact.velocity(x, 0.0), density, dx * dx)
            })
            .collect()
    }

    /// Relative L2 error of the velocity vector.
    fn error(&self, time: f64, particles: &[Point]) -> f64 {
        relative(particles.iter().map(|p| {
            let exact = self.exact.velocity(p.position, time);
            [(p.velocity - exact).norm_squared(), exact.norm_squared()]
        }))
    }

    /// Relative L2 error of the pressure, whose mean is free.
    ///
    /// # Errors
    /// Without densities.
    fn pressure_error(&self, now: &Snapshot) -> Result<f64, Absent> {
        let (eos, density, particles) = (self.flow.medium.eos, now.density()?, now.all());
        let pressure = |p: &Point| eos.pressure(density.of(p)) - eos.background;
        let mean = particles.iter().map(pressure).sum::<f64>() / particles.len() as f64;
        Ok(relative(particles.iter().map(|p| {
            let exact = self.exact.pressure(p.position, now.time());
            [(pressure(p) - mean - exact).powi(2), exact.powi(2)]
        })))
    }
}

/// Ratio of exact speed to initial speed below which errors are not relative to it: 1 %, the effect of
/// compressibility at c0 = 10 U, (U/c0)^2.
const DECAYED: f64 = 0.01;

/// Samples of the series.
const SAMPLES: usize = 40;

/// The mean velocity at the start, and time and error at the samples.
#[derive(Serialize, Deserialize)]
pub struct VortexHistory {
    drift: Vector2<f64>,
    errors: Vec<[f64; 2]>,
}

impl Problem for VortexSetup {
    type Extra = ();
    type Simulation = dyn Stepper<()>;
    type Watch = VortexHistory;

    fn method(&self) -> &Method {
        &self.method
    }

    fn brief(&self) -> Brief {
        self.flow.brief()
    }

    fn times(&self) -> Vec<f64> {
        rules::samples(self.settings.end, SAMPLES, self.settings.dt)
    }

    fn scene(&self) -> Result<Parts, RunError> {
        Ok(self.flow.parts(Domain::torus(1.0, 1.0), self.particles()))
    }

    fn watch(&self, _: &Snapshot, start: &Snapshot) -> VortexHistory {
        let start = start.all();
        VortexHistory { drift: drift(&start), errors: vec![[0.0, self.error(0.0, &start)]] }
    }

    fn calls(&self, calls: Calls<Self>, _: OptionalOutput) -> Calls<Self> {
        calls.at("series", |setup, series, now, _, _| {
            series.errors.push([now.time(), setup.error(now.time(), &now.all())]);
        })
    }

    fn measure(
        &self,
        VortexHistory { drift, mut errors }: VortexHistory,
        now: &Snapshot,
        record: &mut Record,
    ) {
        if record.status == Status::Completed {
            measure(self, drift, now, &errors, record);
            if OptionalOutput::of(&record.run).particles {
                let (end, time) = (now.all(), now.time());
                let scale = self.exact.decay(time);
                let all = end.iter().map(|p| {
                    let error = (p.velocity - self.exact.velocity(p.position, time)).norm() / scale;
                    (p.position.map(|x| x.rem_euclid(1.0)), error)
                });
                pictures::keep(record, pictures::END, "L", ("error", "U exp(bt)"), all);
            }
        }
        // The exact flow may have decayed to 0.
        errors.retain(|[_, error]| error.is_finite());
        let series = Profile::of(
            &errors,
            &[("t", "L/U", &|[time, _]| *time), ("error", "-", &|[_, error]| *error)],
        );
        record.profiles.insert("series".into(), series);
    }
}

/// Mean velocity of the mass \[m/s\].
fn drift(particles: &[Point]) -> Vector2<f64> {
    snapshot::momentum(particles) / particles.iter().map(|p| p.mass).sum::<f64>()
}

fn measure(
    setup: &VortexSetup,
    start: Vector2<f64>,
    now: &Snapshot,
    series: &[[f64; 2]],
    record: &mut Record,
) {
    let [time, error] = series[series.len() - 1];
    let is_left = |[time, _]: &&[f64; 2]| setup.exact.decay(*time) >= DECAYED;
    record.put(L2_WORST, largest(series.iter().filter(is_left).map(|s| s[1])));
    let end = now.all();
    record.put(MOMENTUM_ADDED, (drift(&end) - start).norm());
    record.put(NEAREST, nearest(end.iter().map(|p| p.position)) / setup.flow.medium.dx);
    let left = setup.exact.decay(time);
    if left < DECAYED {
        let reason = format!(
            "the exact speed has decayed to {left:.1e} of that of the start, below {DECAYED}"
        );
        for metric in [L2, ENERGY, PRESSURE_L2] {
            record.leave_out(metric, &reason);
        }
        return;
    }
    record.put(L2, error);
    let energy = end.iter().map(|p| 0.5 * p.mass * p.velocity.norm_squared()).sum::<f64>();
    record.put(ENERGY, energy / setup.exact.kinetic_energy(time) - 1.0);
    record.put_or_absent(PRESSURE_L2, setup.pressure_error(now));
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_base::record::Record;

    fn setup() -> VortexSetup {
        let settings = VortexSettings { n: 40, ..VortexSettings::default() };
        VortexSetup::new(&touchstone_schemes::flow::vortices_modern(), &settings)
    }

    /// The record of particles that have the exact velocity times `1 + error`, a uniform velocity and the
    /// exact pressure times `1 + pressure`, at `time`.
    fn measured(setup: &VortexSetup, time: f64, [error, drift, pressure]: [f64; 3]) -> Record {
        let eos = setup.flow.medium.eos;
        let at = |time: f64, [error, drift, pressure]: [f64; 3]| {
            let mut particles = setup.particles();
            for p in &mut particles {
                let exact = setup.exact.velocity(p.position, time);
                p.velocity = exact * (1.0 + error) + Vector2::new(drift, 0.0);
                let exact = setup.exact.pressure(p.position, time);
                p.density = eos.density(exact * (1.0 + pressure) + eos.background);
            }
            particles
        };
        let (start, end) = (at(0.0, [0.0; 3]), at(time, [error, drift, pressure]));
        let [start, now] = [Snapshot::of(0.0, &start), Snapshot::of(time, &end)];
        let [before, after] = [&start, &now].map(Snapshot::all);
        let series = [[0.0, setup.error(0.0, &before)], [time, setup.error(time, &after)]];
        let mut record = Record::new("taylor_green", "plain", serde_json::Value::Null, 1);
        measure(setup, super::drift(&before), &now, &series, &mut record);
        record
    }

    fn assert_near(
        record: &Record,
        metric: touchstone_base::record::MetricKey,
        exact: f64,
        tolerance: f64,
    ) {
        let found = record.value(metric).expect("measured");
        assert!(
            (found - exact).abs() < tolerance,
            "{}: {found} is not {exact}",
            String::from(metric)
        );
    }

    #[test]
    fn errors_that_are_put_in_are_measured() {
        let setup = setup();
        let none = measured(&setup, 1.0, [0.0; 3]);
        for metric in [L2, L2_WORST, MOMENTUM_ADDED] {
            assert_near(&none, metric, 0.0, 1e-12);
        }
        // The density follows the pressure, and the energy the density, by (U/c0)^2/4 and less.
        assert_near(&none, ENERGY, 0.0, 1e-4);
        assert_near(&none, PRESSURE_L2, 0.0, 1e-9);
        assert_near(&none, NEAREST, 1.0, 1e-9);
        // A velocity 2 % too large: energy 4.04 %.
        let fast = measured(&setup, 1.0, [0.02, 0.0, 0.03]);
        assert_near(&fast, L2, 0.02, 1e-9);
        assert_near(&fast, L2_WORST, 0.02, 1e-9);
        assert_near(&fast, ENERGY, 0.0404, 1e-4);
        assert_near(&fast, PRESSURE_L2, 0.03, 1e-6);
        let adrift = measured(&setup, 1.0, [0.0, 0.01, 0.0]);
        assert_near(&adrift, MOMENTUM_ADDED, 0.01, 1e-12);
    }

    /// At Re 10 and t = 2 the flow is 1e-7 of its start, and an error of 6162 % relative to it was shown.
    #[test]
    fn no_error_is_relative_to_a_flow_that_has_decayed() {
        let setup = setup();
        // exp(-8 pi^2 0.01 t) is 0.01 at t = 5.83.
        assert!(measured(&setup, 5.8, [0.0; 3]).value(L2).is_some());
        let record = measured(&setup, 5.9, [0.0, 1e-3, 0.0]);
        for metric in [L2, ENERGY, PRESSURE_L2] {
            assert_eq!(record.value(metric), None);
            assert!(record.absent[&String::from(metric)].to_string().contains("decayed to 9.5e-3"));
        }
        assert_near(&record, L2_WORST, 0.0, 1e-12);
        assert_near(&record, MOMENTUM_ADDED, 1e-3, 1e-12);
    }
}
