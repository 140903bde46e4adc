//! Each operator against what it must be to round-off, and with one of them wrong.

use base::gate::Verdict;
use harness::{case::Case, context::Context, runs::JudgedRun};

use super::{plan::plan, *};
use harness::case::Tier;

/// The gates of each planned control pass or fail as they must, by the name of the variant.
#[test]
fn a_wrong_viscosity_fails_the_gates_of_the_laplacian_and_no_other() {
    let broken = plan(Tier::Quick).into_iter().filter(|run| run.spec.mutation.is_some());
    let mut failed = Vec::new();
    for planned in broken {
        let context = Context { mutation: planned.spec.mutation, ..Context::default() };
        let record = OPERATORS.run(&planned.spec, &context).expect("a run");
        let (name, judged) = (planned.spec.variant.clone(), JudgedRun::new(planned, record).judged);
        let verdicts: Vec<_> = judged.iter().map(|judged| &judged.judgement.verdict).collect();
        match verdicts[..] {
            [Verdict::ExpectedFailure] => failed.push(name),
            ref others => assert_eq!(others, [&Verdict::Pass], "{name}"),
        }
    }
    assert_eq!(failed, ["quintic-laplacian", "quintic-laplacian-corrected"]);
}
