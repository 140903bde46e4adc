//! The examples that `CONTRIBUTING.md` names: the case gets every study that its declaration asks for.

use crate::decay::DECAY;
use touchstone_harness::case::Tier;
use touchstone_harness::make::BatchOptions;
use touchstone_harness::studies::Accuracy;
use touchstone_harness::suite;
use touchstone_solver::{Continuity, CubicSpline};
use touchstone_tests::{assert_small, new_term::CentralViscosity, open_rates, patch, relative_sum};

#[test]
fn a_new_case_is_short() {
    let lines = include_str!("../src/new_case.rs").lines();
    let lines = lines.skip_while(|line| !line.starts_with("touchstone_base::settings!")).count();
    assert!(lines <= 67, "{lines} lines from the settings on");
}

/// Forces along the line of centres, opposite in every pair: no force and no moment in all.
#[test]
fn a_new_term_conserves_both_momenta() {
    let particles = patch(8, 0.2, 3);
    let term = CentralViscosity { nu: 0.1, eta2: 1e-6 };
    let rates = open_rates::<CubicSpline, _, _, ()>(0.16, &particles, term, Continuity);
    let forces =
        || rates.iter().zip(&particles).map(|(rate, p)| (p.position, rate.velocity * p.mass));
    let moment = forces().map(|(x, f)| x.x * f.y - x.y * f.x);
    for sum in [relative_sum(forces().map(|(_, f)| f.x)), relative_sum(moment)] {
        assert_small("the sum of all forces, or of their moments, over their size", sum, 1e-12);
    }
}

#[test]
fn a_new_case_has_order_cost_budget_and_step_limit() {
    let making = BatchOptions::new(Tier::Quick, &|_| "these".into());
    let suite = suite::run(&[&DECAY], &making);
    let [results] = &suite.cases[..] else { panic!("one case") };
    let ids: Vec<&str> = results.sections.iter().map(|section| section.id.as_str()).collect();
    let expected = ["decay-work-precision", "decay-error-budget", "decay-time-step"];
    assert_eq!(ids, expected);
    for run in &results.runs.all {
        let record = &run.record;
        assert!(!record.metrics.is_empty(), "{:?}: {:?}", record.run.settings, record.status);
    }
    // Every run of the ladder was timed alone, and the error falls by more than half from level to level.
    let ladder = &results.studies.first::<Accuracy>().expect("an accuracy").ladders[1];
    let errors: Vec<f64> = ladder
        .levels
        .iter()
        .map(|level| {
            let record = results.runs.completed(&level.run.spec).expect("a record");
            assert!(!record.cost.alone_s.is_empty());
            record.metric("error").expect("measured")
        })
        .collect();
    let falls = errors.windows(2).all(|pair| pair[1] < 0.6 * pair[0]);
    assert!(
        falls,
        "errors of spacings that are halved: expected each below 0.6 of the last: {errors:?}"
    );
}
