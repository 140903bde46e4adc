//! How far the flow over hills can be pushed: the time step against theory, and the Reynolds number.

use super::{
    BEST, CASE, HillSettings, NAME,
    measure::{DRIFT, FORCE, FORCE_RIPPLE, OUTSIDE, SECTION_FLUX},
};
use base::{
    gate::{Bound, Evidence, Gate},
    record::{Record, Status},
    spec::RunSpec,
};
use harness::{
    case::{Case, Rules, Tier},
    columns::Columns,
    declare::{StepLimit, StepLimits},
    runs::Runs,
    study::Study,
};
use report::Cell;

/// Spacings along the height of the hill in the runs of the full tier.
const N: usize = 10;
/// Those of the quick tier.
const QUICK_N: usize = 5;

/// Variant, and its longest stable step over the default one when this study was introduced: not the
/// truth, but the margin must not shrink unnoticed.
const MARGINS: [(&str, f64); 3] = [("modern", 1.577), (BEST, 1.577), ("consistent", 1.577)];

/// Resolution of the bisection, relative to the theoretical limit: that of [`StepLimit::proportional`].
const RESOLUTION: f64 = 0.02;

/// Variant and the Reynolds number it is tried at. 1000 is the most that the setting allows, and all but
/// `plain` hold it: lower ones would say nothing more. `plain` is a control, tried at the lowest alone.
const TRIED: [(&str, f64); 6] = [
    ("plain", 10.0),
    ("interface-wall", 1000.0),
    ("modern", 1000.0),
    (BEST, 1000.0),
    ("mixed", 1000.0),
    ("consistent", 1000.0),
];

/// End of these runs \[H/U_b\]: the flux has filled the period 0.96 times. `plain` diverges before.
const TRIED_TO: f64 = 12.0;

/// Ended, and no sample of the kinetic energy is above twice that of the first one after the start, which is
/// near the answer.
pub fn is_stable(record: &Record) -> bool {
    let energy = record.column("series", "kinetic energy").get(1..).unwrap_or_default();
    let bounded = |first: &f64| energy.iter().all(|e| *e <= 2.0 * first);
    record.status == Status::Completed && energy.first().is_some_and(bounded)
}

/// The longest stable step over the theoretical one, by bisection.
pub fn limits(tier: Tier) -> StepLimits {
    let (n, tried) = match tier {
        Tier::Quick => (QUICK_N, "One of six variants was tried, the best."),
        Tier::Full => (
            N,
            "Three of six variants were tried, one each with sums over pairs, with shifted velocities and \
             with consistent sums; `plain`, `interface-wall` and `mixed` were not.",
        ),
    };
    let of = match tier {
        Tier::Quick => vec![limit(BEST, n)],
        Tier::Full => MARGINS.map(|(variant, margin)| judged(limit(variant, n), margin)).into(),
    };
    let about = format!(
        "The longest time step with which the flow at Re 50, H/dx = {n}, goes on for 3 H/U_b from the \
         interpolated reference without diverging or doubling its kinetic energy, by bisection to 2 %, over \
         the limit of linear theory for a periodic lattice at rest. Walls, curvature and particles in \
         disorder are not in that theory. {tried}"
    );
    StepLimits::new("periodic-hill", &about, of)
}

/// The bisection of a variant.
fn limit(variant: &'static str, n: usize) -> StepLimit {
    let spec = CASE.spec(variant, |s| (s.n, s.from_reference, s.end) = (n, true, 3.0));
    let rules = CASE.rules(&spec).unwrap_or(Rules::REFUSED);
    // The step is proportional to the Courant number: the viscous limit is ten times as far at Re 50.
    let at_limit = HillSettings::default().courant / (rules.dt() / rules.dt_limit());
    let scene = format!("Re 50, H/dx = {n}");
    StepLimit::proportional(variant, &scene, spec, ("courant", at_limit), &rules)
}

