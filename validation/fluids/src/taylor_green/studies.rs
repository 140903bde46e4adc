//! What the runs say together: decay and error through time, pictures, order, error against run time.

use super::plan::{self, BEST, BUDGET, LADDER, SIDES, STARTS};
use base::{
    gate::{Bound, Evidence, Gate},
    record::{Profile, Record, Status},
    reference::{Reference, ReferenceError},
};
use harness::{
    case::Tier,
    convergence::{self, Level},
    suite::{JudgedRun, Study},
    work_precision::{self, Peer, Point},
};
use report::{
    Axis, Cell, Colour, ColourMap, Column, Figure, Layer, Legend, ParticleMap, Plot, Series, Table,
    percent,
};

/// All of them.
pub fn studies(tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
    let mut studies = vec![histories(runs), pictures(tier, runs)];
    if tier == Tier::Full {
        studies.extend([order(runs), budget(runs), cost(runs)]);
    }
    studies
}

/// The run with just these settings.
fn find<'a>(runs: &'a [JudgedRun], variant: &str, n: usize, start: f64) -> Option<&'a JudgedRun> {
    let set = plan::set(n, start);
    runs.iter().find(|run| run.planned.variant == variant && run.planned.set == set)
}

/// In words.
fn start_of(start: f64) -> &'static str {
    if start == 0.0 { "lattice" } else { "disturbed lattice" }
}

fn points(record: &Record, name: &str) -> Vec<(f64, f64)> {
    let empty = Profile::default();
    let series = record.profiles.get("series").unwrap_or(&empty);
    series.column("t").iter().copied().zip(series.column(name).iter().copied()).collect()
}

/// Most particles a side of a history: what finer runs show in the other figures.
const SHOWN: usize = 50;

