//! The judged runs: three compressibilities with the modern method, the paper's at one, a control; in
//! the full tier every wall with every density treatment.

use super::{
    HYDROSTATIC, HydrostaticSettings, NAME,
    run::{GAP, KINETIC, LEVEL_DRIFT, OUTSIDE, P_L2},
};
use crate::{causes::MIRRORED_PRESSURE, water::gate};
use base::{
    gate::{Bound, Evidence, Gate},
    mutation::Constant,
    spec::RunSpec,
};
use harness::{
    case::{Planned, Tier},
    declare::{Accuracy, Declaration, ErrorOf, Ladder, Level, Sensitivity, Watched},
};

/// g H/c₀², and as gates name it.
pub const COMPRESSIBILITIES: [(f64, &str); 3] = [(1e-4, "1e-4"), USUAL, (0.1, "0.1")];
const USUAL: (f64, &str) = (0.01, "0.01");

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

/// A run with 20 rows and nothing else special.
pub fn plain(variant: &str, compressibility: f64) -> RunSpec {
    HYDROSTATIC.spec(variant, |s| s.compressibility = compressibility)
}

/// The runs.
pub fn plan(tier: Tier) -> Vec<Planned> {
    let judged = |variant: &str, (value, name): (f64, &str)| {
        planned(plain(variant, value)).judged(gates(variant, name))
    };
    let mut runs = Vec::new();
    runs.extend(COMPRESSIBILITIES.map(|c| judged("modern", c)));
    runs.extend(["seed", "ghosts"].map(|variant| judged(variant, USUAL)));
    let modern = |set: fn(&mut HydrostaticSettings)| planned(HYDROSTATIC.spec("modern", set));
    runs.push(modern(|s| s.wall_gravity = 0.0).judged(vec![control()]));
    if tier == Tier::Full {
        for variant in ["seed", "ghosts"] {
            runs.extend([0, 2].map(|k| judged(variant, COMPRESSIBILITIES[k])));
        }
        for variant in TABLE.into_iter().filter(|v| *v != "modern") {
            runs.extend(COMPRESSIBILITIES.map(|(c, _)| planned(plain(variant, c))));
        }
        runs.push(modern(|s| (s.jitter, s.end) = (0.1, 40.0)));
        runs.push(modern(|s| (s.uniform, s.end) = (true, 40.0)));
    }
    runs
}

fn planned(spec: RunSpec) -> Planned {
    let dear = if ["seed", "ghosts"].contains(&spec.variant.as_str()) { 3.0 } else { 1.0 };
    Planned::new(spec).taking(0.3 * dear)
}

/// Resolutions: rows.
fn ladder(tier: Tier, variant: &str) -> &'static [usize] {
    match (tier, variant) {
        (Tier::Quick, _) => &[10, 14, 20],
        (Tier::Full, "modern") => &[10, 14, 20, 28, 40],
        (Tier::Full, _) => &[10, 14, 20, 28],
    }
}

/// Error of the pressure over resolutions.
pub fn declaration(tier: Tier) -> Declaration {
    let level = |variant: &str, rows: usize| {
        let spec = HYDROSTATIC.spec(variant, |s| (s.rows, s.columns) = (rows, rows / 2));
        let (spacing, label) = (1.0 / rows as f64, format!("{rows} rows"));
        // Twice as many rows and columns take half the step.
        let seconds = 0.3 * (rows as f64 / 20.0).powi(3);
        Level { run: Planned::new(spec).taking(seconds), spacing, label }
    };
    let of = |variant: &'static str| {
        Ladder::new(variant, ladder(tier, variant).iter().map(|rows| level(variant, *rows)))
    };
    let error = ErrorOf::Metric(P_L2.into());
    let about = "Water at rest after 20 acoustic periods, g H/c0² = 0.01. Errors are rms, over the rms of \
                 the pressure.";
    let accuracy = Accuracy {
        about: about.into(),
        spacing: "dx/H [-]",
        slope: Some(1.0),
        ladders: SHOWN.map(of).into(),
        ..Accuracy::new("hydrostatic", error, "error of the pressure [-]")
    };
    let run = plain("modern", USUAL.0);
    let watched = [Constant::BodyForce, Constant::Density, Constant::Height]
        .map(|constant| Watched::new(constant).quick());
    let sensitivity = Some(Sensitivity::new(NAME, tier, [run], watched));
    Declaration { accuracy: vec![accuracy], sensitivity, ..Declaration::default() }
}

fn gates(variant: &str, compressibility: &str) -> Vec<Gate> {
    let id = format!("{NAME}.{variant}.{compressibility}");
    let known = "The pressure of water at rest is known exactly. The bound of 2 % of its rms is a fifth of \
                 the weight of one of 20 rows.";
    let mirrored = "The lowest row bears 0.8 ρ g dx too much, and errors of rows above alternate in sign, \
                    because the pressure force (5) does not act against a pressure that alternates between \
                    rows. The bound: an error of ρ g dx in every row, which is 8.7 % of the rms at 20 rows.";
    let stays = "The level of water at rest stays. The surface may settle by a tenth of one of 20 spacings, \
                 because the kernel finds no water above it.";
    let lowest = "The lowest row stays where it starts. A wall that pushes it away by a quarter of a \
                  spacing leaves a visible gap.";
    let still = "Nothing moves. The bound is the energy that raises the surface by a tenth of a spacing, \
                 (0.1 dx/H)² M g H at 20 rows.";
    let exact = |metric, bound, because| gate(&id, metric, bound, Evidence::Analytic, because);
    let pressure = exact(P_L2, Bound::Below(0.02), known);
    vec![
        if variant == "ghosts" {
            pressure.with_limitation(Bound::Below(0.087), mirrored).because_of(&MIRRORED_PRESSURE)
        } else {
            pressure
        },
        exact(LEVEL_DRIFT, Bound::Within(-0.005, 0.005), stays),
        exact(GAP, Bound::Within(-0.25, 0.25), lowest),
        exact(KINETIC, Bound::Below(2.5e-5), still),
        gate(&id, OUTSIDE, Bound::Equals(0.0), Evidence::Invariant, "No particle passes a wall."),
    ]
}

/// A wall that extrapolates the pressure as if nothing weighed: it lacks half a spacing of water.
fn control() -> Gate {
    let because = "Control: without gravity in the extrapolation, the bottom bears the mean pressure of \
                   the water before it instead of the pressure at its own depth, and the water sinks.";
    let id = format!("{NAME}.modern.no-wall-gravity");
    gate(&id, P_L2, Bound::Below(0.02), Evidence::Analytic, because).expected_to_fail()
}
