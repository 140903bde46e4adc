//! Studies of the case: profiles and shear against finite elements, order, error against run time, error
//! budget, largest stable time step, errors of constants that gates must detect; and for hills only: whether
//! the start matters.

use touchstone_base::{mutation::Constant, record::Status, spec::RunSpec};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::{Drawn, Draws, Parameter, Planned, Statement},
    runs::Runs,
    section::Section,
    studies::{
        Accuracy, Breaks, Budgets, Card, Change, Comparison, Comparisons, CurveOf, CurvePanel,
        Curves, CustomStudy, Heading, OF_THEORY, ORDER, Picture, PicturePanel, Sensitivity,
        Spacing, Stated, StepLimit, StepLimits, Study, Watched,
        causes::{ENOUGH_OR_IDLE, NOT_MEASURED, SAFETY_MARGIN, STEP, STRESS, WIDE_BOUNDS},
    },
};
use touchstone_maths::metrics::{history::differences, norms::rms};
use touchstone_report::{Axis, ColourMap, percent};

use super::{
    CASE, HillSettings, NAME, RECOMMENDED, columns,
    measure::{
        ALL, DRAG_BALANCE, FORCE, FORCE_ERROR, L2_U, L2_V, OUTSIDE, POINTS, REATTACHMENT_ERROR,
        SEPARATION_ERROR,
    },
    plan::{END, Group, Row, Table, flow, name, shown, table},
    reference::{HillReference, REYNOLDS, Station, bubble, floor, reference, summary},
    run::FLUX,
};

/// The finite elements are of the Reynolds numbers that are judged. A run that goes on for longer is as near.
const SEALED: Draws = Draws {
    others: &[("re", Drawn::Judged)],
    free: &["end"],
    ..Draws::new(&["carried"], ("n", [8.0, 11.0]), 1.0, &["l2_u", "force_error"])
};

/// The studies of a tier.
pub fn studies(tier: Tier) -> Studies {
    let table = table(tier);
    let accuracy = accuracy(tier, &table);
    let (card, comparisons) = (card(tier, &accuracy), comparisons(tier, &accuracy));
    let budgets = (tier == Tier::Full).then(|| budgets(&accuracy));
    Studies::judging(table.plan())
        .with_all(starts(&table))
        .with(profiles(&table))
        .with(picture(&table))
        .with(accuracy)
        .with(comparisons)
        .with_all(budgets)
        .with(limits(tier))
        .with(sensitivity(tier, &table))
        .with(card)
}

/// The facts of the case.
pub fn facts() -> Facts {
    let boundary = "No slip: at the hill and at the lid the velocity is 0. Nothing passes them. x is \
                    periodic.";
    let statement = Statement { further: Some(drive), ..Statement::new(boundary, &[ALL]) };
    Facts {
        statement,
        // The force of our own controller; no file of another code contains one.
        stepwise: &[FORCE, FORCE_ERROR, DRAG_BALANCE],
        is_stable: Some(is_stable),
        sealed: Some(SEALED),
        ..Facts::default()
    }
}

/// Drive of the flow: the requested flux.
fn drive(run: &RunSpec) -> Vec<Parameter> {
    let settings: HillSettings = run.settings_as();
    let flux = "the flux of volume through every section, the integral of u over y from the hill to the \
                lid, that the force keeps: 2.035 U_b H times the setting `flux`, U_b = 1 m/s the mean \
                velocity over the crest and H = 1 m the height of the hill";
    let force = "at the start, of the acceleration f(t) along x, uniform over the fluid: dv/dt = -(1/ρ) ∇p \
                 + ν ∇²v + (f, 0). Any f(t) that leads to this flux is allowed, because the steady flow \
                 has one force";
    let response = "T of our controller: f' = ((u* - u)/T - u')/(T/4), u the mean of the velocity along x \
                    over the fluid, u* that of the flux, looked at every ten steps; 0 keeps the force";
    vec![
        Parameter { name: "flux", value: settings.flux * FLUX, unit: "m^2/s", about: flux },
        Parameter { name: "force", value: settings.force, unit: "m/s^2", about: force },
        Parameter { name: "response", value: settings.response, unit: "s", about: response },
    ]
}

