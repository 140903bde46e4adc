//! A lattice at rest: the largest stable time step, measured, against linear theory.
//!
//! A box of 12 × 12 particles at rest with velocity noise of 1e-8 c₀, which is every wave of the box at once
//! and too small to be anything but linear, runs for N steps at a dt; dt is bisected to 0.4 %. It grows if
//! its energy (kinetic and acoustic) exceeds a hundred times the start at some step, where the run stops, or
//! if its mean over the last quarter of the steps exceeds that over the second quarter by half. N = ½/(the
//! growth rate a step that theory gives 0.5 % beyond the limit), at least 300 and at most 12 000: so weakly
//! growing modes have time to show. A larger box has waves between, of which one may be stiffer: with 20
//! limits are up to 1.6 % shorter, measured and in theory, and take twice as long to find.

use std::ops::ControlFlow;

use nalgebra::Vector2;
use touchstone_base::{absent::Absent, random::Random, record::Status, spec::Bisect};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    bisect::Growth,
    case::{PLANNED_DT, Planned, Step},
    limits::TimeStepLimits,
    method::{MediumSetting, Properties},
    rules::PLANNED_DT_OVER_LIMIT,
    snapshot::{Point, Snapshot},
    studies::{StepLimit, StepLimits},
    table::{Row, Table},
};
use touchstone_maths::theory::time_step::{self, Mode, WaveMedium};
use touchstone_solver::{DivergenceBounds, Tait};

use crate::lattice::torus;

touchstone_base::settings! {
    /// Settings of a periodic lattice at rest with velocity noise; its side, its density and its sound
    /// speed are 1.
    pub struct BoxSettings {
        /// particles along each side
        n: usize ["-"] in 4..=400 = 12,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.5..=5.0 = 1.3,
        /// ratio of sound to viscosity, c0 h/nu; auto: no viscosity
        stiffness: Option<f64> ["-"] in 1e-6..=1e9 = Some(10.0),
        /// alpha of the artificial viscosity, on every pair
        alpha: f64 ["-"] in 0.0..=10.0 = 0.0,
        /// delta of the density diffusion
        delta: f64 ["-"] in 0.0..=10.0 = 0.0,
        /// time step
        courant: f64 ["h/c0"] in 1e-9..=1e3 = 0.25,
        /// number of time steps
        steps: usize ["-"] in 4..=100000000 = 300,
    }
}

touchstone_base::metrics! {
    GREW = "grew" ["-"]
        "1 if the energy exceeded a hundred times that of the start at some step, or in the mean of the \
         last quarter of the steps 1.5 times that of the second; else 0";
    ENERGY = "energy_ratio" ["-"] "kinetic and acoustic energy at the end/at the start";
}

/// A lattice at rest.
pub static RESTING_BOX: Composed<BoxSettings> = Composed {
    name: "resting_box",
    problem: "Small noise at rest: is the time step stable?",
    recommended: Recommended {
        variant: CUBIC,
        because: "all reach the limit of theory, and this one needs the fewest pairs per step",
        papers: None,
    },
    about: "Velocity noise of 1e-8 c0 excites every wave of a periodic lattice at rest. Its energy grows \
            if the time step is beyond the limit that linear theory of the same box predicts.",
    variants,
    facts: || Facts { is_stable: Some(is_stable), ..Facts::default() },
    studies,
};

fn is_stable(record: &Record) -> bool {
    record.status == Status::Completed && record.value(GREW) == Some(0.0)
}

const CUBIC: &str = "cubic-leapfrog";
const MIDPOINT: &str = "cubic-pc";
const SUPER: &str = "cubic-super";
const DAMPED: &str = "cubic-damped";
const QUINTIC: &str = "quintic-leapfrog";
const SINGLE: &str = "cubic-single-sweep";

/// The method of a variant.
fn method(variant: &str) -> Method {
    match variant {
        MIDPOINT => touchstone_schemes::lattice::midpoint(),
        SINGLE => touchstone_schemes::lattice::single_sweep(),
        SUPER => touchstone_schemes::lattice::super_stepping(),
        DAMPED => touchstone_schemes::lattice::damped(),
        QUINTIC => touchstone_schemes::lattice::quintic(),
        _ => touchstone_schemes::lattice::cubic(),
    }
}

