//! Studies of the case: the front of the column of Martin & Moyce over resolutions, its error budget, the
//! longest stable time steps, and the errors of constants that the gates must detect.

use nalgebra::Vector2;
use touchstone_base::{
    mutation::{Constant, Mutation},
    record::{MetricName, Status},
    reference::{Reference, Uncertain},
};
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::{Draws, Statement, SubmittedCurve},
    composed::SettingChange,
    pictures::{self, Film},
    studies::{
        Accuracy, Breaks, Budgets, Card, Change, Comparison, Comparisons, Heading, OF_THEORY,
        ORDER, Picture, PicturePanel, Sensitivity, Spacing, Stated, StepLimit, StepLimits, Watched,
        causes::{NOT_MEASURED, SAFETY_MARGIN, STEP, WIDE_BOUNDS},
    },
};
use touchstone_report::{ColourMap, sig};
use touchstone_solver::Numbers;

use super::{
    DAM_BREAK, DamSettings, Experiment, NAME, columns, curves, ensembles,
    metrics::{
        self, FRONT, FRONT_AWAY, FRONT_BACK, HEIGHT, HEIGHT_AWAY, IMPULSE, IMPULSE_AWAY,
        LEVEL_AWAY, LEVELS, MACH, Z,
    },
    plan::{self, Group, Table},
    reference::{FRONT_SPREAD, IMPULSE_SPREAD, LEVEL_SPREAD, TANK_FRONT_SPREAD},
    run::COSTLY,
};
use crate::waters::water::ledger::ENERGY_GAP;

/// A run that ended, with the energy that it began with.
pub fn is_stable(record: &Record) -> bool {
    let is_below = |metric, most: f64| record.value(metric).is_some_and(|value| value < most);
    record.status == Status::Completed && is_below(ENERGY_GAP, 0.02) && is_below(MACH, 0.5)
}

/// The experiment does not depend on the spacing, and the distance between it and the model does not fall
/// with the spacing.
const SEALED: Draws =
    Draws::new(&["modern"], ("n", [14.0, 40.0]), 0.0, &["front_rms_shifted", "height_rms_shifted"]);

/// The studies of a tier.
pub fn studies(tier: Tier) -> Studies {
    let table = plan::table(tier);
    let accuracy = accuracy(tier, &table);
    let (card, budgets) = (card(&accuracy), budgets(tier, &accuracy));
    Studies::judging(table.plan())
        .with_all(curves::curves(tier))
        .with(picture(&table))
        .with(accuracy)
        .with(in_the_tank(&table))
        .with(comparisons(tier, &table))
        .with_all(ensembles::ensembles(tier, &table))
        .with(budgets)
        .with(limits(tier))
        .with(sensitivity(tier))
        .with(card)
}

/// The facts of the case.
pub fn facts() -> Facts {
    let boundary = "Water slips along floor and walls without friction, and nothing passes them below their \
                    rim. The surface is free: no pressure acts on it. At the start the water is at rest; no \
                    wall holds it on its right.";
    let statement = Statement { metrics: metrics::every(), ..Statement::new(boundary, &[]) };
    Facts {
        statement,
        is_stable: Some(is_stable),
        costly: COSTLY,
        curve: Some(front()),
        sealed: Some(SEALED),
        ..Facts::default()
    }
}

