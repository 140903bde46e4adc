//! What the studies that every case has are made of: profiles and shear over finite elements, order, error
//! against run time, error budget, largest stable time step.

use nalgebra::Vector2;

use super::{
    BEST, HillSettings, NAME, VARIANTS,
    measure::{L2_U, POINTS, STATIONS},
    plan::{HillRun, REYNOLDS, best},
    reference::{Reference, Station, floor, reference, uncertainty},
    sensitivity, stability,
};
use base::{
    gate::{Bound, Evidence},
    record::Record,
};
use harness::{
    case::Tier,
    declare::{
        Accuracy, Budget, Budgets, Card, Change, CurveOf, CurvePanel, Curves, Declaration, ErrorOf,
        Ladder, Level, OrderGate,
    },
};
use report::Axis;

const ERROR: &str = "rms error of u [U_b]";

/// The declaration of a tier.
pub fn declaration(tier: Tier) -> Declaration {
    let accuracy = accuracy(tier);
    Declaration {
        card: Some(card(tier, &accuracy)),
        curves: vec![profiles(tier), shear(tier)],
        budgets: Some(budgets(tier, &accuracy)),
        accuracy: vec![accuracy],
        limits: Some(stability::limits(tier)),
        sensitivity: Some(sensitivity::sensitivity(tier)),
        maps: Vec::new(),
        ..Declaration::default()
    }
}

/// What the report says first of the case.
fn card(tier: Tier, accuracy: &Accuracy) -> Card {
    // The picture is of Re 50: the only one of the quick tier, the second one of the full tier.
    let (re, panel) = match tier {
        Tier::Quick => (10.0, 0),
        Tier::Full => (50.0, 1),
    };
    Card {
        title: "Periodic hill",
        picture: ("periodic-hill-pictures", panel),
        error: format!("velocity at ten stations at Re {re}, rms in U_b"),
        metric: L2_U.into(),
        runs: accuracy.finest(&[BEST, "interface-wall"]),
        against: "finite elements",
        uncertainty: uncertainty(re),
        reach: ("re", "Re", ""),
    }
}

/// A run of the quick tier's ladder and budget: at Re 10 the decay is the fastest.
fn quick(variant: &'static str, n: usize) -> HillRun {
    HillRun { re: 10.0, end: 10.0, ..HillRun::rest(variant, n) }
}

fn ladder<const N: usize>(runs: [HillRun; N]) -> Ladder {
    let level = |run: HillRun| Level {
        run: run.planned(),
        spacing: 1.0 / run.n as f64,
        label: format!("H/dx = {}", run.n),
    };
    Ladder::new(runs[0].variant, runs.map(level))
}

fn accuracy(tier: Tier) -> Accuracy {
    let (about, ladders) = match tier {
        Tier::Quick => (
            "Flow over periodic hills at Re 10 after 10 H/U_b, against finite elements at ten stations. \
             About 0.3 % of U_b is left of the start from rest.",
            ["interface-wall", "modern", BEST]
                .map(|variant| ladder([4, 5, 7].map(|n| quick(variant, n))))
                .into(),
        ),
        Tier::Full => (
            "Flow over periodic hills at Re 50, steady after 40 H/U_b, against finite elements at ten \
             stations.",
            VARIANTS.map(full_ladder).into(),
        ),
    };
    let accuracy = Accuracy::new("periodic-hill", ErrorOf::Metric(L2_U.into()), ERROR);
    Accuracy { about: about.into(), spacing: "dx/H [-]", slope: Some(1.0), ladders, ..accuracy }
}

/// Runs from rest alone: those from the reference end before they could leave it.
fn full_ladder(variant: &'static str) -> Ladder {
    if variant != BEST {
        return ladder([4, 5, 7, 10].map(|n| HillRun::rest(variant, n)));
    }
    let order = OrderGate {
        id: format!("{NAME}.{BEST}.50.order"),
        bound: Bound::Above(1.0),
        evidence: Evidence::Theory,
        because: "The walls are of first order on disordered particles, and their sums of second. The goal \
                  of 2 % at 20 spacings and 1 % at 40 is first order."
            .into(),
    };
    Ladder { order: Some(order), ..ladder([4, 5, 7, 10, 20].map(|n| HillRun::rest(BEST, n))) }
}

