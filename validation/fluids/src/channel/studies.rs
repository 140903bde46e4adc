//! What the ladders of a channel flow say together: profiles, order, work-precision, error budget.

use rayon::prelude::*;

use super::{
    Flow,
    floor::LatticeFloor,
    hypotheses,
    plan::{COARSE_ROWS, LIKE_PEERS, ladder, ladder_of, levels},
};
use base::{
    gate::{Bound, Evidence, Gate},
    record::{Profile, Record, Status},
    reference::Reference,
};
use harness::{
    case::{Case, Tier},
    convergence::{Convergence, Label, Level, convergence},
    runner::Context,
    suite::{JudgedRun, Study},
    work_precision::{self, Peer, Point},
};
use maths::exact::{couette::Couette, poiseuille::Poiseuille};
use report::{
    Axis, Block, Cell, Colour, ColourMap, Column, Figure, Layer, Legend, ParticleMap, Plot, Series,
    Shape, Table, percent, sig,
};

/// All studies of a flow.
pub fn studies(case: &'static dyn Case, flow: Flow, tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
    let mut studies = vec![
        profiles(flow, tier, runs),
        orders(flow, tier, runs),
        cost(case, flow, tier, runs),
        budget(case, flow, tier),
        reynolds(flow, runs),
    ];
    if flow == Flow::Poiseuille {
        studies.extend(hypotheses::studies(case, tier));
    }
    studies
}

fn name(flow: Flow) -> &'static str {
    if flow == Flow::Couette { "couette" } else { "poiseuille" }
}

/// The run of the ladder with this variant and rows.
fn run_of<'a>(
    flow: Flow,
    tier: Tier,
    runs: &'a [JudgedRun],
    variant: &str,
    rows: usize,
) -> Option<&'a Record> {
    let k = levels(tier).iter().position(|r| *r == rows)?;
    runs.get(ladder_of(flow, tier, variant).start + k).map(|run| &run.record)
}

/// Times that fit into a figure.
const SHOWN: [f64; 5] = [0.02, 0.05, 0.1, 0.2, 1.0];
/// Width of the channel that the default settings have \[m\].
const WIDTH: f64 = 1e-3;

fn profiles(flow: Flow, tier: Tier, runs: &[JudgedRun]) -> Study {
    let (id, best) = match flow {
        Flow::Couette => ("couette-profiles", "plain"),
        Flow::Poiseuille => ("poiseuille-profiles", "curved"),
    };
    let caption = format!(
        "Velocity across the channel at five times, Re = 0.5, 20 rows. Lines: exact series. Symbols: \
         SPH, mean of each row of particles. Left the seed's settings, middle the variant `{best}`, \
         right the error of the latter in units of V."
    );
    let mut figure = Figure::new(id, caption).columns(3).panel_size(290.0, 290.0);
    for variant in ["seed", best] {
        let Some(record) = run_of(flow, tier, runs, variant, 20) else { continue };
        figure = figure.panel(profile_panel(flow, record, variant));
    }
    if let Some(record) = run_of(flow, tier, runs, best, 20) {
        figure = figure.panel(error_panel(record));
    }
    let mut study = Study::new(id, "Velocity profiles").prose(ASSUMED);
    if let Some(record) = run_of(flow, tier, runs, "seed", 20) {
        let walls = run_of(flow, tier, runs, "interface-wall", 20);
        study = study.block(Block::List(verdicts(flow, record, walls)));
    }
    study = study.block(figure);
    match runs.last() {
        Some(run) if run.planned.set == ["columns=20"] => study.block(snapshot(flow, &run.record)),
        _ => study,
    }
}

const ASSUMED: &str = "Assumed where the paper is silent or its scan is damaged: plates 1 mm apart, water \
    (ρ = 1000 kg/m³, ν = 10⁻⁶ m²/s), V from Re = V L/ν, in Poiseuille flow the speed of the centre line; a \
    periodic section as short as two supports allow, for the flow does not depend on x; the \
    predictor-corrector read as the explicit midpoint rule; a square lattice at rest, rows half a spacing \
    from ghost walls, and on the plates where there are interface particles.";