/// Summary of the case in the report: the front against volume of fluid, and both distances from the
/// experiment.
fn card(accuracy: &Accuracy) -> Card {
    Card {
        title: "Dam break",
        picture: "dam-break-picture",
        pictured_scene: "tank of Lobovsky et al.",
        metric: FRONT_AWAY.at(2),
        stated: |run| {
            let front = "front at T = 2 in the tank of Martin & Moyce, a/dx = {n}";
            let in_tank = "front at t = 2 √(H/g) in the tank of Lobovsky et al., H/dx = {n}";
            let (name, uncertainty, unit) = match run.settings_as::<DamSettings>().scene() {
                Some(Experiment::MartinMoyce) => {
                    (front, 2.0 * u_d("martin_moyce", "front_at_1"), "a")
                }
                Some(Experiment::Lobovsky) => (in_tank, u_d("lobovsky", "front_at_2"), "H"),
                None => ("front, dx a part of 1/{n} of the column", f64::NAN, "a"),
            };
            let uncertainty = Some(uncertainty).filter(|u| u.is_finite());
            Stated { uncertainty, unit, ..Stated::new(run, name, "volume of fluid") }
        },
        beside: Some(against_the_experiment),
        runs: accuracy.finest(&[DAM_BREAK.recommended.variant, "seed"]),
        breaks: Breaks {
            value: |run| run.settings_as::<DamSettings>().n as f64,
            words: ["a/dx = ", ""],
            // Both variants are compared in the tank of the error.
            has_broken: |record| {
                let scene = record.run.settings_as::<DamSettings>().scene();
                (scene == Some(Experiment::MartinMoyce))
                    .then(|| record.value(MACH).is_some_and(|mach| mach >= 0.5))
            },
            sign: "water is faster than half of the sound speed",
        },
    }
}

/// The distance of the front from the experiment with the tank of the settings.
fn against_the_experiment(record: &Record) -> Option<String> {
    let (experiment, spread, unit) = match record.run.settings_as::<DamSettings>().scene()? {
        Experiment::MartinMoyce => ("Martin & Moyce", FRONT_SPREAD, "a"),
        Experiment::Lobovsky => ("Lobovsky et al.", TANK_FRONT_SPREAD, "H"),
    };
    let number = |value| format!("{}\u{a0}{unit}", sig(value, 2));
    let [released, shifted, shift] =
        [FRONT.rms, FRONT.rms_shifted, FRONT.shift].map(|of| record.value(of));
    Some(format!(
        "front against the experiment of {experiment} (± {}), rms: {} as released, {} after the best shift \
         of its clock, by {}",
        number(spread),
        number(released?),
        number(shifted?),
        sig(shift?, 2)
    ))
}

/// The finest run in the tank, when the jet falls back from the far wall.
fn picture(table: &Table) -> Picture {
    let caption = "What does the jet do at the far wall? It plunges back: `modern` in the tank of Lobovsky \
                   et al., coloured by pressure; colours end at 0 and 1 ρ g H.";
    let heading = Heading { id: "dam-break-picture", title: "Picture of the tank", caption };
    let colours = ("p [ρ g H]", ColourMap::Sequential);
    let picture = table.picture(heading, colours, [560.0, 230.0], |row| {
        let DamSettings { n, end, .. } = row.settings;
        let title = format!("time {} √(H/g), H/dx = {n}", sig(end, 3));
        let panel = row.panel(title, 1.0 / n as f64);
        vec![PicturePanel { profile: pictures::at_share(1.0), ..panel }]
    });
    // A few drops that meet have many times the pressure of the water.
    let film = Film {
        caption: "How does the dam break? Tank of Lobovsky et al., `modern`, coloured by pressure: the water \
                  rises at the far wall, and its jet plunges back.",
        time: |record, share| {
            let DamSettings { end, .. } = record.run.settings_as();
            format!("t = {:.2} √(H/g)", share * end)
        },
        view: [[0.0, 5.37], [0.0, 2.0]],
        width: 480.0,
        is_mirrored: false,
        still: 1.0,
    };
    Picture { range: Some([0.0, 1.0]), film: Some(film), ..picture }
}

