//! A new case in one file: the decay of a shear wave in a periodic box.
//!
//! A case of `validation/cases` takes its methods from `touchstone_schemes`, declares its metrics by
//! `metrics!`, states them in `Facts::statement`, and has a longer reason for the recommended variant.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use touchstone_base::{
    functions::{exp, sin},
    record::MetricKey,
};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::Step,
    composed::SettingChange,
    problem::Simple,
    snapshot::Snapshot,
    studies::{Accuracy, Budgets, Spacing, StepLimit, StepLimits},
    table,
};
use touchstone_solver::{
    Compose, Continuity, CubicSpline, Leapfrog, Open, Pressure, QuinticSpline, Tait, Viscosity,
    lattice,
};

touchstone_base::settings! {
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

fn pose(method: &Method, s: &Decay) -> Result<Simple, RunError> {
    let (n, end, dx) = (s.n, s.end, 1.0 / s.n as f64);
    let medium = method.properties.medium(Tait::new(1.0, 1.0), dx, 1.3 * dx);
    let medium = Medium { nu: 0.01, eta2_over_h2: 1e-6, ..medium };
    let limits = method.properties.limits_in(&medium, 1.3, 32);
    let rules = Rules { step: Step::share(s.step, &limits), limits, sound_speed: 1.0, end };
    let scene = move || {
        let wave = |x: Vector2<f64>| Vector2::new(1e-3 * sin(TAU * x.y), 0.0);
        let places = lattice(Vector2::repeat(0.5 * dx), dx, n, n);
        let particles = places.map(|x| Particle::fluid(x, wave(x), 1.0, dx * dx)).collect();
        Ok(Parts::new(medium, Domain::torus(1.0, 1.0), particles))
    };
    let measure = move |now: &Snapshot, record: &mut Record| {
        let all = now.all();
        let projected = all.iter().map(|p| p.velocity.x * sin(TAU * p.position.y));
        let amplitude = 2e3 * projected.sum::<f64>() / all.len() as f64;
        record.put(ERROR, (amplitude / exp(-0.01 * TAU * TAU * end) - 1.0).abs());
    };
    let size = ((n * n) as f64, "n, step or end");
    Ok(Simple::new(method, (medium, rules), size, &[], scene, measure))
}

fn studies(tier: Tier) -> Studies {
    let mut table = table::Table::new(&DECAY, tier);
    table.over((), &["cubic", "quintic"], [&[8, 16, 32]; 2], |s, n| s.n = n);
    let spacing = Spacing::count(|s: &mut Decay| &mut s.n, "n = {}");
    let ladders = table.ladders(&[()], &["cubic", "quintic"], spacing);
    let accuracy = Accuracy { ladders, ..Accuracy::new("decay", ERROR, "Error [-]") };
    let changes: [SettingChange<Decay>; 2] =
        [("none", "–", |_| {}), ("dt/2", "time", |s| s.step *= 0.5)];
    let budgets = Budgets::new(&accuracy, "", vec![DECAY.changes("cubic", |_| {}, &changes)]);
    let long = DECAY.spec("cubic", |s| s.end = 5.0);
    let limit = StepLimit::proportional(&DECAY, "the wave", long, ("step", |_| 1.0), |_| None);
    let limits = StepLimits { about: "Stable is what reaches its end.".into(), of: vec![limit] };
    Studies::default().with(accuracy).with(budgets).with(limits)
}

/// The case: add it to the list of cases.
pub const DECAY: Composed<Decay> = Composed {
    name: "decay",
    problem: "A shear wave decays in a periodic box",
    recommended: Recommended { variant: "quintic", because: "its error is smaller", papers: None },
    about: "A shear wave in a periodic box decays as exp(-ν(2π)²t).",
    variants: || {
        Variants::of(pose)
            .with("cubic", "cubic spline", Method::of::<Flow<CubicSpline>>(), |_| {})
            .with("quintic", "quintic spline", Method::of::<Flow<QuinticSpline>>(), |_| {})
            .all
    },
    facts: Facts::default,
    studies,
};
