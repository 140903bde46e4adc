//! What the runs say together: decay and error through time, pictures, order, error against run time.

use super::plan::{BEST, LADDER, SIDES, STARTS};
use crate::{
    case::Tier,
    gate::{Bound, Evidence, Gate},
    record::{Profile, Record, Status},
    reference::{Reference, ReferenceError},
    report::{
        Axis, Cell, Colour, ColourMap, Column, Figure, Legend, ParticleMap, Plot, Series, Table,
    },
    studies::{
        convergence::{self, Level},
        work_precision::{self, Peer, Point},
    },
    suite::{JudgedRun, Study},
};

/// All of them.
pub fn studies(tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
    let mut studies = vec![histories(tier, runs), pictures(tier, runs)];
    if tier == Tier::Full {
        studies.extend([order(runs), cost(runs)]);
    }
    studies
}

fn setting(record: &Record, key: &str) -> f64 {
    record.settings.get(key).and_then(serde_json::Value::as_f64).unwrap_or(f64::NAN)
}

fn metric(record: &Record, name: &str) -> f64 {
    record.metric(name).unwrap_or(f64::NAN)
}

fn column<'a>(profile: &'a Profile, name: &str) -> &'a [f64] {
    profile.columns.iter().find(|c| c.name == name).map_or(&[], |c| &c.values)
}

/// The run with just these settings.
fn find<'a>(runs: &'a [JudgedRun], variant: &str, n: usize, start: f64) -> Option<&'a JudgedRun> {
    let set = [format!("n={n}"), format!("perturb={start}")];
    runs.iter().find(|run| run.planned.variant == variant && run.planned.set == set)
}

/// In words.
fn start_of(start: f64) -> &'static str {
    if start == 0.0 { "lattice" } else { "disturbed lattice" }
}

fn points(record: &Record, name: &str) -> Vec<(f64, f64)> {
    let empty = Profile::default();
    let series = record.profiles.get("series").unwrap_or(&empty);
    column(series, "t").iter().copied().zip(column(series, name).iter().copied()).collect()
}

/// Energy and error through time.
fn histories(tier: Tier, runs: &[JudgedRun]) -> Study {
    let n = if tier == Tier::Full { 50 } else { 32 };
    let caption = format!(
        "Taylor-Green vortices at Re 100, {n} x {n} particles. Left: kinetic energy over that at the start, \
         black the exact decay. Right: relative L2 error of the velocity vector over the particles. A run \
         that diverged ends where it did."
    );
    let mut figure = Figure::new("taylor-green-histories", caption).columns(2);
    for start in STARTS {
        let title = format!("from the {}", start_of(start));
        let axis = || Axis::linear("t [L/U]");
        let mut energy = Plot::new(&title, axis(), Axis::log("kinetic energy [of the start]"));
        let mut error = Plot::new(&title, axis(), Axis::log("error of the velocity [-]"));
        let decay = |t: f64| (-16.0 * std::f64::consts::PI.powi(2) / 100.0 * t).exp();
        let exact = (0..=40).map(|k| 0.05 * f64::from(k)).map(|t| (t, decay(t))).collect();
        energy = energy.layer(Series::line("exact", exact).colour(Colour::BLACK).width(2.4));
        let mut any = false;
        for (k, variant) in LADDER.into_iter().enumerate() {
            let Some(run) = find(runs, variant, n, start) else { continue };
            any = true;
            let of = |t: f64, y: f64| (t, y * decay(t));
            let share = points(&run.record, "energy").into_iter().map(|(t, y)| of(t, y)).collect();
            energy = energy.layer(Series::line(variant, share).colour(Colour::cycle(k)));
            let errors = points(&run.record, "error").into_iter().skip(1).collect();
            error = error.layer(Series::line(variant, errors).colour(Colour::cycle(k)));
        }
        if any {
            figure =
                figure.panel(energy.legend(Legend::Outside)).panel(error.legend(Legend::Hidden));
        }
    }
    Study::new("taylor-green-histories", "Decay and error through time")
        .block(figure.panel_size(400.0, 260.0))
        .block(table(runs))
}

/// Every run.
fn table(runs: &[JudgedRun]) -> Table {
    let columns = vec![
        Column::text("variant"),
        Column::text("settings"),
        Column::num("error of the velocity", "-"),
        Column::num("energy less exact", "-"),
        Column::num("viscosity found", "nu"),
        Column::num("error of the pressure", "-"),
        Column::num("momentum", "U"),
        Column::num("nearest pair", "dx"),
        Column::num("time", "s"),
    ];
    let caption = "All runs at t = 2 L/U. Viscosity found: from the fall of kinetic energy. Momentum: the \
                   total one over the total mass, exactly 0 but for what a disturbed start has. Time: \
                   of the stepping loop, one thread, side by side with other runs.";
    let mut table = Table::new(caption, columns);
    for JudgedRun { planned, record, .. } in runs {
        table = table.row(vec![
            Cell::text(format!("`{}`", record.variant)),
            Cell::text(planned.set.join(", ")),
            Cell::percent(metric(record, "l2"), 2),
            Cell::percent(metric(record, "energy"), 2),
            Cell::num(metric(record, "nu_eff"), 4),
            Cell::percent(metric(record, "pressure_l2"), 2),
            Cell::sci(metric(record, "momentum"), 2),
            Cell::num(metric(record, "nearest"), 3),
            Cell::num(record.cost.cpu_s, 3),
        ]);
    }
    table
}