/// The front over time, represented by the column moved with it.
fn front() -> SubmittedCurve {
    SubmittedCurve {
        columns: &[("front", "m")],
        about: "front is the x of the foremost water below H/4, from the back wall: for particles that of \
                the foremost one plus dx/2, its distance from the face of the column at the start",
        least: 0,
        rows: |_| 1,
        place: |run, at, starts| {
            let DamSettings { width, .. } = run.settings_as();
            let moved = Vector2::new(at[0][0] - width, 0.0);
            starts.iter().map(|start| [start + moved, Vector2::zeros()]).collect()
        },
        metrics: vec![Z, FRONT_AWAY, FRONT_BACK, FRONT.rms, FRONT.rms_shifted, FRONT.shift],
        coarsen: None,
        shown: &[columns::TIME, columns::FRONT],
    }
}

/// `modern` as a method, against volume of fluid, and its model, against both experiments. The tank has a
/// ladder in the full tier alone.
fn comparisons(tier: Tier, table: &Table) -> Comparisons {
    // Compared quantity, its metric, and u_D as a method.
    let column = [
        ("front at T = 2 [a]", FRONT_AWAY.at(2), 2.0 * u_d("martin_moyce", "front_at_1")),
        ("residual height, rms [H]", HEIGHT_AWAY.into(), u_d("martin_moyce", "height_at_1.65")),
    ];
    let measured_column = [
        ("front after its best shift, rms [a]", FRONT.rms_shifted.into(), FRONT_SPREAD),
        ("residual height after its best shift, rms [H]", HEIGHT.rms_shifted.into(), 1.0 / 18.0),
    ];
    let mut all = compared(table, Group::Ladder, 0.005 / 2.25, &column, &measured_column);
    if tier == Tier::Full {
        let mut tank = vec![
            ("tank: front at t = 2 [H]", FRONT_AWAY.at(2), u_d("lobovsky", "front_at_2")),
            ("tank: level at H4, rms [H]", LEVEL_AWAY[3].into(), u_d("lobovsky", "H4_at_5")),
        ];
        let [front, levels] = [
            "tank: front after its best shift, rms [H]",
            "tank: levels after their best shift, rms [H]",
        ];
        let mut measured_tank = vec![
            (front, FRONT.rms_shifted.into(), TANK_FRONT_SPREAD),
            (levels, LEVELS.rms_shifted.into(), LEVEL_SPREAD),
        ];
        let sensors = ["impulse on P1", "impulse on P2", "impulse on P3", "impulse on P4"];
        for (k, what) in sensors.into_iter().enumerate() {
            let impulse = vof("lobovsky", &format!("impulse_P{}_1", k + 1));
            tank.push((what, IMPULSE_AWAY[k].at(1), impulse.uncertainty / impulse.value));
            measured_tank.push((what, IMPULSE[k].at(1), IMPULSE_SPREAD));
        }
        all.extend(compared(table, Group::Tank, 0.5 / 300.0, &tank, &measured_tank));
    }
    Comparisons(all)
}

/// A number of the reference by volume of fluid.
fn vof(scene: &str, name: &str) -> Uncertain {
    Reference::summarised("dam_break_vof", &[("scene", scene), ("quantity", name)])
}

/// The uncertainty of this number.
fn u_d(scene: &str, name: &str) -> f64 {
    vof(scene, name).uncertainty
}

/// Comparisons of the ladder of a group with volume of fluid and with an experiment, each with the compared
/// quantity, its metric and u_D; `digit` is half of the last digit of a height over this height.
fn compared(
    table: &Table,
    group: Group,
    digit: f64,
    method: &[(&str, MetricName, f64)],
    model: &[(&str, MetricName, f64)],
) -> Vec<Comparison> {
    let of_method =
        "computed for the same inputs; u_D: meshes and steps (`references/dam_break_vof`)";
    let of_model = "u_input: heights wrong by half of the last digit that is stated, of a = 2.25 inches and \
                    of H = 300 mm; u_D: spread of digitised curves, of two series, of two sensors";
    let spacing = Spacing::count(|s: &mut DamSettings| &mut s.n, "");
    let ladder = table.ladder(&[group], "modern", spacing);
    let higher = Mutation { of: Constant::Height, factor: 1.0 + digit };
    let coarsest = ladder.levels.first().map(|level| level.run.spec.clone());
    let inputs = coarsest.map(|run| [run.clone(), run.mutated(higher)]);
    let new = |of: &(&str, MetricName, f64), against, because| {
        Comparison::new(of.0, against, of.1.clone(), &ladder, (of.2, because))
    };
    let method = method.iter().map(|of| new(of, "volume of fluid: the method", of_method));
    let model = model.iter().map(|of| Comparison {
        inputs: inputs.clone().into_iter().collect(),
        ..new(of, "the experiment: the model", of_model)
    });
    method.chain(model).collect()
}

