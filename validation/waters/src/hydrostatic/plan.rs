//! The runs: three compressibilities with the modern method, the paper's at one, a control; in the full tier
//! what walls and density treatments do, and starts that are not at rest.

use super::{
    HYDROSTATIC, HydrostaticSettings, NAME,
    run::{GAP, KINETIC, LEVEL_DRIFT, OUTSIDE, P_L2},
};
use crate::{causes::MIRRORED_PRESSURE, water::gate};
use base::{
    gate::{Bound, Evidence, Gate},
    mutation::Constant,
    record::Record,
};
use harness::{
    case::Tier,
    columns::Columns,
    declare::{Accuracy, CurveOf, CurvePanel, Curves, Declaration, ErrorOf, Sensitivity, Watched},
    runs::Runs,
    study::Study,
    table,
};
use report::{Axis, Cell};

/// What a run is for.
#[derive(Clone, Copy, PartialEq)]
pub enum Group {
    /// Judged, with 20 rows.
    Judged,
    /// A wall that extrapolates the pressure as if nothing weighed.
    Control,
    /// Resolutions.
    Ladder,
    /// Walls and density treatments, and starts that are not at rest: shown, not judged.
    Shown,
}

type Row = table::Row<HydrostaticSettings, Group>;

/// g H/c₀².
const COMPRESSIBILITIES: [f64; 3] = [1e-4, 0.01, 0.1];
/// The paper's variants and the best.
const VARIANTS: [&str; 3] = ["seed", "ghosts", "modern"];

/// All runs of a tier.
pub fn table(tier: Tier) -> table::Table<HydrostaticSettings, Group> {
    let mut table = table::Table::new(&HYDROSTATIC, tier);
    let all: &[f64] = &COMPRESSIBILITIES;
    let compressed = |s: &mut HydrostaticSettings, value: f64| s.compressibility = value;
    table.over(Group::Judged, &["modern"], [all, all], compressed);
    table.over(Group::Judged, &["seed", "ghosts"], [&[0.01], &[0.01]], compressed);
    table.one(Group::Control, "modern", |s| s.wall_gravity = 0.0);
    table.over(Group::Ladder, &VARIANTS, [&[10, 14, 20], &[10, 14, 20, 28, 40]], |s, rows| {
        (s.rows, s.columns) = (rows, rows / 2);
    });
    table.over(
        Group::Shown,
        &["extrapolating-molteni", "interface-hydrostatic"],
        [&[], all],
        compressed,
    );
    table.over(Group::Shown, &["modern"], [&[], all], |s, value| {
        (s.compressibility, s.diffusion) = (value, 0.0);
    });
    table.over(Group::Shown, &["modern"], [&[], &[(0.1, false), (0.0, true)]], |s, start| {
        ((s.jitter, s.uniform), s.end) = (start, 40.0);
    });
    for Row { variant, settings, run, .. } in &mut table.rows {
        // Twice as many rows and columns take half the step.
        let dear = if *variant == "modern" { 1.0 } else { 3.0 };
        run.seconds = 0.3 * dear * (settings.rows as f64 / 20.0).powi(3);
    }
    table.judge(gates);
    table
}