/// H1, H2 and M4 of the paper in words.
fn verdicts(flow: Flow, seed: &Record, walls: Option<&Record>) -> Vec<String> {
    let worst = |record: &Record| record.measured("l2_worst");
    let said = |supported: bool| if supported { "supported" } else { "refuted here" };
    let (name, what) = match flow {
        Flow::Couette => {
            ("H1", "the transient Couette profiles at Re 0.5 follow the analytic series")
        }
        Flow::Poiseuille => ("H2", "the steady Poiseuille parabola follows the analytic solution"),
    };
    let mut list = vec![format!(
        "**{name}** ({what}) **{}**: variant `seed`, 20 rows, Re 0.5: worst relative L2 error from νt/L² = \
         0.1 on {}, of which the lattice and η² may explain 1.9 %.",
        said(worst(seed) <= 0.02),
        percent(worst(seed), 2)
    )];
    if let Some(walls) = walls {
        list.push(format!(
            "**M4** (both wall models work) **{}** for this flow: ghosts with {}, interface and wall \
             particles with {} as worst error.",
            said(worst(seed) <= 0.02 && worst(walls) <= 0.02),
            percent(worst(seed), 2),
            percent(worst(walls), 2)
        ));
    }
    list
}

fn profile_panel(flow: Flow, record: &Record, title: &str) -> Plot {
    let v = record.chose("V [m/s]");
    let mut plot = Plot::new(title, Axis::linear("u/V [-]"), Axis::linear("y/L [-]"));
    for (k, tau) in SHOWN.into_iter().enumerate() {
        let Some(profile) = record.profiles.get(&format!("u@{tau}")) else { continue };
        let rows = profile.column("u").iter().zip(profile.column("y"));
        let points = rows.map(|(u, y)| (u / v, y / WIDTH)).collect();
        let colour = Colour::cycle(k);
        plot = plot.layer(Series::line("", exact_line(flow, tau)).colour(colour)).layer(
            Series::markers(format!("νt/L² = {tau}"), points)
                .colour(colour)
                .shape(Shape::cycle(k))
                .open(),
        );
    }
    plot.legend(Legend::Auto)
}

/// (u/V, y/L) of the exact flow from wall to wall.
fn exact_line(flow: Flow, tau: f64) -> Vec<(f64, f64)> {
    let (v, l, nu) = (1.0, 1.0, 1.0);
    let velocity = |y: f64| match flow {
        Flow::Couette => Couette { v0: v, l, nu }.velocity(y, tau),
        Flow::Poiseuille => Poiseuille { v, l, nu }.velocity(y, tau),
    };
    (0..=100).map(|k| f64::from(k) / 100.0).map(|y| (velocity(y), y)).collect()
}

fn error_panel(record: &Record) -> Plot {
    let v = record.chose("V [m/s]");
    let mut plot = Plot::new("error", Axis::linear("(u − u_exact)/V [-]"), Axis::linear("y/L [-]"));
    for (k, tau) in SHOWN.into_iter().enumerate() {
        let Some(profile) = record.profiles.get(&format!("u@{tau}")) else { continue };
        let u = profile.column("u").iter().zip(profile.column("u_exact"));
        let points: Vec<(f64, f64)> =
            u.zip(profile.column("y")).map(|((u, e), y)| ((u - e) / v, y / WIDTH)).collect();
        let name = format!("νt/L² = {tau}");
        plot = plot.layer(
            Series::line_markers(name, points).colour(Colour::cycle(k)).shape(Shape::cycle(k)),
        );
    }
    plot.legend(Legend::Outside)
}

/// Particles at the end of a run, coloured by velocity and by pressure.
fn snapshot(flow: Flow, record: &Record) -> Figure {
    let id = format!("{}-particles", name(flow));
    let dx = record.chose("dx [m]");
    let caption = "Particles of the seed's run at the end, νt/L² = 1, 20 rows of 20: velocity along the \
                   channel, and pressure, which is exactly zero in the flow. The pressure that is left \
                   is a pattern of rows that slide past each other. The section is periodic in x.";
    let empty = Profile::default();
    let particles = record.profiles.get("particles").unwrap_or(&empty);
    let map = |title: &str, field: &str, label: &str, colours| {
        let (x, y) = (particles.column("x"), particles.column("y"));
        let values = particles.column(field).iter();
        let points = x.iter().zip(y).zip(values).map(|((x, y), v)| (*x, *y, *v)).collect();
        let axes = (Axis::linear("x [m]"), Axis::linear("y [m]"));
        ParticleMap::new(title, axes, label, colours, points).diameter(0.9 * dx)
    };
    Figure::new(id, caption)
        .columns(2)
        .panel(map("velocity", "u", "u [m/s]", ColourMap::Sequential))
        .panel(map("pressure", "p", "p [Pa]", ColourMap::Diverging))
}

