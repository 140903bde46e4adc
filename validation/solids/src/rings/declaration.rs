//! What the studies that every case has are made of: histories over finite elements, errors over spacing and
//! cost, an error budget, step limits, maps.

use super::{
    LAGRANGIAN, RUBBER_RINGS, RingSettings, budget,
    metrics::{
        Fate, HEIGHT_MAX_ERROR, PIECES_MOST, RESTITUTION, RESTITUTION_ERROR, TORN_AT,
        WIDTH_MIN_ERROR,
    },
    plan::{self, FIVE_LAYERS, SPEED, collision},
    reference::Reference,
    sensitivity,
};
use base::{
    gate::{Bound, Evidence, Gate},
    record::{MetricKey, Record},
    spec::RunSpec,
};
use harness::{
    case::{Case, Planned, Rules, Tier},
    declare::{
        Accuracy, Budget, Budgets, Card, Change, CurveOf, CurvePanel, Curves, Declaration, ErrorOf,
        Ladder, Level, Map, MapPanel, StepLimit, StepLimits,
    },
};
use report::{Axis, Colour, exact, sig};

/// Everything that the harness draws and judges.
pub fn declaration(tier: Tier) -> Declaration {
    let mut maps = vec![fracture_map(tier)];
    if tier == Tier::Full {
        maps.extend([stress_map(), viscosity_map()]);
    }
    let accuracy = accuracy(tier);
    Declaration {
        card: Some(card(&accuracy[0])),
        curves: vec![histories(tier)],
        accuracy,
        budgets: Some(budgets(tier)),
        limits: Some(limits(tier)),
        maps,
        sensitivity: Some(sensitivity::sensitivity(tier)),
        costly: &budget::METRICS,
    }
}

/// What the report says first of the case.
fn card(accuracy: &Accuracy) -> Card {
    let reference = Reference::of("seed", &RingSettings::default());
    let number = reference.and_then(|reference| reference.number(RESTITUTION));
    Card {
        title: "Colliding rubber rings, 0.059 c0 each",
        picture: ("rubber-rings-pictures", 2),
        error: "restitution".into(),
        metric: RESTITUTION_ERROR.into(),
        runs: accuracy.finest(&[RUBBER_RINGS.best.variant, "seed"]),
        against: "finite elements",
        uncertainty: number.map(|(value, uncertainty)| uncertainty / value),
        reach: ("speed", "speeds of", " c0 each"),
    }
}

/// The best variant and the paper's, each with the reference of its law.
fn histories(tier: Tier) -> Curves {
    let variants = [RUBBER_RINGS.best.variant, "seed"];
    let named = ["finite elements", ""]; // the other law is a thin line
    let of_laws = variants.map(|variant| Reference::of(variant, &RingSettings::default()));
    let labels = ["centre of mass [L]", "its velocity [c0]", "width [L]", "height [L]"];
    let panel = |(k, name): (usize, &'static str)| {
        let line = |(variant, spacing): (&str, f64)| CurveOf {
            name: format!("{variant}, spacing {} L", exact(spacing)),
            spec: collision(variant, spacing, SPEED),
            points: Box::new(move |record| {
                let [t, y] = ["t", name].map(|name| record.column("series", name));
                t.iter().copied().zip(y.iter().copied()).collect()
            }),
        };
        let exact = of_laws.iter().zip(named).filter_map(|(reference, name)| {
            let reference = reference.as_ref()?;
            let points = reference.times.iter().zip(&reference.columns[k]);
            Some((name.to_string(), points.map(|(t, (y, _))| (*t, *y)).collect()))
        });
        let of = |variant| plan::spacings(variant, tier).iter().map(move |dx| (variant, *dx));
        CurvePanel {
            title: String::new(),
            x: Axis::linear("t [L/c0]"),
            y: Axis::linear(labels[k]),
            lines: variants.into_iter().flat_map(of).map(line).collect(),
            references: exact.collect(),
            symbols: false,
        }
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
        panels: Reference::COLUMNS.into_iter().enumerate().map(panel).collect(),
    }
}

/// Layers through the thickness of rings that only show how the error falls.
const COARSE: [f64; 2] = [1.0 / 3.0, 0.25];

/// The runs that `spec` makes of these spacings.
fn ladder(
    variant: &'static str,
    spacings: impl IntoIterator<Item = f64>,
    spec: impl Fn(f64) -> RunSpec,
) -> Ladder {
    let level = |spacing: f64| Level {
        run: Planned::new(spec(spacing)),
        spacing,
        label: format!("{} layers", (1.0 / spacing).round()),
    };
    Ladder::new(variant, spacings.into_iter().map(level))
}

