//! What the studies that every case has are made of: histories over finite elements, errors over spacing and
//! cost, an error budget, step limits, maps, errors of constants that the gates must detect.

use super::{
    COMPONENTWISE, LAGRANGIAN, RUBBER_RINGS, RingSettings, budget,
    metrics::*,
    plan::{Group, Row, SPEED, table},
    reference::Reference,
};
use base::{
    gate::{Bound, Evidence, Gate},
    mutation::Constant,
    record::{MetricKey, Record},
};
use harness::{
    case::{Case, Rules, Tier},
    declare::{
        Accuracy, Budget, Budgets, Card, Change, Comparison, CurveOf, CurvePanel, Curves,
        Declaration, ErrorOf, Ladder, Map, MapPanel, Sensitivity, StepLimit, StepLimits, Watched,
    },
    studies::causes::{ENOUGH_OR_IDLE, SAFETY_MARGIN, STEP, WIDE_BOUNDS},
};
use report::{Axis, Colour, exact, sig};

/// What is read from the phases of contact, which begin and end between two steps; extremes of every step;
/// and energies that lack the stress.
const STEPWISE: &[MetricKey] = &[
    RESTITUTION,
    RESTITUTION_ERROR,
    CONTACT_MOST,
    MODES_MOST,
    IMPULSE,
    IMPULSE_ERROR,
    T_IMPULSE_1,
    T_IMPULSE_50,
    T_IMPULSE_99,
    CONTACT_BEGIN_ERROR,
    CONTACT_END_ERROR,
    STRETCH_MOST,
    T_STRETCH_MOST,
    ENERGY_GAINED,
];

/// Everything that the harness draws and judges.
pub fn declaration(tier: Tier) -> Declaration {
    let accuracy = accuracy(tier);
    Declaration {
        card: Some(card(&accuracy[0])),
        curves: vec![histories(tier)],
        comparisons: comparisons(&accuracy),
        accuracy,
        budgets: Some(budgets()),
        limits: Some(limits(tier)),
        maps: maps(tier),
        sensitivity: Some(sensitivity(tier)),
        costly: &budget::METRICS,
        stepwise: STEPWISE,
        ..Declaration::default()
    }
}

/// The best variant and the paper's over their ladders, each with the reference of its law.
fn comparisons(accuracy: &[Accuracy]) -> Vec<Comparison> {
    const BECAUSE: &str = "computed for the same inputs; u_D: meshes, steps, contact, disorder \
                           (`references/rubber_rings`)";
    let of = |ladder: &Ladder| {
        let reference = Reference::of(ladder.variant, &RingSettings::default());
        let number = |quantity| reference.as_ref().and_then(|reference| reference.number(quantity));
        let share = |quantity| number(quantity).map_or(f64::NAN, |[value, spread]| spread / value);
        let histories = reference.as_ref().map_or(f64::NAN, |reference| reference.uncertainty);
        let quantities = [
            ("histories", HISTORIES, histories),
            ("restitution", RESTITUTION_ERROR, share(RESTITUTION)),
            ("least width", WIDTH_MIN_ERROR, share(WIDTH_MIN)),
        ];
        quantities.map(|(what, metric, uncertainty)| {
            Comparison::new(what, "finite elements", metric, ladder, (uncertainty, BECAUSE))
        })
    };
    let compared = |ladder: &&Ladder| [LAGRANGIAN, "seed"].contains(&ladder.variant);
    accuracy[0].ladders.iter().filter(compared).flat_map(of).collect()
}

/// What the report says first of the case.
fn card(accuracy: &Accuracy) -> Card {
    let reference = Reference::of("seed", &RingSettings::default());
    Card {
        title: "Colliding rubber rings, 0.059 c0 each",
        picture: ("rubber-rings-pictures", 2),
        error: "centre, width and height over time, in outer diameters".into(),
        metric: HISTORIES.into(),
        runs: accuracy.finest(&[LAGRANGIAN, "seed"]),
        against: "finite elements",
        uncertainty: reference.map(|reference| reference.uncertainty),
        reach: ("speed", "speeds of", " c0 each"),
    }
}