fn variants() -> Compositions<BoxSettings> {
    let cubic =
        "largest step with sound and viscosity together: kernel and viscous term of the seed";
    let midpoint = "largest step of the predictor-corrector, which amplifies undamped sound";
    let super_stepping = "largest step with super-time-stepping of viscosity";
    let damped = "largest step with artificial viscosity and density diffusion";
    let single = "largest step with one pair sweep per step instead of the leapfrog's two";
    let quintic = "does theory hold for a kernel of wider support?";
    Variants::of(Resting::new)
        .with(CUBIC, cubic, method(CUBIC), |_| ())
        .with(MIDPOINT, midpoint, method(MIDPOINT), |_| ())
        .with(SUPER, super_stepping, method(SUPER), |_| ())
        .with(DAMPED, damped, method(DAMPED), |_| ())
        .with(SINGLE, single, method(SINGLE), |_| ())
        .with(QUINTIC, quintic, method(QUINTIC), |s| s.h_over_dx = 1.0)
        .all
}

/// The guard of the viscous and the artificial term, as the seed has it.
const ETA2: f64 = 0.01;
/// Initial velocity noise, standard deviation of each component \[c₀\].
const NOISE: f64 = 1e-8;
/// Resolution of the bisection, relative to the theoretical limit.
const RESOLUTION: f64 = 0.004;
/// Ratio of the step to the limit at which the theoretical growth must be detectable, which sets the number
/// of steps; it does not affect the resulting limit otherwise.
const SEEN_FROM: f64 = 1.005;
/// Fewest and most steps of a run.
const STEPS: [f64; 2] = [300.0, 12_000.0];

/// Smoothing length \[m\].
fn h(s: &BoxSettings) -> f64 {
    s.h_over_dx / s.n as f64
}

/// c₀h/ν, infinite without viscosity.
fn stiffness(s: &BoxSettings) -> f64 {
    s.stiffness.unwrap_or(f64::INFINITY)
}

/// The waves of the box in the lattice of a method, in units of c₀ and h.
fn modes(method: &Method, s: &BoxSettings) -> Vec<Mode> {
    let (nu, alpha, delta) = (1.0 / stiffness(s), s.alpha, s.delta);
    let medium = WaveMedium { nu, alpha, delta, ..WaveMedium::of_sound(1.0, 1.0) };
    time_step::modes(&method.properties.square(s.h_over_dx, ETA2), s.n, &medium)
}

/// A run of the case.
struct Resting {
    method: Method,
    settings: BoxSettings,
    rules: Rules,
}

impl Resting {
    /// Setup from settings and theory.
    fn new(method: &Method, s: &BoxSettings) -> Result<Self, RunError> {
        if s.delta > 0.0 && !method.properties.uses.contains(&MediumSetting::Diffusion) {
            let variant = "without density diffusion".into();
            return Err(RunError::Unused { key: "delta".into(), variant });
        }
        let limits = TimeStepLimits::of(&modes(method, s), method.properties.theory);
        let limits = limits.times(h(s));
        let step = Step::courant(s.courant, h(s), [1.0, 0.0]);
        let rules = Rules { step, limits, sound_speed: 1.0, end: s.steps as f64 * step.dt };
        Ok(Self { method: method.clone(), settings: s.clone(), rules })
    }
}

fn medium(method: &Method, s: &BoxSettings) -> Medium {
    Medium {
        nu: h(s) / stiffness(s),
        eta2_over_h2: ETA2,
        alpha: s.alpha,
        diffusion: s.delta,
        ..method.properties.medium(Tait::new(1.0, 1.0), 1.0 / s.n as f64, h(s))
    }
}

/// Kinetic and acoustic energy, ½ m v² + ½ m (ρ/ρ₀ - 1)² with c₀ = 1.
fn energy(now: &Snapshot) -> Result<f64, Absent> {
    let density = now.density()?;
    let of = |p: Point| {
        let compression = density.of(&p) - 1.0;
        0.5 * p.mass * (p.velocity.norm_squared() + compression * compression)
    };
    Ok(now.stored().map(of).sum())
}

impl Problem for Resting {
    type Extra = ();
    type Simulation = dyn Stepper<()>;
    type Watch = Growth;

    fn method(&self) -> &Method {
        &self.method
    }

