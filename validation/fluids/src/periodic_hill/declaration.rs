//! What the studies that every case has are made of: profiles and shear over finite elements, order, error
//! against run time, error budget, largest stable time step, errors of constants that gates must detect.

use nalgebra::Vector2;

use super::{
    BEST, CASE, HillSettings, NAME, SINGLE_SWEEP,
    measure::{FORCE_ERROR, L2_U, L2_V, POINTS, REATTACHMENT_ERROR, SEPARATION_ERROR, STATIONS},
    plan::{For, Row, STABLE, Table, flow, name, shown, table},
    reference::{REYNOLDS, Reference, floor, reference},
};
use base::{
    gate::{Bound, Evidence, Gate},
    mutation::Constant,
    record::{Record, Status},
    reference::Reference as Data,
};
use harness::{
    case::{Case, Rules, Tier},
    declare::{
        Accuracy, Budget, Budgets, Card, Change, Comparison, CurveOf, CurvePanel, Curves,
        Declaration, ErrorOf, OrderGate, Sensitivity, StepLimit, StepLimits, Watched,
    },
    studies::causes::{ENOUGH_OR_IDLE, NOT_MEASURED, SAFETY_MARGIN, STEP, WIDE_BOUNDS},
};
use report::Axis;

/// The declaration of a tier.
pub fn declaration(tier: Tier) -> Declaration {
    let table = table(tier);
    let accuracy = accuracy(tier, &table);
    Declaration {
        card: Some(card(tier, &accuracy)),
        comparisons: comparisons(tier, &accuracy),
        curves: vec![profiles(&table)],
        budgets: Some(budgets(tier, &accuracy)),
        accuracy: vec![accuracy],
        limits: Some(limits(tier)),
        sensitivity: Some(sensitivity(tier, &table)),
        ..Declaration::default()
    }
}

/// The best variant and the paper's over their ladders: at Re 10 in the quick tier, where nothing separates.
fn comparisons(tier: Tier, accuracy: &Accuracy) -> Vec<Comparison> {
    const BECAUSE: &str = "computed for the same inputs; u_D: meshes (`references/periodic_hill`)";
    let re = if tier == Tier::Quick { 10.0_f64 } else { 50.0 };
    let of =
        |name| Data::summarised("periodic_hill", &[("re", &re.to_string()), ("quantity", name)]);
    let profiles = reference(re).map_or(f64::NAN, |reference| reference.uncertainty);
    let [force, force_uncertainty] = of("force");
    let mut all = vec![
        ("u, rms [U_b]", L2_U, profiles),
        ("v, rms [U_b]", L2_V, profiles),
        ("driving force", FORCE_ERROR, force_uncertainty / force),
    ];
    if re > 10.0 {
        all.push(("separation [H]", SEPARATION_ERROR, of("separation")[1]));
        all.push(("reattachment [H]", REATTACHMENT_ERROR, of("reattachment")[1]));
    }
    let ladder =
        accuracy.ladders.iter().filter(|of| [BEST, "interface-wall"].contains(&of.variant));
    let comparison = |ladder| {
        let of = move |(what, metric, uncertainty)| {
            Comparison::new(what, "finite elements", metric, ladder, (uncertainty, BECAUSE))
        };
        all.clone().into_iter().map(of)
    };
    ladder.flat_map(comparison).collect()
}

/// What the report says first of the case.
fn card(tier: Tier, accuracy: &Accuracy) -> Card {
    // The picture is of Re 50: the only one of the quick tier, the second one of the full tier.
    let (re, panel) = if tier == Tier::Quick { (10.0, 0) } else { (50.0, 1) };
    Card {
        title: "Periodic hill",
        picture: ("periodic-hill-pictures", panel),
        error: format!("velocity at ten stations at Re {re}, rms in U_b"),
        metric: L2_U.into(),
        runs: accuracy.finest(&[BEST, "interface-wall"]),
        against: "finite elements",
        uncertainty: reference(re).map(|reference| reference.uncertainty),
        reach: ("re", "Re", ""),
    }
}

/// Runs from rest alone: those from the reference end before they could leave it.
fn accuracy(tier: Tier, table: &Table) -> Accuracy {
    let about = "Flow over periodic hills at Re 50 after 40 H/U_b, against finite elements at ten stations. \
                 In the quick tier at Re 10 after 10 H/U_b, when 0.3 % of U_b is left of the start.";
    let level = |s: &HillSettings| (1.0 / s.n as f64, format!("H/dx = {}", s.n));
    let variants = STABLE.into_iter().chain((tier == Tier::Full).then_some(SINGLE_SWEEP));
    let mut ladders: Vec<_> =
        variants.map(|variant| table.ladder(&[For::Ladder], variant, level)).collect();
    for ladder in ladders.iter_mut().filter(|of| of.variant == BEST && tier == Tier::Full) {
        ladder.order = Some(OrderGate {
            id: format!("{NAME}.{BEST}.50.order"),
            bound: Bound::Above(1.0),
            evidence: Evidence::Theory,
            because: "Walls are of first order on disordered particles, sums of second.".into(),
        });
    }
    Accuracy {
        about: about.into(),
        spacing: "dx/H [-]",
        slope: Some(1.0),
        ladders,
        ..Accuracy::new("periodic-hill", ErrorOf::Metric(L2_U.into()), "rms error of u [U_b]")
    }
}

