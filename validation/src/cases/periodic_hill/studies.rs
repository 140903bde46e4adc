//! What the runs say together: profile ladder, pictures, wall shear, error against run time.

use nalgebra::Vector2;

use super::{
    HillSettings,
    measure::POINTS,
    plan::{BEST, LADDER},
    reference::Reference,
};
use crate::{
    case::Tier,
    gate::{Bound, Evidence, Gate},
    geometry::Hill,
    record::{Profile, Record, Status},
    report::{
        Axis, Cell, Colour, ColourMap, Column, Figure, Layer, Legend, ParticleMap, Plot, Series,
        Shape, Table,
    },
    studies::{
        convergence::{self, Level},
        work_precision::{self, Point},
    },
    suite::{JudgedRun, Study},
};

/// All of them.
pub fn studies(tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
    let mut studies = vec![ladder(runs), pictures(runs), walls(runs)];
    if tier == Tier::Full {
        studies.extend([order(runs), starts(runs), cost(runs)]);
    }
    studies
}

fn setting(record: &Record, key: &str) -> f64 {
    record.settings.get(key).and_then(serde_json::Value::as_f64).unwrap_or(f64::NAN)
}

fn metric(record: &Record, name: &str) -> f64 {
    record.metric(name).unwrap_or(f64::NAN)
}

fn column<'a>(record: &'a Record, profile: &str, name: &str) -> &'a [f64] {
    let profile = record.profiles.get(profile);
    let found = profile.and_then(|p: &Profile| p.columns.iter().find(|c| c.name == name));
    found.map_or(&[], |c| &c.values)
}

/// The planned run of this variant with just these settings, from rest.
fn find<'a>(runs: &'a [JudgedRun], variant: &str, re: f64, n: usize) -> Option<&'a Record> {
    let set = [format!("re={re}"), format!("n={n}")];
    let is_it = |run: &&JudgedRun| {
        let rest = run.planned.set.iter().skip(2);
        run.planned.variant == variant
            && run.planned.set.starts_with(&set)
            && rest.clone().all(|s| s.starts_with("end="))
    };
    runs.iter().find(is_it).map(|run| &run.record)
}

/// The finest run of the best variant at this Reynolds number.
fn finest(runs: &[JudgedRun], re: f64) -> Option<&Record> {
    [40, 20, 10].into_iter().find_map(|n| find(runs, BEST, re, n))
}

fn reference(re: f64) -> Option<Reference> {
    Reference::of(&HillSettings { re, ..HillSettings::default() }).ok().flatten()
}

const REYNOLDS: [f64; 3] = [10.0, 50.0, 100.0];

/// The floor as a line.
fn floor() -> Vec<(f64, f64)> {
    let Ok(hill) = Hill::new(1.0) else { return Vec::new() };
    (0..=360).map(|k| 0.025 * f64::from(k)).map(|x| (x, hill.wall(x))).collect()
}

/// Profiles at their stations, symbols on lines.
fn ladder(runs: &[JudgedRun]) -> Study {
    let caption = "Velocity along x (left) and y (right) across ten stations, drawn from the place of the \
                   station: a distance of 1 H is 1.25 U_b of u and 0.4 U_b of v. Lines: finite elements. \
                   Symbols: the finest run of the best variant, every tenth of 200 points. Grey: the floor.";
    let mut figure = Figure::new("periodic-hill-profiles", caption).columns(2);
    for re in REYNOLDS {
        let (Some(record), Some(reference)) = (finest(runs, re), reference(re)) else { continue };
        for (name, scale) in [("u", 0.8), ("v", 2.5)] {
            let n = setting(record, "n");
            let title = format!("Re {re}, H/dx = {n}: {name}");
            let label = format!("x/H + {scale} {name}/U_b");
            let mut plot =
                Plot::new(title, Axis::linear(label), Axis::linear("y/H").range(0.0, 3.1))
                    .layer(Series::line("", floor()).colour(Colour::GREY));
            let of = |v: &Vector2<f64>| if name == "u" { v.x } else { v.y };
            let (x, y) = (column(record, "stations", "x"), column(record, "stations", "y"));
            let values = column(record, "stations", name);
            for (k, station) in reference.stations.iter().enumerate() {
                let exact = station.y.iter().zip(&station.v);
                let exact = exact.map(|(y, v)| (station.x + scale * of(v), *y)).collect();
                let first = k == 0;
                let line = Series::line(if first { "finite elements" } else { "" }, exact);
                plot = plot.layer(line.colour(Colour::BLACK).width(1.2));
                let found = (k * POINTS + 5..((k + 1) * POINTS).min(values.len())).step_by(10);
                let found = found.map(|j| (x[j] + scale * values[j], y[j])).collect();
                let name = if first { "particles" } else { "" };
                let marks = Series::markers(name, found).colour(Colour::BLUE);
                plot = plot.layer(marks.shape(Shape::Circle).open().size(4.0));
            }
            let legend = if name == "u" { Legend::Auto } else { Legend::Hidden };
            figure = figure.panel(plot.legend(legend));
        }
    }
    Study::new("periodic-hill-profiles", "Profiles over finite elements")
        .block(figure.panel_size(470.0, 220.0))
        .block(table(runs))
}