fn ladders(tier: Tier) -> Vec<Ladder> {
    let over_spacings = |variant| {
        let spacings = COARSE.iter().chain(plan::spacings(variant, tier)).copied();
        ladder(variant, spacings, |spacing| collision(variant, spacing, SPEED))
    };
    let mut ladders: Vec<Ladder> =
        ["seed", "leapfrog", "componentwise", LAGRANGIAN].map(over_spacings).into();
    if tier == Tier::Full {
        let without_xsph =
            |spacing: f64| RUBBER_RINGS.spec("leapfrog", |s| (s.spacing, s.xsph) = (spacing, 0.0));
        let spacings = COARSE.into_iter().chain([FIVE_LAYERS, 0.1]);
        let note = " without XSPH".into();
        ladders.push(over_spacings("no-artificial-stress"));
        ladders.push(Ladder { note, ..ladder("leapfrog", spacings, without_xsph) });
    }
    ladders
}

/// Every run of the ladders.
pub fn specs_of_ladders(tier: Tier) -> impl Iterator<Item = RunSpec> {
    ladders(tier).into_iter().flat_map(|ladder| ladder.levels).map(|level| level.run.spec)
}

fn accuracy(tier: Tier) -> Vec<Accuracy> {
    let of = |what: &str, metric: MetricKey| {
        let id = format!("rubber-rings-{}", what.replace(' ', "-"));
        let (error, label) =
            (ErrorOf::Metric(metric.into()), format!("relative error of the {what} [-]"));
        Accuracy {
            about: format!(
                "Rubber rings of thickness L collide at 0.059 c0 each; the reference is finite elements. \
                 The {what} is compared in runs to t = 200 L/c0."
            ),
            spacing: "spacing [L]",
            slope: Some(1.0),
            ladders: ladders(tier),
            ..Accuracy::new(&id, error, &label)
        }
    };
    vec![
        of("restitution", RESTITUTION_ERROR),
        of("least width", WIDTH_MIN_ERROR),
        of("largest height", HEIGHT_MAX_ERROR),
    ]
}

fn budgets(tier: Tier) -> Budgets {
    let (spacing, variants): (f64, &[&'static str]) = match tier {
        Tier::Quick => (0.25, &["leapfrog"]),
        Tier::Full => (FIVE_LAYERS, &["seed", "leapfrog"]),
    };
    let budget = |variant: &&'static str| {
        let changed = |set: &dyn Fn(&mut RingSettings)| {
            RUBBER_RINGS.spec(variant, |s| {
                s.spacing = spacing;
                set(s);
            })
        };
        let less_viscous =
            |s: &mut RingSettings| (s.alpha, s.beta) = (0.25 * s.alpha, 0.25 * s.beta);
        let changes = vec![
            Change::new("none", "", collision(variant, spacing, SPEED)),
            Change::new("dt/2", "time", changed(&|s| s.courant *= 0.5)),
            Change::new("spacing 0.1 L", "space", collision(variant, 0.1, SPEED)),
            Change::new("α/4, β/4", "artificial viscosity", changed(&less_viscous)),
            Change::new("no XSPH", "XSPH", changed(&|s| s.xsph = 0.0)),
            Change::new("ξ = 0", "artificial stress", changed(&|s| s.xi = 0.0)),
        ];
        Budget { variant, changes }
    };
    Budgets {
        id: "rubber-rings-budget".into(),
        error: ErrorOf::Metric(WIDTH_MIN_ERROR.into()),
        label: "relative error of the least width".into(),
        about: format!(
            "Rings collide at 0.059 c0 each at spacing {spacing} L. The error is that of the least width \
             against finite elements."
        ),
        of: variants.iter().map(budget).collect(),
    }
}

