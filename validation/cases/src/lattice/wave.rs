//! One Fourier mode on a periodic lattice: the cases of the sound wave and of the shear wave.
//!
//! Particles are labelled by where they start, and amplitudes are projections over the labels: that
//! is the linear problem that [`touchstone_maths::theory::lattice`] solves exactly. Without background
//! pressure a displacement meets a pressure of the same order, so moving particles are second order in the
//! amplitude; products of one wave number with itself have wave numbers 0 and 2k, so the mode k itself is
//! disturbed only to third order, relative to itself by amplitude² (unless 3k is a whole number of turns from
//! one particle to the next, where 2k looks like -k).
//!
//! The error in time is not subtracted but divided out: the amplitudes of one step follow from the last by a
//! matrix known in closed form for each integrator, and the inverse of this form turns the measured matrix
//! into ω and γ of continuous time. See `fit`.

use std::{f64::consts::TAU, iter::once};

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::{
    absent::Absent,
    functions::{cos, sin},
    random::Random,
    record::{MetricKey, digest},
};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::{PLANNED_DT, Statement, Step, TimeStepLimits},
    snapshot::{Snapshot, momentum},
    table::{Row, Table},
};
use touchstone_maths::{
    metrics::norms::largest,
    theory::{
        steps::{self, DampedMode, WaveAmplitudes},
        time_step::{Integrator, Mode, WaveMedium, modes},
    },
};
use touchstone_solver::{EquationOfState, Tait};

use crate::lattice::torus;

touchstone_base::settings! {
    /// Settings of one mode in a periodic square box.
    pub struct WaveSettings {
        /// particles along each side
        n: usize ["-"] in 4..=400 = 16,
        /// wave number along x: whole waves in the box
        kx: usize ["-"] in 1..=200 = 1,
        /// wave number along y
        ky: usize ["-"] in 0..=200 = 0,
        /// side of the box
        length: f64 ["m"] in 1e-9..=1e6 = 1.0,
        /// density
        rho: f64 ["kg/m^3"] in 1e-6..=1e6 = 1000.0,
        /// sound speed
        c0: f64 ["m/s"] in 1e-9..=1e9 = 1.0,
        /// density of the lattice over the reference density, minus one; the sound speed rises with its cube,
        /// and a background pressure cancels the pressure
        compression: f64 ["-"] in 0.0..=0.2 = 0.0,
        /// kinematic viscosity
        nu: f64 ["m^2/s"] in 0.0..=1e6 = 1e-3,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.5..=5.0 = 1.2,
        /// guard against 0/0 in the viscous term
        eta2_over_h2: f64 ["-"] in 1e-12..=0.1 = 0.01,
        /// density diffusion δ
        diffusion: f64 ["-"] in 0.0..=10.0 = 0.0,
        /// standard deviation of the initial displacements, which break the symmetry of the sums; theory
        /// assumes the lattice
        jitter: f64 ["dx"] in 0.0..=0.2 = 0.0,
        /// initial velocity amplitude
        amplitude: f64 ["c0"] in 1e-12..=0.1 = 1e-6,
        /// time step; auto: the smaller of courant h/c0 and viscous h²/ν
        dt: Option<f64> ["s"] in 1e-15..=1e6 = None,
        /// Courant number of the time step
        courant: f64 ["-"] in 1e-6..=10.0 = 0.2,
        /// viscous number of the time step
        viscous: f64 ["-"] in 1e-6..=10.0 = 0.05,
        /// end of the run: periods of the sound wave, decay times 1/γ of the shear wave
        span: f64 ["periods"] in 1e-3..=1e4 = 2.0,
    }
}

/// Kind of wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Polarisation {
    /// Velocity along the gradient symbol.
    Sound,
    /// Velocity across it.
    Shear,
}

