//! The solver of another library that `docs/rust.md` names is judged, and has a section of the report.

use serde_json::json;
use touchstone_exchange::{
    library::Solver,
    problem::ExportedProblem,
    submission::{Method, System},
};
use touchstone_harness::{
    case::{Case, Tier, spec},
    foreign::ForeignParticle,
    gates::GateIndex,
    make::BatchResult,
    suite,
};
use touchstone_tests::foreign_solver::FiniteDifferences;

#[test]
fn a_solver_of_another_library_is_judged_and_has_a_section() {
    for name in ["couette", "poiseuille"] {
        let case: &dyn Case = touchstone_cases::find(name).unwrap();
        let of = spec(case, "seed", &[]).unwrap();
        let record = |cells| {
            let solver = FiniteDifferences { cells };
            touchstone_exchange::library::record(case, &of, &solver)
                .unwrap_or_else(|error| panic!("{error}"))
        };
        let [coarse, fine] = [8, 32].map(|cells| {
            let error = record(cells).metrics["l2@0.2"].value;
            assert!(error.is_finite(), "{name} with {cells} cells: the error is {error}");
            error
        });
        // Of second order: 16 times less with cells of a quarter.
        assert!((8.0..32.0).contains(&(coarse / fine)), "{name}: errors are {coarse} and {fine}");
        let run = suite::submitted(&GateIndex::of(case), record(32));
        let (apply, _) = run.applicable();
        assert!(apply.len() >= 4, "{name}: {} gates apply", apply.len());
        let failed = apply.iter().filter(|judged| judged.judgement.verdict.is_failure());
        assert_eq!(failed.map(|judged| &judged.gate.id).collect::<Vec<_>>(), Vec::<&String>::new());
        let made = BatchResult { submissions: vec![record(32)], ..BatchResult::default() };
        let suite = suite::judge(vec![(case, Vec::new())], Tier::Quick, made);
        let section =
            suite.cases[0].sections.iter().find(|s| s.id == format!("{name}-submissions"));
        assert!(section.is_some(), "{name} has a section of other codes");
    }
}

/// Finite differences of a fluid with another viscosity, which may say that they are our own method.
struct Other {
    states: bool,
    viscosity: f64,
    case: &'static str,
}

impl Other {
    fn problem(&self) -> ExportedProblem {
        let case = touchstone_cases::find(self.case).unwrap();
        let of = spec(case, "plain", &["rows=20".into()]).unwrap();
        ExportedProblem::of(case, of).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The verdict of the gate on the error, none if it does not apply.
    fn verdict(&self, gate: &str) -> Option<(String, bool)> {
        let case: &dyn Case = touchstone_cases::find(self.case).unwrap();
        let of = spec(case, "plain", &["rows=20".into()]).unwrap();
        let record =
            touchstone_exchange::library::record(case, &of, self).unwrap_or_else(|e| panic!("{e}"));
        let run = suite::submitted(&GateIndex::of(case), record);
        let (apply, _) = run.applicable();
        let judged = apply.into_iter().find(|judged| judged.gate.id == gate)?;
        Some((judged.gate.bounds(), judged.judgement.verdict.is_failure()))
    }
}

impl Solver for Other {
    fn method(&self) -> Method {
        let mut method = FiniteDifferences { cells: 64 }.method();
        let problem = self.problem();
        let support = problem.outline.method.support * problem.outline.medium.h;
        let ours = json!({
            "kernel": problem.outline.method.kernel, "support": support, "dt": problem.outline.dt
        });
        if self.states {
            method.settings = ours.as_object().unwrap().clone();
        }
        method
    }

    fn solve(
        &self,
        problem: &ExportedProblem,
        tell: &mut dyn FnMut(f64, Vec<ForeignParticle>),
    ) -> System {
        let mut other = self.problem();
        assert_eq!(other.outline.times, problem.outline.times);
        other.outline.medium.nu *= self.viscosity;
        let system = FiniteDifferences { cells: 64 }.solve(&other, tell);
        System { steps: None, ..system }
    }
}

/// Finite differences with an error of 0.002 % must not fail a window around the error of our own kernel and
/// step. A code that states our kernel and step is judged by this window; a kernel with a norm off by 2 %, as
/// in a viscosity, is outside.
#[test]
fn a_better_method_passes_and_one_that_states_ours_must_have_our_error() {
    for (case, gate) in
        [("couette", "couette.plain.20.l2@0.1"), ("poiseuille", "poiseuille.plain.20.l2@1")]
    {
        let verdict = |states, viscosity| {
            let found = Other { states, viscosity, case }.verdict(gate);
            found.unwrap_or_else(|| panic!("{gate} does not apply"))
        };
        let (bound, fails) = verdict(false, 1.0);
        assert!(!fails && bound.starts_with("at most"), "{gate}: {bound}");
        assert!(verdict(false, 2.0).1, "{gate}: twice the viscosity");
        for viscosity in [1.0, 1.02, 0.98] {
            let (bound, fails) = verdict(true, viscosity);
            assert!(fails && bound.contains(" to "), "{gate}, viscosity {viscosity}: {bound}");
        }
    }
}

/// Writes the last particle of each frame twice.
struct Twice;

impl Solver for Twice {
    fn method(&self) -> Method {
        FiniteDifferences { cells: 8 }.method()
    }

    fn solve(
        &self,
        problem: &ExportedProblem,
        tell: &mut dyn FnMut(f64, Vec<ForeignParticle>),
    ) -> System {
        FiniteDifferences { cells: 8 }.solve(problem, &mut |time, mut placed| {
            placed.extend(placed.last().copied());
            tell(time, placed);
        })
    }
}

#[test]
fn what_a_solver_of_another_library_tells_is_checked() {
    let case: &dyn Case = touchstone_cases::find("couette").unwrap();
    let of = spec(case, "seed", &[]).unwrap();
    let error = touchstone_exchange::library::record(case, &of, &Twice).expect_err("no record");
    assert!(error.to_string().contains("is there twice at t = "), "{error}");
}
