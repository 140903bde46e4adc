//! What the channel flows declare: profiles over the exact ones, ladders of resolutions, an error budget and
//! the largest stable steps.

use super::{
    Channel, ChannelSettings, Flow, limits, map,
    measure::{L2, profile_at},
    plan::ladder_gates,
    sensitivity,
};
use base::{
    gate::{Bound, Evidence},
    record::{MetricName, Record},
    reference::{Reference, ReferenceError},
    spec::RunSpec,
};
use harness::{
    case::{Case, Rules, Step, Tier},
    declare::{
        Accuracy, Budget, Budgets, Card, Change, CurveOf, CurvePanel, Curves, Declaration, ErrorOf,
        Ladder, Level, OrderGate, Peer,
    },
};
use maths::exact::{couette::Couette, poiseuille::Poiseuille};
use report::Axis;

/// What a flow declares.
pub fn declaration(channel: Channel, tier: Tier) -> Declaration {
    let flow = channel.flow;
    let mut accuracy = vec![at_half(channel, tier)];
    let mut maps = Vec::new();
    if flow == Flow::Poiseuille {
        accuracy.push(like_peers(channel));
        maps.push(map::declared(channel.case, tier));
    }
    let card = Some(card(channel, &accuracy[0]));
    Declaration {
        card,
        curves: vec![curves(channel)],
        accuracy,
        budgets: Some(budgets(channel, tier)),
        limits: Some(limits::limits(channel, tier)),
        maps,
        sensitivity: Some(sensitivity::sensitivity(channel, tier)),
        ..Declaration::default()
    }
}

/// What the report says first of the flow.
fn card(channel: Channel, accuracy: &Accuracy) -> Card {
    let tau = channel.flow.compared_at();
    let (title, picture) = match channel.flow {
        Flow::Couette => ("Couette flow, Re 0.5", "couette-profiles"),
        Flow::Poiseuille => ("Poiseuille flow, Re 0.5", "poiseuille-profiles"),
    };
    Card {
        title,
        picture: (picture, 0),
        error: format!("velocity at νt/L² = {tau}, relative L2 norm"),
        metric: L2.at(tau),
        runs: accuracy.finest(&[channel.case.best.variant, "seed"]),
        against: "the exact series",
        uncertainty: None,
        reach: ("re", "Re", ""),
    }
}

/// The flow, at the beginning of a sentence.
fn title(flow: Flow) -> &'static str {
    match flow {
        Flow::Couette => "Couette flow",
        Flow::Poiseuille => "Poiseuille flow",
    }
}

/// The error that ladders are judged by, and its name.
fn error(flow: Flow) -> (MetricName, String) {
    let tau = flow.compared_at();
    (L2.at(tau), format!("Relative L2 error of u at νt/L² = {tau} [-]"))
}

/// Variants whose error is drawn against their cost. Without a body force `curved` is `plain`.
pub fn ladder(flow: Flow) -> [&'static str; 9] {
    [
        "seed",
        "interface-wall",
        "seed-small-eta",
        "cubic-leapfrog",
        "wendland-leapfrog",
        "quintic-pc",
        "plain",
        if flow == Flow::Couette { "modern" } else { "curved" },
        "stiff",
    ]
}

/// Rows of the ladder.
pub fn levels(tier: Tier) -> &'static [usize] {
    match tier {
        Tier::Quick => &[8, 10, 14, 20, 40],
        Tier::Full => &[8, 10, 14, 20, 40, 80],
    }
}

/// The run of the ladder of a variant with so many rows.
pub fn at_rows(channel: Channel, variant: &str, rows: usize) -> RunSpec {
    channel.case.spec(variant, |s| s.rows = rows)
}

fn level(channel: Channel, variant: &str, rows: usize) -> Level {
    let run = channel.case.planned(variant, |s| s.rows = rows);
    let run = run.judged(ladder_gates(channel.flow, variant, rows));
    Level { run, spacing: 1.0 / rows as f64, label: format!("{rows} rows") }
}

fn rows_of(channel: Channel, variant: &'static str, rows: &[usize]) -> Ladder {
    let levels = rows.iter().map(|rows| level(channel, variant, *rows)).collect();
    let order = (channel.flow == Flow::Poiseuille && variant == "plain").then(|| OrderGate {
        id: "poiseuille.plain.order".into(),
        bound: Bound::Within(1.8, 2.2),
        evidence: Evidence::Theory,
        because:
            "Mirrored walls and the kernel are of second order. Levels whose error is near what the \
                  lattice leaves at any spacing are not in the fit."
                .into(),
    });
    Ladder { variant, note: String::new(), levels, order }
}