fn limits(tier: Tier) -> StepLimits {
    let variants: &[&'static str] = match tier {
        Tier::Quick => &["leapfrog"],
        Tier::Full => &["seed", "leapfrog", "no-artificial-stress", "componentwise"],
    };
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

/// What a collision can come to.
fn outcomes() -> Vec<(String, Colour)> {
    let fates = [
        (Fate::Whole, Colour::GREEN),
        (Fate::Torn, Colour::YELLOW),
        (Fate::InPieces, Colour::ORANGE),
    ];
    let outcomes = fates.map(|(fate, colour)| (fate.name().into(), colour)).into_iter();
    outcomes.chain([("diverged".into(), Colour::VERMILLION)]).collect()
}

fn outcome(records: &[&Record]) -> (usize, String) {
    let [record] = records else { return (3, String::new()) };
    let number = |metric| record.value(metric).unwrap_or(f64::NAN);
    match Fate::of(record) {
        None => (3, "diverged".into()),
        Some(Fate::Whole) => {
            let parted = record.value(RESTITUTION).map(|restitution| sig(restitution, 2));
            (0, parted.map_or("in touch".into(), |restitution| format!("e = {restitution}")))
        }
        Some(Fate::Torn) => (1, format!("at {}", sig(number(TORN_AT), 2))),
        Some(Fate::InPieces) => (2, format!("{} pieces", number(PIECES_MOST))),
    }
}

/// Claim M2: whole, torn or in pieces over speed and spacing.
fn fracture_map(tier: Tier) -> Map {
    let mut speeds = [plan::speeds(tier), &[SPEED]].concat();
    speeds.sort_by(f64::total_cmp);
    let spacings = [0.05, 0.1, FIVE_LAYERS];
    let planned: Vec<RunSpec> =
        plan::collisions(tier).into_iter().map(|planned| planned.spec).collect();
    let panel = |variant: &str| {
        MapPanel::over(variant, &speeds, &spacings, |speed, spacing| {
            let spec = collision(variant, spacing, speed);
            if planned.contains(&spec) { vec![spec] } else { Vec::new() }
        })
    };
    Map {
        id: "rubber-rings-fracture-map".into(),
        title: "M2: whole, torn or in pieces over speed and spacing".into(),
        caption: "Outcome of collisions of two rubber rings over speed and particle spacing; an empty cell \
                  was not run. Whole rings show the coefficient of restitution e, or that they still touch \
                  at the end. Torn rings (cut through once) show the time of the tear in L/c0, and others \
                  the largest number of pieces."
            .into(),
        x: "speed of each ring [c0]".into(),
        y: "particle spacing [L]".into(),
        outcomes: outcomes(),
        panels: ["seed", "no-artificial-stress", "componentwise"].map(panel).into(),
        outcome,
    }
}

/// A cell of a map over settings: rings of five layers at 0.12 c0 each, whatever their step.
fn cell(set: impl FnOnce(&mut RingSettings)) -> Vec<RunSpec> {
    let spec = RUBBER_RINGS.spec("seed", |s| {
        (s.spacing, s.speed) = (FIVE_LAYERS, 0.12);
        set(s);
    });
    vec![spec.allow_unstable()]
}

/// Whole, torn or in pieces over ξ and n.
fn stress_map() -> Map {
    const XI: [f64; 5] = [0.0, 0.1, 0.2, 0.3, 0.5];
    const N: [usize; 3] = [2, 4, 6];
    let cell = |xi, n| cell(|s| (s.xi, s.exponent) = (xi, n));
    Map {
        id: "rubber-rings-stress-map".into(),
        title: "Stability over the artificial stress".into(),
        caption: "Outcome of a collision of two rubber rings at 0.12 c0 each, spacing 0.2 L, over strength \
                  and exponent of the artificial stress. Whole rings show the coefficient of restitution \
                  e, torn ones the time of the tear in L/c0, and others the largest number of pieces."
            .into(),
        x: "strength of the artificial stress ξ [-]".into(),
        y: "exponent n [-]".into(),
        outcomes: outcomes(),
        panels: vec![MapPanel::over("", &XI, &N, cell)],
        outcome,
    }
}

/// The same over α.
fn viscosity_map() -> Map {
    const ALPHA: [f64; 4] = [0.0, 0.5, 1.0, 2.0];
    let cell = |alpha, _| cell(|s| (s.alpha, s.beta) = (alpha, 2.0 * alpha));
    Map {
        id: "rubber-rings-viscosity-map".into(),
        title: "Stability over the artificial viscosity".into(),
        caption: "Outcome of a collision of two rubber rings at 0.12 c0 each, spacing 0.2 L, over the \
                  coefficient α of the artificial viscosity (β = 2α). Whole rings show the coefficient of \
                  restitution e, and torn ones the time of the tear in L/c0."
            .into(),
        x: "artificial viscosity α [-]".into(),
        y: String::new(),
        outcomes: outcomes(),
        panels: vec![MapPanel::over("", &ALPHA, &[""], cell)],
        outcome,
    }
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