/// The recommended variant and the paper's over their ladders: at Re 10 in the quick tier, where nothing
/// separates.
fn comparisons(tier: Tier, accuracy: &Accuracy) -> Comparisons {
    const BECAUSE: &str = "computed for the same inputs; u_D: meshes (`references/periodic_hill`)";
    let re = if tier == Tier::Quick { 10.0_f64 } else { 50.0 };
    let profiles = reference(re).map_or(f64::NAN, |reference| reference.uncertainty);
    let force = summary(re, "force");
    let mut all = vec![
        ("u, rms [U_b]", L2_U, profiles),
        ("v, rms [U_b]", L2_V, profiles),
        ("driving force", FORCE_ERROR, force.uncertainty / force.value),
    ];
    if re > 10.0 {
        all.push(("separation [H]", SEPARATION_ERROR, summary(re, "separation").uncertainty));
        all.push(("reattachment [H]", REATTACHMENT_ERROR, summary(re, "reattachment").uncertainty));
    }
    let ladder =
        accuracy.ladders.iter().filter(|of| [RECOMMENDED, "interface-wall"].contains(&of.variant));
    let comparison = |ladder| {
        let of = move |(what, metric, uncertainty)| {
            Comparison::new(what, "finite elements", metric, ladder, (uncertainty, BECAUSE))
        };
        all.clone().into_iter().map(of)
    };
    Comparisons(ladder.flat_map(comparison).collect())
}

/// Summary of the case in the report, at Re 50, where the flow separates: the ladder of the quick tier is at
/// Re 10.
fn card(tier: Tier, accuracy: &Accuracy) -> Card {
    let shown = [RECOMMENDED, "interface-wall"];
    let quick = |variant| CASE.spec(variant, |s| flow(s, (50.0, 10, 30.0, false)));
    let runs = if tier == Tier::Quick { shown.map(quick).into() } else { accuracy.finest(&shown) };
    Card {
        title: "Periodic hill",
        picture: "periodic-hill-pictures",
        pictured_scene: "",
        metric: L2_U.into(),
        stated: |run| {
            let settings: HillSettings = run.settings_as();
            let name =
                "velocity at ten stations at Re {re} and t = {end} H/U_b{left}, {n} spacings a \
                        hill, rms in U_b"
                    .replace("{left}", &left_of_start(&settings));
            let uncertainty = reference(settings.re).map(|of| of.uncertainty);
            Stated { uncertainty, ..Stated::new(run, &name, "finite elements") }
        },
        beside: None,
        runs,
        breaks: Breaks {
            value: |run| run.settings_as::<HillSettings>().re,
            words: ["Re ", ""],
            has_broken: |record| Some(record.value(OUTSIDE).is_some_and(|count| count > 0.0)),
            sign: "a particle has passed a wall",
        },
    }
}

/// How far a run from rest is from the steady flow that it is compared with, if that is more than a twentieth
/// of the flow: transients decay by 0.11 U_b/H at Re 50, and five times as fast at Re 10.
fn left_of_start(s: &HillSettings) -> String {
    let left = touchstone_base::functions::exp(-5.5 * s.end / s.re);
    match s.from_reference {
        false if left > 0.05 => {
            format!(" (not steady: about {} of the start from rest is left)", percent(left, 1))
        }
        _ => String::new(),
    }
}

/// Runs from rest only: runs from the reference end before they could leave it.
fn accuracy(tier: Tier, table: &Table) -> Accuracy {
    let spacing = Spacing::count(|s: &mut HillSettings| &mut s.n, "H/dx = {}");
    let variants = ["interface-wall", RECOMMENDED, "modern", "consistent"];
    let mut ladders = table.ladders(&[Group::Ladder], &variants, spacing);
    let HillSettings { re, end, .. } = ladders[0].levels[0].run.spec.settings_as();
    let rest = if re == 10.0 { ", when 0.3 % of U_b is left of the start" } else { "" };
    let about = format!(
        "Flow over periodic hills at Re {re} after {end} H/U_b{rest}, against finite elements at ten \
         stations."
    );
    if tier == Tier::Full {
        let because = "Walls are of first order on disordered particles, sums of second.";
        let (id, bound) = (format!("{NAME}.{RECOMMENDED}.50.order"), Bound::Above(1.0));
        if let Some(ladder) = ladders.iter_mut().find(|ladder| ladder.variant == RECOMMENDED) {
            ladder.order = Some(Gate::new(id, ORDER, bound, Evidence::Theory, because));
        }
    }
    Accuracy {
        about,
        spacing: "dx/H [-]",
        slope: Some(1.0),
        ladders,
        ..Accuracy::new("periodic-hill", L2_U, "error of the velocity [U_b]")
    }
}

/// One thing changed at a time.
const DIFFUSION: &str = "density diffusion";