/// The best variant and the paper's, each with the reference of its law.
fn histories(tier: Tier) -> Curves {
    let table = table(tier);
    let variants = [LAGRANGIAN, "seed"];
    let labels = ["centre of mass [L]", "its velocity [c0]", "width [L]", "height [L]"];
    let panel = |(k, label): (usize, &str)| {
        let name = Reference::COLUMNS[k];
        let rows = variants.map(|of| table.of(Group::Paper).filter(move |row| row.variant == of));
        let lines = rows.into_iter().flatten().map(|row| CurveOf {
            name: format!("{}, spacing {} L", row.variant, exact(row.settings.spacing)),
            spec: row.run.spec.clone(),
            points: Box::new(move |record| {
                let [t, y] = ["t", name].map(|name| record.column("series", name));
                t.iter().copied().zip(y.iter().copied()).collect()
            }),
        });
        // The other law is a thin line without a name.
        let references = variants.iter().zip(["finite elements", ""]).filter_map(|(of, title)| {
            let reference = Reference::of(of, &RingSettings::default())?;
            let points = reference.times.iter().zip(&reference.columns[k]);
            Some((title.to_string(), points.map(|(t, y)| (*t, *y)).collect()))
        });
        let (lines, references) = (lines.collect(), references.collect());
        let (x, y) = (Axis::linear("t [L/c0]"), Axis::linear(label));
        CurvePanel { title: String::new(), x, y, lines, references, symbols: false }
    };
    Curves {
        id: "rubber-rings-histories".into(),
        title: "Histories over finite elements".into(),
        caption: format!(
            "Centre of mass of one of two rubber rings that collide at 0.059 c0 each, its velocity, and \
             the width along and height across the line of flight. Coloured: the best variant, `{}`, and \
             the paper's, `{}`. Black: finite elements with the law of the best; thin and grey, mostly \
             hidden by it: with the law of the paper. Their uncertainty is less than the width of the lines.",
            variants[0], variants[1]
        ),
        columns: 2,
        panels: labels.into_iter().enumerate().map(panel).collect(),
    }
}

fn accuracy(tier: Tier) -> Vec<Accuracy> {
    let table = table(tier);
    let variants: &[&str] = match tier {
        Tier::Quick => &["seed", "leapfrog", LAGRANGIAN],
        _ => &["seed", "leapfrog", "single-sweep", LAGRANGIAN],
    };
    let of = |what: &str, metric: MetricKey, label: &str, about: &str| {
        let id = format!("rubber-rings-{}", what.replace(' ', "-"));
        let ladder = |variant| {
            table.ladder(&[Group::Coarse, Group::Paper], variant, |s| {
                (s.spacing, format!("{} layers", (1.0 / s.spacing).round()))
            })
        };
        Accuracy {
            about: format!(
                "Rubber rings of thickness L collide at 0.059 c0 each; the reference is finite elements. \
                 {about} in runs to t = 200 L/c0."
            ),
            spacing: "spacing [L]",
            slope: Some(1.0),
            ladders: variants.iter().copied().map(ladder).collect(),
            ..Accuracy::new(&id, ErrorOf::Metric(metric.into()), label)
        }
    };
    vec![
        of(
            "histories",
            HISTORIES,
            "distance of the histories [outer diameters]",
            "The error is the largest of the root-mean-square distances of the centre of mass, the width and \
             the height of a ring over time, in outer diameters, 8 L,",
        ),
        of(
            "least width",
            WIDTH_MIN_ERROR,
            "relative error of the least width [-]",
            "The least width is compared",
        ),
    ]
}

fn budgets() -> Budgets {
    let change = |what: &str, part: &'static str, set: fn(&mut RingSettings)| {
        let spec = RUBBER_RINGS.spec("leapfrog", |s| {
            s.spacing = 0.25;
            set(s);
        });
        Change::new(what, part, spec)
    };
    let changes = vec![
        change("none", "", |_| {}),
        change("dt/2", "time", |s| s.courant *= 0.5),
        change("spacing 0.1 L", "space", |s| s.spacing = 0.1),
        change("α/4, β/4", "artificial viscosity", |s| {
            (s.alpha, s.beta) = (0.25 * s.alpha, 0.25 * s.beta);
        }),
        change("no XSPH", "XSPH", |s| s.xsph = 0.0),
        change("ξ = 0", "artificial stress", |s| s.xi = 0.0),
    ];
    Budgets {
        id: "rubber-rings-budget".into(),
        error: ErrorOf::Metric(WIDTH_MIN_ERROR.into()),
        label: "relative error of the least width".into(),
        about: "Rings collide at 0.059 c0 each at spacing 0.25 L. The error is that of the least width \
                against finite elements."
            .into(),
        of: vec![Budget { variant: "leapfrog", changes }],
    }
}

