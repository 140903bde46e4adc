//! What the channel flows declare: profiles over the exact ones, ladders of resolutions, an error budget, the
//! largest stable steps, maps and the errors of constants that gates must detect.

use super::{
    Channel, ChannelSettings, Flow, limits, maps,
    measure::{L2, L2_WORST, LINF, NU_EFF, SHEAR_LOWER, SHEAR_UPPER, profile_at},
    plan::{self, PEERS_RE, ladder},
    runs::{ChannelTable, For},
    sensitivity,
};
use crate::peers;
use base::{
    gate::{Bound, Evidence},
    record::Record,
    reference::Table,
};
use harness::{
    case::{Case, Rules, Tier},
    declare::{
        Accuracy, Budget, Budgets, Card, Change, Comparison, Curve, CurveOf, CurvePanel, Curves,
        Declaration, ErrorOf, Ladder, OrderGate, Peer,
    },
};
use nalgebra::Vector2;
use report::Axis;
use serde_json::Value;

/// What a flow declares.
pub fn declaration(channel: Channel, tier: Tier) -> Declaration {
    let table = plan::table(channel, tier);
    let at_half = at_half(channel.flow, &table);
    let comparisons = comparisons(channel, &at_half);
    let (card, budgets) = (card(channel, &at_half), budgets(channel, &at_half, tier));
    let (mut accuracy, mut maps) = (vec![at_half], Vec::new());
    if channel.flow == Flow::Poiseuille {
        accuracy.push(like_peers(&table));
        maps = maps::declared(&table);
    }
    Declaration {
        card: Some(card),
        curves: vec![curves(channel)],
        accuracy,
        comparisons,
        budgets: Some(budgets),
        limits: Some(limits::limits(channel, tier)),
        maps,
        sensitivity: Some(sensitivity::sensitivity(channel, tier)),
        curve: Some(profile()),
        ..Declaration::default()
    }
}

/// The velocities of rows across the channel: each row of particles stands for one.
fn profile() -> Curve {
    let rows = |settings: &Value| settings["rows"].as_u64().unwrap_or_default() as usize;
    Curve {
        columns: [("y", "m"), ("u", "m/s")],
        rows,
        place: |settings, at, start| {
            let width = settings["width"].as_f64().unwrap_or(f64::NAN);
            let row = (start.y / width * at.len() as f64) as usize;
            let [y, u] = at[row.min(at.len() - 1)];
            [Vector2::new(start.x, y), Vector2::new(u, 0.0)]
        },
        metrics: vec![L2, LINF, SHEAR_LOWER, SHEAR_UPPER, NU_EFF, L2_WORST],
        shown: ("u@", &["y", "u", "u_exact"]),
    }
}

/// The best variant and the paper's over their ladders.
fn comparisons(Channel { case, .. }: Channel, accuracy: &Accuracy) -> Vec<Comparison> {
    let exact = (0.0, "exact: the series has the same inputs, and is summed to round-off");
    let compared = |ladder: &&Ladder| [case.best.variant, "seed"].contains(&ladder.variant);
    let of = |ladder| {
        let what = "velocity from νt/L² = 0.1 on, rms";
        Comparison::new(what, "the exact series", L2_WORST, ladder, exact)
    };
    accuracy.ladders.iter().filter(compared).map(of).collect()
}

/// What the report says first of the flow.
fn card(Channel { flow, case }: Channel, accuracy: &Accuracy) -> Card {
    let tau = flow.compared_at();
    let (title, picture) = match flow {
        Flow::Couette => ("Couette flow, Re 0.5", "couette-profiles"),
        Flow::Poiseuille => ("Poiseuille flow, Re 0.5", "poiseuille-profiles"),
    };
    Card {
        title,
        picture: (picture, 0),
        error: format!("velocity at νt/L² = {tau}, relative L2 norm"),
        metric: L2.at(tau),
        runs: accuracy.finest(&[case.best.variant, "seed"]),
        against: "the exact series",
        uncertainty: None,
        reach: ("re", "Re", ""),
    }
}

/// Ladders of the error at the time of the comparison.
fn accuracy(id: &str, flow: Flow, ladders: Vec<Ladder>, re: f64) -> Accuracy {
    let tau = flow.compared_at();
    let label = format!("Relative L2 error of u at νt/L² = {tau} [-]");
    Accuracy {
        spacing: "Δx/L [-]",
        ladders,
        peers: peers(flow, re),
        ..Accuracy::new(id, ErrorOf::Metric(L2.at(tau)), &label)
    }
}

fn of_table(table: &ChannelTable, group: For, variant: &'static str) -> Ladder {
    table.ladder(&[group], variant, |s| (1.0 / s.rows as f64, format!("{} rows", s.rows)))
}

/// The ladders at Re 0.5.
fn at_half(flow: Flow, table: &ChannelTable) -> Accuracy {
    let order = OrderGate {
        id: "poiseuille.plain.order".into(),
        bound: Bound::Within(1.8, 2.2),
        evidence: Evidence::Theory,
        because: "Mirrored walls and the kernel are of second order. Levels whose error is near what the \
                  lattice leaves at any spacing are not in the fit."
            .into(),
    };
    let of = |variant| Ladder {
        order: ((flow, variant) == (Flow::Poiseuille, "plain")).then(|| order.clone()),
        ..of_table(table, For::Ladder, variant)
    };
    Accuracy {
        about: "Runs at Re 0.5 to νt/L² = 1. Of the other codes the plain scalar reimplementation is no \
                package, but a program of this method, written for this comparison."
            .into(),
        ..accuracy(flow.name(), flow, ladder(flow).map(of).into(), 0.5)
    }
}

