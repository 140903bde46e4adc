//! What the runs say together: pressures over the exact line, and walls by density treatments.

use super::{
    HydrostaticSettings,
    plan::{self, COMPRESSIBILITIES, SHOWN, TABLE},
    run::{GAP, KINETIC, LEVEL_DRIFT, OUTSIDE, P_L2},
};
use base::record::{Record, Status};
use harness::{case::Tier, columns::Columns, runs::Runs, study::Study};
use report::{Axis, Cell, Colour, Column, Figure, Legend, Plot, Series, Shape, Table};

/// All of them.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    let pressures = Study::new("hydrostatic-pressure", "Pressure of water at rest")
        .block(pressures(runs))
        .block(table(
            "Errors of all runs of water at rest after 20 acoustic periods, unless another time is given.",
            runs.all().iter().map(|run| &run.record),
        ));
    let mut studies = vec![pressures];
    if tier == Tier::Full {
        let of = |variant: &'static str| {
            runs.records(COMPRESSIBILITIES.map(|(c, _)| plan::plain(variant, c)))
        };
        let caption = "Every wall with every treatment of density. Runs are water at rest with Wendland \
                           C2, h/dx = 1.5, leapfrog and 20 rows.";
        let by_wall = table(caption, TABLE.into_iter().flat_map(of));
        let study = Study::new("hydrostatic-walls", "Walls and density treatments");
        studies.push(study.block(by_wall));
    }
    studies
}

/// p over y of the variants at g H/c₀² = 0.01, and how far it is from exact.
fn pressures(runs: &Runs) -> Figure {
    let caption = "Pressure of every particle over its height after 20 acoustic periods (left), and its \
                   error (right), at g H/c0² = 0.01 with 20 rows. Variants `seed` and `ghosts` have the \
                   paper's walls, and `modern` walls that extrapolate. Exact lines differ because the \
                   surface of `seed` is half a spacing lower.";
    let mut over = Plot::new("", Axis::linear("p/(ρ₀ g H) [-]"), Axis::linear("y/H [-]"));
    let mut error =
        Plot::new("", Axis::linear("(p − p_exact)/(ρ₀ g H) [-]"), Axis::linear("y/H [-]"));
    for (k, variant) in SHOWN.into_iter().enumerate() {
        let Some(record) = runs.record(&plan::plain(variant, 0.01)) else { continue };
        let [y, p, exact] = ["y", "p", "p_exact"].map(|name| record.column("pressure", name));
        let line = exact.iter().zip(y).map(|(p, y)| (*p, *y)).collect();
        over = over.layer(Series::line(format!("exact, {variant}"), line).colour(Colour::cycle(k)));
        let series = |points: Vec<(f64, f64)>| {
            let markers = Series::markers(variant, points).colour(Colour::cycle(k));
            markers.shape(Shape::cycle(k)).open().size(5.0)
        };
        over = over.layer(series(p.iter().zip(y).map(|(p, y)| (*p, *y)).collect()));
        let distance = p.iter().zip(exact).zip(y).map(|((p, exact), y)| (p - exact, *y));
        error = error.layer(series(distance.collect()));
    }
    Figure::new("hydrostatic-pressure", caption)
        .columns(2)
        .panel(over.legend(Legend::Auto))
        .panel(error.legend(Legend::Hidden))
        .panel_size(420.0, 320.0)
}

fn table<'a>(caption: &str, records: impl Iterator<Item = &'a Record>) -> Table {
    let s = |record: &Record| record.settings_as::<HydrostaticSettings>();
    let outside = |record: &Record| match &record.status {
        Status::Completed => {
            let count = record.value(OUTSIDE).unwrap_or(f64::NAN);
            Cell::or_dash(count, |count| Cell::num(count, 3))
        }
        _ => Cell::text("did not finish"),
    };
    Columns::of_variants()
        .of(["g H/c0^2", "-"], |record| s(record).compressibility, |value| Cell::num(value, 2))
        .of(["rows", "-"], |record| s(record).rows as f64, |rows| Cell::num(rows, 3))
        .text("other settings", |record| others(&s(record)))
        .percent("error of p", "-", P_L2, 1.0)
        .percent("drift of the level", "H", LEVEL_DRIFT, 1.0)
        .metric(["gap at the bottom", "dx"], GAP, |gap| Cell::num(gap, 2))
        .metric(["kinetic energy", "M g H"], KINETIC, |energy| Cell::sci(energy, 2))
        .with(Column::num("outside", "-"), outside)
        .table(caption, records)
}

/// What else is not the default.
fn others(s: &HydrostaticSettings) -> String {
    let mut words = Vec::new();
    if s.wall_gravity != 1.0 {
        words.push("wall without gravity".to_string());
    }
    if s.jitter != 0.0 {
        words.push(format!("jitter {} dx", s.jitter));
    }
    if s.uniform {
        words.push("starts uncompressed".into());
    }
    if s.end != 20.0 {
        words.push(format!("{} periods", s.end));
    }
    words.join(", ")
}