/// The same with its gates.
fn judged(limit: StepLimit, margin: f64) -> StepLimit {
    let StepLimit { variant, default_at: default, .. } = limit;
    let gate = |what: &str, metric: &str, bound: Bound, evidence: Evidence, because: &str| {
        Gate::new(format!("{NAME}.step.{variant}.{what}"), metric, bound, evidence, because)
    };
    let theory = gate(
        "theory",
        "measured/theory",
        Bound::Within(default, 1.2),
        Evidence::Theory,
        "The default step must be stable. Disorder makes neither sound slower nor the stencil softer by a \
         fifth, so a limit far above that of the lattice would show a wrong theory.",
    );
    let kept = gate(
        "margin",
        "longest stable dt/default dt",
        Bound::Above(margin - RESOLUTION / default),
        Evidence::Regression,
        "The bound is what was measured when this study was introduced, less the resolution of the \
         bisection.",
    );
    StepLimit { of_theory: vec![theory], of_default: vec![kept], ..limit }
}

/// Completed, no particle behind a wall, and the force that holds the flux is one against a drag.
fn holds(record: &Record) -> bool {
    record.status == Status::Completed
        && record.value(OUTSIDE) == Some(0.0)
        && record.value(FORCE).is_some_and(|force| force > 0.0)
}

/// The runs at the highest Reynolds number, with that number.
pub fn tried() -> [(RunSpec, f64); 6] {
    let run = |(variant, re)| (CASE.spec(variant, |s| (s.n, s.re, s.end) = (N, re, TRIED_TO)), re);
    TRIED.map(run)
}

/// A Reynolds number that variants hold.
pub fn reynolds(runs: &Runs) -> Study {
    let caption = format!(
        "Every variant at Re 1000, the highest that the setting allows, and `plain` at Re 10. Runs have \
         H/dx = 10 and go from rest to {TRIED_TO} H/U_b. A variant holds a Reynolds number if its run \
         completes with no particle behind a wall and a force along the flow. Force, ripple and flux are \
         of the last {window} H/U_b. Windows differ by the rms over ten stations of the change of mean u \
         from the {window} H/U_b before. The flow still develops then, so these numbers do not show its \
         accuracy.",
        window = TRIED_TO / 5.0,
    );
    let re = |record: &Record| record.settings_as::<HillSettings>().re;
    let table = Columns::of_variants()
        .num(["Re", "-"], move |record| Cell::exact(re(record)))
        .num(["U_b dx/ν", "-"], move |record| Cell::num(re(record) / N as f64, 2))
        .ended()
        .metric(["outside", "1"], OUTSIDE, |v| Cell::count(v as u64))
        .number("force", "U_b^2/H", FORCE)
        .metric(["ripple of it", "-"], FORCE_RIPPLE, |v| Cell::percent(v, 1))
        .metric(["flux of sections", "-"], SECTION_FLUX, |v| Cell::percent(v, 1))
        .metric(["windows differ by", "U_b"], DRIFT, |v| Cell::sci(v, 1))
        .table(caption, runs.records(tried().map(|(spec, _)| spec)));
    let mut study = Study::new("periodic-hill-reynolds", "Highest Reynolds number");
    for (spec, re) in tried() {
        let (variant, record) = (spec.variant.as_str(), runs.record(&spec));
        let held = if record.is_some_and(holds) { re } else { 0.0 };
        let gate = Gate::new(
            format!("{NAME}.highest_re.{variant}"),
            "highest Re held",
            Bound::Above(re),
            Evidence::Regression,
            "The Reynolds number that was held to 20 H/U_b when this study was introduced must not fall; \
             here runs last 12 H/U_b to save time. Control: without shifting and density diffusion not \
             even Re 10, the lowest tried, is held.",
        );
        let gate = if variant == "plain" { gate.expected_to_fail() } else { gate };
        study = study.judge(gate, held);
    }
    study.block(table)
}