/// Changes a setting.
type Set = fn(&mut HillSettings);

/// What a budget changes, one thing at a time: in words, part of the error, setting. In the quick tier the
/// first three.
const CHANGES: [(&str, &str, Set); 5] = [
    ("dt/2", "time", |s| s.courant = 0.75),
    ("c0=30", "sound speed", |s| s.c0 = 30.0),
    ("h_over_dx=1.2", "h/dx", |s| s.h_over_dx = 1.2),
    ("diffusion=0.05", "density diffusion", |s| s.diffusion = 0.05),
    ("shift=1.5", "shifting", |s| s.shift = 1.5),
];

fn budgets(tier: Tier, accuracy: &Accuracy) -> Budgets {
    let (about, base, finer, settings) = match tier {
        Tier::Quick => {
            let about = "Re 10, H/dx = 5 and 7, from rest to 10 H/U_b.";
            (about, quick(BEST, 5), quick(BEST, 7), &CHANGES[..3])
        }
        Tier::Full => (
            "Re 50, H/dx = 10 and 20, from rest. A change smaller than that by the start is within the \
             effect of disorder.",
            HillRun::rest(BEST, 10),
            HillRun::rest(BEST, 20),
            &CHANGES[..],
        ),
    };
    let change = |what, part, run: HillRun| Change::new(what, part, run.spec());
    let mut changes = vec![change("none", "none", base), change("finer spacing", "spacing", finer)];
    let changed = settings.iter().map(|&(what, part, set)| (what, part, base.changed(set)));
    changes.extend(changed.map(|(what, part, spec)| Change::new(what, part, spec)));
    if tier == Tier::Full {
        let other = |variant| HillRun { variant, ..base };
        let from_reference = HillRun { from_reference: true, ..base };
        changes.extend([
            change("from the reference", "start", from_reference),
            change("`mixed`: consistent pressure and continuity", "sums", other("mixed")),
            change("`consistent`: viscosity too", "sums", other("consistent")),
            change("`modern`: weaker shifting, no velocities", "shifting", other("modern")),
        ]);
        let against = changes.len() - 1;
        let wall = change("`interface-wall` over `modern`", "wall", other("interface-wall"));
        changes.push(Change { against, ..wall });
    }
    let budget = Budget { variant: BEST, changes };
    Budgets { about: about.into(), ..Budgets::of(accuracy, vec![budget]) }
}

/// Profiles at their stations, symbols on lines.
fn profiles(tier: Tier) -> Curves {
    let caption = "Velocity u along the channel (left) and v across it (middle) at ten stations: lines are \
                   finite elements, symbols the finest run of variant `carried`. A velocity is drawn from \
                   the place of its station, where 1 H stands for 1.25 U_b of u or 0.4 U_b of v. Right: \
                   error of u, magnified.";
    let mut panels = Vec::new();
    for re in REYNOLDS {
        if let Some((run, reference)) = best(tier, re).last().zip(reference(re)) {
            panels.push(profile(run, &reference, "u", 0.8, |v| v.x));
            panels.push(profile(run, &reference, "v", 2.5, |v| v.y));
            panels.push(errors(run, &reference));
        }
    }
    let (id, title) = ("periodic-hill-profiles".into(), "Profiles over finite elements".into());
    Curves { id, title, caption: caption.into(), columns: 3, panels }
}