/// The error that a flow is judged by, and its name.
fn error_metric(flow: Flow) -> (&'static str, &'static str) {
    match flow {
        Flow::Couette => ("l2@0.1", "Relative L2 error of u at νt/L² = 0.1 [-]"),
        Flow::Poiseuille => ("l2@1", "Relative L2 error of u at νt/L² = 1 [-]"),
    }
}

/// νt/L² of the error that ladders are judged by.
fn compared_at(flow: Flow) -> f64 {
    if flow == Flow::Couette { 0.1 } else { 1.0 }
}

fn orders(flow: Flow, tier: Tier, runs: &[JudgedRun]) -> Study {
    let (metric, label) = error_metric(flow);
    let id = format!("{}-convergence", name(flow));
    let at = compared_at(flow);
    let mut study = Study::new(&id, "Order of accuracy");
    let figure = format!(
        "{label} against spacing, Re = 0.5. The triangle shows second order. The order in the table is a \
         least-squares fit over all levels; 95 % interval of Student's t."
    );
    let mut plot = Plot::new("", Axis::log("Δx/L [-]"), Axis::log(label));
    let columns = vec![
        Column::text("variant"),
        Column::num("order ± standard error", "-"),
        Column::text("95 % interval"),
        Column::text("local orders, coarse to fine"),
        Column::text("label"),
        Column::num("finest error", "-"),
        Column::num("fitted floor", "-"),
        Column::num("lattice in place makes", "-"),
        Column::num("slid rows make", "-"),
    ];
    let caption = format!(
        "Observed order of {metric} over the rows of the ladder; last, the errors that the viscosity of a \
         square lattice makes at any spacing, in place and with rows that shear has slid past each other."
    );
    let mut table = Table::new(caption, columns);
    let mut floors = Vec::new();
    for (k, variant) in ladder(flow).into_iter().enumerate() {
        let ladder = &runs[ladder_of(flow, tier, variant)];
        let error = |run: &JudgedRun| run.record.measured(metric);
        let levels: Vec<Level> = levels(tier)
            .iter()
            .zip(ladder)
            .map(|(rows, run)| Level { spacing: 1.0 / *rows as f64, value: error(run) })
            .collect();
        let line = levels.iter().map(|l| (l.spacing, l.value)).collect();
        plot = plot.layer(Series::line_markers(variant, line).cycle(k));
        let found = convergence(&levels);
        let finest = levels.last().map_or(f64::NAN, |l| l.value);
        if let ("plain", Flow::Poiseuille) = (variant, flow) {
            let because = "mirrored walls and the kernel are second order; finer levels than the \
                           floor of the lattice are not in the ladder";
            let bound = Bound::Within(1.8, 2.2);
            let gate =
                Gate::new("poiseuille.plain.order", "order", bound, Evidence::Theory, because);
            study = study.judge(gate, found.as_ref().map_or(f64::NAN, |c| c.order));
        }
        let lattice = ladder.last().and_then(|run| LatticeFloor::of(&run.record, flow, at));
        if let (Ok(c), Some(lattice)) = (&found, lattice)
            && let Some(floor) = c.floor
        {
            let [floor, cause] = [percent(floor.error, 2), lattice.cause(floor.error)];
            floors.push(format!("`{variant}` stops at {floor}: {cause}."));
        }
        table = table.row(order_row(variant, finest, found.ok().as_ref(), lattice));
    }
    plot = plot.layer(Layer::slope(2.0)).legend(Legend::Outside);
    study.block(Figure::new(&id, figure).panel(plot)).block(table).block(Block::List(floors))
}

