//! One run of a mode: scene, stepping, projection, record.

use std::{f64::consts::TAU, iter::once};

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::{
    absent::Absent,
    functions::{cos, sin},
    random::Random,
    record::digest,
};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::{PLANNED_DT, Step, TimeStepLimits},
    snapshot::{Snapshot, momentum},
};
use touchstone_maths::{
    metrics::norms::largest,
    theory::{
        steps::{self, DampedMode, WaveAmplitudes},
        time_step::{Integrator, Mode, WaveMedium, modes},
    },
};
use touchstone_solver::{EquationOfState, Tait};

use super::{
    DECAY_ERROR, FREQUENCY_ERROR, MOMENTUM_ERROR, Polarisation, TRAJECTORY_ERROR, WaveSettings,
};
use crate::lattice::torus;

/// The numbers of one run, SI units.
#[derive(Clone)]
pub(super) struct Wave {
    settings: WaveSettings,
    method: Method,
    /// Kind of wave.
    polarisation: Polarisation,
    /// Phase from one particle to the next.
    theta: Vector2<f64>,
    /// Constants of the terms.
    medium: Medium,
    /// Theory of sound, of shear, and of the density alone.
    mode: Mode,
    /// A time step of which a whole number ends the run, the leapfrog's limits of it, sound speed, end.
    pub rules: Rules,
}

/// Amplitudes after each step.
#[derive(Serialize, Deserialize)]
pub(super) struct Projection {
    /// cos and sin of the phase of each label, over the sum of their squares.
    basis: Vec<[f64; 2]>,
    series: Vec<WaveAmplitudes>,
    /// Σ m v after the first step and the last \[kg m/s\].
    momentum: Option<[[f64; 2]; 2]>,
}

impl Wave {
    /// A wave of these settings in the lattice of a method.
    ///
    /// # Errors
    /// If the lattice does not carry it, or the step is beyond its limit.
    pub fn new(
        polarisation: Polarisation,
        s: &WaveSettings,
        method: &Method,
    ) -> Result<Self, RunError> {
        for (what, k) in [("the wave number kx", s.kx), ("the wave number ky", s.ky)] {
            let (value, most) = (k as f64, ((s.n - 1) / 2) as f64);
            if value > most {
                return Err(RunError::TooMuch { what, value, most, setting: "n, kx or ky" });
            }
        }
        let (dx, h) = (s.length / s.n as f64, s.h_over_dx * s.length / s.n as f64);
        let theta = Vector2::new(s.kx as f64, s.ky as f64) * (TAU / s.n as f64);
        let lattice = method.properties.square([s.h_over_dx, s.eta2_over_h2]);
        let density = s.rho * (1.0 + s.compression);
        let sound_speed = s.c0 * (1.0 + s.compression).powi((GAMMA - 1) / 2);
        // A background pressure makes p = 0 at this density: a displacement then acts on a pressure of its
        // own order, as in the theory of the lattice.
        let eos = Tait::new(s.rho, s.c0);
        let eos = Tait { background: -eos.pressure(density), ..eos };
        let medium = Medium {
            density,
            sound_speed,
            nu: s.nu,
            ..method.properties.medium(eos, [dx, h]).set_by(s)
        };
        let waves =
            WaveMedium { nu: s.nu, delta: s.diffusion, ..WaveMedium::of_sound(sound_speed, h) };
        let mode = Mode::new(&lattice, theta, &waves);
        let step = Step::courant(s.courant, h, [sound_speed, 0.0]).viscous(s.viscous, h, s.nu);
        // The predictor-corrector amplifies sound at every dt, which is part of the comparison.
        let limits = TimeStepLimits::of(&modes(&lattice, s.n, &waves), Integrator::Leapfrog);
        let end = s.span
            * match polarisation {
                Polarisation::Shear if mode.transverse > 0.0 => 1.0 / mode.transverse,
                _ => TAU / mode.omega,
            };
        let mut rules = Rules { step: step.or_given(s.dt), limits, sound_speed, end };
        rules.step.dt = end / (end / rules.dt()).ceil().max(4.0);
        let (settings, method) = (s.clone(), method.clone());
        Ok(Self { settings, method, polarisation, theta, medium, mode, rules })
    }