fn table(runs: &[JudgedRun]) -> Table {
    let columns = vec![
        Column::text("variant"),
        Column::text("settings"),
        Column::num("error of u", "U_b"),
        Column::num("error of v", "U_b"),
        Column::num("force", "U_b^2/H"),
        Column::num("error of it", "-"),
        Column::num("ripple", "-"),
        Column::num("separation", "H"),
        Column::num("reattachment", "H"),
        Column::num("flux of sections", "-"),
        Column::num("drag balance", "-"),
        Column::num("unsteady", "U_b"),
        Column::num("time", "s"),
        Column::text("ended"),
    ];
    let caption = "All runs. Errors are rms over the points of ten stations against finite elements; force \
                   and ripple (rms) over the last fifth of the run; flux of sections is the largest error \
                   of ten; drag balance is the stress at the walls over the force, less 1. Time: stepping, \
                   one thread, side by side with other runs.";
    let mut table = Table::new(caption, columns);
    for JudgedRun { planned, record, .. } in runs {
        let ended = match &record.status {
            Status::Completed => "completed".to_string(),
            Status::Diverged { time, .. } => format!("diverged at {time:.2} H/U_b"),
            _ => "interrupted".into(),
        };
        let percent = |name: &str| Cell::percent(metric(record, name), 2);
        table = table.row(vec![
            Cell::text(format!("`{}`", planned.variant)),
            Cell::text(planned.set.join(", ")),
            percent("l2_u"),
            percent("l2_v"),
            Cell::num(metric(record, "force"), 4),
            percent("force_error"),
            percent("force_ripple"),
            Cell::num(metric(record, "separation"), 3),
            Cell::num(metric(record, "reattachment"), 4),
            percent("section_flux"),
            percent("drag_balance"),
            Cell::sci(metric(record, "unsteady"), 1),
            Cell::num(record.cost.cpu_s, 3),
            Cell::text(ended),
        ]);
    }
    table
}

/// Particles by their velocity, with the line between bubble and stream of the reference.
fn pictures(runs: &[JudgedRun]) -> Study {
    let caption = "Particles by their velocity along x, the finest run of the best variant. Black: the \
                   floor, and the line between bubble and stream of the finite elements.";
    let mut figure = Figure::new("periodic-hill-pictures", caption);
    for re in REYNOLDS {
        let (Some(record), Some(reference)) = (finest(runs, re), reference(re)) else { continue };
        let (x, y) = (column(record, "particles", "x"), column(record, "particles", "y"));
        let values = column(record, "particles", "u").iter();
        let points = x.iter().zip(y).zip(values).map(|((x, y), u)| (*x, *y, *u)).collect();
        let title = format!("Re {re}, H/dx = {}", setting(record, "n"));
        let axes = (Axis::linear("x [H]"), Axis::linear("y [H]"));
        let map = ParticleMap::new(title, axes, "u [U_b]", ColourMap::Diverging, points)
            .values(-1.5, 1.5)
            .diameter(1.0 / setting(record, "n"))
            .line(floor())
            .line(reference.line);
        figure = figure.panel(map);
    }
    Study::new("periodic-hill-pictures", "Pictures").block(figure.panel_size(640.0, 230.0))
}