/// Energy and error through time.
fn histories(runs: &[JudgedRun]) -> Study {
    let caption = format!(
        "Taylor-Green vortices at Re 100, each variant at the most particles a side that ran, up to {SHOWN} \
         (in the legend). Left: how far the kinetic energy is from the exact one, |E/E_exact - 1|; where a \
         line dips it changes its sign; dashed the gate of `{BEST}`, 1 %. Right: relative L2 error of the \
         velocity vector over the particles. A run that diverged ends where it did."
    );
    let mut figure = Figure::new("taylor-green-histories", caption).columns(2);
    for start in STARTS {
        let title = format!("from the {}", start_of(start));
        let axis = || Axis::linear("t [L/U]");
        // Below a hundredth of the gate is nothing to see.
        let off = Axis::log("kinetic energy off the exact one [-]").range(1e-4, 1.0);
        let mut energy = Plot::new(&title, axis(), off).layer(Layer::horizontal(0.01, "gate"));
        let mut error = Plot::new(&title, axis(), Axis::log("error of the velocity [-]"));
        let mut any = false;
        for (k, variant) in LADDER.into_iter().enumerate() {
            let ran = (0..=SHOWN).rev().find_map(|n| Some((n, find(runs, variant, n, start)?)));
            let Some((n, run)) = ran else { continue };
            any = true;
            let name = format!("{variant}, {n} x {n}");
            let share = points(&run.record, "energy").into_iter().skip(1);
            let off = share.map(|(t, y)| (t, (y - 1.0).abs())).collect();
            energy = energy.layer(Series::line(&name, off).colour(Colour::cycle(k)));
            let errors = points(&run.record, "error").into_iter().skip(1).collect();
            error = error.layer(Series::line(&name, errors).colour(Colour::cycle(k)));
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
        Column::num("momentum added", "U"),
        Column::num("nearest pair", "dx"),
        Column::num("time", "s"),
    ];
    let caption = "All runs at their end, t = 2 L/U where the settings say no other. Viscosity found: from \
                   the fall of kinetic energy. Momentum added: the change of the total one from start to end \
                   over the total mass, exactly 0; that of a disturbed start does not count. Time: of the \
                   stepping loop, one thread, side by side with other runs.";
    let mut table = Table::new(caption, columns);
    for JudgedRun { planned, record, .. } in runs {
        table = table.row(vec![
            Cell::text(format!("`{}`", record.variant)),
            Cell::text(planned.set.join(", ")),
            Cell::percent(record.measured("l2"), 2),
            Cell::percent(record.measured("energy"), 2),
            Cell::num(record.measured("nu_eff"), 4),
            Cell::percent(record.measured("pressure_l2"), 2),
            Cell::sci(record.measured("momentum_added"), 2),
            Cell::num(record.measured("nearest"), 3),
            Cell::num(record.cost.cpu_s, 3),
        ]);
    }
    table
}

/// Particles at the end, by speed and by error.
fn pictures(tier: Tier, runs: &[JudgedRun]) -> Study {
    let shown = match tier {
        Tier::Quick => [("plain", 32, 0.2), (BEST, 50, 0.2)],
        Tier::Full => [("plain", 50, 0.2), (BEST, 50, 0.2)],
    };
    let caption = "Particles at t = 2 L/U by their speed (left) and by the error of their velocity (right), \
                   both over the largest exact speed of that time: without a stabiliser, whose errors are \
                   far above the scale of 1 %, and the best variant.";
    let mut figure = Figure::new("taylor-green-pictures", caption).columns(2);
    for (variant, n, start) in shown {
        let Some(run) = find(runs, variant, n, start) else { continue };
        let Some(particles) = run.record.profiles.get("particles") else { continue };
        let (x, y) = (particles.column("x"), particles.column("y"));
        for (name, label, most) in
            [("speed", "|v| [U exp(bt)]", 1.0), ("error", "|v - exact| [U exp(bt)]", 0.01)]
        {
            let values = particles.column(name).iter();
            let points = x.iter().zip(y).zip(values).map(|((x, y), v)| (*x, *y, *v)).collect();
            let title = format!("{variant}, {n} x {n}, from the {}", start_of(start));
            let axes = (Axis::linear("x [L]"), Axis::linear("y [L]"));
            let map = ParticleMap::new(title, axes, label, ColourMap::Sequential, points);
            figure = figure.panel(map.values(0.0, most).diameter(1.0 / n as f64));
        }
    }
    Study::new("taylor-green-pictures", "Pictures").block(figure.panel_size(260.0, 260.0))
}

/// Order of the best variant.
fn order(runs: &[JudgedRun]) -> Study {
    let mut study = Study::new("taylor-green-order", "Order of the best variant");
    for start in STARTS {
        let level = |n: usize| {
            let run = find(runs, BEST, n, start)?;
            Some(Level { spacing: 1.0 / n as f64, value: run.record.measured("l2") })
        };
        let levels: Vec<Level> = SIDES.into_iter().filter_map(level).collect();
        let Ok(found) = convergence::convergence(&levels) else { continue };
        let gate = Gate::new(
            format!("taylor_green.{BEST}.{start}.order"),
            "order",
            Bound::Within(1.4, 3.0),
            Evidence::Theory,
            "its sums are exact for linear fields, so their errors fall as h^2; those of the sound speed \
             and the step fall otherwise and partly cancel them (the error budget), and disorder adds: \
             0.6 below, 1 above",
        );
        let errors: Vec<String> = levels.iter().map(|l| percent(l.value, 2)).collect();
        let local: Vec<String> = found.local_orders.iter().map(|p| format!("{p:.2}")).collect();
        let text = format!(
            "`{BEST}` from the {}, {SIDES:?} particles a side: errors {}. Order {:.2} ± {:.2} ({:?}), from \
             one spacing to the next {}.",
            start_of(start),
            errors.join(", "),
            found.order,
            found.standard_error,
            found.label,
            local.join(", ")
        );
        study = study.prose(text).judge(gate, found.order);
    }
    study
}

/// One thing changed at a time, over the best variant at 50 x 50 from the disturbed lattice.
fn budget(runs: &[JudgedRun]) -> Study {
    let columns = vec![
        Column::text("part"),
        Column::text("change"),
        Column::num("error of the velocity", "-"),
        Column::num("change of it", "-"),
        Column::num("energy less exact", "-"),
        Column::num("time", "s"),
    ];
    let caption = "Error budget of `consistent`, 50 x 50 particles from the disturbed lattice, Re 100: one \
                   thing changed at a time, at t = 2 L/U. Another disturbance (last row) says what is \
                   chance. A shorter step, faster sound and less diffusion all raise the error: their parts \
                   have the sign opposite to that of the spacing and cancel some of it, so that the error as \
                   it is says less than the parts do. Time: of the stepping loop, one thread, side by side \
                   with other runs.";
    let mut table = Table::new(caption, columns);
    let study = Study::new("taylor-green-error-budget", "Error budget");
    let Some(base) = find(runs, BEST, 50, 0.2) else { return study };
    let changed = |set: &str| {
        let is_it = |run: &&JudgedRun| run.planned.set == plan::changed(set);
        runs.iter().find(is_it)
    };
    let mut rows =
        vec![("none", "as it is", Some(base)), ("spacing", "dx/2", find(runs, BEST, 100, 0.2))];
    rows.extend(BUDGET.iter().map(|(part, set)| (*part, *set, changed(set))));
    for (part, change, run) in rows {
        let Some(record) = run.map(|run| &run.record) else { continue };
        let error = record.measured("l2");
        table = table.row(vec![
            Cell::text(part),
            Cell::text(change),
            Cell::percent(error, 3),
            Cell::percent(error - base.record.measured("l2"), 2),
            Cell::percent(record.measured("energy"), 2),
            Cell::num(record.cost.cpu_s, 3),
        ]);
    }
    study.block(table)
}

fn cost(runs: &[JudgedRun]) -> Study {
    let mut points = Vec::new();
    for variant in LADDER {
        for run in SIDES.into_iter().filter_map(|n| find(runs, variant, n, 0.2)) {
            let record = &run.record;
            points.push(Point::of(
                variant,
                record.setting("n") as usize,
                record.measured("l2"),
                record,
            ));
        }
    }
    let caption = "Relative L2 error of the velocity vector at t = 2 L/U, Re 100, over the cost of the run: \
                   25, 50 and, for `consistent`, 100 particles a side from a disturbed \
                   lattice. Timed once, side by side with other runs; pair interactions are exact. Grey: \
                   PySPH EDAC (73 s, 456 s) and SPHinXsys (1.9 s, 16 s) at 50 and 100 a side on another \
                   machine.";
    let id = "taylor-green-work-precision";
    let figure =
        work_precision::figure(id, caption, "error of the velocity [-]", &points, &peers());
    let mut study = Study::new(id, "Error against run time").block(figure).block(peer_table(runs));
    let diverged = runs.iter().filter(|run| run.record.status != Status::Completed);
    let names: Vec<&str> = diverged.map(|run| run.planned.variant).collect();
    if !names.is_empty() {
        study = study.prose(format!("Diverged: {}.", names.join(", ")));
    }
    study
}

/// Code, scheme, particles a side, error \[-\], seconds.
type PeerRow = (String, String, f64, f64, f64);

/// Codes whose time was measured.
fn peer_rows() -> Vec<PeerRow> {
    let read = || -> Result<Vec<PeerRow>, ReferenceError> {
        let package = Reference::load("peers_taylor_green")?;
        let table = package.table("errors")?;
        let (codes, schemes) = (table.texts("code")?, table.texts("scheme")?);
        let (sides, errors) = (table.numbers("side")?, table.numbers("error")?);
        let seconds = table.optional("seconds")?;
        let row = |k: usize| {
            let (code, scheme) = (codes[k].to_string(), schemes[k].to_string());
            Some((code, scheme, sides[k], errors[k] / 100.0, seconds[k]?))
        };
        Ok((0..codes.len()).filter_map(row).collect())
    };
    read().unwrap_or_default()
}

fn peers() -> Vec<Peer> {
    peer_rows().into_iter().map(|(code, _, _, error, seconds)| (code, seconds, error)).collect()
}

/// Error and time beside those of other codes.
fn peer_table(runs: &[JudgedRun]) -> Table {
    let columns = vec![
        Column::text("code"),
        Column::text("scheme"),
        Column::num("particles a side", "1"),
        Column::num("error of the velocity", "-"),
        Column::num("time", "s"),
    ];
    let caption = "Taylor-Green vortices at Re 100 from a lattice disturbed by 0.2 spacings, t = 2 L/U: \
                   error and time of the stepping loop on one thread. touchstone: processor time in this \
                   report, side by side with other runs. Others: `references/peers_taylor_green`, measured \
                   once on a machine of two x86-64 cores. Between machines times compare within a factor of \
                   about two: what is within that is no difference.";
    let mut rows = peer_rows();
    for variant in ["carried", BEST] {
        for run in SIDES.into_iter().filter_map(|n| find(runs, variant, n, 0.2)) {
            let record = &run.record;
            let (side, error) = (record.setting("n"), record.measured("l2"));
            let (code, scheme) = ("touchstone".into(), format!("`{variant}`"));
            rows.push((code, scheme, side, error, record.cost.cpu_s));
        }
    }
    rows.into_iter().fold(
        Table::new(caption, columns),
        |table, (code, scheme, side, error, time)| {
            table.row(vec![
                Cell::text(code),
                Cell::text(scheme),
                Cell::exact(side),
                Cell::percent(error, 2),
                Cell::num(time, 2),
            ])
        },
    )
}