    /// Phase of each label, in the order of the scene.
    fn phases(&self) -> impl Iterator<Item = f64> {
        let (n, theta) = (self.settings.n, self.theta);
        touchstone_solver::lattice(Vector2::zeros(), 1.0, n, n).map(move |label| theta.dot(&label))
    }

    fn across(&self) -> Vector2<f64> {
        Vector2::new(-self.mode.along.y, self.mode.along.x)
    }

    /// Theoretical amplitudes after each of `steps` steps, exact.
    fn predicted(&self, integrator: Integrator, steps: usize) -> Vec<WaveAmplitudes> {
        let (a, dt) = (self.settings.amplitude, self.rules.dt());
        let Mode { omega, longitudinal: gamma, transverse, density, .. } = self.mode;
        let m = steps::step(&DampedMode { omega, gamma }, density, integrator, dt);
        let shear_mode = DampedMode { omega: 0.0, gamma: transverse };
        let factor = steps::step(&shear_mode, 0.0, integrator, dt).m22;
        let (mut y, mut shear) = match self.polarisation {
            Polarisation::Sound => (Vector2::new(0.0, a), 0.0),
            Polarisation::Shear => (Vector2::zeros(), a),
        };
        if integrator == Integrator::Leapfrog {
            // The first kick is half a one: back to where a whole one would start.
            y.y = (y.y * (1.0 - 0.5 * gamma * dt) - omega * dt * y.x) / (1.0 - gamma * dt);
            shear *= (1.0 - 0.5 * transverse * dt) / (1.0 - transverse * dt);
        }
        let advance = |_| {
            (y, shear) = (m * y, factor * shear);
            WaveAmplitudes { pressure: y.x, along: y.y, across: shear }
        };
        (0..steps).map(advance).collect()
    }
}

impl Projection {
    fn new(wave: &Wave) -> Self {
        let mut basis: Vec<[f64; 2]> = wave.phases().map(|a| [cos(a), sin(a)]).collect();
        let squares = [0, 1].map(|k| basis.iter().map(|b| b[k] * b[k]).sum::<f64>());
        basis.iter_mut().for_each(|b| *b = [b[0] / squares[0], b[1] / squares[1]]);
        Self { basis, series: Vec::new(), momentum: None }
    }

    fn after_step(&mut self, wave: &Wave, simulation: &dyn Stepper<()>) {
        let Wave { mode, medium: Medium { density, sound_speed, .. }, .. } = wave;
        let across = wave.across();
        let mut sums = WaveAmplitudes::default();
        for (particle, [cos, sin]) in simulation.particles().iter().zip(&self.basis) {
            sums.pressure -= (particle.density / density - 1.0) * sin;
            sums.along += particle.velocity.dot(&mode.along) / sound_speed * cos;
            sums.across += particle.velocity.dot(&across) / sound_speed * cos;
        }
        self.series.push(sums);
        let momentum = momentum(&Snapshot::ours(simulation).all()).into();
        self.momentum = Some([self.momentum.map_or(momentum, |[first, _]| first), momentum]);
    }
}

/// The exponent of [`Tait::new`].
const GAMMA: i32 = 7;

/// A wave is projected on itself and compared with theory.
impl Problem for Wave {
    type Extra = ();
    type Simulation = dyn Stepper<()>;
    type Watch = Projection;

    fn method(&self) -> &Method {
        &self.method
    }

    fn brief(&self) -> Brief {
        let (s, Medium { sound_speed, h, .. }) = (&self.settings, self.medium);
        let (dt, particles) = (self.rules.dt(), (s.n * s.n) as f64);
        let decisive = "span, dt, courant, viscous, nu or n";
        let brief = Brief::new(self.medium, self.rules, particles, decisive).numbers(&[
            ("h/dx", s.h_over_dx),
            ("c0 [m/s]", sound_speed),
            ("c0 h/nu", sound_speed * h / s.nu),
            (PLANNED_DT, dt),
            ("omega dt", self.mode.omega * dt),
        ]);
        Brief { samples: self.rules.end / dt, limit_of: Some("leapfrog"), ..brief }
    }