/// A standing sound wave.
pub static ACOUSTIC_WAVE: Composed<WaveSettings> = Composed {
    name: "acoustic_wave",
    problem: "A small standing sound wave in a periodic box",
    recommended: RECOMMENDED,
    about: "A standing sound wave of infinitesimal amplitude in a periodic box follows p'' + nu lambda \
            p' + (c0 |g|)^2 p = 0. On a lattice, the symbols g(k) and lambda(k) of the sums of the method \
            are known exactly. A correct program has the frequency and decay that follow from them, \
            whatever the kernel.",
    variants: || variants(Polarisation::Sound),
    facts,
    studies: |tier| studies(&ACOUSTIC_WAVE, Polarisation::Sound, tier),
};

/// A decaying shear wave.
pub static SHEAR_WAVE: Composed<WaveSettings> = Composed {
    name: "shear_wave",
    problem: "A small shear wave decays in a periodic box",
    recommended: RECOMMENDED,
    about: "A shear wave of infinitesimal amplitude in a periodic box decays as exp(-nu lambda t). On \
            a lattice, the symbol lambda(k) of the viscous sum is known exactly. Sound and pressure stay \
            exactly zero to first order.",
    variants: || variants(Polarisation::Shear),
    facts,
    studies: |tier| studies(&SHEAR_WAVE, Polarisation::Shear, tier),
};

const RECOMMENDED: Recommended = Recommended {
    variant: "cubic-leapfrog",
    because: "all kernels follow lattice theory to round-off, and this one needs the fewest pairs",
    papers: None,
};

const fn amplitude(name: &'static str, unit: &'static str) -> ColumnKey {
    ColumnKey::new("amplitudes", name, unit)
}

const TIME: ColumnKey = amplitude("t", "s");
const PRESSURE: ColumnKey = amplitude("p", "rho c0^2");
const V_ALONG: ColumnKey = amplitude("v_along", "c0");
const V_ACROSS: ColumnKey = amplitude("v_across", "c0");

touchstone_base::metrics! {
    all ALL;
    // Error of the frequency of a sound wave.
    FREQUENCY_ERROR = "frequency_error" ["-"]
        "|omega - c0 |g(k)||/(c0 |g(k)|), time error divided out";
    // Error of the decay.
    DECAY_ERROR = "decay_error" ["-"]
        "|gamma - nu lambda(k)|/(nu lambda(k)), of omega if nu = 0, time error divided out";
    // Distance of the amplitudes from exact steps.
    TRAJECTORY_ERROR = "trajectory_error" ["-"]
        "max|amplitudes - exact steps|/amplitude over p, v along, v across and all steps";
    // Change of momentum.
    MOMENTUM_ERROR = "momentum_error" ["-"]
        "|change of sum m v after the first step|/(sum m times the velocity amplitude)";
}

/// Measurements after every step, and facts for other codes.
fn facts() -> Facts {
    let statement = Statement::new("There is no wall: x and y are periodic.", &[ALL, FACTORS]);
    Facts { statement, stepwise: STEPWISE, ..Facts::default() }
}

/// All are fits to every step, or differences between steps.
const STEPWISE: &[MetricKey] =
    &[FREQUENCY_ERROR, DECAY_ERROR, TRAJECTORY_ERROR, MOMENTUM_ERROR, SOUND_FACTOR, VISCOUS_FACTOR];

/// The numbers of one run, SI units.
#[derive(Clone)]
struct Wave {
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
    rules: Rules,
}

