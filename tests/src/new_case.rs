//! A case of its own in one file: the decay of a shear wave in a periodic box.

use base::record::{MetricKey, Record};
use harness::{case::*, composed::*, context::Context, declare::*, simulate::simulate};
use maths::theory::{lattice::SquareLattice, time_step};
use nalgebra::Vector2;
use solver::*;
use std::f64::consts::TAU;

base::settings! {
    /// A velocity sin(2πy) mm/s in a box of side 1 m, c0 = 1 m/s, ν = 0.01 m²/s.
    pub struct Decay {
        /// particles along each side
        n: usize ["-"] in 8..=200 = 16,
        /// time step over its theoretical limit
        step: f64 ["-"] in 1e-6..=100.0 = 0.3,
        /// end of the run
        end: f64 ["s"] in 1e-6..=100.0 = 0.4,
    }
}
const ERROR: MetricKey = MetricKey::new("error", "-", "|a/exp(-ν(2π)²t) - 1|, a = 2 mean(u sin)");
type Flow<K> = Compose<K, (Pressure<Tait>, Viscosity), Continuity, Open, Leapfrog>;

fn rules<K: Kernel>(s: &Decay) -> Result<Rules, RunError> {
    let (h, symbols) = (1.3 / s.n as f64, SquareLattice::<K>::new(1.3, 1e-6));
    let medium = time_step::Medium { c0: 1.0, h, nu: 0.01, alpha: 0.0, delta: 0.0 };
    let modes = time_step::modes(&symbols, 32, &medium);
    let dt_limit = time_step::time_step_limit(&modes, time_step::Integrator::Leapfrog);
    Ok(Rules { dt: s.step * dt_limit, dt_limit, sound_speed: 1.0 })
}

fn run<K: Kernel>(variant: &str, s: &Decay, context: &Context) -> Result<Record, RunError> {
    let (dx, eos, dt) = (1.0 / s.n as f64, Tait::new(1.0, 1.0), rules::<K>(s)?.dt);
    let wave = |x: Vector2<f64>| Vector2::new(1e-3 * (TAU * x.y).sin(), 0.0);
    let places = lattice(Vector2::repeat(0.5 * dx), dx, s.n, s.n);
    let particles = places.map(|x| Particle::fluid(x, wave(x), 1.0, dx * dx)).collect();
    let forces = (Pressure::new(eos), Viscosity { mu: 0.01, eta2: 1e-6 * dx * dx });
    let torus = Domain::torus(1.0, 1.0);
    let scene = Scene::<Flow<K>>::new(1.3 * dx, torus, particles, forces, Continuity, Open);
    let name = (DECAY.name, variant);
    let (end, mut record) = simulate(name, s, scene, [dt, s.end], &|d| eos.pressure(d), context)?;
    let all = end.particles();
    let projected = all.iter().map(|p| p.velocity.x * (TAU * p.position.y).sin());
    let amplitude = 2e3 * projected.sum::<f64>() / all.len() as f64;
    record.put(ERROR, (amplitude / (-0.01 * TAU * TAU * s.end).exp() - 1.0).abs());
    Ok(record)
}

fn variant<K: Kernel>(name: &'static str) -> Composition<Decay> {
    let variant = Variant { name, about: "pressure, viscosity, continuity" };
    Composition { variant, adjust: |_| {}, run: run::<K>, rules: rules::<K>, lacks: vec![] }
}

fn declaration(_: Tier) -> Declaration {
    let level = |variant: &str, n| DECAY.planned(variant, |s| s.n = n);
    let error = Accuracy::new("decay", ErrorOf::Metric(ERROR.into()), "Error [-]");
    let accuracy = error.over(&["cubic", "quintic"], [8, 16, 32], level);
    let none = Change::new("none", "–", DECAY.spec("cubic", |_| {}));
    let halved = Change::new("dt/2", "time", DECAY.spec("cubic", |s| s.step *= 0.5));
    let changes = vec![none, halved];
    let budgets = Budgets::of(&accuracy, vec![Budget { variant: "cubic", changes }]);
    let limit = rules::<CubicSpline>(&Decay::default()).map(|rules| {
        let spec = DECAY.spec("cubic", |s| s.end = 5.0);
        StepLimit::proportional("cubic", "the wave", spec, ("step", 1.0), &rules)
    });
    let limits = StepLimits::new("decay", "Stable is what reaches its end.", limit.ok());
    let (budgets, limits, accuracy) = (Some(budgets), Some(limits), vec![accuracy]);
    Declaration { budgets, limits, accuracy, ..Declaration::default() }
}

/// The case: add it to `CASES` of its crate.
pub const DECAY: Composed<Decay> = Composed {
    name: "decay",
    about: "A shear wave in a periodic box decays as exp(-ν(2π)²t).",
    variants: || vec![variant::<CubicSpline>("cubic"), variant::<QuinticSpline>("quintic")],
    is_stable: completed,
    declaration,
    plan: no_plan,
    studies: no_studies,
};
