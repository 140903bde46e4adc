//! What the runs say together: profile ladder, pictures, wall shear, error against run time.

use nalgebra::Vector2;

use super::{
    HillSettings,
    measure::{DRAGS, POINTS},
    plan::{self, BEST, END, FINEST, LADDER, SIDES, Start},
    reference::Reference,
    stability,
};
use base::{
    gate::{Bound, Evidence, Gate},
    record::{Record, Status},
};
use harness::{
    case::{Case, Tier},
    convergence::{self, Level},
    gate_power,
    suite::{JudgedRun, Study},
    work_precision::{self, Point},
};
use maths::geometry::Hill;
use report::{
    Axis, Cell, Colour, ColourMap, Column, Figure, Layer, Legend, ParticleMap, Plot, Series, Shape,
    Table, percent, sig,
};

/// All of them.
pub fn studies(case: &'static dyn Case, tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
    let mut studies = vec![ladder(runs), pictures(runs), walls(runs), power()];
    if tier == Tier::Full {
        studies.extend([order(runs), starts(runs), budget(runs), cost(runs)]);
        studies.extend([stability::limits(case), stability::reynolds(case)]);
    }
    studies
}

/// The planned run of this variant with just these settings, from rest or from the reference.
fn find<'a>(
    runs: &'a [JudgedRun],
    variant: &str,
    re: f64,
    n: usize,
    start: Start,
) -> Option<&'a Record> {
    let set = plan::set(re, n, start);
    let is_it = |run: &&JudgedRun| {
        let (own, last) = run.planned.set.split_at(set.len().min(run.planned.set.len()));
        run.planned.variant == variant
            && own == set
            && last.len() == 1
            && last[0].starts_with("end=")
    };
    runs.iter().find(is_it).map(|run| &run.record)
}

/// The run of the best variant at this Reynolds number and resolution: from rest, where there is one.
fn best(runs: &[JudgedRun], re: f64, n: usize) -> Option<&Record> {
    let from = |start| find(runs, BEST, re, n, start);
    from(Start::Rest).or_else(|| from(Start::Reference))
}

/// The finest run of the best variant at this Reynolds number.
fn finest(runs: &[JudgedRun], re: f64) -> Option<&Record> {
    SIDES.into_iter().rev().find_map(|n| best(runs, re, n))
}