/// Amplitudes after each step.
#[derive(Serialize, Deserialize)]
struct Projection {
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
    fn new(
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
        let lattice = method.properties.square(s.h_over_dx, s.eta2_over_h2);
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
            ..method.properties.medium(eos, dx, h).set_by(s)
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
            return record.leave_all_out(STEPWISE, &Absent::EveryStep);
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
        record.put_column(TIME, &rows, |(step, _)| *step as f64 * self.rules.dt());
        record.put_column(PRESSURE, &rows, |(_, of)| of.pressure);
        record.put_column(V_ALONG, &rows, |(_, of)| of.along);
        record.put_column(V_ACROSS, &rows, |(_, of)| of.across);
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

fn variants(of: Polarisation) -> Compositions<WaveSettings> {
    let of_kernel =
        "plain equations with this kernel and the leapfrog: do the sums have its symbols?";
    let of_step = "as cubic-leapfrog, with the predictor-corrector: does it amplify sound exactly as theory \
                   says?";
    let of_diffusion =
        "as cubic-leapfrog, with density diffusion: does it decay as its symbol says?";
    Variants::of(move |m, s| Wave::new(of, s, m))
        .with(CUBIC, of_kernel, touchstone_schemes::lattice::cubic(), |_| ())
        .with(MIDPOINT, of_step, touchstone_schemes::lattice::midpoint(), |_| ())
        .with(QUINTIC, of_kernel, touchstone_schemes::lattice::quintic(), |_| ())
        .with(WENDLAND, of_kernel, touchstone_schemes::lattice::wendland(), |_| ())
        .with(DIFFUSIVE, of_diffusion, touchstone_schemes::lattice::diffusive(), |s| {
            s.diffusion = 0.1
        })
        .all
}

const CUBIC: &str = "cubic-leapfrog";
const MIDPOINT: &str = "cubic-pc";
const QUINTIC: &str = "quintic-leapfrog";
const WENDLAND: &str = "wendland-leapfrog";
const DIFFUSIVE: &str = "cubic-leapfrog-diffusion";

/// Gates allow this relative error. Measured at amplitudes 1e-3 to 1e-8: the error of γ is
/// 1.3e3 amplitude² for sound and 6e4 amplitude² for shear at ν = 1e-3 (rows slide by amplitude
/// c₀/γ), plus, for sound, round-off of about 3e-15/amplitude. At 1e-6 both leave two decades.
const TOLERANCE: f64 = 1e-6;

/// Total momentum may change by this much of Σ m |v|: round-off of a thousand sums.
const MOMENTUM: f64 = 1e-10;

/// The judged metrics of runs, and why each is exact.
type Judged = &'static [(MetricKey, &'static str)];

/// A sound wave on the lattice as it is.
const SOUND: Judged = &[
    (
        FREQUENCY_ERROR,
        "The gradient symbol is exact on a lattice. At an amplitude of 1e-6, nonlinearity and round-off \
         were measured as 1e-11 or less.",
    ),
    (
        DECAY_ERROR,
        "The Laplacian symbol is exact on a lattice. The decay rate gamma is a difference of amplitudes, \
         so round-off counts by 1/(gamma dt), which was measured as 6e-9 at most.",
    ),
    EXACT_STEPS,
];
/// A shear wave on the lattice as it is.
const SHEAR: Judged = &[
    (
        DECAY_ERROR,
        "The Laplacian symbol is exact on a lattice. Rows slide by amplitude c0/gamma, which counts with \
         the square of the amplitude and was measured as 3e-9.",
    ),
    (
        TRAJECTORY_ERROR,
        "Every amplitude of every step follows from the symbol and the closed form of one step, and \
         sound is not excited.",
    ),
];
/// `fit` has no inverse for density diffusion: the trajectory is judged.
const DIFFUSED: Judged = &[EXACT_STEPS];
/// The sound speed rises with compression, which no wave at rho0 shows.
const COMPRESSED: Judged = &[(
    FREQUENCY_ERROR,
    "The sound speed of the Tait equation rises as (rho/rho0)^3, which no wave at rho0 shows. \
     The exponent shows in the curvature of p(rho) alone.",
)];
/// Forces on a disordered lattice, whose symmetry hides nothing.
const DISORDERED: Judged = &[(
    MOMENTUM_ERROR,
    "Forces of pairs are equal and opposite wherever particles are. On a lattice, symmetry would \
     hide a pressure force that is not, which a disorder of 0.1 dx shows.",
)];
/// A short wave that nothing damps.
const UNDAMPED: Judged = &[(
    TRAJECTORY_ERROR,
    "Without damping the predictor-corrector amplifies sound by the factor 1 + (omega dt)^4/4 of \
     the energy a step, at every time step: a weak instability, and exactly this one.",
)];
/// The amplitudes of sound are exact.
const EXACT_STEPS: (MetricKey, &str) = (
    TRAJECTORY_ERROR,
    "Every amplitude of every step follows from the symbols and the closed form of one step. The largest \
     difference measured was 3e-10.",
);