fn budgets(accuracy: &Accuracy) -> Budgets {
    let about = "Runs from rest at Re 50, H/dx = 10. A change smaller than that by the start is within the \
                 effect of disorder.";
    let usual = |s: &mut HillSettings| flow(s, (50.0, 10, END, false));
    let mut changes = CASE.changes(
        RECOMMENDED,
        usual,
        &[
            ("none", "none", |_| {}),
            ("finer spacing", "spacing", |s| s.n = 20),
            ("dt/2", "time", |s| s.numerics.courant = 0.75),
            ("c0=30", "sound speed", |s| s.c0 = 30.0),
            ("h_over_dx=1.2", "h/dx", |s| s.h_over_dx = 1.2),
            ("diffusion=0.05", DIFFUSION, |s| s.numerics.diffusion = 0.05),
            ("shift=1.5", "shifting", |s| s.numerics.shift = 1.5),
            ("from the reference", "start", |s| s.from_reference = true),
        ],
    );
    for change in changes.iter_mut().filter(|of| of.part == DIFFUSION) {
        change.spec.allow_unstable = true; // below 0.07 it diverges
    }
    let variant = |what, part, variant| Change::new(what, part, CASE.spec(variant, usual));
    changes.push(variant("`consistent`: sums exact for linear fields", "sums", "consistent"));
    changes.push(variant("`modern`: weaker shifting, no velocities", "shifting", "modern"));
    let walls = variant("`interface-wall` over `modern`", "wall", "interface-wall");
    changes.push(Change { against: changes.len() - 1, ..walls });
    Budgets::new(accuracy, about, vec![changes])
}

/// Profiles at their stations, symbols on lines, and shear along the hill.
fn profiles(table: &Table) -> Curves {
    let caption = "Does the flow over the hills follow finite elements? Velocity u at ten stations of the \
                   finest run of `carried`, each drawn from the place of its station, and shear stress on \
                   the hill, negative where the flow goes backwards.";
    let mut panels = Vec::new();
    for re in REYNOLDS {
        let rows = shown(table, re);
        let Some((finest, reference)) = rows.last().zip(reference(re)) else { continue };
        panels.extend([false, true].map(|differs| profile(finest, reference, differs)));
        panels.push(shear(&rows, reference));
    }
    Curves::new("periodic-hill-profiles", "Velocity and shear stress", caption, panels)
}

/// The velocity along the channel, every tenth point of a station, or how far it is from finite elements.
fn profile(row: &Row, reference: &HillReference, is_difference: bool) -> CurvePanel {
    let (scale, symbol, title) = match is_difference {
        true => (20.0, "Δu", "minus finite elements".to_string()),
        false => (0.8, "u", name(row)),
    };
    let known = |station: &Station| -> Vec<(f64, f64)> {
        station.y.iter().zip(&station.v).map(|(y, v)| (*y, v.x)).collect()
    };
    let line = |(k, station): (usize, &Station)| {
        let known = known(station);
        let points = move |record: &Record| {
            let [x, y, u] = [columns::X, columns::Y, columns::U].map(|key| record.column(key));
            let subtracted = |j: usize| match is_difference {
                true => differences(&known, &[(y[j], 0.0)]).map_or(f64::NAN, |found| found[0]),
                false => 0.0,
            };
            let points = (k * POINTS + 5..((k + 1) * POINTS).min(u.len())).step_by(10);
            points.map(|j| (x[j] + scale * (u[j] - subtracted(j)), y[j])).collect()
        };
        let (name, spec) = (format!("{}, {}", row.variant, name(row)), row.run.spec.clone());
        CurveOf::new(name, spec, points)
    };
    let exact = reference.stations.iter().map(|station| match is_difference {
        true => (String::new(), known(station).iter().map(|(y, _)| (station.x, *y)).collect()),
        false => {
            let points = known(station).iter().map(|(y, u)| (station.x + scale * u, *y)).collect();
            ("finite elements".to_string(), points)
        }
    });
    CurvePanel {
        title: format!("Re {}, {title}", row.settings.re),
        x: Axis::linear(format!("x/H + {scale} {symbol}/U_b")),
        y: Axis::linear("y/H").range(0.0, 3.1),
        lines: reference.stations.iter().enumerate().map(line).collect(),
        references: exact.chain([(String::new(), floor())]).collect(),
        symbols: !is_difference,
    }
}

/// Shear stress along the hill.
fn shear(rows: &[&Row], reference: &HillReference) -> CurvePanel {
    let line = |row: &&Row| {
        let name = format!("{}, {}", row.variant, name(row));
        CurveOf::columns(name, row.run.spec.clone(), [columns::ALONG, columns::HILL_SHEAR])
    };
    let exact = reference.hill_shear.clone();
    let title = format!("Re {}: shear on the hill", rows[0].settings.re);
    let axes = ["x/H", "shear stress [ρ U_b²]"];
    CurvePanel::linear(&title, axes, rows.iter().map(line).collect(), ("finite elements", exact))
}

/// Completed, and no sample of the kinetic energy exceeds twice the first one after the start, which is near
/// the solution.
pub fn is_stable(record: &Record) -> bool {
    let energy = record.column(columns::KINETIC_ENERGY).get(1..).unwrap_or_default();
    let bounded = |first: &f64| energy.iter().all(|e| *e <= 2.0 * first);
    record.status == Status::Completed && energy.first().is_some_and(bounded)
}

