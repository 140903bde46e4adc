//! The largest stable time step compared with theory.

use touchstone_base::{
    gate::Gate,
    spec::{Bisect, RunSpec},
};
use touchstone_report::Cell;

use super::anchor;
use crate::{
    bisect::STABLE,
    case::Case,
    columns::TableColumns,
    rules::Rules,
    runs::{Judged, Planned, Runs},
    section::Section,
    study::Study,
};

/// Metric of a gate on a step limit.
pub const OF_THEORY: &str = "measured/theory";

/// Largest stable time steps against theory.
#[derive(Default)]
pub struct StepLimits {
    /// The runs and the criterion of stability, in one or two sentences.
    pub about: String,
    /// One per variant and scene.
    pub of: Vec<StepLimit>,
}

/// The largest stable time step of one variant.
#[derive(Clone)]
pub struct StepLimit {
    /// The scene in words.
    pub scene: String,
    /// The bisection.
    pub spec: RunSpec,
    /// Theoretical limit \[s\].
    pub theory: f64,
    /// The x of the bisection at the theoretical limit.
    pub theory_at: f64,
    /// The x of the bisection at the default step.
    pub default_at: f64,
    /// A gate on the largest stable step over the theoretical limit.
    pub gate: Option<Gate>,
}

impl StepLimit {
    /// The bisection of a setting that is the time step over its theoretical limit, or proportional to it;
    /// `at_limit` returns the value of the setting at the limit, from the rules of the run with its default
    /// step. `gate` judges the largest stable step over the limit, from the default step over the limit.
    ///
    /// Without rules of its step the run is refused, and its record states why.
    pub fn proportional(
        case: &dyn Case,
        scene: impl Into<String>,
        spec: RunSpec,
        (setting, at_limit): (&str, impl Fn(&Rules) -> f64),
        gate: impl FnOnce(f64) -> Option<Gate>,
    ) -> Self {
        let rules = case.rules(&spec).unwrap_or(Rules::REFUSED);
        let (setting, unit) = (setting.to_string(), at_limit(&rules));
        let bisect = Bisect { setting, guess: 1.0, unit, resolution: 0.02, end: None };
        let default_at = rules.dt() / rules.dt_limit();
        Self {
            scene: scene.into(),
            spec: spec.allow_unstable().bisect(bisect),
            theory_at: 1.0,
            theory: rules.dt_limit(),
            default_at,
            gate: gate(default_at),
        }
    }
}

impl Study for StepLimits {
    fn runs(&self) -> Vec<Planned> {
        self.of.iter().map(|limit| Planned::new(limit.spec.clone())).collect()
    }

    fn evaluate(&self, case: &str, runs: &Runs) -> Option<Section> {
        let caption = format!("Largest stable time step of `{case}` by bisection. {}", self.about);
        let ratio = |value: Option<f64>| Cell::num(value.unwrap_or(f64::NAN), 3);
        let table = TableColumns::<StepLimit>::default()
            .code("variant", |limit| limit.spec.variant.clone())
            .text("scene", |limit| limit.scene.clone())
            .num(["theory", "s"], |limit| Cell::sci(limit.theory, 3))
            .num([OF_THEORY, "-"], |limit| ratio(of_theory(limit, runs)))
            .num(["default/theory", "-"], |limit| ratio(Some(limit.default_at / limit.theory_at)))
            .table(caption, &self.of);
        let mut section = Section::new(&anchor(case, "time-step"), "Largest stable time step");
        let judged =
            |limit: &StepLimit| Some(Judged::new(limit.gate.clone()?, of_theory(limit, runs)));
        section.judged.extend(self.of.iter().filter_map(judged));
        (!self.of.is_empty()).then(|| section.block(table))
    }
}

/// The largest stable step over the theoretical limit, if one was found.
pub fn of_theory(limit: &StepLimit, runs: &Runs) -> Option<f64> {
    stable(limit, runs).map(|x| x / limit.theory_at)
}

/// The largest stable x of the bisection.
fn stable(limit: &StepLimit, runs: &Runs) -> Option<f64> {
    runs.completed(&limit.spec)?.value(STABLE)
}

#[cfg(test)]
mod tests {
    use touchstone_base::{
        gate::{Bound, Evidence, Verdict},
        record::{Metric, Record},
    };

    use super::*;
    use crate::studies::tests::{column, evaluate, records, spec, tables};

    /// A limit of x = 1.2 where theory has 0.8 and the default is 0.6: 1.5 of theory, and default/theory
    /// 0.75.
    #[test]
    fn limit_and_default_step_are_stated_over_theory() {
        let bisect =
            Bisect { setting: "n".into(), guess: 1.0, unit: 1.0, resolution: 0.02, end: None };
        let bound = Bound::Within(1.49, 1.51);
        let gate = Gate::new("of theory", STABLE, bound, Evidence::Theory, "made up");
        let limit = |n: usize| StepLimit {
            scene: "made up".into(),
            spec: spec("seed", n).bisect(bisect.clone()),
            theory: 4e-3,
            theory_at: 0.8,
            default_at: 0.6,
            gate: Some(gate.clone()),
        };
        let limits = StepLimits { about: "Made up.".into(), of: vec![limit(8), limit(9)] };
        let stable = |record: &mut Record| {
            record.metrics.insert(STABLE.into(), Metric::new(1.2, "-", "made up"));
        };
        let runs = records([(limits.of[0].spec.clone(), stable)]);
        let section = evaluate(&limits, runs);
        let table = tables(&section)[0];
        for (head, expected) in
            [("theory", "4.00·10⁻³"), ("measured/theory", "1.50"), ("default/theory", "0.750")]
        {
            assert_eq!(column(table, head)[0], expected, "{head}");
        }
        let verdicts: Vec<(&str, Verdict)> = section
            .judged
            .iter()
            .map(|judged| (judged.gate.id.as_str(), judged.judgement.verdict))
            .collect();
        // The second was not made, so its gate fails.
        assert_eq!(verdicts, [("of theory", Verdict::Pass), ("of theory", Verdict::Fail)]);
    }
}