/// h/dx of each variant, and more of the full tier.
const RATIOS: [(&str, &[f64], &[f64]); 4] = [
    (CUBIC, &[1.2, 1.3], &[1.0, 1.5, 2.0]),
    (MIDPOINT, &[1.2, 1.3], &[1.0, 1.5, 2.0]),
    (QUINTIC, &[1.0, 1.3], &[0.9, 1.5]),
    (WENDLAND, &[1.5, 2.0], &[1.2, 2.5]),
];

/// The runs of a tier; the full one adds waves that are oblique to the lattice.
fn studies(case: &'static Composed<WaveSettings>, of: Polarisation, tier: Tier) -> Studies {
    let mut table = Table::new(case, tier);
    let on_lattice = if of == Polarisation::Sound { SOUND } else { SHEAR };
    let wave = |s: &mut WaveSettings, (n, ratio, [kx, ky]): (usize, f64, [usize; 2])| {
        (s.n, s.h_over_dx, s.kx, s.ky) = (n, ratio, kx, ky);
        // Strong viscosity: rows slide less before the shear wave has decayed, within fewer steps.
        s.nu = if of == Polarisation::Shear { 0.01 } else { s.nu };
    };
    for (variant, usual, more) in RATIOS {
        let along = |s: &mut _, ratio| wave(s, (16, ratio, [1, 0]));
        table.over(on_lattice, &[variant], [usual; 2], along);
        let oblique = |s: &mut _, ratio| wave(s, (16, ratio, [3, 2]));
        table.over(on_lattice, &[variant], [&[], &[usual, more].concat()], oblique);
    }
    // Smoothing lengths from too short to too long, in a box that holds the widest support.
    let far = |s: &mut _, ratio| wave(s, (20, ratio, [1, 0]));
    table.over(on_lattice, &[CUBIC, QUINTIC, WENDLAND], [&[0.9, 3.0]; 2], far);
    if of == Polarisation::Sound {
        let diffusive = |s: &mut _, k| wave(s, (16, 1.2, k));
        let waves = [[1, 0], [3, 2]];
        table.over(DIFFUSED, &[DIFFUSIVE], [&waves[..1], &waves], diffusive);
        table.one(COMPRESSED, CUBIC, |s| s.compression = 0.05);
        table.one(DISORDERED, CUBIC, |s| s.jitter = 0.1);
        table.over(UNDAMPED, &[MIDPOINT], [&[0.2, 0.7]; 2], |s, courant| {
            wave(s, (16, 1.3, [5, 0]));
            (s.nu, s.courant) = (0.0, courant);
        });
    }
    table.judge(|row| gates(case, row));
    Studies::judging(table.plan())
}