/// Shear stress along hill and lid.
fn walls(runs: &[JudgedRun]) -> Study {
    let caption = "Shear stress along the hill (left) and the lid (right), best variant at every resolution, \
                   over finite elements (black). Where it is negative on the hill the flow goes backwards.";
    let mut figure = Figure::new("periodic-hill-shear", caption).columns(2);
    for re in REYNOLDS {
        let Some(reference) = reference(re) else { continue };
        for (name, k) in [("hill shear", 1), ("lid shear", 2)] {
            let mut plot = Plot::new(
                format!("Re {re}: {name}"),
                Axis::linear("x/H"),
                Axis::linear("shear stress [ρ U_b²]"),
            )
            .layer(Layer::horizontal(0.0, ""));
            let exact = reference.wall.iter().map(|w| (w[0], w[k])).collect();
            plot =
                plot.layer(Series::line("finite elements", exact).colour(Colour::BLACK).width(2.2));
            let mut any = false;
            for (c, n) in [10, 20, 40].into_iter().enumerate() {
                let Some(record) = find(runs, BEST, re, n) else { continue };
                any = true;
                let (x, y) = (column(record, "wall", "x"), column(record, "wall", name));
                let line = x.iter().copied().zip(y.iter().copied()).collect();
                let line = Series::line(format!("H/dx = {n}"), line).colour(Colour::cycle(c));
                plot = plot.layer(line);
            }
            let legend = if k == 1 { Legend::Auto } else { Legend::Hidden };
            if any {
                figure = figure.panel(plot.legend(legend));
            }
        }
    }
    Study::new("periodic-hill-shear", "Shear along the walls")
        .block(figure.panel_size(430.0, 230.0))
}

/// Order of the best variant.
fn order(runs: &[JudgedRun]) -> Study {
    let study = Study::new("periodic-hill-order", "Order of the best variant");
    let level = |n: usize| {
        let record = find(runs, BEST, 50.0, n)?;
        Some(Level { spacing: 1.0 / n as f64, value: metric(record, "l2_u") })
    };
    let levels: Vec<Level> = [10, 20, 40].into_iter().filter_map(level).collect();
    match convergence::convergence(&levels) {
        Ok(found) => study.prose(format!(
            "Re 50, error of u over the stations: order {:.2} ± {:.2} ({:?}); 95 % interval {:.1} to {:.1}.",
            found.order, found.standard_error, found.label, found.interval[0], found.interval[1]
        )),
        Err(error) => study.prose(format!("No order at Re 50: {error}.")),
    }
}

/// From rest and from near the answer.
fn starts(runs: &[JudgedRun]) -> Study {
    let mut study = Study::new("periodic-hill-starts", "From rest and from the reference");
    for re in [50.0, 100.0] {
        let other = runs.iter().map(|run| &run.record).find(|record| {
            setting(record, "re") == re && record.settings["from_reference"] == true
        });
        let (Some(rest), Some(other)) = (find(runs, BEST, re, 10), other) else { continue };
        let (a, b) = (column(rest, "stations", "u"), column(other, "stations", "u"));
        let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
        let apart = (square / a.len() as f64).sqrt();
        let gate = Gate::new(
            format!("periodic_hill.{BEST}.{re}.starts"),
            "rms over stations of the difference of u [U_b]",
            Bound::Below(0.005),
            Evidence::Invariant,
            "both starts must lead to the same steady flow, but for what disorder leaves in averages over \
             8 H/U_b and more",
        );
        let text = format!("Re {re}, H/dx = 10: the two differ by {:.2} % of U_b.", 100.0 * apart);
        study = study.prose(text).judge(gate, apart);
    }
    study
}

fn cost(runs: &[JudgedRun]) -> Study {
    let mut points = Vec::new();
    for (variant, resolutions) in LADDER {
        for record in resolutions.iter().filter_map(|&n| find(runs, variant, 50.0, n)) {
            points.push(Point {
                variant,
                rows: setting(record, "n") as usize,
                note: String::new(),
                error: metric(record, "l2_u"),
                seconds: vec![record.cost.cpu_s],
                cost: record.cost.clone(),
                status: record.status.clone(),
            });
        }
    }
    let caption = "Error of u over ten stations, rms over U_b, against the cost of a run from rest to \
                   40 H/U_b at Re 50; H/dx = 10, 20 and 40. Timed once, side by side with other runs; pair \
                   interactions are exact.";
    let id = "periodic-hill-work-precision";
    Study::new(id, "Error against run time").block(work_precision::figure(
        id,
        caption,
        "rms error of u [U_b]",
        &points,
        &[],
    ))
}