fn limits(tier: Tier) -> StepLimits {
    let variants: &[&str] = if tier == Tier::Quick { &["leapfrog"] } else { &["seed", "leapfrog"] };
    let about = "Rings of 4 layers collide at 0.059 c0 each, to t = 100 L/c0. A time step counts as stable \
                 if the energy never rises by more than 1 %. Theory is that of a stress-free lattice with \
                 artificial viscosity on every pair; rings have it on approaching pairs alone.";
    StepLimits::new("rubber-rings", about, variants.iter().map(|variant| step_limit(variant)))
}

fn step_limit(variant: &'static str) -> StepLimit {
    // A sample or a picture would shorten the step before it.
    let set = |s: &mut RingSettings| (s.spacing, s.end, s.samples) = (0.25, 100.0, 1);
    let spec = RUBBER_RINGS.spec(variant, set).keep_pictures(1);
    let rules = RUBBER_RINGS.rules(&spec).unwrap_or(Rules::REFUSED);
    let because = "Nothing drives the rings, so at the default step their energy must not rise.";
    let id = format!("rubber_rings.{variant}.step_limit");
    let bound = Bound::Above(1.0);
    let gate = Gate::new(id, "stable dt/default dt", bound, Evidence::Invariant, because);
    let limit =
        StepLimit::proportional(variant, "collision", spec, ("dt", rules.dt_limit()), &rules);
    StepLimit { of_default: vec![gate], ..limit }
}

/// Whole, torn or in pieces: over speed and spacing, and over the settings of what stabilises.
fn maps(tier: Tier) -> Vec<Map> {
    let table = table(tier);
    let whole = &[Group::Paper, Group::Speed][..];
    let is_shown = |row: &&Row| whole.contains(&row.group) || row.group == Group::Unstressed;
    let has = |is: &dyn Fn(&RingSettings) -> bool| {
        table.rows.iter().filter(is_shown).any(|row| is(&row.settings))
    };
    let mut speeds = vec![0.03, SPEED, 0.12, 0.2, 0.3];
    speeds.retain(|speed| has(&|s| s.speed == *speed));
    let mut spacings = vec![0.05, 0.1, 0.2];
    spacings.retain(|spacing| has(&|s| s.spacing == *spacing));
    let panel = |(title, variant, groups): (&str, &str, &[Group])| {
        MapPanel::over(title, &speeds, &spacings, |speed, spacing| {
            let rows = table.rows.iter().filter(|row| {
                let here = (row.settings.speed, row.settings.spacing) == (speed, spacing);
                here && row.variant == variant && groups.contains(&row.group)
            });
            rows.map(|row| row.run.spec.clone()).collect()
        })
    };
    let panels = [
        ("seed", "seed", whole),
        ("seed, ξ = 0", "seed", &[Group::Unstressed]),
        (COMPONENTWISE, COMPONENTWISE, whole),
        (LAGRANGIAN, LAGRANGIAN, whole),
    ];
    let mut maps = vec![map(
        ["fracture", "M2: whole, torn or in pieces over speed and spacing"],
        ["speed of each ring [c0]", "particle spacing [L]"],
        "over speed and particle spacing; an empty cell was not run. In runs by hand, rings of ten layers \
         hold at 0.08 c0 and tear at 0.09; rings of five hold at 0.08, are torn at 0.09, and hold at 0.12",
        panels.map(panel).into(),
    )];
    if tier == Tier::Quick {
        return maps;
    }
    let cell = |set: &dyn Fn(&mut RingSettings)| {
        let spec = RUBBER_RINGS.spec("seed", |s| {
            (s.spacing, s.speed) = (0.2, 0.12);
            set(s);
        });
        vec![spec.allow_unstable()]
    };
    let (xi, n) = ([0.0, 0.1, 0.2, 0.3, 0.5], [2, 4, 6]);
    let stress = |xi, n| cell(&|s| (s.xi, s.exponent) = (xi, n));
    maps.push(map(
        ["stress", "Stability over the artificial stress"],
        ["strength of the artificial stress ξ [-]", "exponent n [-]"],
        "at 0.12 c0 each, spacing 0.2 L, over strength and exponent of the artificial stress",
        vec![MapPanel::over("", &xi, &n, stress)],
    ));
    let viscosity = |alpha, _| cell(&|s| (s.alpha, s.beta) = (alpha, 2.0 * alpha));
    maps.push(map(
        ["viscosity", "Stability over the artificial viscosity"],
        ["artificial viscosity α [-]", ""],
        "at 0.12 c0 each, spacing 0.2 L, over the coefficient α of the artificial viscosity (β = 2α)",
        vec![MapPanel::over("", &[0.0, 0.5, 1.0, 2.0], &[""], viscosity)],
    ));
    maps
}

