//! The judged runs and their gates.

use crate::{
    case::{Planned, Tier},
    gate::{Bound, Evidence, Gate},
};

/// The variant that is held to the goals.
pub const BEST: &str = "carried";

/// Variants, each at these resolutions in the full tier, from rest.
pub const LADDER: [(&str, &[usize]); 6] = [
    ("plain", &[10]),
    ("interface-wall", &[10]),
    ("modern", &[10, 20]),
    ("carried", &[10, 20]),
    ("mixed", &[10]),
    ("consistent", &[10, 20]),
];

/// The runs of a tier: first the ladder at Re 50, variant by variant.
pub fn plan(tier: Tier) -> Vec<Planned> {
    if tier == Tier::Quick {
        // Three quarters of the time: what is left of the decay is gated, as everywhere.
        return vec![run(BEST, 50.0, 10, 30.0, false)];
    }
    let mut runs = Vec::new();
    for (variant, resolutions) in LADDER {
        runs.extend(resolutions.iter().map(|&n| run(variant, 50.0, n, END, false)));
    }
    runs.push(run(BEST, 50.0, FINEST, 10.0, true));
    // At Re 100 the bubble fills slowly: from rest twice as long, or from near the answer.
    runs.push(run(BEST, 10.0, 10, 20.0, false));
    runs.push(run(BEST, 10.0, 20, 20.0, false));
    runs.push(run(BEST, 100.0, 10, 2.0 * END, false));
    runs.push(run(BEST, 100.0, 20, END, true));
    // From the interpolated reference: the same steady flow.
    runs.push(run(BEST, 50.0, 10, END, true));
    runs.push(run(BEST, 100.0, 10, 2.0 * END, true));
    // The error budget, and a flat channel, whose flow is exact.
    let budget =
        ["courant=0.75", "c0=30", "h_over_dx=1.2", "diffusion=0.05", "shift=1.5", "crest=0"];
    runs.extend(budget.map(|set| {
        Planned::new(BEST, &["n=10".to_string(), set.to_string()]).taking(seconds(10, END))
    }));
    runs
}

/// Spacings along the height of the hill of the finest run. From rest it would take half an hour, so it
/// starts from the reference; that coarser runs reach the same flow from there as from rest is gated.
pub const FINEST: usize = 40;

/// End of a run from rest \[H/U_b\]: at constant flux transients decay within 20 H/U_b at Re 50.
const END: f64 = 40.0;

/// Roughly what a run takes \[s\].
fn seconds(n: usize, end: f64) -> f64 {
    0.4 * end * (n as f64 / 10.0).powi(3)
}

fn run(variant: &'static str, re: f64, n: usize, end: f64, from_reference: bool) -> Planned {
    let mut set = vec![format!("re={re}"), format!("n={n}"), format!("end={end}")];
    if from_reference {
        set.push("from_reference=true".into());
    }
    let start = if from_reference { "reference." } else { "" };
    Planned::new(variant, &set).judged(gates(variant, re, n, start)).taking(seconds(n, end))
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
        gate(
            "force_error",
            Bound::Within(-goal, goal),
            Evidence::Reference,
            "the force goes with the velocity at the walls: the same goal as for the velocity",
        ),
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
