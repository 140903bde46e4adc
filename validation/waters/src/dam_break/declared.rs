//! What the studies that every case has are made of: the front of the column of Martin & Moyce over
//! resolutions, what its error is made of, the longest stable time steps in both scenes, and the errors of
//! constants that the gates must detect.

use super::{
    DAM_BREAK, DamSettings, NAME, curves, ensembles, lobovsky,
    metrics::{
        FRONT, FRONT_AWAY, HEIGHT, HEIGHT_AWAY, IMPULSE, IMPULSE_AWAY, LEVEL_AWAY, LEVELS, MACH,
    },
    plan::{self, Group, free},
    reference::{self, FRONT_SPREAD, IMPULSE_SPREAD, front, value},
    run::COSTLY,
};
use crate::water::ledger::ENERGY_GAP;
use base::{
    gate::{Bound, Evidence, Gate},
    mutation::{Constant, Mutation},
    record::{MetricName, Record, Status},
    reference::Reference,
    spec::RunSpec,
};
use harness::{
    case::{Case, Rules, Tier},
    declare::{
        Accuracy, Budget, Budgets, Card, Change, Comparison, Declaration, ErrorOf, OrderGate,
        Sensitivity, StepLimit, StepLimits, Watched,
    },
    studies::causes::{NOT_MEASURED, SAFETY_MARGIN, STEP, WIDE_BOUNDS},
};

/// A run that ended, with the energy that it began with.
pub fn is_stable(record: &Record) -> bool {
    let is_below = |metric, most: f64| record.value(metric).is_some_and(|value| value < most);
    record.status == Status::Completed && is_below(ENERGY_GAP, 0.02) && is_below(MACH, 0.5)
}

/// All of it.
pub fn declaration(tier: Tier) -> Declaration {
    let accuracy = accuracy(tier);
    let card = Card {
        title: "Dam break",
        picture: ("dam-break-martin-moyce-pictures", 3),
        error: "front after its best shift in time, rms in column widths".into(),
        metric: FRONT.rms_shifted.into(),
        runs: accuracy.finest(&[DAM_BREAK.best.variant, "seed"]),
        against: "the experiment of Martin & Moyce",
        uncertainty: Some(FRONT_SPREAD),
        reach: ("n", "", " spacings across the column"),
    };
    let comparisons = comparisons(tier);
    Declaration {
        card: Some(card),
        ensembles: ensembles::ensembles(tier, &comparisons),
        comparisons,
        curves: curves::curves(tier),
        budgets: Some(budgets(tier, &accuracy)),
        accuracy: vec![accuracy],
        limits: Some(limits(tier)),
        sensitivity: Some(sensitivity(tier)),
        costly: COSTLY,
        ..Declaration::default()
    }
}

/// `modern` as a method, against volume of fluid, and its model, against both experiments. The tank has a
/// ladder in the full tier alone.
fn comparisons(tier: Tier) -> Vec<Comparison> {
    const METHOD: &str =
        "computed for the same inputs; u_D: meshes and steps (`references/dam_break_vof`)";
    const MODEL: &str = "u_input: heights wrong by half of the last digit that is stated, of a = 2.25 \
                         inches and of H = 300 mm; u_D: spread of digitised curves, of two series, of two \
                         sensors";
    let table = plan::table(tier);
    let level = |s: &DamSettings| (1.0 / s.n as f64, String::new());
    let vof = |scene, name: &str| {
        Reference::summarised("dam_break_vof", &[("scene", scene), ("quantity", name)])
    };
    let of_scene = |group, digit: f64, model: &[Compared], method: &[Compared]| {
        let ladder = table.ladder(&[group], "modern", level);
        let base = ladder.levels.first().map(|level| level.run.spec.clone());
        let input = base.map(|run| {
            let higher = Mutation { of: Constant::Height, factor: 1.0 + digit };
            [run.clone(), run.mutated(higher)]
        });
        let new = |of: &Compared, against, because| {
            Comparison::new(of.0, against, of.1.clone(), &ladder, (of.2, because))
        };
        let of_method = method.iter().map(|of| new(of, "volume of fluid: the method", METHOD));
        let of_model = model.iter().map(|of| Comparison {
            inputs: input.clone().into_iter().collect(),
            ..new(of, "the experiment: the model", MODEL)
        });
        of_method.chain(of_model).collect::<Vec<_>>()
    };
    // In units of the width a, which is H/2.
    let front = 2.0 * vof("martin_moyce", "front_at_1")[1];
    let method = [
        ("front at T = 2 [a]", FRONT_AWAY.at(2), front),
        ("residual height, rms [H]", HEIGHT_AWAY.into(), vof("martin_moyce", "height_at_1.65")[1]),
    ];
    let model = [
        ("front after its best shift, rms [a]", FRONT.rms_shifted.into(), FRONT_SPREAD),
        ("residual height after its best shift, rms [H]", HEIGHT.rms_shifted.into(), 1.0 / 18.0),
    ];
    let mut all = of_scene(Group::Ladder, 0.005 / 2.25, &model, &method);
    if tier == Tier::Full {
        let relative = |name: &str| {
            let [value, uncertainty] = vof("lobovsky", name);
            uncertainty / value
        };
        let sensors = ["impulse on P1", "impulse on P2", "impulse on P3", "impulse on P4"];
        let mut method = vec![
            ("tank: front at t = 2 [H]", FRONT_AWAY.at(2), vof("lobovsky", "front_at_2")[1]),
            ("tank: level at H4, rms [H]", LEVEL_AWAY[3].into(), vof("lobovsky", "H4_at_5")[1]),
        ];
        let mut model = vec![
            // Two series arrive 0.038 apart, √2 times the standard uncertainty, at a speed of 1.515.
            ("tank: front after its best shift, rms [H]", FRONT.rms_shifted.into(), 0.041),
            ("tank: levels after their best shift, rms [H]", LEVELS.rms_shifted.into(), 0.024),
        ];
        for (k, what) in sensors.into_iter().enumerate() {
            let uncertainty = relative(&format!("impulse_P{}_1", k + 1));
            method.push((what, IMPULSE_AWAY[k].at(1), uncertainty));
            model.push((what, IMPULSE[k].at(1), IMPULSE_SPREAD / 2.0_f64.sqrt()));
        }
        all.extend(of_scene(Group::Tank, 0.5 / 300.0, &model, &method));
    }
    all
}