/// `H/dx = 10, from rest`.
fn name_of(record: &Record) -> String {
    let start = if record.settings["from_reference"] == true { "the reference" } else { "rest" };
    format!("H/dx = {}, from {start}", record.setting("n"))
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
                   Symbols: the finest run of variant `carried`, whose title says where it started, every \
                   tenth of 200 points. Grey: the floor.";
    let mut figure = Figure::new("periodic-hill-profiles", caption).columns(2);
    for re in REYNOLDS {
        let (Some(record), Some(reference)) = (finest(runs, re), reference(re)) else { continue };
        for (name, scale) in [("u", 0.8), ("v", 2.5)] {
            let title = format!("Re {re}, {}: {name}", name_of(record));
            let label = format!("x/H + {scale} {name}/U_b");
            let mut plot =
                Plot::new(title, Axis::linear(label), Axis::linear("y/H").range(0.0, 3.1))
                    .layer(Series::line("", floor()).colour(Colour::GREY));
            let of = |v: &Vector2<f64>| if name == "u" { v.x } else { v.y };
            let (x, y) = (record.column("stations", "x"), record.column("stations", "y"));
            let values = record.column("stations", name);
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
        Column::num("error of shear", "-"),
        Column::num("flux of sections", "-"),
        Column::num("drag balance", "-"),
        Column::num("unsteady", "U_b"),
        Column::num("time", "s"),
        Column::text("ended"),
    ];
    let caption = "All runs, after what finite elements have. Errors \
                   are rms over the points of ten stations against finite elements; force and ripple (rms) \
                   over the last fifth of the run; error of shear is rms over the hill, of the largest \
                   shear there; flux of sections is the largest error of ten; drag balance is the stress at \
                   the walls over the force, less 1; unsteady is what is left of the decay, extrapolated. A \
                   dash: a run that diverged, no bubble, or no finite elements to compare with. Time: \
                   processor time of the whole run to its end, one thread, side by side with other runs. \
                   Runs from the reference start within 0.04 % of U_b of it: their error says that the flow \
                   stays there, and unsteady how far it would still go.";
    let of_elements = REYNOLDS.into_iter().filter(|&re| finest(runs, re).is_some());
    let rows = of_elements.filter_map(elements_row).chain(runs.iter().map(run_row));
    rows.fold(Table::new(caption, columns), Table::row)
}

/// A metric as `show` has it; a dash where there is none.
pub fn shown(record: &Record, name: &str, show: impl Fn(f64) -> Cell) -> Cell {
    record.metric(name).map_or_else(|| Cell::text("–"), show)
}

/// What finite elements have in the columns of the table of runs.
fn elements_row(re: f64) -> Option<Vec<Cell>> {
    let reference = reference(re)?;
    let none = || Cell::text("–");
    let number =
        |name: &str, digits| reference.number(name).map_or_else(none, |v| Cell::num(v, digits));
    let mut row = vec![Cell::text("finite elements"), Cell::text(format!("re={re}"))];
    row.extend([none(), none(), number("force", 4), none(), none()]);
    row.extend([number("separation", 3), number("reattachment", 4)]);
    row.extend((0..6).map(|_| none()));
    Some(row)
}

fn run_row(JudgedRun { planned, record, .. }: &JudgedRun) -> Vec<Cell> {
    let ended = match &record.status {
        Status::Completed => "completed".to_string(),
        Status::Diverged { time, .. } => format!("diverged at {time:.2} H/U_b"),
        _ => "interrupted".into(),
    };
    let percent = |name: &str| shown(record, name, |v| Cell::percent(v, 2));
    vec![
        Cell::text(format!("`{}`", planned.variant)),
        Cell::text(planned.set.join(", ")),
        percent("l2_u"),
        percent("l2_v"),
        shown(record, "force", |v| Cell::num(v, 4)),
        percent("force_error"),
        percent("force_ripple"),
        shown(record, "separation", |v| Cell::num(v, 3)),
        shown(record, "reattachment", |v| Cell::num(v, 4)),
        percent("shear_error"),
        percent("section_flux"),
        percent("drag_balance"),
        shown(record, "unsteady", |v| Cell::sci(v, 1)),
        Cell::num(record.cost.cpu_s, 3),
        Cell::text(ended),
    ]
}

/// Particles by their velocity, with the line between bubble and stream of the reference.
fn pictures(runs: &[JudgedRun]) -> Study {
    let caption = "Particles at the end of the finest run of variant `carried`, by their velocity along x. \
                   Black: the floor, and the line between bubble and stream of the finite elements (Re 10 \
                   has no bubble). Colours end at 0.5 U_b, so that the bubble shows.";
    let mut figure = Figure::new("periodic-hill-pictures", caption);
    for re in REYNOLDS {
        let (Some(record), Some(reference)) = (finest(runs, re), reference(re)) else { continue };
        let (x, y) = (record.column("particles", "x"), record.column("particles", "y"));
        let values = record.column("particles", "u").iter();
        let points = x.iter().zip(y).zip(values).map(|((x, y), u)| (*x, *y, *u)).collect();
        let title = format!("Re {re}, {}", name_of(record));
        let axes = (Axis::linear("x [H]"), Axis::linear("y [H]"));
        let map = ParticleMap::new(title, axes, "u [U_b]", ColourMap::Diverging, points)
            .values(-0.5, 0.5)
            .diameter(1.0 / record.setting("n"))
            .line(floor())
            .line(reference.line);
        figure = figure.panel(map);
    }
    Study::new("periodic-hill-pictures", "Pictures").block(figure.panel_size(640.0, 230.0))
}

/// Shear stress along hill and lid.
fn walls(runs: &[JudgedRun]) -> Study {
    let caption = "Shear stress along the hill (left) and the lid (right), variant `carried`, over finite \
                   elements (black). H/dx = 5 runs at Re 50 only. Where it is negative on the hill the flow \
                   goes backwards. The crest is at x = 0 and 9 H.";
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
            for (c, n) in SIDES.into_iter().enumerate() {
                let Some(record) = best(runs, re, n) else { continue };
                any = true;
                let (x, y) = (record.column("wall", "x"), record.column("wall", name));
                let line = x.iter().copied().zip(y.iter().copied()).collect();
                let line = Series::line(name_of(record), line).colour(Colour::cycle(c));
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
        .block(drags(runs))
}

/// What the drag of each variant is made of.
fn drags(runs: &[JudgedRun]) -> Table {
    let columns = vec![
        Column::text("variant"),
        Column::num("shear on the hill", "rho U_b^2 H"),
        Column::num("shear on the lid", "rho U_b^2 H"),
        Column::num("pressure on the hill", "rho U_b^2 H"),
        Column::num("drag balance", "-"),
    ];
    let caption = "Drag by its parts, Re 50, H/dx = 10: integrals over the walls of what the field has \
                   there. Shear agrees with finite elements to some percent in every variant. What \
                   breaks the drag balance of `interface-wall` and `modern` is the pressure on the hill: \
                   the force that holds the flux, and so the drag that the particles feel, is within 4 % of \
                   finite elements, but the pressure that the field has at the wall is not the one of the \
                   sums that move particles.";
    let mut table = Table::new(caption, columns);
    if let Some(reference) = reference(50.0) {
        let number = |name: &str| reference.number(name);
        let parts = DRAGS.map(number);
        let cells = parts.map(|part| part.map_or(Cell::text("–"), |v| Cell::num(v, 3)));
        let row = [Cell::text("finite elements")].into_iter().chain(cells);
        table = table.row(row.chain([Cell::text("–")]).collect());
    }
    for (variant, _) in LADDER {
        let Some(record) = find(runs, variant, 50.0, 10, Start::Rest) else { continue };
        if record.status != Status::Completed {
            continue;
        }
        let row = [Cell::text(format!("`{variant}`"))].into_iter();
        let row = row.chain(DRAGS.map(|part| shown(record, part, |v| Cell::num(v, 3))));
        let balance = shown(record, "drag_balance", |v| Cell::percent(v, 2));
        table = table.row(row.chain([balance]).collect());
    }
    table
}

/// Order of the best variant.
fn order(runs: &[JudgedRun]) -> Study {
    let study = Study::new("periodic-hill-order", "Order of the best variant");
    let found = SIDES.into_iter().filter_map(|n| best(runs, 50.0, n));
    let level = |record: &Record| Level {
        spacing: 1.0 / record.setting("n"),
        value: record.measured("l2_u"),
    };
    let records: Vec<&Record> = found.collect();
    let levels: Vec<Level> = records.iter().map(|record| level(record)).collect();
    let found = match convergence::convergence(&levels) {
        Ok(found) => found,
        Err(error) => return study.prose(format!("No order at Re 50: {error}.")),
    };
    let errors = records.iter().zip(&levels);
    let errors: Vec<String> =
        errors.map(|(r, l)| format!("{} ({})", percent(l.value, 2), name_of(r))).collect();
    let local: Vec<String> = found.local_orders.iter().map(|p| format!("{p:.2}")).collect();
    let text = format!(
        "Re 50, variant `{BEST}`, rms error of u over the stations: {}. Order {:.2} ± {:.2} ({:?}), \
         from one spacing to the next {}; 95 % interval {:.1} to {:.1}. The errors hold what is left of the \
         decay (`unsteady` in the table of all runs), and at H/dx = 10 what the error budget shows.",
        errors.join(", "),
        found.order,
        found.standard_error,
        found.label,
        local.join(", "),
        found.interval[0],
        found.interval[1]
    );
    let gate = Gate::new(
        format!("periodic_hill.{BEST}.50.order"),
        "order of l2_u in dx",
        Bound::Above(1.0),
        Evidence::Theory,
        "the walls are of first order on disordered particles, their sums of second: the goal of 2 % at 20 \
         spacings and 1 % at 40 is first order",
    );
    let study = study.prose(text).prose(of_finest(&records, &levels));
    reasons(runs).into_iter().fold(study, Study::prose).judge(gate, found.order)
}

/// What the order and the error of the finest run owe to its start and its length.
fn of_finest(records: &[&Record], levels: &[Level]) -> String {
    let Some((last, others)) = records.last().zip(levels.split_last().map(|(_, others)| others))
    else {
        return String::new();
    };
    let without = convergence::convergence(others).map_or("none".to_string(), |found| {
        let local: Vec<String> = found.local_orders.iter().map(|p| format!("{p:.2}")).collect();
        let order = format!("{:.2} ± {:.2}", found.order, found.standard_error);
        format!("{order}, from one spacing to the next {}", local.join(", "))
    });
    let (error, left) = (last.measured("l2_u"), last.measured("unsteady"));
    format!(
        "The run at {} began near the answer and ended at {} H/U_b, before it was steady: its error may be \
         low by what is left of the way from there to its own steady flow. Order without it: {without}. Its \
         error and what is left, which may not add, come to {} + {} = {} of U_b; the goal is 1 %.",
        name_of(last),
        sig(last.setting("end"), 3),
        percent(error, 2),
        percent(left, 2),
        percent(error + left, 2),
    )
}

/// Why the best variant is the best: not for its error of u.
fn reasons(runs: &[JudgedRun]) -> Option<String> {
    let row = |variant: &str, n: usize| -> Option<String> {
        let record = find(runs, variant, 50.0, n, Start::Rest)?;
        let metric = |name: &str| Some(percent(record.metric(name)?, 2));
        let (error, force) = (metric("l2_u")?, metric("force_error")?);
        let (drag, seconds) = (metric("drag_balance")?, sig(record.cost.cpu_s, 3));
        Some(format!("`{variant}` {error}, {force}, {drag}, {seconds} s"))
    };
    let at = |n| -> Option<String> {
        let rows = ["modern", BEST, "consistent"].map(|variant| row(variant, n));
        Some(rows.into_iter().collect::<Option<Vec<_>>>()?.join("; "))
    };
    Some(format!(
        "`{BEST}` is not the one with the least error of u at every spacing. Error of u, of the force, of \
         the drag balance, processor time: at H/dx = 5 {}; at 10 {}. It is held to the goals for its force \
         and its drag balance: `modern` misses both, and those of `consistent` are no closer, for terms \
         that take more work a pair.",
        at(5)?,
        at(10)?
    ))
}

/// rms over stations of the difference of u of two runs \[U_b\].
fn apart(a: &Record, b: &Record) -> f64 {
    let (a, b) = (a.column("stations", "u"), b.column("stations", "u"));
    let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    (square / a.len().min(b.len()) as f64).sqrt()
}

/// From rest and from near the answer.
fn starts(runs: &[JudgedRun]) -> Study {
    let mut study = Study::new("periodic-hill-starts", "From rest and from the reference");
    for re in REYNOLDS {
        let from = |start| find(runs, BEST, re, 10, start);
        let (Some(rest), Some(other)) = (from(Start::Rest), from(Start::Reference)) else {
            continue;
        };
        let gate = Gate::new(
            format!("periodic_hill.{BEST}.{re}.starts"),
            "rms over stations of the difference of u [U_b]",
            Bound::Below(0.005),
            Evidence::Invariant,
            "both starts must lead to the same steady flow, but for what disorder leaves in averages over \
             a fifth of the run, 3 H/U_b and more",
        );
        let apart = apart(rest, other);
        let bubble = match [other, rest].map(|r| r.metric("reattachment")) {
            [Some(other), Some(rest)] => format!(", reattachment by {} H", sig(other - rest, 2)),
            _ => String::new(),
        };
        let text = format!(
            "Re {re}, H/dx = 10: profiles of u from rest and from the reference differ by {} of U_b (rms \
             over ten stations), forces by {}{bubble}.",
            percent(apart, 2),
            percent(other.measured("force") / rest.measured("force") - 1.0, 2),
        );
        study = study.prose(text).judge(gate, apart);
    }
    study
}

/// One thing changed at a time, over the run of the best variant at Re 50, ten spacings, from rest.
fn budget(runs: &[JudgedRun]) -> Study {
    let columns = vec![
        Column::text("part"),
        Column::text("change"),
        Column::num("error of u", "U_b"),
        Column::num("change of it", "U_b"),
        Column::num("u moves by", "U_b"),
        Column::num("force moves by", "-"),
        Column::num("reattachment moves by", "H"),
    ];
    let caption = "Error budget at Re 50, H/dx = 10, from rest: one thing changed at a time. Error of u: rms \
                   over ten stations against finite elements; u moves by: rms over them of the difference \
                   between the two runs. What moves less than the row *start* is within what disorder does.";
    let mut table = Table::new(caption, columns);
    let study = Study::new("periodic-hill-error-budget", "Error budget");
    let rest = |variant, n| find(runs, variant, 50.0, n, Start::Rest);
    let Some(base) = rest(BEST, 10) else { return study };
    let changed = |set: &str| {
        let is_it = |run: &&JudgedRun| run.planned.set == plan::changed(set);
        runs.iter().find(is_it).map(|run| &run.record)
    };
    let start = find(runs, BEST, 50.0, 10, Start::Reference);
    let mut rows = vec![
        ("none", "as it is".to_string(), Some(base), Some(base)),
        ("start", "from the reference".into(), start, Some(base)),
        ("spacing", "dx/2".into(), rest(BEST, 20), Some(base)),
    ];
    let parts =
        plan::BUDGET.iter().map(|(part, set)| (*part, set.to_string(), changed(set), Some(base)));
    rows.extend(parts);
    rows.extend([
        (
            "sums",
            "`mixed`: consistent pressure and continuity".into(),
            rest("mixed", 10),
            Some(base),
        ),
        ("sums", "`consistent`: viscosity too".into(), rest("consistent", 10), Some(base)),
        (
            "wall",
            "`interface-wall` over `modern`".into(),
            rest("interface-wall", 10),
            rest("modern", 10),
        ),
    ]);
    for (part, change, record, over) in rows {
        let (Some(record), Some(over)) = (record, over) else { continue };
        let moved = |name: &str| record.measured(name) - over.measured(name);
        table = table.row(vec![
            Cell::text(part),
            Cell::text(change),
            Cell::percent(record.measured("l2_u"), 2),
            Cell::percent(moved("l2_u"), 2),
            Cell::percent(apart(record, over), 2),
            Cell::percent(moved("force") / over.measured("force"), 2),
            Cell::num(moved("reattachment"), 2),
        ]);
    }
    study.block(table)
}

fn cost(runs: &[JudgedRun]) -> Study {
    let mut points = Vec::new();
    for (variant, resolutions) in LADDER {
        let rest = resolutions.iter().map(|&n| (n, Start::Rest));
        let finest = (variant == BEST).then_some((FINEST, Start::Reference));
        for (n, start) in rest.chain(finest) {
            let Some(record) = find(runs, variant, 50.0, n, start) else { continue };
            let mut point = Point::of(variant, n, record.measured("l2_u"), record);
            (point.resolution, point.time) = (format!("H/dx = {n}"), "H/U_b");
            if record.status == Status::Completed {
                let share = END / record.setting("end");
                point.seconds[0] *= share;
                let pairs = &mut point.cost.pair_interactions;
                *pairs = (share * *pairs as f64) as u64;
            }
            points.push(point);
        }
    }
    let caption = format!(
        "Error of u over ten stations at Re 50, rms over U_b, against the cost of {END} H/U_b of flow, \
         which is what a start from rest takes to become steady. H/dx doubles from point to point of a line. \
         All ran {END} H/U_b from rest, but for the last of `{BEST}`, H/dx = {FINEST}: it started from \
         the reference and ran less, and its cost is scaled to the same time (steps are of equal length). \
         Timed once, side by side with other runs; pair interactions are exact."
    );
    let id = "periodic-hill-work-precision";
    Study::new(id, "Error against run time").block(work_precision::figure(
        id,
        &caption,
        "rms error of u [U_b]",
        &points,
        &[],
    ))
}

/// Mutant, how many gates it fails, of how many, which: written by `tests/tests/hill_power.rs`.
const SPOILED: &str = include_str!("../../../../tests/hill_power.csv");

/// What the gates are worth.
fn power() -> Study {
    let caption = "The run of the quick tier (Re 50, H/dx = 10, from rest to 30 H/U_b) with one thing \
                   spoiled, judged by its own gates. Measured by `tests/tests/hill_power.rs`, which takes a \
                   minute and a half and runs on request: `cargo test --test hill_power -- --ignored`.";
    let table = gate_power::of_one_scene("hills with", SPOILED, caption);
    Study::new("periodic-hill-gate-power", "What the gates are worth").block(table)
}