/// Error of u over the stations.
fn errors(run: &HillRun, reference: &Reference) -> CurvePanel {
    // At 40 spacings in H errors are below 1 %.
    let scale = if run.n >= 40 { 50.0 } else { 10.0 };
    let line = |(k, station): (usize, &Station)| {
        let station = station.clone();
        CurveOf {
            name: String::new(),
            spec: run.spec(),
            points: Box::new(move |record| {
                let found = record.column("stations", "u").iter().skip(k * POINTS);
                let exact = station.v.iter().zip(&station.y);
                let point = |(u, (exact, y)): (&f64, (&Vector2<f64>, &f64))| {
                    (station.x + scale * (u - exact.x), *y)
                };
                found.zip(exact).map(point).collect()
            }),
        }
    };
    let at_stations = reference.stations.iter().map(|s| {
        let end = |y: Option<&f64>| (s.x, y.copied().unwrap_or(f64::NAN));
        (String::new(), vec![end(s.y.first()), end(s.y.last())])
    });
    CurvePanel {
        title: format!("Re {}, {}: error of u", run.re, run.name()),
        x: Axis::linear(format!("x/H + {scale} (u − u of finite elements)/U_b")),
        y: Axis::linear("y/H").range(0.0, 3.1),
        lines: reference.stations.iter().enumerate().map(line).collect(),
        references: at_stations.chain([(String::new(), floor())]).collect(),
        symbols: false,
    }
}

/// One component of the velocity.
fn profile(
    run: &HillRun,
    reference: &Reference,
    name: &'static str,
    scale: f64,
    component: fn(&Vector2<f64>) -> f64,
) -> CurvePanel {
    let line = |k: usize| CurveOf {
        name: String::new(),
        spec: run.spec(),
        points: Box::new(move |record| station(record, k, name, scale)),
    };
    let exact = reference.stations.iter().map(|station| {
        let at = |(y, v): (&f64, &Vector2<f64>)| (station.x + scale * component(v), *y);
        (String::new(), station.y.iter().zip(&station.v).map(at).collect())
    });
    CurvePanel {
        title: format!("Re {}, {}: {name}", run.re, run.name()),
        x: Axis::linear(format!("x/H + {scale} {name}/U_b")),
        y: Axis::linear("y/H").range(0.0, 3.1),
        lines: (0..STATIONS.len()).map(line).collect(),
        references: exact.chain([(String::new(), floor())]).collect(),
        symbols: true,
    }
}

/// Every tenth point of the k-th station.
fn station(record: &Record, k: usize, name: &str, scale: f64) -> Vec<(f64, f64)> {
    let [x, y, values] = ["x", "y", name].map(|name| record.column("stations", name));
    let points = (k * POINTS + 5..((k + 1) * POINTS).min(values.len())).step_by(10);
    points.map(|j| (x[j] + scale * values[j], y[j])).collect()
}

/// Shear stress along hill and lid.
fn shear(tier: Tier) -> Curves {
    let caption = "Shear stress over ρ U_b² on the hill (left) and on the lid (right), variant `carried` \
                   at several spacings and finite elements (black). Where it is negative the flow goes \
                   backwards; the crests are at x = 0 and 9 H.";
    let mut panels = Vec::new();
    for re in REYNOLDS {
        let runs = best(tier, re);
        let Some(reference) = reference(re).filter(|_| !runs.is_empty()) else { continue };
        for (name, k) in [("hill shear", 1), ("lid shear", 2)] {
            let line = |run: &HillRun| CurveOf {
                name: run.name(),
                spec: run.spec(),
                points: Box::new(move |record| wall(record, name)),
            };
            let exact = reference.wall.iter().map(|w| (w[0], w[k])).collect();
            panels.push(CurvePanel {
                title: format!("Re {re}: {name}"),
                x: Axis::linear("x/H"),
                y: Axis::linear("shear stress [ρ U_b²]"),
                lines: runs.iter().map(line).collect(),
                references: vec![("finite elements".into(), exact)],
                symbols: false,
            });
        }
    }
    let (id, title) = ("periodic-hill-shear".into(), "Shear along the walls".into());
    Curves { id, title, caption: caption.into(), columns: 2, panels }
}

fn wall(record: &Record, name: &str) -> Vec<(f64, f64)> {
    let [x, y] = ["x", name].map(|name| record.column("wall", name).iter().copied());
    x.zip(y).collect()
}
