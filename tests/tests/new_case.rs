//! The case that `CONTRIBUTING.md` shows is this one, and it gets every study that a declaration asks for.

use std::fs;
use std::path::Path;

use harness::case::Case;
use harness::case::Tier;
use harness::make::Making;
use harness::suite;
use touchstone_tests::new_case::DECAY;

const SOURCE: &str = include_str!("../src/new_case.rs");

#[test]
fn contributing_shows_this_case_and_it_is_short() {
    assert!(SOURCE.lines().count() <= 80, "{} lines", SOURCE.lines().count());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../CONTRIBUTING.md");
    let text = fs::read_to_string(path).expect("a text");
    assert!(text.contains(&format!("```rust\n{SOURCE}```")), "CONTRIBUTING.md shows another case");
}

#[test]
fn a_new_case_has_order_cost_budget_and_step_limit() {
    let making = Making {
        tier: Tier::Quick,
        store: None,
        sources: &|_| "these".into(),
        reuse_other: false,
        progress: None,
        interrupt: None,
    };
    let suite = suite::run(&[&DECAY], &making).expect("runs");
    let [results] = &suite.cases[..] else { panic!("one case") };
    let ids: Vec<&str> = results.studies.iter().map(|study| study.id.as_str()).collect();
    let expected =
        ["decay-convergence", "decay-work-precision", "decay-error-budget", "decay-time-step"];
    assert_eq!(ids, expected);
    for run in results.runs.all() {
        let record = &run.record;
        assert!(!record.metrics.is_empty(), "{:?}: {:?}", record.settings, record.status);
    }
    // Every run of the ladder was timed alone, and the error falls by more than half from level to level.
    let ladder = &DECAY.declaration(Tier::Quick).accuracy[0].ladders[1];
    let errors: Vec<f64> = ladder
        .levels
        .iter()
        .map(|level| {
            let record = results.runs.completed(&level.run.spec).expect("a record");
            assert!(!record.cost.alone_s.is_empty());
            record.metric("error").expect("measured")
        })
        .collect();
    assert!(errors.windows(2).all(|pair| pair[1] < 0.6 * pair[0]), "{errors:?}");
}