/// Particles at the end, by speed and by error.
fn pictures(tier: Tier, runs: &[JudgedRun]) -> Study {
    let shown = match tier {
        Tier::Quick => [("plain", 32, 0.2), (BEST, 50, 0.2)],
        Tier::Full => [("plain", 50, 0.2), (BEST, 50, 0.0)],
    };
    let caption = "Particles at t = 2 L/U by their speed (left) and by the error of their velocity (right), \
                   both over the largest exact speed of that time: without a stabiliser, and the best \
                   variant.";
    let mut figure = Figure::new("taylor-green-pictures", caption).columns(2);
    for (variant, n, start) in shown {
        let Some(run) = find(runs, variant, n, start) else { continue };
        let Some(particles) = run.record.profiles.get("particles") else { continue };
        let (x, y) = (column(particles, "x"), column(particles, "y"));
        for (name, label, most) in
            [("speed", "|v| [U exp(bt)]", 1.0), ("error", "|v - exact| [U exp(bt)]", 0.05)]
        {
            let values = column(particles, name).iter();
            let points = x.iter().zip(y).zip(values).map(|((x, y), v)| (*x, *y, *v)).collect();
            let title = format!("{variant}, {n} x {n}, from the {}", start_of(start));
            let axes = (Axis::linear("x [L]"), Axis::linear("y [L]"));
            let map = ParticleMap::new(title, axes, label, ColourMap::Sequential, points);
            figure = figure.panel(map.values(0.0, most).diameter(1.0 / n as f64));
        }
    }
    Study::new("taylor-green-pictures", "Pictures").block(figure.panel_size(330.0, 330.0))
}

/// Order of the best variant.
fn order(runs: &[JudgedRun]) -> Study {
    let mut study = Study::new("taylor-green-order", "Order of the best variant");
    for start in STARTS {
        let level = |n: usize| {
            let run = find(runs, BEST, n, start)?;
            Some(Level { spacing: 1.0 / n as f64, value: metric(&run.record, "l2") })
        };
        let levels: Vec<Level> = SIDES.into_iter().filter_map(level).collect();
        let Ok(found) = convergence::convergence(&levels) else { continue };
        let gate = Gate::new(
            format!("taylor_green.{BEST}.{start}.order"),
            "order",
            Bound::Within(1.4, 3.0),
            Evidence::Theory,
            "its sums are exact for linear fields, so their errors fall as h^2; Mach's error of 0.3 % of \
             the speed does not fall, and disorder adds to it",
        );
        study = study
            .prose(format!(
                "From the {}: order {:.2} ± {:.2} ({:?}).",
                start_of(start),
                found.order,
                found.standard_error,
                found.label
            ))
            .judge(gate, found.order);
    }
    study
}

fn cost(runs: &[JudgedRun]) -> Study {
    let mut points = Vec::new();
    for variant in LADDER {
        for run in SIDES.into_iter().filter_map(|n| find(runs, variant, n, 0.2)) {
            points.push(Point {
                variant,
                rows: setting(&run.record, "n") as usize,
                note: String::new(),
                error: metric(&run.record, "l2"),
                seconds: vec![run.record.cost.cpu_s],
                cost: run.record.cost.clone(),
                status: run.record.status.clone(),
            });
        }
    }
    let caption = "Relative L2 error of the velocity vector at t = 2 L/U, Re 100, over the cost of the run: \
                   25, 50 and 100 particles a side from a disturbed lattice. Timed once, side by side with \
                   other runs; pair interactions are exact. Grey: PySPH EDAC (73 s, 456 s) and SPHinXsys \
                   (1.9 s, 16 s) at 50 and 100 a side on another machine.";
    let id = "taylor-green-work-precision";
    let figure =
        work_precision::figure(id, caption, "error of the velocity [-]", &points, &peers());
    let mut study = Study::new(id, "Error against run time").block(figure);
    let diverged = runs.iter().filter(|run| run.record.status != Status::Completed);
    let names: Vec<&str> = diverged.map(|run| run.planned.variant).collect();
    if !names.is_empty() {
        study = study.prose(format!("Diverged: {}.", names.join(", ")));
    }
    study
}

/// Codes whose time was measured.
fn peers() -> Vec<Peer> {
    let read = || -> Result<Vec<Peer>, ReferenceError> {
        let package = Reference::load("peers_taylor_green")?;
        let table = package.table("errors")?;
        let (codes, errors) = (table.texts("code")?, table.numbers("error")?);
        let seconds = table.optional("seconds")?;
        let rows = codes.iter().zip(errors).zip(seconds);
        Ok(rows.filter_map(|((c, e), s)| Some((c.to_string(), s?, e / 100.0))).collect())
    };
    read().unwrap_or_default()
}