    fn brief(&self) -> Brief {
        let (Self { settings: s, rules, .. }, dt) = (self, self.rules.dt());
        let medium = medium(&self.method, s);
        let brief = Brief::new(medium, *rules, (s.n * s.n) as f64, "steps or n").numbers(&[
            ("h/dx", s.h_over_dx),
            ("c0 [m/s]", rules.sound_speed),
            ("c0 h/nu", stiffness(s)),
            (PLANNED_DT, dt),
            (PLANNED_DT_OVER_LIMIT, dt / rules.dt_limit()),
        ]);
        Brief { is_serial: true, ..brief }
    }

    fn not_exported(&self) -> Option<&'static str> {
        Some("its energy is read after every step")
    }

    fn scene(&self) -> Result<Parts, RunError> {
        let medium = medium(&self.method, &self.settings);
        let mut random = Random::new(7);
        let mut noise = || NOISE * random.normal();
        let limits = DivergenceBounds { density: [0.7, 1.3], speed: 2.0 };
        let velocity = |_, place| (place, Vector2::new(noise(), noise()));
        Ok(Parts { limits, ..torus((1.0, self.settings.n), medium, velocity) })
    }

    fn watch(&self, _: &Snapshot, start: &Snapshot) -> Growth {
        Growth::new(energy(start).unwrap_or(f64::NAN), self.settings.steps as u64)
    }

    fn calls(&self, calls: Calls<Self>, _: OptionalOutput) -> Calls<Self> {
        // The run ends if the energy grew beyond doubt.
        calls.after_step("energy", |_, growth, now| {
            match energy(now).is_ok_and(|energy| growth.see(energy)) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        })
    }

    fn measure(&self, growth: Growth, end: &Snapshot, record: &mut Record) {
        let grew = matches!(record.status, Status::Diverged { .. }) || growth.grew();
        record.put(GREW, f64::from(u8::from(grew)));
        record.put_or_absent(ENERGY, energy(end).map(|energy| energy / growth.start));
        // A run that is over early because its energy grew beyond doubt is complete.
        if growth.beyond_doubt {
            record.status = Status::Completed;
        }
    }
}

/// Sets the step to the limit of a box with its damping, c₀h/ν, α, δ, and sets the number of steps.
fn at_limit(variant: &str) -> impl Fn(&mut BoxSettings, [f64; 3]) {
    let method = method(variant);
    move |s, [stiffness, alpha, delta]| {
        s.stiffness = stiffness.is_finite().then_some(stiffness);
        (s.alpha, s.delta) = (alpha, delta);
        let (modes, theory) = (modes(&method, s), method.properties.theory);
        s.courant = time_step::time_step_limit(&modes, theory);
        let growth = time_step::growth_per_step(&modes, theory, SEEN_FROM * s.courant);
        s.steps = (0.5 / growth).clamp(STEPS[0], STEPS[1]) as usize;
    }
}

/// All bisections.
fn table(tier: Tier) -> Table<BoxSettings, ()> {
    const INVISCID: f64 = f64::INFINITY;
    let mut table = Table::new(&RESTING_BOX, tier);
    let viscous = |variant| {
        let limit = at_limit(variant);
        move |s: &mut BoxSettings, stiffness: f64| limit(s, [stiffness, 0.0, 0.0])
    };
    let all = &[1.0, 3.0, 10.0, 30.0, 100.0, INVISCID];
    // Weak growth of the predictor-corrector needs thousands of steps to show beyond 10, and without
    // viscosity it has no limit.
    for (variant, values) in [
        (CUBIC, [&all[..], all]),
        (MIDPOINT, [&all[..3], &all[..5]]),
        (SUPER, [&all[..4]; 2]),
        (SINGLE, [&[1.0, INVISCID], all]),
        (QUINTIC, [&[1.0, 10.0, INVISCID]; 2]),
    ] {
        table.over((), &[variant], values, viscous(variant));
    }
    let [alpha, delta] = [[INVISCID, 1.0, 0.0], [INVISCID, 0.0, 1.0]];
    let together = [alpha, delta, [30.0, 0.1, 0.1]];
    table.over((), &[DAMPED], [&together[..2], &together], at_limit(DAMPED));
    table.judge(|row| vec![gate(row)]);
    table
}

