//! What the studies that every case has are made of: the front of the column of Martin & Moyce over
//! resolutions, what its error is made of, and the longest stable time steps in both scenes.

use super::{
    DAM_BREAK, DamSettings, NAME, front, lobovsky, metrics::FRONT, reference::FRONT_SPREAD,
    run::COSTLY, sensitivity, specs,
};
use base::{
    gate::{Bound, Evidence, Gate},
    record::Record,
    spec::RunSpec,
};
use harness::{
    case::{Case, Rules, Tier},
    declare::{
        Accuracy, Budget, Budgets, Card, Change, Declaration, ErrorOf, Ladder, Level, StepLimit,
        StepLimits,
    },
};

/// All of it.
pub fn declaration(tier: Tier) -> Declaration {
    let accuracy = accuracy(tier);
    let (budgets, limits) = (Some(budgets(tier, &accuracy)), Some(limits(tier)));
    let sensitivity = Some(sensitivity::sensitivity(tier));
    Declaration {
        card: Some(card(tier)),
        accuracy: vec![accuracy],
        budgets,
        limits,
        sensitivity,
        costly: COSTLY,
        ..Declaration::default()
    }
}

/// What the report says first of the case.
fn card(tier: Tier) -> Card {
    let finest = |variant: &str| {
        let n = specs::martin_moyce(variant, tier).last().copied().unwrap_or_default();
        specs::free(tier, variant, n)
    };
    Card {
        title: "Dam break",
        picture: ("dam-break-martin-moyce-pictures", 3),
        error: "front after its best shift in time, rms in column widths".into(),
        metric: FRONT.rms_shifted.into(),
        runs: vec![finest(DAM_BREAK.best.variant), finest("seed")],
        against: "the experiment of Martin & Moyce",
        uncertainty: Some(FRONT_SPREAD),
        reach: ("n", "", " spacings across the column"),
    }
}

/// rms distance of two fronts \[a\].
fn between(one: &Record, other: &Record) -> f64 {
    front::rms(&front::front(one), &front::front(other), front::LATER)
}

/// Variants and resolutions of the ladders: successive spacings differ by √2 or nearly so, and each fills
/// the column.
pub fn ladders(tier: Tier) -> Vec<(&'static str, &'static [usize])> {
    match tier {
        Tier::Quick => {
            ["seed", "modern", "modern-interface"].map(|v| (v, &[7, 10, 14, 20][..])).to_vec()
        }
        Tier::Full => vec![
            ("seed", &[10, 14, 20, 28, 40]),
            ("modern", &[10, 14, 20, 28, 40]),
            ("seed-no-stress", &[10, 14, 20, 28]),
            ("modern-interface", &[10, 14, 20, 28]),
            ("modern-bare", &[10, 14, 20, 28]),
        ],
    }
}

fn accuracy(tier: Tier) -> Accuracy {
    // The finest run of `modern`.
    let n = specs::martin_moyce("modern", tier).last().copied().unwrap_or_default();
    let error = ErrorOf::Distance { finest: specs::free(tier, "modern", n), between };
    let level = |variant: &str, n: usize| Level {
        run: specs::planned_free(tier, variant, n),
        spacing: 1.0 / n as f64,
        label: format!("a/dx {n}"),
    };
    let ladder = |(variant, resolutions): (&'static str, &[usize])| {
        Ladder::new(variant, resolutions.iter().map(|n| level(variant, *n)))
    };
    let about = format!(
        "Front Z(T), 1 ≤ T ≤ 3.3, of the column of Martin & Moyce. Per cent are of its width a. An error \
         is the rms distance from the front of `modern` at a/dx = {n}, which is itself short of the limit, \
         so an error smaller than the last one of its own series says no more."
    );
    Accuracy {
        about,
        spacing: "dx/a [-]",
        slope: Some(1.0),
        ladders: ladders(tier).into_iter().map(ladder).collect(),
        ..Accuracy::new("dam-break", error, "rms distance of the front [a]")
    }
}

/// A change of the settings.
type Set = fn(&mut DamSettings);

fn budgets(tier: Tier, accuracy: &Accuracy) -> Budgets {
    let n = match tier {
        Tier::Quick => 10,
        Tier::Full => 20,
    };
    let changes = |variant: &'static str, own: &[(&str, &'static str, Set)]| {
        let changed = |set: Set| {
            let change = |s: &mut DamSettings| {
                s.n = n;
                set(s);
            };
            // A change may ask more of the time step than the variant's own settings do.
            DAM_BREAK.spec(variant, change).allow_unstable()
        };
        let mut changes = vec![
            Change::new("none", "all", specs::free(tier, variant, n)),
            Change::new("dt/2", "time", changed(|s| s.courant *= 0.5)),
            Change::new("dx/2", "spacing", specs::free(tier, variant, 2 * n)),
            Change::new("2 c0", "compressibility", changed(|s| s.c0 *= 2.0)),
            Change::new("alpha/2", "artificial viscosity", changed(|s| s.alpha *= 0.5)),
            Change::new("h/dx 2", "smoothing", changed(|s| s.h_over_dx = 2.0)),
        ];
        changes.extend(own.iter().map(|(what, part, set)| Change::new(*what, part, changed(*set))));
        Budget { variant, changes }
    };
    let mut of =
        vec![changes("modern", &[("delta/2", "density diffusion", |s| s.diffusion *= 0.5)])];
    if tier == Tier::Full {
        of.push(changes(
            "seed",
            &[
                ("no artificial stress", "artificial stress", |s| s.xi = 0.0),
                ("no XSPH", "XSPH", |s| s.xsph = 0.0),
            ],
        ));
    }
    Budgets::of(accuracy, of)
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
    let all =
        ["modern", "modern-bare", "seed-leapfrog", "seed"].into_iter().flat_map(of).take(most);
    let about = "A time step counts as stable if the collapse ends with its energy accounted for within 2 \
                 %. Theory is the limit of a lattice at rest. Water that moves, is compressed and loses \
                 its lattice is expected at 0.7 to 1.0 of it.";
    StepLimits::new("dam-break", about, all)
}

/// The theoretical limit of the time step as the record's dt and dt/limit state it \[s\].
pub fn theory(rules: &Rules) -> f64 {
    rules.dt() / (rules.dt() / rules.dt_limit())
}

fn limit(variant: &'static str, scene: &str, spec: RunSpec) -> StepLimit {
    let rules = DAM_BREAK.rules(&spec).unwrap_or(Rules::REFUSED);
    let because = "Theory is the limit of a lattice at rest. Moving, disordered water is expected at 0.7 \
                   to 1.0 of it, and the step of the case must be below what is measured. A run that holds \
                   at 1.2 would measure another limit, because the stiffest mode of leapfrog grows \
                   3.5-fold a step there.";
    let id = format!("{NAME}.limit.{variant}.{}", scene.split(' ').next().unwrap_or_default());
    let bound = Bound::Within(rules.dt() / rules.dt_limit(), 1.2);
    let gate = Gate::new(id, "measured/theory", bound, Evidence::Theory, because);
    let setting = ("dt", theory(&rules));
    let limit = StepLimit::proportional(variant, scene, spec, setting, &rules);
    StepLimit { of_theory: vec![gate], ..limit }
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