/// The error of the pressure over resolutions and over the height, and what the gates must detect.
pub fn declaration(tier: Tier) -> Declaration {
    let table = table(tier);
    let level = |s: &HydrostaticSettings| (1.0 / s.rows as f64, format!("{} rows", s.rows));
    let about = "Water at rest after 20 acoustic periods, g H/c0² = 0.01. Errors are rms, over the rms of \
                 the pressure.";
    let accuracy = Accuracy {
        about: about.into(),
        spacing: "dx/H [-]",
        slope: Some(1.0),
        ladders: VARIANTS.map(|variant| table.ladder(&[Group::Ladder], variant, level)).into(),
        ..Accuracy::new("hydrostatic", ErrorOf::Metric(P_L2.into()), "error of the pressure [-]")
    };
    let watched = [Constant::BodyForce, Constant::Density, Constant::Height]
        .map(|constant| Watched::new(constant).quick());
    let plain = |variant: &str| HYDROSTATIC.spec(variant, |_| ());
    let sensitivity = Some(Sensitivity::new(NAME, tier, [plain("modern")], watched));
    let error = |record: &Record| {
        let [y, p, exact] = ["y", "p", "p_exact"].map(|name| record.column("pressure", name));
        p.iter().zip(exact).zip(y).map(|((p, exact), y)| (p - exact, *y)).collect()
    };
    let line = |variant: &str| CurveOf {
        name: variant.into(),
        spec: plain(variant),
        points: Box::new(error),
    };
    let panel = CurvePanel {
        title: String::new(),
        x: Axis::linear("(p − p_exact)/(ρ₀ g H) [-]"),
        y: Axis::linear("y/H [-]"),
        lines: VARIANTS.map(line).into(),
        references: Vec::new(),
        symbols: true,
    };
    let caption = "Error of the pressure of every particle over its height after 20 acoustic periods, at g \
                   H/c0² = 0.01 with 20 rows. Variants `seed` and `ghosts` have the paper's walls, and \
                   `modern` walls that extrapolate.";
    let curves = Curves {
        id: "hydrostatic-pressure".into(),
        title: "Pressure of water at rest".into(),
        caption: caption.into(),
        columns: 1,
        panels: vec![panel],
    };
    Declaration {
        curves: vec![curves],
        accuracy: vec![accuracy],
        sensitivity,
        ..Declaration::default()
    }
}

/// The errors of all runs.
pub fn studies(_: Tier, runs: &Runs) -> Vec<Study> {
    let caption = "Errors of water at rest after 20 acoustic periods, unless another end is given.";
    let table = Columns::of_variants()
        .changed("settings", &HYDROSTATIC)
        .ended()
        .percent("error of p", "-", P_L2, 1.0)
        .percent("drift of the level", "H", LEVEL_DRIFT, 1.0)
        .metric(["gap at the bottom", "dx"], GAP, |gap| Cell::num(gap, 2))
        .metric(["kinetic energy", "M g H"], KINETIC, |energy| Cell::sci(energy, 2))
        .number("outside", "-", OUTSIDE)
        .table(caption, runs.all().iter().map(|run| &run.record));
    vec![Study::new("hydrostatic-errors", "Errors of water at rest").block(table)]
}

fn gates(row: &Row) -> Vec<Gate> {
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
    let control = "Control: without gravity in the extrapolation, the bottom bears the mean pressure of \
                   the water before it instead of the pressure at its own depth, and the water sinks.";
    let tight = "No particle passes a wall.";
    let (id, because) = match (row.group, row.settings.compressibility) {
        (Group::Ladder | Group::Shown, _) => return Vec::new(),
        (Group::Control, _) => (format!("{NAME}.modern.no-wall-gravity"), control),
        (Group::Judged, 1e-4) => (format!("{NAME}.{}.1e-4", row.variant), known),
        (Group::Judged, of) => (format!("{NAME}.{}.{of}", row.variant), known),
    };
    let pressure = gate(&id, P_L2, Bound::Below(0.02), Evidence::Analytic, because);
    if row.group == Group::Control {
        return vec![pressure.expected_to_fail()];
    }
    let exact = |metric, bound, because| gate(&id, metric, bound, Evidence::Analytic, because);
    vec![
        match row.variant {
            "ghosts" => pressure
                .with_limitation(Bound::Below(0.087), mirrored)
                .because_of(&MIRRORED_PRESSURE),
            _ => pressure,
        },
        exact(LEVEL_DRIFT, Bound::Within(-0.005, 0.005), stays),
        exact(GAP, Bound::Within(-0.25, 0.25), lowest),
        exact(KINETIC, Bound::Below(2.5e-5), still),
        gate(&id, OUTSIDE, Bound::Equals(0.0), Evidence::Invariant, tight),
    ]
}
