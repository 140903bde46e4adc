//! Steps about the limit: up to it nothing grows, beyond it runs diverge as soon as theory says.

use super::{BoxSettings, GREW, NoisyBox, Pair, RESTING_BOX, noisy_box::NOISE};
use crate::extremes::{Experiment, measured};
use base::functions::ln;
use base::{
    gate::{Bound, Evidence},
    record::{Record, Status},
};
use harness::extremes::Entry;
use maths::theory::time_step;

pub const TITLE: [&str; 2] = ["steps-beyond-the-limit", "Steps beyond the limit"];
pub const LEAD: &str = "A box of 20 × 20 particles at a time step beyond its limit must diverge, in the \
    number of steps in which its fastest wave grows from the noise to the speed of sound.";

/// The noisy box at 1.05 and 2 times its limit.
pub fn experiments() -> Vec<Experiment> {
    let at = |factor: f64| {
        [
            beyond(Pair::cubic_leapfrog(), None, factor),
            beyond(Pair::cubic_leapfrog(), Some(1.0), factor),
            beyond(Pair::cubic_pc(), Some(1.0), factor),
            beyond(Pair::cubic_super(), Some(1.0), factor),
            beyond(Pair::cubic_super(), Some(10.0), factor),
        ]
    };
    let up_to = |factor: f64| [1.0, 10.0].map(|stiffness| up_to(stiffness, factor));
    let stable = [0.9, 1.0].into_iter().flat_map(up_to);
    stable.chain([1.05, 2.0].into_iter().flat_map(at)).collect()
}

/// The box with super-time-stepping of viscosity, whose limit is that of sound.
fn up_to(stiffness: f64, factor: f64) -> Experiment {
    let pair = Pair::cubic_super();
    let settings =
        BoxSettings { n: 20, h_over_dx: 1.3, stiffness: Some(stiffness), ..Default::default() };
    let theory = NoisyBox::new(&settings).theory(pair.plain());
    let (courant, integrator) = (factor * theory.limit, pair.plain().integrator);
    let set = |s: &mut BoxSettings| {
        *s = BoxSettings { courant, steps: theory.steps, to_the_end: true, ..settings };
    };
    let spec = RESTING_BOX.spec(pair.name, set).allow_unstable();
    Experiment::of(spec, 1e-3 * theory.steps as f64, move |record: &Record| {
        let setting = format!("{factor} limits, {integrator}, c₀h/ν = {stiffness}");
        let name = format!("step.{integrator}.{stiffness}.{factor}");
        let what = ["step up to the limit".into(), setting];
        let because = "Up to the limit of sound and viscosity together no wave grows, however stiff \
                       viscosity is.";
        let entry =
            Entry::new(&name, what, "grew", Bound::Equals(0.0)).because(Evidence::Theory, because);
        measured(entry, record, GREW, " (0: no growth)")
    })
}

fn beyond(pair: Pair, stiffness: Option<f64>, factor: f64) -> Experiment {
    let settings = BoxSettings { n: 20, h_over_dx: 1.3, stiffness, ..Default::default() };
    let (theory, integrator) = (pair.plain().theory, pair.plain().integrator);
    let modes = NoisyBox::new(&settings).modes(pair.plain());
    let courant = factor * time_step::time_step_limit(&modes, theory);
    let growth = time_step::growth_per_step(&modes, theory, courant);
    // From the noise to the speed of sound.
    let expected = ln(1.0 / NOISE) / growth;
    let steps = (3.0 * expected + 20.0).ceil() as usize;
    let set = |s: &mut BoxSettings| {
        *s = BoxSettings { courant, steps, to_the_end: true, ..settings };
    };
    let spec = RESTING_BOX.spec(pair.name, set).allow_unstable();
    Experiment::of(spec, 1e-4 * steps as f64, move |record: &Record| {
        let sound = stiffness.map_or("no viscosity".into(), |ratio| format!("c₀h/ν = {ratio}"));
        let what =
            ["step beyond the limit".into(), format!("{factor} limits, {integrator}, {sound}")];
        let name = format!("step.{integrator}.{}.{factor}", stiffness.unwrap_or(f64::INFINITY));
        let because = "The expected number of steps is ln(c₀/noise)/growth. The run may end earlier, by \
                       ln(4/0.3) of that logarithm, because the largest of 800 normal numbers is 4 times \
                       their deviation and 30 % of compression end the run as well. It may end later, by \
                       ln(20 · 20 · 2), because the noise of 20 × 20 particles leaves 1/20 of itself to a \
                       wave, of 800 waves one starts 20 times lower with a chance of 1/400, and a speed of \
                       2 c₀ ends the run.";
        let share = |times: f64| ln(times) / ln(1.0 / NOISE);
        let bound = Bound::Within(1.0 - share(4.0 / 0.3), 1.0 + share(800.0));
        let steps = match record.status {
            Status::Diverged { step, .. } => step as f64 / expected,
            _ => f64::NAN,
        };
        Entry::new(&name, what, "steps/theory", bound)
            .because(Evidence::Theory, because)
            .found(steps, format!("{}; theory {expected:.0} steps", record.status))
    })
}