fn accuracy(tier: Tier, table: &Table) -> Accuracy {
    let spacing = Spacing::count(|s: &mut DamSettings| &mut s.n, "a/dx {}");
    let mut ladders = table.ladders(&[Group::Ladder], &["seed", "modern"], spacing);
    if tier == Tier::Full {
        let because = "Errors of artificial viscosity, of the place of a surface and of the pressure on a \
                       wall are of first order in dx. A front is known to a quarter of a spacing, so the \
                       order is uncertain by 0.5.";
        let id = format!("{NAME}.martin-moyce.modern.front.order");
        let bound = Bound::Within(0.5, 1.5);
        if let Some(ladder) = ladders.iter_mut().find(|ladder| ladder.variant == "modern") {
            ladder.order = Some(Gate::new(id, ORDER, bound, Evidence::Theory, because));
        }
    }
    Accuracy {
        about: "Front of the column of Martin & Moyce at T = 2, minus the front of the same model by volume \
                of fluid, in widths a of the column. Fine runs are ahead by up to its uncertainty, so the \
                gate on the order looks at T = 1."
            .into(),
        judged: Some(FRONT_AWAY.at(1)),
        spacing: "dx/a [-]",
        slope: Some(1.0),
        ladders,
        ..Accuracy::new("dam-break", FRONT_AWAY.at(2), "error of the front [a]")
    }
}

/// The front of the column in the tank of Lobovsky et al.
fn in_the_tank(table: &Table) -> Accuracy {
    let spacing = Spacing::count(|s: &mut DamSettings| &mut s.n, "H/dx {}");
    Accuracy {
        about: "Front of the column in the tank at t = 2 √(H/g), minus the front of the same model by volume \
                of fluid, which is known to 0.028 H."
            .into(),
        spacing: "dx/H [-]",
        slope: Some(1.0),
        ladders: table.ladders(&[Group::Tank], &["modern"], spacing),
        ..Accuracy::new("dam-break-tank", FRONT_AWAY.at(2), "error of the front at t = 2 [H]")
    }
}

/// Changes of both variants.
const CHANGES: [SettingChange<DamSettings>; 6] = [
    ("none", "all", |_| ()),
    ("dt/2", "time", |s| s.water.courant *= 0.5),
    ("dx/2", "spacing", |s| s.n *= 2),
    ("2 c0", "compressibility", |s| s.c0 *= 2.0),
    ("alpha/2", "artificial viscosity", |s| s.water.alpha *= 0.5),
    ("h/dx 2", "smoothing", |s| s.water.h_over_dx = 2.0),
];
/// Changes of terms that `modern` has alone, and of terms that `seed` has alone.
const OF_MODERN: [SettingChange<DamSettings>; 1] =
    [("delta/2", "density diffusion", |s| s.water.diffusion *= 0.5)];
const OF_SEED: [SettingChange<DamSettings>; 2] = [
    ("no artificial stress", "artificial stress", |s| s.water.xi = 0.0),
    ("no XSPH", "XSPH", |s| s.water.xsph = 0.0),
];

