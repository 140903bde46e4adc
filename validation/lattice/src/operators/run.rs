//! One operator: scene, steps, record.

use std::f64::consts::TAU;

use base::{
    functions::{cos, sin},
    random::Random,
    record::*,
};
use harness::{case::*, context::Context, method::*, simulate};
use maths::theory::time_step::{self, Mode};
use nalgebra::Vector2;
use schemes::lattice::summing_step;
use solver::{Domain, EquationOfState, Particle, Stepper, Tait};

use super::{Operator, OperatorSettings, Subject};

base::metrics! {
    ERROR = "error" ["-"] "(sum |o - o_exact|^2/sum |o_exact|^2)^(1/2) over particles, o the operator";
    GAIN = "gain" ["-"] "sum o o_exact/sum o_exact^2";
    BIAS = "bias" ["-"] "|gain - 1|";
    NOISE = "noise" ["-"] "(sum |o - gain o_exact|^2/sum |o_exact|^2)^(1/2)";
    SYMBOL_ERROR = "symbol_error" ["-"] "|gain/(gain of theory) - 1| on a lattice";
}

/// Wave number along each axis \[1/m\].
const K: f64 = TAU;
/// Amplitude of the pressure \[ρ₀c₀²\]: a linear equation of state, as far as this can be told.
const PRESSURE: f64 = 1e-6;
/// Amplitude of the velocity \[c₀\].
const SPEED: f64 = 0.1;
/// Amplitude of the density that is summed \[ρ₀\].
const DENSITY: f64 = 0.5;
/// η² of (6) \[h²\]: a guard against 0/0 and no more.
const ETA2: f64 = 1e-6;

fn medium(method: &Method, s: &OperatorSettings) -> Medium {
    let dx = 1.0 / s.n as f64;
    let medium = method.medium(Tait::new(1.0, 1.0), [dx, s.h_over_dx * dx]);
    // Viscosity as fast as sound.
    Medium { nu: medium.h * medium.eos.sound_speed, eta2_over_h2: ETA2, ..medium }
}

/// Step, limits and end.
pub(super) fn rules(
    method: &Method,
    s: &OperatorSettings,
    context: &Context,
) -> Result<Rules, RunError> {
    let medium = medium(method, s);
    let limits = method.limits([s.h_over_dx, ETA2], 32, &medium.waves(&method.uses));
    let step = Step::given(summing_step(&medium));
    let rules = Rules { step, limits, sound_speed: 1.0, end: step.dt * s.steps as f64 };
    simulate::check(method, &medium, &rules, (s.n * s.n) as f64, "n or steps", context)?;
    Ok(rules)
}

/// sin Kx cos Ky.
fn scalar(x: Vector2<f64>) -> f64 {
    sin(K * x.x) * cos(K * x.y)
}

/// (sin Kx cos Ky, cos Kx sin Ky), of which the first part is [`scalar`].
fn vector(x: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(scalar(x), cos(K * x.x) * sin(K * x.y))
}

impl Operator {
    /// The particle at a place that has the field.
    fn particle(self, x: Vector2<f64>, Medium { eos, dx, .. }: &Medium) -> Particle {
        let (velocity, density) = match self {
            Self::Density => (Vector2::zeros(), 1.0 + DENSITY * scalar(x)),
            Self::Gradient => (Vector2::zeros(), eos.density(PRESSURE * scalar(x))),
            Self::Laplacian | Self::Divergence => (vector(x) * SPEED, 1.0),
        };
        Particle::fluid(x, velocity, density, dx * dx)
    }

    /// What was made of the field within a time \[s\], and the exact value.
    fn values(self, [start, end]: [&Particle; 2], m: &Medium, time: f64) -> [Vector2<f64>; 2] {
        let (x, along) = (start.position, |value| Vector2::new(value, 0.0));
        let accelerated = (end.velocity - start.velocity) / time;
        match self {
            Self::Density => [along(end.density - 1.0), along(DENSITY * scalar(x))],
            Self::Gradient => {
                let gradient =
                    Vector2::new(cos(K * x.x) * cos(K * x.y), -sin(K * x.x) * sin(K * x.y));
                [accelerated, -gradient * (PRESSURE * K / start.density)]
            }
            Self::Laplacian => [accelerated, vector(x) * (-2.0 * K * K * m.nu * SPEED)],
            Self::Divergence => {
                let divergence = 2.0 * SPEED * K * cos(K * x.x) * cos(K * x.y);
                [along((start.density - end.density) / time), along(divergence)]
            }
        }
    }
}

