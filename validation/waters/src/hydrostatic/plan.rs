//! The judged runs: three compressibilities with the modern method, the paper's at one, a control; in
//! the full tier every wall with every density treatment.

use super::NAME;
use base::gate::{Bound, Evidence, Gate};
use harness::case::{Planned, Tier};

/// g H/c₀².
pub const COMPRESSIBILITIES: [&str; 3] = ["1e-4", "0.01", "0.1"];

/// Variants of the quick tier and what they are called in figures.
pub const SHOWN: [&str; 3] = ["seed", "ghosts", "modern"];

/// Walls by density treatments, all with the kernel and the integrator of `modern`.
pub const TABLE: [&str; 9] = [
    "interface-none",
    "interface-molteni",
    "interface-hydrostatic",
    "ghosts-none",
    "ghosts-molteni",
    "ghosts-hydrostatic",
    "extrapolating-none",
    "extrapolating-molteni",
    "modern",
];

/// The runs.
pub fn plan(tier: Tier) -> Vec<Planned> {
    let mut runs = Vec::new();
    for compressibility in COMPRESSIBILITIES {
        runs.push(run("modern", compressibility, &[]).judged(gates("modern", compressibility)));
    }
    for variant in ["seed", "ghosts"] {
        runs.push(run(variant, "0.01", &[]).judged(gates(variant, "0.01")));
    }
    runs.push(run("modern", "0.01", &["wall_gravity=0"]).judged(vec![control()]));
    if tier == Tier::Full {
        for (variant, compressibility) in
            ["seed", "ghosts"].into_iter().flat_map(|v| [(v, "1e-4"), (v, "0.1")])
        {
            runs.push(run(variant, compressibility, &[]).judged(gates(variant, compressibility)));
        }
        for variant in TABLE.into_iter().filter(|v| *v != "modern") {
            runs.extend(COMPRESSIBILITIES.map(|c| run(variant, c, &[])));
        }
        for set in [["rows=40", "columns=20"], ["jitter=0.1", "end=40"], ["uniform=true", "end=40"]]
        {
            runs.push(run("modern", "0.01", &set));
        }
    }
    runs
}

fn run(variant: &'static str, compressibility: &str, more: &[&str]) -> Planned {
    let mut set = vec![format!("compressibility={compressibility}")];
    set.extend(more.iter().map(|text| (*text).to_string()));
    // Twice as many rows and columns take half the step, and two right-hand sides a step twice as long.
    let fine = if more.contains(&"rows=40") { 8.0 } else { 1.0 };
    let dear = if ["seed", "ghosts"].contains(&variant) { 3.0 } else { 1.0 };
    Planned::new(variant, &set).taking(0.3 * fine * dear)
}

fn gate(id: &str, metric: &str, bound: Bound, evidence: Evidence, because: &str) -> Gate {
    Gate::new(format!("{NAME}.{id}.{metric}"), metric, bound, evidence, because)
}

fn gates(variant: &str, compressibility: &str) -> Vec<Gate> {
    let id = format!("{variant}.{compressibility}");
    let pressure = gate(
        &id,
        "p_l2",
        Bound::Below(0.02),
        Evidence::Analytic,
        "the pressure of water at rest is known exactly; 2 % of its rms is a fifth of the weight of one of \
         20 rows",
    );
    let pressure = match variant {
        "ghosts" => pressure.with_limitation(
            "a mirror repeats the pressure of the water before the bottom where it should go on rising by \
             rho g: over the half spacing to the bottom that is 2.5 % of rho g H at 20 rows",
        ),
        _ => pressure,
    };
    vec![
        pressure,
        gate(
            &id,
            "level_drift",
            Bound::Within(-0.005, 0.005),
            Evidence::Analytic,
            "the level of water at rest stays: a tenth of one of 20 spacings is what the surface may \
             settle by, as the kernel sees no water above it",
        ),
        gate(
            &id,
            "gap",
            Bound::Within(-0.25, 0.25),
            Evidence::Analytic,
            "the lowest row starts where it belongs: a wall that pushes it away by a quarter of a spacing \
             leaves a gap that is seen",
        ),
        gate(
            &id,
            "kinetic",
            Bound::Below(2.5e-5),
            Evidence::Analytic,
            "nothing moves: less than the energy that raises the surface by a tenth of a spacing, (0.1 \
             dx/H)^2 of M g H at 20 rows",
        ),
        gate(&id, "outside", Bound::Equals(0.0), Evidence::Invariant, "no particle passes a wall"),
    ]
}

/// A wall that extrapolates the pressure as if nothing weighed: it lacks half a spacing of water.
fn control() -> Gate {
    let because = "control: without g in the extrapolation the bottom bears the mean pressure of the water \
                   before it instead of that at its own depth, and the water sinks";
    gate("modern.no-wall-gravity", "p_l2", Bound::Below(0.02), Evidence::Analytic, because)
        .expected_to_fail()
}