fn order_row(
    variant: &str,
    finest: f64,
    found: Option<&Convergence>,
    lattice: Option<LatticeFloor>,
) -> Vec<Cell> {
    let part = |part: fn(LatticeFloor) -> f64| {
        lattice.map_or(Cell::text("–"), |lattice| Cell::percent(part(lattice), 2))
    };
    let lattice = [part(|l| l.in_place), part(|l| l.slid)];
    let Some(c) = found else {
        let rest = (0..4).map(|_| Cell::text("–"));
        let mut row = vec![Cell::text(format!("`{variant}`"))];
        row.extend(rest);
        row.extend([Cell::percent(finest, 2), Cell::text("–")]);
        row.extend(lattice);
        return row;
    };
    let local: Vec<String> = c.local_orders.iter().map(|p| sig(*p, 2)).collect();
    let label = match c.label {
        Label::Asymptotic => "asymptotic",
        Label::FloorReached => "floor reached",
        Label::NotAsymptotic => "not asymptotic",
    };
    let mut row = vec![
        Cell::text(format!("`{variant}`")),
        Cell::text(format!("{} ± {}", sig(c.order, 3), sig(c.standard_error, 2))),
        Cell::text(format!("{} … {}", sig(c.interval[0], 2), sig(c.interval[1], 2))),
        Cell::text(local.join(", ")),
        Cell::text(label),
        Cell::percent(finest, 2),
        c.floor.map_or(Cell::text("–"), |floor| Cell::percent(floor.error, 2)),
    ];
    row.extend(lattice);
    row
}

/// Runs up to this many processor seconds are timed again \[s\].
const TIMED_AGAIN_BELOW: f64 = 0.3;
/// The same in the quick tier, which has to be quick: short runs are the noisiest.
const QUICK_TIMED_AGAIN_BELOW: f64 = 0.01;
/// Timings of a run that is timed again: the fewest that have a median.
const REPETITIONS: usize = 3;

fn cost(case: &'static dyn Case, flow: Flow, tier: Tier, runs: &[JudgedRun]) -> Study {
    let (metric, label) = error_metric(flow);
    let id = format!("{}-work-precision", name(flow));
    let ladder_runs = &runs[..ladder(flow).len() * levels(tier).len()];
    let points = timed_points(case, tier, ladder_runs, metric);
    let rows: Vec<String> = levels(tier).iter().map(usize::to_string).collect();
    let others = match flow {
        Flow::Couette => "at the same Reynolds number, with their error at νt/L² = 0.1125",
        Flow::Poiseuille => "at Re 0.0125 except the plain reimplementation at 0.5",
    };
    let caption = format!(
        "{label} against the cost of the whole run to νt/L² = 1, Re = 0.5. Left: processor seconds of the \
         stepping loop on one thread, which are its wall time on a core of its own, median of up to {} \
         interleaved runs, bars from fastest to slowest; other codes were timed on another machine, \
         {others}. Right: pair interactions, which no noise touches. Rows: {}.",
        REPETITIONS,
        rows.join(", ")
    );
    let figure = work_precision::figure(&id, &caption, label, &points, &peers(flow));
    let coarse: Vec<JudgedRun> =
        runs.iter().filter(|run| run.planned.set == [COARSE_ROWS]).cloned().collect();
    let points = [points, timed_points(case, tier, &coarse, metric)].concat();
    let study = Study::new(&id, "Error against run time")
        .block(figure)
        .block(work_precision::cheapest_table(CHEAPEST, &points));
    let like = if flow == Flow::Couette { points } else { like_peers(case, tier, runs, metric) };
    study.block(peer_table(flow, &like))
}

const CHEAPEST: &str = "Cheapest setting that reaches an error. At a single level errors of time and \
    spacing can cancel, so a point counts only if every finer level of its ladder meets the goal as well; \
    the finest level has none to be held against.";

/// Poiseuille flow at the peers' Reynolds number, timed.
fn like_peers(case: &'static dyn Case, tier: Tier, runs: &[JudgedRun], metric: &str) -> Vec<Point> {
    let end = runs.len() - 1;
    let like = &runs[end - LIKE_PEERS.len()..end];
    let mut points = timed_points(case, tier, like, metric);
    for (point, (_, _, ratio)) in points.iter_mut().zip(LIKE_PEERS) {
        point.note = format!(", h/dx {ratio}");
    }
    points
}

