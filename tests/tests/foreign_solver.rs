//! What `docs/your-method.md` shows of a solver of another library is compiled here, judged, and has a
//! section of the report.

use std::fs;
use std::path::Path;

use harness::{
    case::{Case, Tier, spec},
    make::Made,
    suite,
};
use touchstone_tests::foreign_solver::FiniteDifferences;

const SOLVER: &str = include_str!("../src/foreign_solver.rs");

#[test]
fn the_page_shows_what_is_compiled() {
    assert!(SOLVER.lines().count() <= 75, "{} lines", SOLVER.lines().count());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/your-method.md");
    let text = fs::read_to_string(path).expect("a text");
    assert!(text.contains(&format!("```rust\n{SOLVER}```")), "the page has another text");
}

#[test]
fn a_solver_of_another_library_is_judged_and_has_a_section() {
    for name in ["couette", "poiseuille"] {
        let case: &dyn Case = validation::cases::find(name).unwrap();
        let of = spec(case, "seed", &[]).unwrap();
        let record = |cells| {
            let solver = FiniteDifferences { cells };
            exchange::library::record(case, &of, &solver).unwrap_or_else(|error| panic!("{error}"))
        };
        let [coarse, fine] = [8, 32].map(|cells| {
            let error = record(cells).metrics["l2@0.2"].value;
            assert!(error.is_finite(), "{name} with {cells} cells: the error is {error}");
            error
        });
        // Of second order: 16 times less with cells of a quarter.
        assert!((8.0..32.0).contains(&(coarse / fine)), "{name}: errors are {coarse} and {fine}");
        let run = suite::submitted(case, record(32));
        let (apply, _) = run.applicable();
        assert!(apply.len() >= 4, "{name}: {} gates apply", apply.len());
        let failed = apply.iter().filter(|judged| judged.judgement.verdict.is_failure());
        assert_eq!(failed.map(|judged| &judged.gate.id).collect::<Vec<_>>(), Vec::<&String>::new());
        let made = Made { submissions: vec![record(32)], ..Made::default() };
        let suite = suite::judge(vec![(case, Vec::new())], Tier::Quick, made);
        let section = suite.cases[0].studies.iter().find(|s| s.id == format!("{name}-submissions"));
        assert!(section.is_some(), "{name} has a section of other codes");
    }
}