/// One thing changed at a time; the quick tier has the first five.
fn budgets(tier: Tier, accuracy: &Accuracy) -> Budgets {
    let base = if tier == Tier::Quick { (10.0, 5, 10.0, false) } else { (50.0, 10, 40.0, false) };
    let about = "Runs from rest at Re 50, H/dx = 10, in the quick tier at Re 10, H/dx = 5. A change smaller \
                 than that by the start is within the effect of disorder.";
    let change = |what, part, variant, set: fn(&mut HillSettings)| {
        let mut settings = CASE.chosen(variant, |s| flow(s, base));
        set(&mut settings);
        Change::new(what, part, CASE.spec_of(variant, &settings))
    };
    let finer: fn(&mut HillSettings) = |s| s.n = if s.n == 5 { 7 } else { 20 };
    let mut changes = vec![
        change("none", "none", BEST, |_| {}),
        change("finer spacing", "spacing", BEST, finer),
        change("dt/2", "time", BEST, |s| s.courant = 0.75),
        change("c0=30", "sound speed", BEST, |s| s.c0 = 30.0),
        change("h_over_dx=1.2", "h/dx", BEST, |s| s.h_over_dx = 1.2),
        change("diffusion=0.05", "density diffusion", BEST, |s| s.diffusion = 0.05),
        change("shift=1.5", "shifting", BEST, |s| s.shift = 1.5),
        change("from the reference", "start", BEST, |s| s.from_reference = true),
        change("`consistent`: sums exact for linear fields", "sums", "consistent", |_| {}),
        change("`modern`: weaker shifting, no velocities", "shifting", "modern", |_| {}),
        change("`interface-wall` over `modern`", "wall", "interface-wall", |_| {}),
    ];
    // The walls are compared with those of `modern`, before it in the list.
    changes[10].against = 9;
    changes.truncate(if tier == Tier::Quick { 5 } else { changes.len() });
    let of = vec![Budget { variant: BEST, changes }];
    Budgets { about: about.into(), ..Budgets::of(accuracy, of) }
}

/// A curve of a run.
fn curve(
    name: String,
    row: &Row,
    points: impl Fn(&Record) -> Vec<(f64, f64)> + Send + Sync + 'static,
) -> CurveOf {
    CurveOf { name, spec: row.run.spec.clone(), points: Box::new(points) }
}

/// Profiles at their stations, symbols on lines, and shear along the hill.
fn profiles(table: &Table) -> Curves {
    let caption = "Velocities u along the channel and v across it at ten stations: lines are finite \
                   elements, symbols the finest run of variant `carried`. A velocity is drawn from the \
                   place of its station. Right: shear stress on the hill at several spacings and of finite \
                   elements (black), negative where the flow goes backwards.";
    let mut panels = Vec::new();
    for re in REYNOLDS {
        let rows = shown(table, re);
        let Some((finest, reference)) = rows.last().zip(reference(re)) else { continue };
        panels.push(profile(finest, reference, "u", 0.8, |v| v.x));
        panels.push(profile(finest, reference, "v", 2.5, |v| v.y));
        panels.push(shear(&rows, reference));
    }
    let (id, title) = ("periodic-hill-profiles".into(), "Profiles over finite elements".into());
    Curves { id, title, caption: caption.into(), columns: 3, panels }
}

/// One component of the velocity.
fn profile(
    row: &Row,
    reference: &Reference,
    component: &'static str,
    scale: f64,
    exact: fn(&Vector2<f64>) -> f64,
) -> CurvePanel {
    // Every tenth point of a station.
    let points = move |record: &Record, k: usize| {
        let [x, y, v] = ["x", "y", component].map(|name| record.column("stations", name));
        let points = (k * POINTS + 5..((k + 1) * POINTS).min(v.len())).step_by(10);
        points.map(|j| (x[j] + scale * v[j], y[j])).collect()
    };
    let line = |k| curve(String::new(), row, move |record| points(record, k));
    let exact = reference.stations.iter().map(|station| {
        let at = |(y, v): (&f64, &Vector2<f64>)| (station.x + scale * exact(v), *y);
        (String::new(), station.y.iter().zip(&station.v).map(at).collect())
    });
    CurvePanel {
        title: format!("Re {}, {}: {component}", row.settings.re, name(row)),
        x: Axis::linear(format!("x/H + {scale} {component}/U_b")),
        y: Axis::linear("y/H").range(0.0, 3.1),
        lines: (0..STATIONS.len()).map(line).collect(),
        references: exact.chain([(String::new(), floor())]).collect(),
        symbols: true,
    }
}