fn like_peers(table: &ChannelTable) -> Accuracy {
    let of = |(variant, note): (_, &str)| Ladder {
        note: note.into(),
        ..of_table(table, For::Peers, variant)
    };
    let ladders = [("plain", ", h/dx 1"), ("curved", ", h/dx 0.9")].map(of).into();
    let about = "Poiseuille flow at Re 0.0125, as most other codes were timed, run to νt/L² = 1.";
    let like = accuracy("poiseuille-like-peers", Flow::Poiseuille, ladders, PEERS_RE);
    Accuracy { about: about.into(), ..like }
}

/// Other codes at this Reynolds number, with their error at the time nearest to that of ours: νt/L² =
/// 0.1125 in Couette flow, 1 in Poiseuille flow. None if the reference cannot be read.
fn peers(flow: Flow, re: f64) -> Vec<Peer> {
    let (column, at) = match flow {
        Flow::Couette => ("error_0.1125s", "; error at νt/L² = 0.1125"),
        Flow::Poiseuille => ("error_1s", ""),
    };
    let is_like = |table: &Table| {
        let (cases, reynolds) = (table.texts("case")?, table.optional("reynolds")?);
        let both = cases.iter().zip(&reynolds);
        Ok(both.map(|(case, of)| *case == flow.name() && *of == Some(re)).collect())
    };
    let timed = format!("wall time, one thread of a similar machine, 2025–26{at}");
    let label = |rows: f64| format!("{rows} rows");
    peers::peers("peers_channel", ["rows", column], label, &timed, is_like).unwrap_or_default()
}

/// Times that fit into a figure.
const SHOWN: [f64; 5] = [0.02, 0.05, 0.1, 0.2, 1.0];

fn curves(channel: Channel) -> Curves {
    let flow = channel.flow;
    let best = if flow == Flow::Couette { "plain" } else { "curved" };
    let exact = |tau: f64| {
        let points =
            (0..=100).map(|k| f64::from(k) / 100.0).map(|y| (flow.exact(y, tau, [1.0; 3]), y));
        (String::new(), points.collect())
    };
    let panel = |variant: &str| CurvePanel {
        title: variant.into(),
        x: Axis::linear("u/V [-]"),
        y: Axis::linear("y/L [-]"),
        lines: lines(channel, variant),
        references: SHOWN.map(exact).into(),
        symbols: true,
    };
    Curves {
        id: format!("{}-profiles", flow.name()),
        title: "Velocity profiles".into(),
        caption: format!(
            "Velocity u along the channel at five times, Re 0.5, 20 rows of particles, for variants `seed` \
             (left) and `{best}` (right). Symbols are means over a row, and lines the exact series."
        ),
        columns: 2,
        panels: vec![panel("seed"), panel(best)],
    }
}

/// u/V across the channel at the times of the figure.
fn lines(channel: Channel, variant: &str) -> Vec<CurveOf> {
    let line = |tau: f64| CurveOf {
        name: format!("νt/L² = {tau}"),
        spec: channel.case.spec(variant, |s| s.rows = 20),
        points: Box::new(move |record: &Record| {
            let settings: ChannelSettings = record.settings_as();
            let [u, y] = ["u", "y"].map(|name| record.column(&profile_at(tau), name));
            let point = |(u, y): (&f64, &f64)| (u / settings.speed(), y / settings.width);
            u.iter().zip(y).map(point).collect()
        }),
    };
    SHOWN.map(line).into()
}

fn budgets(channel: Channel, accuracy: &Accuracy, tier: Tier) -> Budgets {
    let variants: &[&str] = match (tier, channel.flow) {
        (Tier::Quick, _) => &["seed"],
        (_, Flow::Couette) => &["seed", "plain"],
        (_, Flow::Poiseuille) => &["seed", "plain", "curved"],
    };
    let of = |variant: &&'static str| Budget { variant, changes: changes(channel, variant, tier) };
    let about = "Runs have 20 rows and Re 0.5.".into();
    Budgets { about, ..Budgets::of(accuracy, variants.iter().map(of).collect()) }
}

fn changes(Channel { flow, case }: Channel, variant: &'static str, tier: Tier) -> Vec<Change> {
    let spec = |set: &dyn Fn(&mut ChannelSettings)| case.spec(variant, set);
    // Of a variant that has no rules every run is refused, and its record says why.
    let rules = case.rules(&spec(&|_| ())).unwrap_or(Rules::REFUSED);
    let (dt, stiffer) = (rules.dt(), 2.0 * rules.sound_speed);
    let (wall, other, ratio, eta2) = match variant {
        "seed" => ("interface and wall particles", "interface-wall", 1.5, 1e-5),
        _ => ("wall particles that extrapolate", "extrapolating-wall", 1.3, 1e-9),
    };
    let stiffer = spec(&|s| (s.c0, s.dt) = (Some(stiffer), Some(0.25 * dt)));
    let mut changes = vec![
        Change::new("none", "–", spec(&|_| ())),
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
    if tier == Tier::Full {
        changes.push(Change::new("40 rows", "spacing: wall and kernel", spec(&|s| s.rows = 40)));
    }
    if flow == Flow::Poiseuille {
        let curved = spec(&|s| s.wall_curvature = variant != "curved");
        changes.push(Change::new("curvature in the ghosts on/off", "wall", curved));
    }
    changes
}