/// The ladders at Re 0.5.
fn at_half(channel: Channel, tier: Tier) -> Accuracy {
    let flow = channel.flow;
    let (metric, label) = error(flow);
    let ladders = ladder(flow).map(|variant| rows_of(channel, variant, levels(tier))).into();
    // At fewer rows than orders are fitted to: what the cheapest settings cost.
    let coarse: &[&str] = match flow {
        Flow::Couette => &["wendland-leapfrog", "plain"],
        Flow::Poiseuille => &[],
    };
    let more =
        coarse.iter().map(|variant| Ladder { order: None, ..rows_of(channel, variant, &[6]) });
    Accuracy {
        id: flow.name().into(),
        error: ErrorOf::Metric(metric),
        label,
        about: format!(
            "{} at Re 0.5, run to νt/L² = 1. Of the other codes the plain scalar reimplementation is no \
             package, but a program of this method, written for this comparison.",
            title(flow)
        ),
        spacing: "Δx/L [-]",
        slope: Some(2.0),
        ladders,
        more: more.collect(),
        peers: peers(flow, 0.5),
    }
}

/// The Reynolds number at which other codes were timed in Poiseuille flow.
const PEERS_RE: f64 = 0.0125;

/// Poiseuille flow at the Reynolds number of the other codes: variant, h/dx, rows. There rows hardly slide
/// (by a quarter of a spacing at 20 rows), so the sum of the viscous term on the aligned lattice is what
/// counts: 1 + 8.0e-4 for the quintic spline at h = dx, 1 - 1.4e-4 at 0.9.
const LIKE_PEERS: [(&str, f64, [usize; 3]); 3] =
    [("plain", 1.0, [10, 20, 40]), ("curved", 1.0, [8, 14, 20]), ("curved", 0.9, [8, 14, 20])];

fn like_peers(channel: Channel) -> Accuracy {
    let (metric, label) = error(channel.flow);
    let ladder = |(variant, ratio, rows): (&'static str, f64, [usize; 3])| {
        let level = |rows: usize| {
            let run = channel.case.planned(variant, |s| {
                (s.rows, s.h_over_dx, s.re) = (rows, ratio, PEERS_RE);
            });
            Level { run, spacing: 1.0 / rows as f64, label: format!("{rows} rows") }
        };
        let note = format!(", h/dx {ratio}");
        Ladder { variant, note, levels: rows.map(level).into(), order: None }
    };
    Accuracy {
        id: "poiseuille-like-peers".into(),
        error: ErrorOf::Metric(metric),
        label,
        about: format!(
            "{} at Re {PEERS_RE}, as most other codes were timed, run to νt/L² = 1.",
            title(channel.flow)
        ),
        spacing: "Δx/L [-]",
        slope: Some(2.0),
        ladders: LIKE_PEERS.map(ladder).into(),
        more: Vec::new(),
        peers: peers(channel.flow, PEERS_RE),
    }
}

/// Other codes at this Reynolds number, with their error at the time nearest to that of ours: νt/L² =
/// 0.1125 in Couette flow, 1 in Poiseuille flow. None if the reference cannot be read.
fn peers(flow: Flow, re: f64) -> Vec<Peer> {
    let (column, at) = match flow {
        Flow::Couette => ("error_0.1125s", "; error at νt/L² = 0.1125"),
        Flow::Poiseuille => ("error_1s", ""),
    };
    let read = || -> Result<Vec<Peer>, ReferenceError> {
        let table = Reference::load("peers_channel")?.table("errors")?.clone();
        let (codes, schemes, cases) =
            (table.texts("code")?, table.texts("scheme")?, table.texts("case")?);
        let (reynolds, rows) = (table.optional("reynolds")?, table.optional("rows")?);
        let (seconds, errors) = (table.optional("seconds")?, table.optional(column)?);
        let peer = |k: usize| {
            Some(Peer {
                name: format!("{}, {}", codes[k], schemes[k]),
                label: format!("{} rows", rows[k]?),
                seconds: seconds[k]?,
                spacing: 1.0 / rows[k]?,
                error: errors[k]? / 100.0,
                timed: format!("wall time, one thread of a similar machine, 2025–26{at}"),
            })
        };
        let is_like = |k: &usize| cases[*k] == flow.name() && reynolds[*k] == Some(re);
        Ok((0..codes.len()).filter(is_like).filter_map(peer).collect())
    };
    read().unwrap_or_default()
}

/// Times that fit into a figure.
const SHOWN: [f64; 5] = [0.02, 0.05, 0.1, 0.2, 1.0];

fn curves(channel: Channel) -> Curves {
    let flow = channel.flow;
    let best = if flow == Flow::Couette { "plain" } else { "curved" };
    let panel = |variant: &str| CurvePanel {
        title: variant.into(),
        x: Axis::linear("u/V [-]"),
        y: Axis::linear("y/L [-]"),
        lines: lines(channel, variant, |u, _| u),
        references: SHOWN.map(|tau| (String::new(), exact_line(flow, tau))).into(),
        symbols: true,
    };
    let error = CurvePanel {
        title: format!("{best}: error"),
        x: Axis::linear("(u − u_exact)/V [-]"),
        y: Axis::linear("y/L [-]"),
        lines: lines(channel, best, |u, exact| u - exact),
        references: Vec::new(),
        symbols: false,
    };
    Curves {
        id: format!("{}-profiles", flow.name()),
        title: "Velocity profiles".into(),
        caption: format!(
            "Velocity u along the channel at five times, Re 0.5, 20 rows of particles, for variants `seed` \
             (left) and `{best}` (middle). Symbols are means over a row, and lines the exact series. \
             Right: error of `{best}`."
        ),
        columns: 3,
        panels: vec![panel("seed"), panel(best), error],
    }
}

