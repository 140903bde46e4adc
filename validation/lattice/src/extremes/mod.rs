//! Settings far outside of the usual: each with a pass criterion of its own, or with the typed
//! failure that must come.
//!
//! Common to all: nothing hangs, nothing panics, and a run that leaves its bounds ends as
//! [`solver::Outcome::Diverged`] with step, time, particle and quantity.

mod experiment;
mod odd;
mod smoothing;
mod vortex;

pub use experiment::{Experiment, measured, plan, study};

use solver::{CubicSpline, EquationOfState, Leapfrog, QuinticSpline, Stepper, Tait, WendlandC2};

use crate::wave::plain;
use base::{record::Record, settings::Settings};
use harness::{
    case::{RunError, Tier},
    checkpoint::Observed,
    composed::{self, Best, Composed, Composition},
    context::Context,
    declare::Declaration,
    method::Method,
    rules::PLANNED_DT,
    runner::Drive,
    runs::Runs,
    simulate,
    study::Study,
};

base::settings! {
    /// Settings of the experiments; each uses some of them.
    pub struct ExtremeSettings {
        /// particles along each side of the periodic box
        n: usize ["-"] in 4..=400 = 10,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.5..=5.0 = 1.2,
        /// number of time steps
        steps: usize ["-"] in 10..=100000000 = 400,
        /// time step
        dt: f64 ["dx/c0"] in 1e-9..=100.0 = 0.6,
        /// pressure at rest
        background: f64 ["rho0 c0^2"] in 0.0..=1.0 = 0.0,
        /// distance of the two particles that are too close
        distance: f64 ["dx"] in 0.0..=1.0 = 0.0,
        /// number of particles out of each other's reach
        count: usize ["-"] in 1..=1000 = 1,
        /// speed of the moving block
        speed: f64 ["c0"] in 0.0..=1e6 = 1000.0,
        /// Mach number of the vortex
        mach: f64 ["-"] in 1e-6..=10.0 = 0.1,
        /// Reynolds number of the vortex
        re: f64 ["-"] in 1e-3..=1e6 = 100.0,
        /// standard deviation of the initial displacements
        jitter: f64 ["dx"] in 0.0..=0.5 = 0.0,
        /// end of the run of the vortex, in units of its side over its speed
        end: f64 ["-"] in 1e-6..=100.0 = 0.5,
    }
}

/// Settings far outside of the usual.
pub static EXTREMES: Composed<ExtremeSettings> = Composed {
    name: "extremes",
    problem: "Extreme settings and scenes: does the program stay sound?",
    best: Best {
        variant: "rest",
        because: "each variant is an experiment of its own, and this one is the plainest",
        papers: None,
    },
    about: "Extreme scenes and settings must end well, or be refused with a reason. They are a lattice at \
            rest for very long, particles on top of each other or far from all others, a block at a \
            thousand times the speed of sound, impossible scenes, vortices with sound too slow and too \
            fast and on disturbed lattices, and smoothing lengths from too short to too long. Each variant \
            is an experiment of its own.",
    variants,
    is_stable: composed::completed,
    declaration: |_| Declaration::default(),
    plan: |tier| plan(experiments(tier)),
    studies,
};

type Adjust = fn(&mut ExtremeSettings);

