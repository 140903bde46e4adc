//! Steps beyond the limit: seen to diverge, and how soon.

use std::marker::PhantomData;

use solver::{CubicSpline, Leapfrog, Outcome, PredictorCorrector};

use super::Entry;
use crate::stability::{NOISE, NoisyBox};
use base::gate::{Bound, Evidence};
use harness::case::Tier;
use maths::theory::{Stepping, time_step};

/// The noisy box at 1.05 and 2 times its limit.
pub fn beyond_the_limit(_tier: Tier) -> Vec<Entry> {
    let mut entries = Vec::new();
    for factor in [1.05, 2.0] {
        entries.push(beyond::<Leapfrog>("leapfrog", f64::INFINITY, factor));
        entries.push(beyond::<Leapfrog>("leapfrog", 1.0, factor));
        entries.push(beyond::<PredictorCorrector>("predictor-corrector", 1.0, factor));
    }
    entries
}

fn beyond<I: Stepping>(integrator: &str, stiffness: f64, factor: f64) -> Entry {
    let fluid = NoisyBox::<CubicSpline> {
        n: 20,
        h_over_dx: 1.3,
        stiffness,
        alpha: 0.0,
        delta: 0.0,
        kernel: PhantomData,
    };
    let modes = time_step::modes(&fluid.lattice(), fluid.n, &fluid.medium());
    let courant = factor * time_step::time_step_limit(&modes, I::THEORY);
    let growth = time_step::growth_per_step(&modes, I::THEORY, courant);
    // From the noise to the speed of sound.
    let expected = (1.0 / NOISE).ln() / growth;
    let dt = courant * 1.3 / fluid.n as f64;
    let outcome = fluid
        .plain::<I>()
        .build()
        .map(|mut simulation| simulation.advance(dt * (3.0 * expected + 20.0).ceil(), dt, &mut ()));
    let (steps, found) = match outcome {
        Ok(Outcome::Diverged(divergence)) => (divergence.step as f64, divergence.to_string()),
        Ok(other) => (f64::NAN, format!("not seen: {other:?}")),
        Err(error) => (f64::NAN, error.to_string()),
    };
    let sound = if stiffness.is_finite() { "c₀h/ν = 1" } else { "no viscosity" };
    let what = ["step beyond the limit".into(), format!("{factor} limits, {integrator}, {sound}")];
    let name = format!("step.{integrator}.{stiffness}.{factor}");
    let because = "ln(c₀/noise)/growth a step, plus what linear theory does not know: how the noise \
                   is spread over waves, and that growth slows where it is not linear";
    Entry::new(&name, what, "steps/theory", Bound::Within(0.8, 1.6))
        .because(Evidence::Theory, because)
        .found(steps / expected, format!("{found}; theory {expected:.0} steps"))
}