/// Points of these runs; cheap ones are timed again one after the other, variants interleaved.
fn timed_points(
    case: &'static dyn Case,
    tier: Tier,
    runs: &[JudgedRun],
    metric: &str,
) -> Vec<Point> {
    let point = |run: &JudgedRun| {
        let rows = run.record.setting("rows") as usize;
        Point::of(run.planned.variant, rows, run.record.measured(metric), &run.record)
    };
    let mut points: Vec<Point> = runs.iter().map(point).collect();
    let most = if tier == Tier::Full { TIMED_AGAIN_BELOW } else { QUICK_TIMED_AGAIN_BELOW };
    let again: Vec<usize> = (0..points.len()).filter(|&k| points[k].seconds[0] < most).collect();
    for &k in &again {
        points[k].seconds.clear();
    }
    for _ in 0..REPETITIONS {
        for &k in &again {
            let planned = &runs[k].planned;
            if let Ok(record) = case.run(planned.variant, &planned.set, &Context::default()) {
                points[k].seconds.push(record.cost.cpu_s);
            }
        }
    }
    points
}

/// Other codes' error at the nearest time, from the reference package.
fn peers(flow: Flow) -> Vec<Peer> {
    let read = || -> Result<Vec<Peer>, base::reference::ReferenceError> {
        let table = Reference::load("peers_channel")?.table("errors")?.clone();
        let column = if flow == Flow::Couette { "error_0.1125s" } else { "error_1s" };
        let (codes, cases) = (table.texts("code")?, table.texts("case")?);
        let (seconds, errors) = (table.optional("seconds")?, table.optional(column)?);
        let rows = (0..codes.len()).filter(|&k| cases[k] == name(flow));
        Ok(rows
            .filter_map(|k| Some((codes[k].to_string(), seconds[k]?, errors[k]? / 100.0)))
            .collect())
    };
    read().unwrap_or_default()
}

/// At the error of each peer, the cheapest of ours and how many times faster it is.
fn peer_table(flow: Flow, points: &[Point]) -> Table {
    let columns = vec![
        Column::text("code"),
        Column::num("its error", "-"),
        Column::num("its time", "s"),
        Column::text("ours at no more error"),
        Column::num("our error", "-"),
        Column::num("our time", "s"),
        Column::num("ratio", "-"),
    ];
    let when = match flow {
        Flow::Couette => "at Re 0.5; their error is that at νt/L² = 0.1125, ours that at 0.1",
        Flow::Poiseuille => {
            "at Re 0.0125, but the plain scalar reimplementation at 0.5; their error and ours are those at \
             νt/L² = 1"
        }
    };
    let caption = format!(
        "Other codes on the same work (reference `peers_channel`: from rest to t = 1 s = L²/ν, their times \
         from another machine of the same class) against our cheapest setting with no more error, {when}. \
         The plain scalar reimplementation is no package: a program written for this comparison, of this \
         method. Of ours, points count whose finer levels have no more error either."
    );
    let mut table = Table::new(caption, columns);
    for (code, seconds, error) in peers(flow) {
        let mut row = vec![Cell::text(code), Cell::percent(error, 2), Cell::seconds(seconds)];
        match work_precision::cheapest(points, error) {
            Some(p) => row.extend([
                Cell::text(format!("`{}`, {} rows{}", p.variant, p.rows, p.note)),
                Cell::percent(p.error, 2),
                Cell::seconds(p.median_seconds()),
                Cell::num(seconds / p.median_seconds(), 2),
            ]),
            None => row.extend((0..4).map(|_| Cell::text("–"))),
        }
        table = table.row(row);
    }
    table
}

/// A change of one thing, what it is called, and the change that it is compared with.
struct Change {
    what: &'static str,
    part: &'static str,
    /// A wall is another variant, all else is the one in question.
    variant: &'static str,
    set: Vec<String>,
    against: usize,
}