/// What is compared, its metric, u_D.
type Compared = (&'static str, MetricName, f64);

/// rms distance of two fronts \[a\], for 1 ≤ T ≤ 3.3: before, they have hardly moved; later, there is no
/// experiment.
fn between(one: &Record, other: &Record) -> f64 {
    const POINTS: usize = 100;
    let (one, other) = (front(one), front(other));
    let at = |k: usize| 1.0 + 2.3 * (k as f64 + 0.5) / POINTS as f64;
    let points: Vec<_> = (0..POINTS).map(at).map(|t| (t, value(&other, t))).collect();
    reference::rms(&one, &points, 0.0)
}

fn accuracy(tier: Tier) -> Accuracy {
    let finest = plan::finest(tier, Group::Free).unwrap_or_else(|| free("modern", 40));
    let table = plan::table(tier);
    let level = |s: &DamSettings| (1.0 / s.n as f64, format!("a/dx {}", s.n));
    let ladder = |variant| table.ladder(&[Group::Ladder], variant, level);
    let variants = ["seed", "modern", "modern-interface", "single-sweep"];
    let mut ladders = variants.map(ladder);
    if tier == Tier::Full {
        let because = "Artificial viscosity, the place of a surface and what a wall sees of it are of first \
                       order in dx. A front is known to a quarter of a spacing, so the order is uncertain by \
                       0.5.";
        ladders[1].order = Some(OrderGate {
            id: format!("{NAME}.martin-moyce.modern.front.order"),
            bound: Bound::Within(0.5, 1.5),
            evidence: Evidence::Theory,
            because: because.into(),
        });
    }
    let about = format!(
        "Front Z(T), 1 ≤ T ≤ 3.3, of the column of Martin & Moyce. Per cent are of its width a. An error \
         is the rms distance from the front of `modern` at a/dx = {}, which is itself short of the limit, \
         so an error smaller than the last one of its own series says no more.",
        finest.settings["n"]
    );
    Accuracy {
        about,
        spacing: "dx/a [-]",
        slope: Some(1.0),
        ladders: ladders.into(),
        ..Accuracy::new(
            "dam-break",
            ErrorOf::Distance { finest, between },
            "rms distance of the front [a]",
        )
    }
}

/// A change of the settings.
type Set = fn(&mut DamSettings);

/// What is changed, the part of the error that this changes, how, and the only variant that has it.
const CHANGES: [(&str, &str, Set, Option<&str>); 9] = [
    ("none", "all", |_| (), None),
    ("dt/2", "time", |s| s.courant *= 0.5, None),
    ("dx/2", "spacing", |s| s.n *= 2, None),
    ("2 c0", "compressibility", |s| s.c0 *= 2.0, None),
    ("alpha/2", "artificial viscosity", |s| s.alpha *= 0.5, None),
    ("h/dx 2", "smoothing", |s| s.h_over_dx = 2.0, None),
    ("delta/2", "density diffusion", |s| s.diffusion *= 0.5, Some("modern")),
    ("no artificial stress", "artificial stress", |s| s.xi = 0.0, Some("seed")),
    ("no XSPH", "XSPH", |s| s.xsph = 0.0, Some("seed")),
];

fn budgets(tier: Tier, accuracy: &Accuracy) -> Budgets {
    let (n, variants): (usize, &[&str]) = match tier {
        Tier::Quick => (10, &["modern"]),
        _ => (20, &["modern", "seed"]),
    };
    let of = |variant: &&'static str| {
        let has =
            |change: &&(&str, &str, Set, Option<&str>)| change.3.is_none_or(|of| of == *variant);
        let change = |(what, part, set, _): &(&'static str, &'static str, Set, Option<&str>)| {
            let spec = DAM_BREAK.spec(variant, |s| {
                s.n = n;
                set(s);
            });
            // Other changes may ask more of the time step than the variant's own settings do.
            let is_ladder = ["all", "spacing"].contains(part);
            Change::new(*what, part, if is_ladder { spec } else { spec.allow_unstable() })
        };
        Budget { variant, changes: CHANGES.iter().filter(has).map(change).collect() }
    };
    Budgets::of(accuracy, variants.iter().map(of).collect())
}