/// A function of u and the exact u, over V, across the channel at the times of the figure.
fn lines(channel: Channel, variant: &str, x: fn(f64, f64) -> f64) -> Vec<CurveOf> {
    let line = |tau: f64| CurveOf {
        name: format!("νt/L² = {tau}"),
        spec: at_rows(channel, variant, 20),
        points: Box::new(move |record: &Record| {
            let settings: ChannelSettings = record.settings_as();
            let profile = profile_at(tau);
            let column = |name: &str| record.column(&profile, name).iter();
            let u = column("u").zip(column("u_exact"));
            let point = |((u, exact), y): ((&f64, &f64), &f64)| {
                (x(*u, *exact) / settings.speed(), y / settings.width)
            };
            u.zip(column("y")).map(point).collect()
        }),
    };
    SHOWN.map(line).into()
}

/// (u/V, y/L) of the exact flow from wall to wall.
fn exact_line(flow: Flow, tau: f64) -> Vec<(f64, f64)> {
    (0..=100).map(|k| f64::from(k) / 100.0).map(|y| (flow.exact(y, tau, 1.0), y)).collect()
}

fn budgets(channel: Channel, tier: Tier) -> Budgets {
    let flow = channel.flow;
    // Without a body force `curved` is `plain`.
    let variants: &[&str] = match (flow, tier) {
        (Flow::Poiseuille, Tier::Full) => &["seed", "plain", "curved"],
        (_, Tier::Quick) => &["seed"],
        _ => &["seed", "plain"],
    };
    let of = |variant: &&'static str| Budget { variant, changes: changes(channel, variant, tier) };
    let (metric, label) = error(flow);
    Budgets {
        id: format!("{}-error-budget", flow.name()),
        error: ErrorOf::Metric(metric),
        label,
        about: format!(
            "Runs have 20 rows and Re 0.5. With twice as many terms, the exact series changes by {} V at \
             most.",
            report::sci(series_moves(flow), 2)
        ),
        of: variants.iter().map(of).collect(),
    }
}

/// How much the exact series moves with twice the terms \[V\].
fn series_moves(flow: Flow) -> f64 {
    let tau = flow.compared_at();
    let moved = (1..20).map(|k| {
        let y = f64::from(k) / 20.0;
        let [once, twice] = [1, 2].map(|times| match flow {
            Flow::Couette => {
                let exact = Couette { v0: 1.0, l: 1.0, nu: 1.0 };
                exact.velocity_by_series(y, tau, times * exact.terms(tau))
            }
            Flow::Poiseuille => {
                let exact = Poiseuille { v: 1.0, l: 1.0, nu: 1.0 };
                exact.velocity_by_series(y, tau, times * exact.terms(tau))
            }
        });
        (once - twice).abs()
    });
    moved.fold(0.0, f64::max)
}

fn changes(Channel { flow, case }: Channel, variant: &'static str, tier: Tier) -> Vec<Change> {
    let spec = |set: &dyn Fn(&mut ChannelSettings)| case.spec(variant, set);
    let base = spec(&|_| ());
    // A variant that has no rules is refused, and its record says why.
    let Ok(Rules { step: Step { dt, .. }, sound_speed, .. }) = case.rules(&base) else {
        return vec![Change::new("none", "–", base)];
    };
    let is_seed = variant == "seed";
    let (wall, other) = match is_seed {
        true => ("interface and wall particles", "interface-wall"),
        false => ("wall particles that extrapolate", "extrapolating-wall"),
    };
    let ratio = if is_seed { 1.5 } else { 1.3 };
    let eta2 = if is_seed { 1e-5 } else { 1e-9 };
    let stiffer = spec(&|s| (s.c0, s.dt) = (Some(2.0 * sound_speed), Some(0.25 * dt)));
    let mut changes = vec![
        Change::new("none", "–", base),
        Change::new("dt/4", "time", spec(&|s| s.dt = Some(0.25 * dt))),
        Change {
            against: 1,
            ..Change::new("c0 × 2 and dt/4, against dt/4", "compressibility (Ma²)", stiffer)
        },
        Change::new("dt/2", "time", spec(&|s| s.dt = Some(0.5 * dt))),
        Change::new("h/dx + 0.3", "kernel sums on the lattice", spec(&|s| s.h_over_dx = ratio)),
        Change::new("eta² × 1e-3", "guard in the viscous term", spec(&|s| s.eta2_over_h2 = eta2)),
        Change::new(wall, "wall", case.spec(other, |_| ())),
    ];
    // The dearest two, half of the whole.
    if tier == Tier::Full {
        changes.push(Change::new("dt/8", "time", spec(&|s| s.dt = Some(0.125 * dt))));
        changes.push(Change::new("40 rows", "spacing: wall and kernel", spec(&|s| s.rows = 40)));
    }
    if flow == Flow::Poiseuille {
        let curved = spec(&|s| s.wall_curvature = variant != "curved");
        changes.push(Change::new("curvature in the ghosts on/off", "wall", curved));
    }
    changes
}