/// The error budget: the same run with one thing changed.
fn budget(case: &'static dyn Case, flow: Flow, tier: Tier) -> Study {
    let id = format!("{}-error-budget", name(flow));
    let (metric, label) = error_metric(flow);
    let columns = vec![
        Column::text("variant, 20 rows"),
        Column::text("change"),
        Column::text("part of the error"),
        Column::num("error", "-"),
        Column::num("change of error", "-"),
    ];
    let caption = format!(
        "Error budget with one thing changed at a time: {lower}. The largest fall names what to spend on. \
         Where the error rises as dt falls, errors of time and spacing cancel at the default dt, and the \
         row with the least dt, dt/8 in the full tier, is the better measure of the spacing.",
        lower = label.replacen("Relative", "relative", 1)
    );
    let mut table = Table::new(caption, columns);
    let mut study = Study::new(&id, "Error budget");
    let mut findings = Vec::new();
    // Without a body force `curved` is `plain`.
    let variants: &[&str] = match (flow, tier) {
        (Flow::Poiseuille, Tier::Full) => &["seed", "plain", "curved"],
        (_, Tier::Quick) => &["seed"],
        _ => &["seed", "plain"],
    };
    for &variant in variants {
        let changes = changes(case, variant, flow, tier);
        let errors: Vec<f64> = changes
            .par_iter()
            .map(|change| {
                let record = case.run(change.variant, &change.set, &Context::default());
                record.ok().and_then(|r| r.metric(metric)).unwrap_or(f64::NAN)
            })
            .collect();
        for (change, error) in changes.iter().zip(&errors) {
            table = table.row(vec![
                Cell::text(format!("`{variant}`")),
                Cell::text(change.what),
                Cell::text(change.part),
                Cell::percent(*error, 3),
                Cell::percent(error - errors[change.against], 2),
            ]);
        }
        table = table.row(series_row(case, variant, flow));
        findings.extend(budget_in_words(variant, &changes, &errors));
    }
    study = study.block(Block::List(findings));
    study.block(table)
}

/// What the budget of one variant says.
fn budget_in_words(variant: &str, changes: &[Change], errors: &[f64]) -> Vec<String> {
    let (base, mut findings) = (errors[0], Vec::new());
    let at = |what: &str| {
        let k = changes.iter().position(|change| change.what == what);
        k.map_or(f64::NAN, |k| errors[k])
    };
    let least = if at("dt/8").is_nan() { "dt/4" } else { "dt/8" };
    let cancels = at(least) > 1.1 * base.min(at("dt/2"));
    if cancels {
        findings.push(format!(
            "`{variant}`: *time and spacing cancel*: as dt falls the error rises; it is {} at dt, {} at \
             dt/2 and {} at {least}.",
            percent(base, 3),
            percent(at("dt/2"), 3),
            percent(at(least), 3)
        ));
    }
    let single = changes.iter().zip(errors).filter(|(change, _)| change.against == 0);
    let single = single.filter(|(change, _)| !(cancels && change.part == "time"));
    let smallest = single.skip(1).min_by(|a, b| a.1.total_cmp(b.1));
    if let Some((change, error)) = smallest.filter(|(_, error)| **error < 0.9 * base) {
        findings.push(format!(
            "`{variant}`: {} falls most by *{}* (to {}): {}.",
            percent(base, 2),
            change.what,
            percent(*error, 2),
            change.part
        ));
    } else {
        findings
            .push(format!("`{variant}`: no single change takes a tenth off {}.", percent(base, 2)));
    }
    findings
}

/// How much the exact series moves with twice the terms, in V: the part of the reference.
fn series_row(case: &dyn Case, variant: &str, flow: Flow) -> Vec<Cell> {
    let tau = compared_at(flow);
    let record = case.run(variant, &[], &Context::default());
    let v = record.as_ref().map_or(f64::NAN, |record| record.chose("V [m/s]"));
    let t = tau * WIDTH * WIDTH / 1e-6;
    let moved = (1..20).map(|k| {
        let y = WIDTH * f64::from(k) / 20.0;
        let (once, twice) = match flow {
            Flow::Couette => {
                let exact = Couette { v0: v, l: WIDTH, nu: 1e-6 };
                let n = exact.terms(t);
                (exact.velocity_by_series(y, t, n), exact.velocity_by_series(y, t, 2 * n))
            }
            Flow::Poiseuille => {
                let exact = Poiseuille { v, l: WIDTH, nu: 1e-6 };
                let n = exact.terms(t);
                (exact.velocity_by_series(y, t, n), exact.velocity_by_series(y, t, 2 * n))
            }
        };
        (once - twice).abs() / v
    });
    vec![
        Cell::text(format!("`{variant}`")),
        Cell::text("twice the terms of the series"),
        Cell::text("reference"),
        Cell::text("–"),
        Cell::sci(moved.fold(0.0, f64::max), 2),
    ]
}

