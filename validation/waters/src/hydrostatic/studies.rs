//! What the runs say together: pressures over the exact line, and walls by density treatments.

use super::plan::{SHOWN, TABLE};
use base::record::{Record, Status};
use harness::{
    case::Tier,
    suite::{JudgedRun, Study},
};
use report::{Axis, Cell, Colour, Column, Figure, Legend, Plot, Series, Shape, Table};

/// All of them.
pub fn studies(tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
    let pressures = Study::new("hydrostatic-pressure", "Pressure of water at rest")
        .block(pressures(runs))
        .block(table("All runs after 20 acoustic periods.", runs.iter().map(|run| &run.record)));
    let mut studies = vec![pressures];
    if tier == Tier::Full {
        let of = |variant: &'static str| {
            runs.iter().map(|run| &run.record).filter(move |r| r.variant == variant && is_plain(r))
        };
        let caption =
            "Every wall with every density treatment, Wendland C2, h/dx 1.5, leapfrog, 20 rows.";
        let by_wall = table(caption, TABLE.into_iter().flat_map(of));
        let study = Study::new("hydrostatic-walls", "Walls and density treatments");
        studies.push(study.block(by_wall));
    }
    studies
}

/// Whether a run differs from others by its variant and compressibility only.
fn is_plain(record: &Record) -> bool {
    record.setting("rows") == 20.0
        && record.setting("end") == 20.0
        && record.setting("wall_gravity") == 1.0
}

/// p over y of the variants at g H/c₀² = 0.01, and how far it is from exact.
fn pressures(runs: &[JudgedRun]) -> Figure {
    let caption = "Pressure of every particle over its height after 20 acoustic periods, g H/c0^2 = 0.01, 20 \
                   rows by 10 columns, on the exact line (left), and its distance from the exact pressure \
                   at the particle's place (right). The lines differ by the place of the surface, half a \
                   spacing lower where the particles stand on the bottom's surface: each has the colour of \
                   its variant. `seed` and `ghosts` are the paper's two walls, `modern` \
                   has walls that extrapolate pressure.";
    let mut over = Plot::new("", Axis::linear("p/(rho0 g H) [-]"), Axis::linear("y/H [-]"));
    let mut error =
        Plot::new("", Axis::linear("(p - p_exact)/(rho0 g H) [-]"), Axis::linear("y/H [-]"));
    for (k, variant) in SHOWN.into_iter().enumerate() {
        let is_shown = |r: &&Record| {
            r.variant == variant && r.setting("compressibility") == 0.01 && is_plain(r)
        };
        let found = runs.iter().map(|run| &run.record).find(is_shown);
        let Some(profile) = found.and_then(|record| record.profiles.get("pressure")) else {
            continue;
        };
        let [y, p, exact] = ["y", "p", "p_exact"].map(|name| profile.column(name));
        let line = exact.iter().zip(y).map(|(p, y)| (*p, *y)).collect();
        over = over.layer(Series::line(format!("exact, {variant}"), line).colour(Colour::cycle(k)));
        let series = |points: Vec<(f64, f64)>| {
            let markers = Series::markers(variant, points).colour(Colour::cycle(k));
            markers.shape(Shape::cycle(k)).open().size(5.0)
        };
        over = over.layer(series(p.iter().zip(y).map(|(p, y)| (*p, *y)).collect()));
        let apart = p.iter().zip(exact).zip(y).map(|((p, exact), y)| (p - exact, *y));
        error = error.layer(series(apart.collect()));
    }
    Figure::new("hydrostatic-pressure", caption)
        .columns(2)
        .panel(over.legend(Legend::Auto))
        .panel(error.legend(Legend::Hidden))
        .panel_size(420.0, 320.0)
}

fn table<'a>(caption: &str, records: impl Iterator<Item = &'a Record>) -> Table {
    let columns = vec![
        Column::text("variant"),
        Column::num("g H/c0^2", "-"),
        Column::num("rows", "-"),
        Column::text("other settings"),
        Column::num("error of p", "-"),
        Column::num("drift of the level", "H"),
        Column::num("gap at the bottom", "dx"),
        Column::num("kinetic energy", "M g H"),
        Column::num("outside", "-"),
        Column::num("CPU time", "s"),
    ];
    let mut table = Table::new(caption, columns);
    for record in records {
        let shown = |name: &str, cell: fn(f64, usize) -> Cell| {
            Cell::or_dash(record.measured(name), |value| cell(value, 2))
        };
        let outside = match &record.status {
            Status::Completed => Cell::num(record.measured("outside"), 3),
            _ => Cell::text("did not finish"),
        };
        table = table.row(vec![
            Cell::text(format!("`{}`", record.variant)),
            Cell::num(record.setting("compressibility"), 2),
            Cell::num(record.setting("rows"), 3),
            Cell::text(others(record)),
            shown("p_l2", Cell::percent),
            shown("level_drift", Cell::percent),
            shown("gap", Cell::num),
            shown("kinetic", Cell::sci),
            outside,
            Cell::seconds(record.cost.cpu_s),
        ]);
    }
    table
}

/// What else is not the default.
fn others(record: &Record) -> String {
    let mut words = Vec::new();
    if record.setting("wall_gravity") != 1.0 {
        words.push("wall without gravity".to_string());
    }
    if record.setting("jitter") != 0.0 {
        words.push(format!("jitter {} dx", record.setting("jitter")));
    }
    if record.settings.get("uniform").and_then(serde_json::Value::as_bool) == Some(true) {
        words.push("starts uncompressed".into());
    }
    if record.setting("end") != 20.0 {
        words.push(format!("{} periods", record.setting("end")));
    }
    words.join(", ")
}