fn limits(tier: Tier) -> StepLimits {
    let scenes: [(&str, Set); 2] = [
        ("Martin & Moyce", |s| s.n = 15),
        ("Lobovsky", |s| {
            lobovsky(s);
            (s.n, s.end) = (15, 4.0);
        }),
    ];
    // Stable is what keeps its energy.
    let spec = |variant, set| DAM_BREAK.spec(variant, set).measure_all();
    let of = |variant| scenes.map(|(scene, set)| limit(variant, scene, spec(variant, set)));
    let most = if tier == Tier::Quick { 1 } else { usize::MAX };
    let about = "A time step counts as stable if the collapse ends with its energy accounted for within 2 \
                 %. Theory is the limit of a lattice at rest. Water that moves, is compressed and loses \
                 its lattice is expected at 0.7 to 1.0 of it.";
    StepLimits::new("dam-break", about, ["modern", "seed"].into_iter().flat_map(of).take(most))
}

fn limit(variant: &'static str, scene: &str, spec: RunSpec) -> StepLimit {
    let rules = DAM_BREAK.rules(&spec).unwrap_or(Rules::REFUSED);
    let because = "Theory is the limit of a lattice at rest. Moving, disordered water is expected at 0.7 \
                   to 1.0 of it, and the step of the case must be below what is measured. A run that holds \
                   at 1.2 would measure another limit, because the stiffest mode of leapfrog grows \
                   3.5-fold a step there.";
    let id = format!("{NAME}.limit.{variant}.{}", scene.split(' ').next().unwrap_or_default());
    let default_at = rules.dt() / rules.dt_limit();
    let bound = Bound::Within(default_at, 1.2);
    let gate = Gate::new(id, "measured/theory", bound, Evidence::Theory, because);
    // The limit as the record's dt and dt/limit state it.
    let setting = ("dt", rules.dt() / default_at);
    let limit = StepLimit::proportional(variant, scene, spec, setting, &rules);
    StepLimit { of_theory: vec![gate], ..limit }
}

const DENSITY: &str = "Times and lengths of a collapse do not depend on the density. Water at rest \
                       (`hydrostatic`) detects 0.1 % by its exact pressure.";
const SOUND: &str = "The model holds for any sound speed that is large compared with the speed of the water, \
                     so what is compared with the experiment must not depend on it.";
const PLACE: &str = "An error of 10 % moves the front by less than 0.1 a, to which the experiment fixes it, \
                     a being the width of the column. The ablation shows how much each part of the method \
                     moves it.";
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
    Sensitivity::new(NAME, tier, ["modern", "seed"].map(|variant| free(variant, 20)), watched)
}

#[cfg(test)]
mod tests {
    use super::*;
    use harness::runs::Runs;

    /// Its gate was left out, so that a report passed without it.
    #[test]
    fn a_step_limit_whose_run_is_refused_keeps_its_gate_and_fails_it() {
        let refused = limit("no such variant", "tank", DAM_BREAK.spec("no such variant", |_| ()));
        assert_eq!(refused.of_theory.len(), 1);
        let limits = Some(StepLimits::new("dam-break", "", [refused]));
        let declared = Declaration { limits, ..Declaration::default() };
        let studies = harness::studies::of(NAME, &declared, &Runs::default());
        let judged: Vec<_> = studies.iter().flat_map(|study| &study.judged).collect();
        assert_eq!(judged.len(), 1);
        assert!(judged[0].judgement.verdict.is_failure());
    }
}