fn map([id, title]: [&str; 2], [x, y]: [&str; 2], over: &str, panels: Vec<MapPanel>) -> Map {
    let fates = [
        (Fate::Whole, Colour::GREEN),
        (Fate::Torn, Colour::YELLOW),
        (Fate::InPieces, Colour::ORANGE),
        (Fate::Diverged, Colour::VERMILLION),
    ];
    Map {
        id: format!("rubber-rings-{id}-map"),
        title: title.into(),
        caption: format!(
            "Outcome of a collision of two rubber rings {over}. Whole rings show the coefficient of \
             restitution e, or that they still touch at the end; torn rings (cut through once) the time of \
             the tear in L/c0, and others the largest number of pieces."
        ),
        x: x.into(),
        y: y.into(),
        outcomes: fates.map(|(fate, colour)| (fate.name().into(), colour)).into(),
        panels,
        outcome,
    }
}

fn outcome(records: &[&Record]) -> (usize, String) {
    let [record] = records else { return (Fate::Diverged as usize, String::new()) };
    let number = |metric| record.value(metric).map_or("–".into(), |value| sig(value, 2));
    let fate = Fate::of(record);
    let text = match fate {
        Fate::Whole if record.value(RESTITUTION).is_none() => "in touch".into(),
        Fate::Whole => format!("e = {}", number(RESTITUTION)),
        Fate::Torn => format!("at {}", number(TORN_AT)),
        Fate::InPieces => {
            let pieces = record.value(PIECES_MOST).map_or("–".into(), |n| n.to_string());
            format!("{pieces} pieces")
        }
        Fate::Diverged => fate.name().into(),
    };
    (fate as usize, text)
}

/// Errors of constants that the gates of the coarsest judged collision must detect.
fn sensitivity(tier: Tier) -> Sensitivity {
    const SPEED: &str = "Rings of five layers miss the reference by 9 % in restitution and by 14 % in width, \
        and the bounds that allow this leave room for an error of this size.";
    const STIFF: &str = "Rings of five layers bend too softly, so a ring that is stiffer for its mass comes \
        nearer to the reference, and one sign of the error passes. A shear modulus that is 11 % too low \
        fails the path of the centre, and with ten layers one that is 2 % too low fails the end of \
        contact.";
    const LOSS: &str = "Artificial viscosity takes a small part of the energy of the rings, and 30 % of that \
        part is inside the bounds on the restitution.";
    const STRESS: &str = "Artificial stress that is 30 % weaker still keeps the rings whole at this speed. \
        Its wrong sign and its absence are detected.";
    const XSPH: &str = "XSPH moves particles by a share of their relative velocities, which are small in a \
        ring. Not even its wrong sign fails a gate.";
    let watched = [
        Watched::blind_up_to(Constant::Speed, 0.2, SPEED, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::SoundSpeed, 1.0, STIFF, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::ShearModulus, 1.0, STIFF, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::Density, 1.0, STIFF, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::Height, 0.1, SPEED, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::Normalisation, 1.0, STIFF, &WIDE_BOUNDS),
        Watched::new(Constant::SmoothingLength).quick(),
        Watched::blind_up_to(Constant::TimeStep, 1.0, STEP, &SAFETY_MARGIN),
        Watched::blind_up_to(Constant::ArtificialViscosity, 1.0, LOSS, &WIDE_BOUNDS),
        Watched::blind_up_to(Constant::ArtificialStress, 1.0, STRESS, &ENOUGH_OR_IDLE)
            .faults(&[-1.0, 0.0]),
        Watched::blind_up_to(Constant::Xsph, 1.0, XSPH, &ENOUGH_OR_IDLE),
    ];
    let run = RUBBER_RINGS.spec("leapfrog", |s| s.spacing = 0.2);
    Sensitivity::new(RUBBER_RINGS.name, tier, [run], watched)
}

#[cfg(test)]
mod tests {
    use super::*;
    use harness::runs::Runs;

    /// It was left out with its gate, so that a report passed without them.
    #[test]
    fn a_step_limit_whose_run_is_refused_keeps_its_gate_and_fails_it() {
        let limits = Some(StepLimits::new("rubber-rings", "", [step_limit("no such variant")]));
        let declared = Declaration { limits, ..Declaration::default() };
        let studies = harness::studies::of("rubber_rings", &declared, &Runs::default());
        let judged: Vec<_> = studies.iter().flat_map(|study| &study.judged).collect();
        assert_eq!(judged.len(), 1);
        assert!(judged[0].judgement.verdict.is_failure());
    }
}