/// The longest stable step over the theoretical one, by bisection: in the full tier of one variant each with
/// sums over pairs, with shifted velocities and with consistent sums.
fn limits(tier: Tier) -> StepLimits {
    let (n, variants): (usize, &[&'static str]) = match tier {
        Tier::Quick => (5, &[RECOMMENDED]),
        _ => (10, &["modern", RECOMMENDED, "consistent"]),
    };
    let about = "The longest time step with which the flow at Re 50 goes on for 3 H/U_b from the reference \
                 without diverging or doubling its kinetic energy, by bisection, over the limit of linear \
                 theory for a lattice at rest, which has no walls, no curvature and no disorder.";
    let of = variants.iter().map(|variant| limit(variant, n)).collect();
    StepLimits { about: about.into(), of }
}

/// The bisection of a variant with its gates.
fn limit(variant: &'static str, n: usize) -> StepLimit {
    let spec = CASE.spec(variant, |s| flow(s, (50.0, n, 3.0, true)));
    // The step is proportional to the Courant number: the viscous limit is ten times as far at Re 50.
    let courant = HillSettings::default().numerics.courant;
    let at_limit = |rules: &Rules| courant / (rules.dt() / rules.dt_limit());
    let theory = "The default step is stable, and disorder makes neither sound slower nor the stencil \
                  softer by a fifth.";
    let gate = |default| {
        let (id, bound) = (format!("{NAME}.step.{variant}.theory"), Bound::Within(default, 1.2));
        Some(Gate::new(id, OF_THEORY, bound, Evidence::Theory, theory))
    };
    let scene = format!("Re 50, H/dx = {n}");
    StepLimit::proportional(&CASE, scene, spec, ("courant", at_limit), gate)
}

const BOUNDS: &str = "The error of the method at ten spacings a hill takes up most of the bounds.";
const CONTROLLED: &str = "A controller sets the force, for any initial force.";
const SOUND: &str = "Compressibility changes the velocity by less than the spacing does.";
const REACH: &str =
    "Sums are valid for any reach; its error is inside the bounds at ten spacings a hill.";
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
    Sensitivity::new(tier, run, watched)
}

/// Runs from rest and from the reference, ten spacings a hill: only the full tier has both.
fn starts(table: &Table) -> Option<impl Study + use<>> {
    let pair = |re: f64| -> Option<(f64, [Planned; 2])> {
        let rows = shown(table, re).into_iter().filter(|row| row.settings.n == 10);
        let runs: Vec<Planned> = rows.map(|row| row.run.clone()).collect();
        Some((re, runs.try_into().ok()?))
    };
    let pairs: Vec<(f64, [Planned; 2])> = REYNOLDS.into_iter().filter_map(pair).collect();
    let runs: Vec<Planned> = pairs.iter().flat_map(|(_, runs)| runs.clone()).collect();
    let section = move |runs: &Runs| {
        let because = "Both starts lead to the same steady flow, except for the effect of disorder on \
                       averages.";
        let section = Section::new("periodic-hill-starts", "Whether the start matters");
        pairs.iter().fold(section, |section, (re, [rest, other])| {
            let u = |run: &Planned| Some(runs.completed(&run.spec)?.column(columns::U));
            let both = u(rest).zip(u(other));
            let found = both.map_or(f64::NAN, |(a, b)| rms(a.iter().zip(b).map(|(a, b)| a - b)));
            let metric = "rms over stations of the difference of u [U_b]";
            let (id, bound) = (format!("{NAME}.{RECOMMENDED}.{re}.starts"), Bound::Below(0.005));
            section.judge(Gate::new(id, metric, bound, Evidence::Invariant, because), found)
        })
    };
    (!runs.is_empty()).then_some(CustomStudy { runs, section })
}

/// Particles of the finest run at each Reynolds number, the floor, and the line that encloses the fluid that
/// circulates.
fn picture(table: &Table) -> Picture {
    let caption = "Where does the flow separate? Particles of the finest run of `carried`, coloured by their \
                   velocity u along the channel. Green lines are the floor and the border of the fluid that \
                   circulates in finite elements.";
    let heading =
        Heading { id: "periodic-hill-pictures", title: "Where the flow separates", caption };
    let panel = |row: &Row| {
        let HillSettings { re, n, .. } = row.settings;
        let panel = row.panel(format!("Re {re}, {}", name(row)), 1.0 / n as f64);
        vec![PicturePanel { lines: vec![floor(), bubble(re)], ..panel }]
    };
    let picture = table.picture(heading, ("u [U_b]", ColourMap::Diverging), [640.0, 230.0], panel);
    Picture { range: Some([-1.5, 1.5]), ..picture }
}
