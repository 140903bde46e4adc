//! How far the default time step of each variant is from where its run blows up.

use super::{
    Channel, ChannelSettings, Flow,
    measure::{L2, V_RMS},
};
use base::{
    gate::{Bound, Evidence, Gate},
    record::{MetricName, Record, Status},
    spec::{Bisect, EndAfter},
};
use harness::{
    case::{Case, Rules, Tier},
    declare::{StepLimit, StepLimits},
};

/// Steps of a run; growth of 1 % a step fills the eight decades from the disturbance to V.
const STEPS: f64 = 1500.0;
/// Disorder of the lattice at the start \[dx\].
const DISORDER: f64 = 1e-6;

/// Completed, and neither cross-flow nor error is as large as the flow itself.
pub fn is_stable(record: &Record) -> bool {
    let is_small = |metric: MetricName| record.value(metric).is_some_and(|value| value < 1.0);
    let settings: ChannelSettings = record.settings_as();
    let mut compared = settings.compared().into_iter();
    record.status == Status::Completed
        && is_small(V_RMS.into())
        && compared.all(|tau| is_small(L2.at(tau)))
}

/// The step limits of a flow: of Couette flow all in the full tier, of Poiseuille flow the paper's and what
/// Couette flow does not have.
pub fn limits(channel: Channel, tier: Tier) -> StepLimits {
    let variants: Vec<&str> = match (channel.flow, tier) {
        (Flow::Couette, Tier::Quick) => vec!["seed", "interface-wall", "plain", "modern"],
        (Flow::Couette, _) => BEFORE.iter().map(|(variant, _)| *variant).collect(),
        (Flow::Poiseuille, Tier::Quick) => vec!["seed"],
        (Flow::Poiseuille, _) => vec!["seed", "curved"],
    };
    let about = format!(
        "The default step of each variant, and how many times longer it could be, for 20 rows between walls \
         on a lattice disturbed by {DISORDER:e} dx, over {STEPS} steps. A run is unstable if it diverges, \
         or if its cross-flow or error exceeds V. Theory is that of the periodic lattice with sound, \
         viscosity and other damping, without walls, motion and stabilisers."
    );
    let of = variants.into_iter().map(|variant| limit(channel, variant));
    StepLimits::new(channel.case.name, &about, of)
}

fn limit(Channel { flow, case }: Channel, variant: &'static str) -> StepLimit {
    let spec = case.spec(variant, |s| s.jitter = DISORDER).allow_unstable();
    let rules = case.rules(&spec).unwrap_or(Rules::REFUSED);
    // Not `dt_limit`, in the last bit: bisections begin where they always have.
    let theory = rules.dt() / (rules.dt() / rules.dt_limit());
    let unit = ChannelSettings::default().unit_of_time();
    let bisect = Bisect {
        setting: "dt".into(),
        guess: theory,
        unit: 1.0,
        resolution: 0.01,
        end: Some(EndAfter { steps: STEPS, unit }),
    };
    let name = match flow {
        Flow::Couette => format!("stability.default.{variant}"),
        Flow::Poiseuille => format!("poiseuille.time-step.{variant}"),
    };
    let gate = |what: &str, metric: &str, least: f64, evidence, because: &str| {
        Gate::new(format!("{name}.{what}"), metric, Bound::Above(least), evidence, because)
    };
    let because = "The default time step must be below the measured limit of stability.";
    let stable = gate("stable", OF_DEFAULT, 1.0, Evidence::Theory, because);
    let before = BEFORE.iter().find(|(known, _)| flow == Flow::Couette && *known == variant);
    let (mut of_theory, mut of_default) = (Vec::new(), vec![stable]);
    if let Some((_, [margin, ratio])) = before {
        let because = "The bound is what this study measured when its baseline was set, less 1 % for the \
                       resolution of the bisection.";
        let no_less = |what: &str, metric: &str, value: f64| {
            gate(what, metric, 0.99 * value, Evidence::Regression, because)
        };
        of_theory.push(no_less("ratio", "measured/theory", *ratio));
        of_default.push(no_less("margin", OF_DEFAULT, *margin));
    }
    StepLimit {
        variant,
        scene: "20 rows".into(),
        spec: spec.bisect(bisect),
        theory,
        theory_at: theory,
        default_at: rules.dt(),
        of_theory,
        of_default,
    }
}

const OF_DEFAULT: &str = "longest stable dt/default dt";

/// Variant of Couette flow at 20 rows: longest stable dt over the default dt, and over the theory of the
/// periodic lattice, as they were measured when they were first written down: not the truth, but nothing may
/// get worse unnoticed. They depend on no clock and no machine, only on the program and, in their last
/// digits, on its libm. A change that moves one on purpose changes it here, and says why.
const BEFORE: &[(&str, [f64; 2])] = &[
    ("seed", [2.8455, 1.0098]),
    ("interface-wall", [2.8596, 1.0148]),
    ("wendland-leapfrog", [1.2903, 1.0101]),
    ("plain", [1.3271, 1.0200]),
    ("modern", [1.3336, 1.0250]),
    ("single-sweep", [1.373, 1.055]),
    ("stiff", [1.3970, 1.0478]),
    ("extrapolating-wall", [1.3401, 1.0299]),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::couette::COUETTE;

    /// The gates of a variant whose default settings were refused were not there at all.
    #[test]
    fn a_variant_that_is_refused_keeps_its_gates() {
        let channel = Channel { flow: Flow::Couette, case: &COUETTE };
        let refused = limit(channel, "no such variant");
        assert_eq!(refused.of_default[0].id, "stability.default.no such variant.stable");
        assert!(refused.of_default[0].judge(None).verdict.is_failure());
    }

    #[test]
    fn every_variant_of_couette_flow_has_a_limit_and_a_baseline() {
        let channel = Channel { flow: Flow::Couette, case: &COUETTE };
        let limits = limits(channel, Tier::Full).of;
        assert_eq!(limits.len(), COUETTE.variants().len());
        for variant in COUETTE.variants() {
            let limit = limits.iter().find(|limit| limit.variant == variant.name);
            let limit = limit.unwrap_or_else(|| panic!("{}", variant.name));
            assert_eq!((limit.of_theory.len(), limit.of_default.len()), (1, 2), "{}", variant.name);
        }
    }
}