/// A variant that uses some of the settings.
fn variant(
    name: [&'static str; 2],
    uses: &[&str],
    adjust: Adjust,
    run: impl Fn(&str, &ExtremeSettings, &Context) -> Result<Record, RunError> + 'static,
) -> Composition<ExtremeSettings> {
    let rules = |_: &ExtremeSettings| Err(RunError::NoRules { case: EXTREMES.name.into() });
    let fields = ExtremeSettings::FIELDS.iter().map(|field| field.name);
    let lacks = fields.filter(|name| !uses.contains(name)).collect();
    Composition::new(name.into(), adjust, run, rules, lacks)
}

fn variants() -> Vec<Composition<ExtremeSettings>> {
    const AT_REST: &[&str] = &["n", "h_over_dx", "steps", "dt", "background"];
    const VORTEX: &[&str] = &["n", "h_over_dx", "mach", "re", "jitter", "end"];
    const SMOOTHING: &[&str] = &["n", "h_over_dx"];
    let at_rest: Adjust = |s| (s.n, s.h_over_dx, s.steps, s.dt) = (5, 1.2, 100_000, 0.7);
    // Positive pressure pairs particles of a cubic spline, not those of a Wendland function.
    let pressed: Adjust = |s| {
        (s.n, s.h_over_dx, s.steps, s.dt, s.background) = (7, 1.5, 10_000, 0.7, 0.05);
    };
    let rest = |name, adjust, method: Method| {
        variant(name, AT_REST, adjust, move |v, s, context| odd::rest(&method, v, s, context))
    };
    let smoothing = |name, method: Method| {
        let run = move |v: &str, s: &ExtremeSettings, context: &Context| {
            smoothing::run(&method, v, s, context)
        };
        variant(name, SMOOTHING, |s| s.n = 20, run)
    };
    vec![
        rest(
            ["rest", "a lattice at rest, cubic spline"],
            at_rest,
            plain::<CubicSpline, Leapfrog>(),
        ),
        rest(
            ["pressed", "a lattice at rest under pressure, Wendland function"],
            pressed,
            plain::<WendlandC2, Leapfrog>(),
        ),
        variant(
            ["coincident", "two particles at one place in a lattice stirred at 0.05 c0"],
            &["distance", "steps", "dt"],
            |_| (),
            odd::coincident,
        ),
        variant(
            ["alone", "particles out of each other's reach"],
            &["count", "steps", "dt"],
            |s| s.steps = 1000,
            odd::alone,
        ),
        variant(
            ["bullet", "a block that hits another"],
            &["speed", "steps", "dt"],
            |s| (s.steps, s.dt) = (200, 0.3),
            odd::bullet,
        ),
        variant(["refused", "what is not a scene"], &[], |_| (), odd::refused),
        variant(
            ["vortex", "Taylor-Green vortices, the modern composition of the channels"],
            VORTEX,
            |s| (s.n, s.h_over_dx) = (32, 1.0),
            vortex::run,
        ),
        smoothing(
            ["smoothing-cubic", "long waves, cubic spline"],
            plain::<CubicSpline, Leapfrog>(),
        ),
        smoothing(
            ["smoothing-quintic", "long waves, quintic spline"],
            plain::<QuinticSpline, Leapfrog>(),
        ),
        smoothing(
            ["smoothing-wendland", "long waves, Wendland function"],
            plain::<WendlandC2, Leapfrog>(),
        ),
    ]
}

/// All experiments, in the order of the table.
fn experiments(tier: Tier) -> Vec<Experiment> {
    [
        odd::at_rest(tier),
        vortex::stiff_sound(tier),
        smoothing::lengths(tier),
        vortex::fast(),
        vortex::jittered(),
        odd::close(),
        odd::far(),
        odd::fast_blocks(),
        odd::no_scenes(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

const LEAD: &str = "Each entry has a criterion of its own. Where a run cannot succeed, it must say so in \
    time. On a disturbed lattice only the energy is judged, which must not rise; the errors of energy and \
    velocity beside it are reported. Steps beyond the limit, creeping flows and rubber at its extremes are \
    with their own cases.";

fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    vec![study(["extremes", "Extreme settings"], LEAD, experiments(tier), runs)]
}

/// A record of an experiment that is yet to be filled.
fn record_of(variant: &str, settings: &ExtremeSettings) -> Record {
    Record::new(EXTREMES.name, variant, serde_json::to_value(settings).unwrap_or_default(), 1)
}

/// A simulation of any experiment.
type Simulation = dyn Stepper<()>;

/// Steps a simulation through `times` \[s\], at which `at` looks, to its end.
fn drive<S: Observed>(
    (method, variant, settings): (&Method, &str, &ExtremeSettings),
    simulation: &mut Simulation,
    (dt, times, eos): (f64, &[f64], Tait),
    context: &Context,
    seen: &mut S,
    at: &dyn Fn(&mut S, &mut Simulation, usize),
) -> Result<Record, RunError> {
    let (name, serial) = ((EXTREMES.name, variant), Context::default());
    let mut record = simulate::begin(name, settings, method, &[(PLANNED_DT, dt)], &serial);
    let pressure = |density| eos.pressure(density);
    (record.status, record.cost) =
        Drive::new(simulation, dt, times, &pressure, seen).at("samples", at).run(context)?;
    record.state = Some(simulate::state(&simulation.particles()));
    Ok(record)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{stability::RESTING_BOX, tests::judged};
    use base::gate::Gate;

    #[test]
    fn the_quick_tier_survives_its_extremes() {
        let judged = judged(&[&EXTREMES, &RESTING_BOX]);
        let gates: Vec<Gate> = judged.iter().map(|judged| judged.gate.clone()).collect();
        assert_eq!(base::gate::check_all(&gates), Ok(()));
        for judged in &judged {
            let (id, value) = (&judged.gate.id, judged.judgement.value);
            assert!(!judged.judgement.verdict.is_failure(), "{id}: {value:?}");
        }
    }
}