/// Shear stress along the hill.
fn shear(rows: &[&Row], reference: &Reference) -> CurvePanel {
    let points = |record: &Record| {
        let [x, y] = ["x", "hill shear"].map(|name| record.column("wall", name).iter().copied());
        x.zip(y).collect()
    };
    let exact = reference.wall.iter().map(|w| (w[0], w[1])).collect();
    CurvePanel {
        title: format!("Re {}: shear on the hill", rows[0].settings.re),
        x: Axis::linear("x/H"),
        y: Axis::linear("shear stress [ρ U_b²]"),
        lines: rows.iter().map(|row| curve(name(row), row, points)).collect(),
        references: vec![("finite elements".into(), exact)],
        symbols: false,
    }
}

/// Ended, and no sample of the kinetic energy is above twice that of the first one after the start, which is
/// near the answer.
pub fn is_stable(record: &Record) -> bool {
    let energy = record.column("series", "kinetic energy").get(1..).unwrap_or_default();
    let bounded = |first: &f64| energy.iter().all(|e| *e <= 2.0 * first);
    record.status == Status::Completed && energy.first().is_some_and(bounded)
}

/// The longest stable step over the theoretical one, by bisection: in the full tier of one variant each with
/// sums over pairs, with shifted velocities and with consistent sums.
fn limits(tier: Tier) -> StepLimits {
    let (n, variants): (usize, &[&'static str]) = match tier {
        Tier::Quick => (5, &[BEST]),
        _ => (10, &["modern", BEST, "consistent"]),
    };
    let about = "The longest time step with which the flow at Re 50 goes on for 3 H/U_b from the reference \
                 without diverging or doubling its kinetic energy, by bisection, over the limit of linear \
                 theory for a lattice at rest, which has no walls, no curvature and no disorder.";
    StepLimits::new("periodic-hill", about, variants.iter().map(|variant| limit(variant, n)))
}

/// The bisection of a variant with its gates.
fn limit(variant: &'static str, n: usize) -> StepLimit {
    let spec = CASE.spec(variant, |s| flow(s, (50.0, n, 3.0, true)));
    let rules = CASE.rules(&spec).unwrap_or(Rules::REFUSED);
    // The step is proportional to the Courant number: the viscous limit is ten times as far at Re 50.
    let default = rules.dt() / rules.dt_limit();
    let at_limit = ("courant", HillSettings::default().courant / default);
    let scene = format!("Re 50, H/dx = {n}");
    let gate = |what: &str, metric: &str, bound, evidence, because: &str| {
        Gate::new(format!("{NAME}.step.{variant}.{what}"), metric, bound, evidence, because)
    };
    let theory = "The default step is stable, and disorder makes neither sound slower nor the stencil \
                  softer by a fifth.";
    let margin =
        "The bound was measured when this study was introduced, less the resolution of 2 %.";
    let (bound, longest) = (Bound::Within(default, 1.2), Bound::Above(1.577 - 0.02 / default));
    let metric = "longest stable dt/default dt";
    StepLimit {
        of_theory: vec![gate("theory", "measured/theory", bound, Evidence::Theory, theory)],
        of_default: vec![gate("margin", metric, longest, Evidence::Regression, margin)],
        ..StepLimit::proportional(variant, &scene, spec, at_limit, &rules)
    }
}

const BOUNDS: &str = "The error of the method at ten spacings a hill takes up most of the bounds.";
const CONTROLLED: &str = "A controller sets the force, whatever force it begins with.";
const STRESS: &str = "No gate judges a stress in Pa. Beyond 30 % the density ends the run.";
const SOUND: &str = "Compressibility changes the velocity by less than the spacing does.";
const REACH: &str =
    "Sums hold for any reach, whose error is inside the bounds at ten spacings a hill.";
const DISORDER: &str =
    "Particles stay evenly spread with 30 % less or more of it, and not without.";

/// Errors of constants that the gates of the cheapest judged run must detect.
fn sensitivity(tier: Tier, table: &Table) -> Sensitivity {
    let watched = [
        Watched::blind_up_to(Constant::Viscosity, 0.1, BOUNDS, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::BodyForce, 1.0, CONTROLLED, &NOT_MEASURED),
        Watched::new(Constant::Height),
        Watched::blind_up_to(Constant::Density, 0.3, STRESS, &NOT_MEASURED),
        Watched::blind_up_to(Constant::SoundSpeed, 1.0, SOUND, &NOT_MEASURED),
        Watched::new(Constant::Normalisation),
        Watched::blind_up_to(Constant::SmoothingLength, 1.0, REACH, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::TimeStep, 1.0, STEP, &SAFETY_MARGIN),
        Watched::blind_up_to(Constant::DensityDiffusion, 1.0, DISORDER, &ENOUGH_OR_IDLE),
        Watched::blind_up_to(Constant::Shifting, 1.0, DISORDER, &ENOUGH_OR_IDLE).faults(&[0.0]),
    ];
    let run = shown(table, 10.0).into_iter().take(1).map(|row| row.run.spec.clone());
    Sensitivity::new(NAME, tier, run, watched)
}