fn budgets(tier: Tier, accuracy: &Accuracy) -> Budgets {
    let (n, variants): (usize, &[&str]) = match tier {
        Tier::Quick => (10, &["modern"]),
        _ => (20, &["modern", "seed"]),
    };
    let of = |variant: &&'static str| {
        let own = if *variant == "modern" { &OF_MODERN[..] } else { &OF_SEED };
        let base = DAM_BREAK.chosen(variant, |s| s.n = n);
        let mut all = DAM_BREAK.changes(variant, |s| s.n = n, &[&CHANGES, own].concat());
        for Change { spec, .. } in &mut all {
            // Changes of more than the spacing may ask more of the time step than the base does.
            spec.allow_unstable = DamSettings { n, ..spec.settings_as() } != base;
        }
        all
    };
    Budgets::new(accuracy, accuracy.about.clone(), variants.iter().map(of).collect())
}

fn limits(tier: Tier) -> StepLimits {
    let most = if tier == Tier::Quick { 1 } else { usize::MAX };
    let about = "A time step counts as stable if the collapse ends with its energy accounted for within 2 %.";
    let of = ["modern", "seed"].map(limit).into_iter().take(most).collect();
    StepLimits { about: about.into(), of }
}

fn limit(variant: &'static str) -> StepLimit {
    // A run is stable if it keeps its energy.
    let spec = DAM_BREAK.spec(variant, |s| s.n = 15).measure_all();
    let because = "Theory is the limit of a lattice at rest. Moving, disordered water is expected at 0.7 to \
                   1.0 of it, and the step of the case must be below the measured limit. A run that holds \
                   at 1.2 would measure another limit, because the stiffest mode of leapfrog grows \
                   3.5-fold a step there.";
    let gate = |default| {
        let (id, bound) = (format!("{NAME}.limit.{variant}.Martin"), Bound::Within(default, 1.2));
        Some(Gate::new(id, OF_THEORY, bound, Evidence::Theory, because))
    };
    // The limit as the record's dt and dt/limit state it.
    let at_limit = |rules: &Rules| rules.dt() / (rules.dt() / rules.dt_limit());
    StepLimit::proportional(&DAM_BREAK, "Martin & Moyce", spec, ("dt", at_limit), gate)
}

const DENSITY: &str = "Times and lengths of a collapse do not depend on the density. Water at rest \
                       (`hydrostatic`) detects 0.1 % by its exact pressure.";
const SOUND: &str = "The model holds for any sound speed that is large compared with the speed of the \
                     water, so the comparison with the experiment must not depend on it.";
const PLACE: &str = "An error of 10 % moves the front by less than 0.1 a, to which the experiment fixes it, \
                     a being the width of the column. The error budget shows how much each part of the \
                     method moves it.";
const PRESSURE: &str =
    "Density diffusion smooths the pressure, which is not judged in this experiment.";

/// The coarsest judged column, released freely.
fn sensitivity(tier: Tier) -> Sensitivity {
    let blind = |constant, why, cause| Watched::blind_up_to(constant, 1.0, why, cause);
    let watched = [
        Watched::new(Constant::BodyForce),
        Watched::new(Constant::Height).quick(),
        blind(Constant::Density, DENSITY, &NOT_MEASURED),
        blind(Constant::SoundSpeed, SOUND, &NOT_MEASURED),
        Watched::new(Constant::Normalisation),
        Watched::new(Constant::SmoothingLength),
        blind(Constant::TimeStep, STEP, &SAFETY_MARGIN),
        blind(Constant::ArtificialViscosity, PLACE, &WIDE_BOUNDS),
        blind(Constant::DensityDiffusion, PRESSURE, &NOT_MEASURED).faults(&[-1.0]),
        blind(Constant::ArtificialStress, PLACE, &WIDE_BOUNDS),
        blind(Constant::Xsph, PLACE, &WIDE_BOUNDS).faults(&[-1.0]),
    ];
    let runs = ["modern", "seed"].map(|variant| DAM_BREAK.spec(variant, |_| {}));
    Sensitivity::new(tier, runs, watched)
}