fn changes(case: &dyn Case, variant: &'static str, flow: Flow, tier: Tier) -> Vec<Change> {
    let base = case.run(variant, &[], &Context::default());
    let base = |name: &str| base.as_ref().map_or(f64::NAN, |record| record.chose(name));
    let (dt, c0) = (base("dt [s]"), base("c0 [m/s]"));
    let change =
        |what, part, set: &[String]| Change { what, part, variant, set: set.to_vec(), against: 0 };
    let (wall, other) = match variant {
        "seed" => ("interface and wall particles", "interface-wall"),
        _ => ("wall particles that extrapolate", "extrapolating-wall"),
    };
    let quarter = format!("dt={}", 0.25 * dt);
    let double = format!("c0={}", 2.0 * c0);
    let mut changes = vec![
        change("none", "–", &[]),
        change("dt/4", "time", std::slice::from_ref(&quarter)),
        Change {
            against: 1,
            ..change("c0 × 2 and dt/4, against dt/4", "compressibility (Ma²)", &[double, quarter])
        },
        change("dt/2", "time", &[format!("dt={}", 0.5 * dt)]),
        change("h/dx + 0.3", "kernel sums on the lattice", &[h_over_dx(variant)]),
        change("eta² × 1e-3", "guard in the viscous term", &[eta(variant)]),
        Change { variant: other, ..change(wall, "wall", &[]) },
    ];
    // The dearest two, half of the whole.
    if tier == Tier::Full {
        changes.push(change("dt/8", "time", &[format!("dt={}", 0.125 * dt)]));
        changes.push(change("40 rows", "spacing: wall and kernel", &["rows=40".into()]));
    }
    if flow == Flow::Poiseuille {
        let curved = (variant != "curved").to_string();
        changes.push(change(
            "curvature in the ghosts on/off",
            "wall",
            &[format!("wall_curvature={curved}")],
        ));
    }
    changes
}

fn h_over_dx(variant: &str) -> String {
    format!("h_over_dx={}", if variant == "seed" { 1.5 } else { 1.3 })
}

fn eta(variant: &str) -> String {
    format!("eta2_over_h2={}", if variant == "seed" { 1e-5 } else { 1e-9 })
}

/// The modern variant over the Reynolds number.
fn reynolds(flow: Flow, runs: &[JudgedRun]) -> Study {
    let id = format!("{}-reynolds", name(flow));
    let columns = vec![
        Column::num("Re", "-"),
        Column::num("c0/V", "-"),
        Column::num("dt/limit", "-"),
        Column::num("νt/L² reached", "-"),
        Column::num("worst error from νt/L² = 0.1 on", "-"),
        Column::num("rms p", "ρV²"),
        Column::num("rms v", "V"),
        Column::num("steps", "1"),
        Column::num("stepping", "s"),
    ];
    let caption = "Variant `modern` at 20 rows over the Reynolds number, all settings by one rule: quintic \
                   spline, h = dx, density diffusion 0.1, shifting 0.5, no background pressure, c0 by \
                   Morris' rule with 1 % density variation and at least 2.2 ν/h, Courant number 1 and \
                   viscous number 0.4. The quick tier leaves higher Re to the full tier.";
    let mut table = Table::new(caption, columns);
    let is_20_rows = |run: &&JudgedRun| {
        run.record.settings.get("rows").and_then(serde_json::Value::as_u64) == Some(20)
    };
    // The ladder of resolutions has its own table.
    let is_of_reynolds =
        |run: &&JudgedRun| run.planned.set.iter().any(|set| set.starts_with("re="));
    let modern = runs.iter().filter(|run| run.planned.variant == "modern");
    let modern = modern.filter(is_20_rows).filter(is_of_reynolds);
    for run in modern {
        let record = &run.record;
        let metric = |name: &str| record.measured(name);
        let set = |key: &str| record.setting(key);
        let reached = match record.status {
            Status::Completed => set("end"),
            Status::Diverged { time, .. } | Status::Interrupted { time, .. } => time,
            Status::Refused { .. } => 0.0,
        };
        table = table.row(vec![
            Cell::exact(set("re")),
            Cell::num(record.chose("c0/V"), 3),
            Cell::num(record.chose("dt/limit"), 2),
            Cell::num(reached, 3),
            Cell::percent(metric("l2_worst"), 2),
            Cell::sci(metric("p_rms"), 2),
            Cell::sci(metric("v_rms"), 2),
            Cell::count(record.cost.steps),
            Cell::seconds(record.cost.cpu_s),
        ]);
    }
    Study::new(&id, "One rule for every Reynolds number").block(table)
}