    /// A pause would bring the leapfrog's velocities to whole steps, so there is none before the end.
    /// A cosine of velocity at uniform density.
    fn scene(&self) -> Result<Parts, RunError> {
        let (s, Medium { dx, sound_speed, .. }) = (&self.settings, self.medium);
        let direction = match self.polarisation {
            Polarisation::Sound => self.mode.along,
            Polarisation::Shear => self.across(),
        };
        let mut random = Random::new(1);
        let mut offset = || Vector2::new(random.normal(), random.normal()) * (s.jitter * dx);
        let start = |label: Vector2<f64>, place| {
            let velocity = direction * (s.amplitude * sound_speed * cos(self.theta.dot(&label)));
            (if s.jitter > 0.0 { place + offset() } else { place }, velocity)
        };
        Ok(torus((s.length, s.n), self.medium, start))
    }

    fn watch(&self, _: &Snapshot, _: &Snapshot) -> Projection {
        Projection::new(self)
    }

    fn calls(&self, calls: Calls<Self>, _: OptionalOutput) -> Calls<Self> {
        calls.every_step_of_ours("projection", |wave, projection, s| projection.after_step(wave, s))
    }

    fn measure(
        &self,
        Projection { series, momentum, .. }: Projection,
        end: &Snapshot,
        record: &mut Record,
    ) {
        if end.simulation().is_err() {
            return record.leave_all_out(super::STEPWISE, &Absent::EveryStep);
        }
        let (s, Medium { density, sound_speed, .. }) = (&self.settings, self.medium);
        compare(self, self.method.properties.theory, &series, record);
        let scale = density * s.length * s.length * s.amplitude * sound_speed;
        let [first, last] = momentum.unwrap_or([[f64::NAN; 2]; 2]).map(Vector2::from);
        record.put(MOMENTUM_ERROR, (last - first).norm() / scale);
        let none = WaveAmplitudes::default();
        let start = match self.polarisation {
            Polarisation::Sound => WaveAmplitudes { along: s.amplitude, ..none },
            Polarisation::Shear => WaveAmplitudes { across: s.amplitude, ..none },
        };
        let rows: Vec<_> = once(&start).chain(&series).enumerate().collect();
        let profile = Profile::of(
            &rows,
            &[
                ("t", "s", &|(step, _)| *step as f64 * self.rules.dt()),
                ("p", "rho c0^2", &|(_, of)| of.pressure),
                ("v_along", "c0", &|(_, of)| of.along),
                ("v_across", "c0", &|(_, of)| of.across),
            ],
        );
        record.profiles.insert("amplitudes".into(), profile);
        // Of every step, not of the last one.
        let all: Vec<f64> = series.iter().flat_map(WaveAmplitudes::all).collect();
        record.state = Some(digest(&all));
    }
}

touchstone_base::metrics! {
    all FACTORS;
    SOUND_FACTOR = "sound_factor" ["-"] "omega/(c0 k), 1 in the continuum";
    VISCOUS_FACTOR = "viscous_factor" ["-"] "gamma/(nu k^2)";
}

