//! The judged runs and their gates.

use crate::{
    case::{Planned, Tier},
    gate::{Bound, Evidence, Gate},
};

/// The variant that is held to the goals.
pub const BEST: &str = "carried";

/// Variants, each at these resolutions in the full tier.
pub const LADDER: [(&str, &[usize]); 6] = [
    ("plain", &[10]),
    ("interface-wall", &[10]),
    ("modern", &[10, 20]),
    ("carried", &[10, 20, 40]),
    ("mixed", &[10]),
    ("consistent", &[10, 20]),
];

/// The runs of a tier: first the ladder at Re 50, variant by variant.
pub fn plan(tier: Tier) -> Vec<Planned> {
    if tier == Tier::Quick {
        return vec![run(BEST, 50.0, 10)];
    }
    let mut runs = Vec::new();
    for (variant, resolutions) in LADDER {
        runs.extend(resolutions.iter().map(|&n| run(variant, 50.0, n)));
    }
    for re in [10.0, 100.0] {
        runs.extend([10, 20].map(|n| run(BEST, re, n)));
    }
    // From the interpolated reference: the same steady flow.
    for re in [50.0, 100.0] {
        let mut set = vec![format!("re={re}"), "n=10".into(), "from_reference=true".into()];
        set.push(format!("end={}", end(re)));
        runs.push(Planned::new(BEST, &set).judged(gates(BEST, re, 10, "reference.")));
    }
    // The error budget, and a flat channel, whose flow is exact.
    let budget =
        ["courant=0.5", "c0=30", "h_over_dx=1.2", "diffusion=0.05", "shift=1.5", "crest=0"];
    runs.extend(budget.map(|set| Planned::new(BEST, &["n=10".to_string(), set.to_string()])));
    runs
}

/// How long the slowest transient takes [H/U_b]: at Re 100 the bubble fills slowly.
fn end(re: f64) -> f64 {
    if re > 60.0 { 80.0 } else { 40.0 }
}

fn run(variant: &'static str, re: f64, n: usize) -> Planned {
    let mut set = vec![format!("re={re}"), format!("n={n}")];
    if end(re) != 40.0 {
        set.push(format!("end={}", end(re)));
    }
    Planned::new(variant, &set).judged(gates(variant, re, n, ""))
}

fn gates(variant: &str, re: f64, n: usize, more: &str) -> Vec<Gate> {
    let gate = |metric: &str, bound: Bound, evidence: Evidence, because: &str| {
        let id = format!("periodic_hill.{more}{variant}.{re}.{n}.{metric}");
        Gate::new(id, metric, bound, evidence, because)
    };
    let none_outside =
        gate("outside", Bound::Equals(0.0), Evidence::Invariant, "no particle passes a wall");
    if variant != BEST {
        return if variant == "plain" { Vec::new() } else { vec![none_outside] };
    }
    let goal = match n {
        40.. => 0.01,
        20.. => 0.02,
        _ => 0.04,
    };
    let reach = if n >= 20 { 0.1 } else { 0.2 };
    let because = "the goal: 2 % of U_b at 20 spacings, 1 % at 40, so of first order, and 4 % at 10; the \
                   reference is known to 0.02 %";
    let mut gates = vec![
        gate("l2_u", Bound::Below(goal), Evidence::Reference, because),
        none_outside,
        gate(
            "section_flux",
            Bound::Below(if n >= 20 { 0.005 } else { 0.02 }),
            Evidence::Invariant,
            "an incompressible steady flow has the same flux through every section: 0.5 %, twice Mach's \
             density variation; at ten spacings four times that, for the field between particles and wall is \
             interpolated to second order",
        ),
        gate(
            "flux",
            Bound::Within(-1e-3, 1e-3),
            Evidence::Invariant,
            "the controller integrates: the flux it holds is the one wanted",
        ),
        gate(
            "drag_balance",
            if n >= 20 { Bound::Within(-0.01, 0.01) } else { Bound::Within(-0.04, 0.04) },
            Evidence::Invariant,
            "in steady flow the walls take what the force gives; stress at the wall from the field, not \
             from the sums that move particles: 1 %, at ten spacings four times that, for its slope is \
             found to second order",
        ),
        gate(
            "unsteady",
            Bound::Below(0.25 * goal),
            Evidence::Theory,
            "what is left of a decay, extrapolated from three windows: a quarter of the goal. Where disorder \
             moves the windows more than the decay does, it is nine times that at most",
        ),
    ];
    if re > 10.0 {
        let because = "a tenth of H, the goal at 20 spacings: two spacings";
        let bound = Bound::Within(-reach, reach);
        gates.push(gate("reattachment_error", bound, Evidence::Reference, because));
    }
    gates
}