/// The gate of a bisection.
fn gate(Row { variant, settings: s, .. }: &Row<BoxSettings, ()>) -> Gate {
    let Properties { kernel, integrator, .. } = method(variant).properties;
    let is_damped = s.alpha > 0.0 || s.delta > 0.0;
    let damping = if is_damped { format!(".alpha{}.delta{}", s.alpha, s.delta) } else { "".into() };
    let (h, stiffness) = (s.h_over_dx, stiffness(s));
    let id = format!("stability.{kernel}.h{h}.{integrator}.stiffness{stiffness}{damping}.ratio");
    let because = "Linear theory of the same box is exact. Bisection resolves 0.4 %, and the criterion of \
                   growth 0.5 %.";
    let (metric, bound) = ("measured limit/theory", Bound::Within(0.97, 1.03));
    Gate::new(id, metric, bound, Evidence::Theory, because)
}

/// The ratio of sound to viscosity, and the damping that there is.
fn scene(s: &BoxSettings) -> String {
    let damping = [("alpha", s.alpha), ("delta", s.delta)].map(|(name, value)| match value {
        0.0 => String::new(),
        value => format!(", {name} = {value}"),
    });
    format!("c0 h/nu = {}{}", stiffness(s), damping.concat())
}

/// The bisection of a row, whose step is the limit of theory.
fn bisected(row: Row<BoxSettings, ()>) -> StepLimit {
    let Row { settings: s, run, .. } = row;
    let (setting, guess) = ("courant".into(), s.courant);
    let bisect = Bisect { setting, guess, unit: 1.0, resolution: RESOLUTION, end: None };
    StepLimit {
        scene: scene(&s),
        spec: run.spec.allow_unstable().bisect(bisect),
        theory: s.courant * h(&s),
        theory_at: s.courant,
        default_at: BoxSettings::default().courant,
        gate: run.gates.into_iter().next(),
    }
}

fn studies(tier: Tier) -> Studies {
    let about = "A box at rest is stable if the energy of its noise does not grow. Theory is linear \
                 stability of the same box, with every wave vector and with sound and damping together. The \
                 predictor-corrector has no limit without damping, because it grows at every step.";
    let of = table(tier).rows.into_iter().map(bisected).collect();
    Studies::judging(vec![at_limit_of_both()]).with(StepLimits { about: about.into(), of })
}

/// Super-time-stepping at its limit, in a larger box.
fn at_limit_of_both() -> Planned {
    let because = "Up to the limit of sound and viscosity together no wave grows.";
    let (id, none) = ("extremes.step.super-leapfrog.10.1", Bound::Equals(0.0));
    let gate = Gate::new(id, String::from(GREW), none, Evidence::Theory, because);
    let spec = RESTING_BOX.spec(SUPER, |s| {
        s.n = 20;
        at_limit(SUPER)(s, [10.0, 0.0, 0.0]);
    });
    Planned::new(spec.allow_unstable()).judged(vec![gate])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::tests::judged;
    use std::collections::BTreeSet;
    use touchstone_harness::case::Case;
    use touchstone_harness::context::Context;

    #[test]
    fn boxes_have_the_limits_of_theory() {
        let judged = judged(&[&RESTING_BOX]);
        assert_eq!(judged.len(), 6 + 3 + 4 + 2 + 3 + 2 + 1);
        for judged in &judged {
            let (id, value) = (&judged.gate.id, judged.judgement.value);
            assert!(!judged.judgement.verdict.is_failure(), "{id}: {value:?}");
        }
    }

    #[test]
    fn a_step_beyond_the_limit_is_refused_unless_allowed() {
        let spec = RESTING_BOX.spec("cubic-leapfrog", |s| s.courant = 2.0);
        assert!(RESTING_BOX.run(&spec, &Context::default()).is_err());
        let record = RESTING_BOX.run(&spec.allow_unstable(), &Context::default()).expect("a run");
        assert!(!is_stable(&record) && record.value(GREW) == Some(1.0));
    }

    /// A damping that a variant lacks must not be set: theory would include it, and the run would not.
    #[test]
    fn damping_that_a_variant_lacks_is_refused() {
        for set in [|s: &mut BoxSettings| s.alpha = 1.0, |s: &mut BoxSettings| s.delta = 1.0] {
            let of =
                |variant| RESTING_BOX.run(&RESTING_BOX.spec(variant, set), &Context::default());
            assert!(matches!(of(CUBIC), Err(RunError::Unused { .. })));
            assert!(of(DAMPED).is_ok());
        }
    }

    #[test]
    fn every_gate_has_a_name_of_its_own() {
        let mut names = BTreeSet::new();
        for gate in table(Tier::Full).rows.into_iter().flat_map(|row| row.run.gates) {
            assert!(names.insert(gate.id.clone()), "two gates are called {}", gate.id);
        }
    }
}