/// Gates of a run, with reasons.
fn gates(
    case: &Composed<WaveSettings>,
    Row { group: judged, variant, settings: s, .. }: &Row<WaveSettings, Judged>,
) -> Vec<Gate> {
    let what = match s {
        _ if s.compression > 0.0 => format!("compressed{}", s.compression),
        _ if s.jitter > 0.0 => format!("jitter{}", s.jitter),
        _ if s.nu == 0.0 => format!("undamped{}", s.courant),
        _ => format!("k{}{}", s.kx, s.ky),
    };
    let (most, evidence) = match s.jitter > 0.0 {
        true => (MOMENTUM, Evidence::Invariant),
        false => (TOLERANCE, Evidence::Theory),
    };
    let gates = case.gates(format!("{variant}.h{}.{what}", s.h_over_dx));
    let gate = |(metric, because): &(MetricKey, &str)| {
        gates.gate(*metric, Bound::Below(most), evidence, because)
    };
    judged.iter().map(gate).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::tests::judged;
    use approx::assert_relative_eq;
    use touchstone_base::functions::ln;
    use touchstone_harness::case::Case;
    use touchstone_harness::context::Context;

    /// Every kernel, integrator and smoothing length of the quick tier has the lattice's symbols.
    #[test]
    fn waves_have_the_symbols_of_the_lattice() {
        let judged = judged(&[&ACOUSTIC_WAVE, &SHEAR_WAVE]);
        assert_eq!(judged.len(), (8 + 6) * 3 + 1 + 1 + 2 + 1 + (8 + 6) * 2);
        for judged in judged {
            let (id, value) = (&judged.gate.id, judged.judgement.value);
            assert!(!judged.judgement.verdict.is_failure(), "{id}: {value:?}");
        }
    }

    /// Test of the gates: a larger amplitude is not linear, and fails them.
    #[test]
    fn an_amplitude_that_is_not_linear_is_seen() {
        let spec = ACOUSTIC_WAVE.spec("cubic-leapfrog", |s| s.amplitude = 1e-3);
        let record = ACOUSTIC_WAVE.run(&spec, &Context::default()).expect("a run");
        assert!(record.value(DECAY_ERROR).expect("measured") > 1e-4);
    }

    /// Growth of the energy of an undamped short wave a step, and ω dt.
    fn growth(variant: &str) -> [f64; 2] {
        let spec = ACOUSTIC_WAVE.spec(variant, |s| (s.nu, s.courant, s.kx) = (0.0, 0.5, 5));
        let record = ACOUSTIC_WAVE.run(&spec, &Context::default()).expect("a run");
        let [p, v] = [PRESSURE, V_ALONG].map(|key| record.column(key));
        let energy = |k: usize| p[k] * p[k] + v[k] * v[k];
        let steps = p.len() - 1;
        let omega_dt = record.numerics["omega dt"].as_f64().expect("a number");
        [ln(energy(steps) / energy(0)) / steps as f64, omega_dt]
    }

    #[test]
    fn undamped_sound_grows_as_theory_says_and_not_in_the_leapfrog() {
        let [growth_of_midpoint, omega_dt] = growth("cubic-pc");
        let theory = ln(1.0 + 0.25 * omega_dt.powi(4));
        assert!((growth_of_midpoint / theory - 1.0).abs() < 1e-4, "{growth_of_midpoint} {theory}");
        // The leapfrog's energy beats by ω dt, and that is all.
        assert!(growth("cubic-leapfrog")[0].abs() < 0.3 * theory);
    }

    #[test]
    fn a_wave_that_the_lattice_does_not_carry_is_refused() {
        let refused = |set: fn(&mut WaveSettings)| {
            let spec = ACOUSTIC_WAVE.spec("cubic-pc", set);
            ACOUSTIC_WAVE.run(&spec, &Context::default()).err()
        };
        assert!(matches!(refused(|s| s.kx = 8), Some(RunError::TooMuch { .. })));
        assert!(matches!(refused(|s| s.dt = Some(1.0)), Some(RunError::TimeStep { .. })));
        let words = refused(|s| s.n = 4).map(|error| error.to_string()).unwrap_or_default();
        assert!(words.starts_with("with n=4 the scene is impossible: "), "{words}");
    }

    /// A viscosity of 1e-300 m²/s decays in 1e300 s: the run must be refused, not panic.
    #[test]
    fn a_shear_wave_that_never_decays_is_refused() {
        let spec = SHEAR_WAVE.spec("cubic-pc", |s| s.nu = 1e-300);
        let refused = SHEAR_WAVE.run(&spec, &Context::default());
        assert!(matches!(refused, Err(RunError::TooLong { .. })));
    }

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