/// Frequency and damping against the symbols, and every amplitude against exact steps.
fn compare(wave: &Wave, integrator: Integrator, series: &[WaveAmplitudes], record: &mut Record) {
    let Mode { omega, longitudinal, transverse, .. } = wave.mode;
    let (dt, turn, s) = (wave.rules.dt(), wave.theta.norm(), &wave.settings);
    let (found, gamma) = match wave.polarisation {
        Polarisation::Sound => {
            let found = steps::mode_of(series, integrator, dt);
            record.put(FREQUENCY_ERROR, (found.omega - omega).abs() / omega);
            let sound = wave.medium.sound_speed * turn * s.n as f64 / s.length;
            record.put(SOUND_FACTOR, found.omega / sound);
            (found.gamma, longitudinal)
        }
        Polarisation::Shear => {
            let (found, k) =
                (steps::decay_of(series, integrator, dt), turn * s.n as f64 / s.length);
            record.put(VISCOUS_FACTOR, found / (s.nu * k * k));
            (found, transverse)
        }
    };
    let scale = if gamma > 0.0 { gamma } else { omega };
    record.put(DECAY_ERROR, (found - gamma).abs() / scale);
    let predicted = wave.predicted(integrator, series.len());
    let [found, expected] =
        [series, &predicted].map(|all| all.iter().flat_map(WaveAmplitudes::all));
    let error = largest(found.zip(expected).map(|(found, expected)| (found - expected).abs()));
    record.put(TRAJECTORY_ERROR, error / s.amplitude);
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// A damped wave and its method.
    fn wave(polarisation: Polarisation) -> (Wave, Method) {
        let method = touchstone_schemes::lattice::cubic();
        let settings = WaveSettings { kx: 2, ky: 1, nu: 1e-3, ..WaveSettings::default() };
        let wave = Wave::new(polarisation, &settings, &method);
        (wave.expect("a wave"), method)
    }

    /// Artificial particles: density −0.003 sin, velocity 0.02 cos along and −0.005 cos across, and a mean
    /// flow that the projection must ignore.
    #[test]
    fn amplitudes_are_those_of_made_up_particles() {
        let (wave, method) = wave(Polarisation::Sound);
        let mut parts = wave.scene().expect("a scene");
        let Medium { density, sound_speed, .. } = wave.medium;
        for (particle, phase) in parts.particles.iter_mut().zip(wave.phases()) {
            particle.density = density * (1.0 - 0.003 * sin(phase));
            let own = wave.mode.along * (0.02 * cos(phase)) - wave.across() * (0.005 * cos(phase));
            particle.velocity = own * sound_speed + Vector2::new(0.3, -0.1);
        }
        let momentum: Vector2<f64> = parts.particles.iter().map(|p| p.velocity * p.mass).sum();
        let simulation = (method.build)(parts).expect("a scene");
        let mut projection = Projection::new(&wave);
        projection.after_step(&wave, &*simulation);
        let WaveAmplitudes { pressure, along, across } = projection.series[0];
        assert_relative_eq!(pressure, 0.003, max_relative = 1e-9);
        assert_relative_eq!(along, 0.02, max_relative = 1e-9);
        assert_relative_eq!(across, -0.005, max_relative = 1e-9);
        let [first, last] = projection.momentum.expect("a momentum").map(Vector2::from);
        assert!((first - momentum).norm() < 1e-9 * momentum.norm() && first == last);
    }

    /// The metric of a record.
    fn value(record: &Record, metric: touchstone_base::record::MetricKey) -> f64 {
        record.value(metric).expect("a metric")
    }

    /// A series that obeys another frequency or damping than theory is as far off as these are.
    #[test]
    fn errors_are_those_of_a_made_up_series() {
        let leapfrog = Integrator::Leapfrog;
        let record = || Record::new("c", "v", serde_json::json!({}), 1);
        let (wave, _) = wave(Polarisation::Sound);
        let mut other = wave.clone();
        let Mode { omega, longitudinal, .. } = wave.mode;
        (other.mode.omega, other.mode.longitudinal) = (1.01 * omega, 0.97 * longitudinal);
        let mut found = record();
        compare(&wave, leapfrog, &other.predicted(leapfrog, 50), &mut found);
        assert_relative_eq!(value(&found, FREQUENCY_ERROR), 0.01, max_relative = 1e-6);
        assert_relative_eq!(value(&found, DECAY_ERROR), 0.03, max_relative = 1e-6);
        let (c, s) = (wave.medium.sound_speed, &wave.settings);
        let k = TAU * 5.0_f64.sqrt() / s.length;
        assert_relative_eq!(
            value(&found, SOUND_FACTOR),
            other.mode.omega / (c * k),
            max_relative = 1e-8
        );

        let mut series = wave.predicted(leapfrog, 50);
        series[30].along -= 0.04 * s.amplitude;
        let mut found = record();
        compare(&wave, leapfrog, &series, &mut found);
        assert_relative_eq!(value(&found, TRAJECTORY_ERROR), 0.04, max_relative = 1e-6);
        series[7].pressure = f64::NAN;
        compare(&wave, leapfrog, &series, &mut found);
        assert!(value(&found, TRAJECTORY_ERROR).is_nan());

        let (wave, _) = self::wave(Polarisation::Shear);
        let mut other = wave.clone();
        other.mode.transverse = 1.02 * wave.mode.transverse;
        let mut found = record();
        compare(&wave, leapfrog, &other.predicted(leapfrog, 50), &mut found);
        assert_relative_eq!(value(&found, DECAY_ERROR), 0.02, max_relative = 1e-6);
        let viscous = other.mode.transverse / (1e-3 * k * k);
        assert_relative_eq!(value(&found, VISCOUS_FACTOR), viscous, max_relative = 1e-8);
    }
}