impl Subject {
    /// The gain on a lattice: the symbol of the sum over that of the continuum, for a diagonal wave.
    fn symbol(&self, method: &Method, s: &OperatorSettings, weight: &dyn Fn(f64) -> f64) -> f64 {
        let (ratio, dx) = (s.h_over_dx, 1.0 / s.n as f64);
        let phase = K * dx;
        let corrected =
            if self.is_corrected { method.square([ratio, 0.0]).gradient_factor() } else { 1.0 };
        match self.operator {
            Operator::Density => {
                let reach = (method.support * ratio).ceil() as i32;
                let all = (-reach..=reach).flat_map(|i| (-reach..=reach).map(move |j| [i, j]));
                all.map(|k| k.map(f64::from))
                    .map(|[i, j]| weight((i * i + j * j) * dx * dx) * cos(phase * (i + j)))
                    .fold(0.0, |sum, w| sum + dx * dx * w)
            }
            Operator::Laplacian => {
                let eta2 = if self.is_corrected { 0.0 } else { ETA2 };
                let unit = time_step::Medium { c0: 1.0, h: 1.0, nu: 1.0, alpha: 0.0, delta: 0.0 };
                let lattice = method.square([ratio, eta2]);
                let mode = Mode::new(&lattice, Vector2::repeat(phase), &unit);
                mode.viscous / (2.0 * (phase * ratio).powi(2)) / corrected
            }
            Operator::Gradient | Operator::Divergence => {
                let symbol = method.square([ratio, 0.0]).gradient(Vector2::repeat(phase)).x;
                symbol / (phase * ratio) / corrected
            }
        }
    }
}

/// One run of a variant.
pub(super) fn run(
    of: &Subject,
    method: &Method,
    s: &OperatorSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let (medium, rules) = (medium(method, s), rules(method, s, context)?);
    let mut random = Random::new(s.seed as u64);
    let mut shake = || s.disorder * medium.dx * (2.0 * random.uniform() - 1.0);
    let particles = solver::lattice(Vector2::repeat(0.5 * medium.dx), medium.dx, s.n, s.n)
        .map(|x| of.operator.particle(x + Vector2::new(shake(), shake()), &medium))
        .collect();
    let parts = Parts::new(medium, Domain::torus(1.0, 1.0), particles, context);
    let start = parts.particles.clone();
    let numbers = rules.numbers([s.h_over_dx, medium.dx]);
    let mut record = simulate::begin(method, &numbers, context);
    let simulation =
        simulate::simulate(method, parts, [rules.dt(), rules.end], context, &mut record)?;
    if record.status == Status::Completed {
        measure(of, &start, &*simulation, &medium, &mut record);
        if s.disorder == 0.0 {
            let symbol = of.symbol(method, s, &|r2| simulation.weight(r2));
            let gain = record.value(GAIN).unwrap_or(f64::NAN);
            record.put(SYMBOL_ERROR, (gain / symbol - 1.0).abs());
        }
    }
    Ok(record)
}

/// The operator on all particles against its exact values.
fn measure(
    of: &Subject,
    start: &[Particle],
    simulation: &dyn Stepper<()>,
    medium: &Medium,
    record: &mut Record,
) {
    let (end, time) = (simulation.particles(), simulation.time());
    let pairs = start.iter().zip(&end);
    let values: Vec<_> =
        pairs.map(|(start, end)| of.operator.values([start, end], medium, time)).collect();
    let sum = |f: &dyn Fn(&[Vector2<f64>; 2]) -> f64| values.iter().fold(0.0, |sum, v| sum + f(v));
    let scale = sum(&|[_, exact]| exact.norm_squared());
    let gain = sum(&|[found, exact]| found.dot(exact)) / scale;
    let off =
        |gain: f64| (sum(&|[found, exact]| (found - exact * gain).norm_squared()) / scale).sqrt();
    record.put(ERROR, off(1.0));
    record.put(GAIN, gain);
    record.put(BIAS, (gain - 1.0).abs());
    record.put(NOISE, off(gain));
}
