//! `verify`: plans of cases, judged.

use std::path::Path;
use std::time::Instant;
use touchstone_base::gate::Verdict;

use touchstone_harness::{
    case::{Case, Tier},
    make::{self, BatchOptions, StoredRuns},
    store::Store,
    suite::{self, JudgedOf, Plans, Suite},
};

use touchstone_cases::peers;
use touchstone_report::counted;

use super::{
    Early, Exit, Failure, Outcome, Session, arguments, judged, output, partial::partial,
    report_problems, summary::summary, trouble,
};

pub fn verify(arguments: &arguments::Verify, session: &Session) -> Outcome {
    let arguments::Verify { of, store, no_runs, timings, making } = arguments;
    show(of, session, |cases| {
        if *no_runs {
            return of_store(cases, of.tier, store, making.any_build, session);
        }
        let plans = plans(cases, of.tier, session)?;
        let plans = if *timings { plans } else { without_timings(plans) };
        run(plans, of.tier, &Store::open(store)?, *making, None, session)
    })
}

/// The results on standard output; how they came about on standard error.
fn show(
    of: &arguments::Judged,
    session: &Session,
    judged: impl FnOnce(&[&'static dyn Case]) -> Result<Suite, Failure>,
) -> Outcome {
    let cases = session.choose(&of.cases)?;
    let start = Instant::now();
    let suite = judged(&cases)?;
    let exported = judged::write_junit(&suite, of.junit.as_deref());
    let printed = if of.json {
        output::print_whole(&judged::json(&suite)?)
    } else {
        let all = if of.all {
            judged::table(suite.judged().map(|of| of.judged)) + "\n"
        } else {
            String::new()
        };
        output::print(&(all + &summary(&suite)))
    };
    let took = touchstone_report::seconds(start.elapsed().as_secs_f64());
    output::say(&format!("{} in {took}", runs(&suite)));
    exported?;
    printed?;
    Ok(exit(&suite))
}

/// `206 runs, 12 of them from the store`, or of a store without our own runs `3 runs of other codes`.
pub fn runs(suite: &Suite) -> String {
    let all: usize = suite.cases.iter().map(|results| results.runs.all.len()).sum();
    let others = suite.submissions().count();
    if all == 0 && others > 0 {
        return counted(others, "run of another code", "runs of other codes");
    }
    let other = match suite.made.of_other_sources {
        0 => String::new(),
        count => format!(", {count} of these made by a build of other sources"),
    };
    let all = counted(all, "run", "runs");
    match suite.made.reused {
        0 => all,
        count => format!("{all}, {count} of them from the store{other},"),
    }
}

/// Exit code for failed runs and records; 1 if a gate failed.
pub fn exit(suite: &Suite) -> Exit {
    let fails = |of: JudgedOf| of.judged.judgement.verdict == Verdict::Fail;
    let mut all = suite.judged().chain(suite.submitted()).peekable();
    let verdict = match (all.peek().is_none(), suite.submissions().next().is_none()) {
        (true, false) => {
            output::say("touchstone: no gate applies to the runs of other codes in the store");
            Exit::Usage
        }
        _ if all.any(fails) => Exit::GateFailed,
        _ => Exit::Pass,
    };
    trouble(&suite.made).unwrap_or(verdict)
}

/// The plans of cases whose references are sound.
pub fn plans(cases: &[&'static dyn Case], tier: Tier, session: &Session) -> Result<Plans, Failure> {
    session.check_references(cases)?;
    Ok(suite::plans(cases, tier))
}

/// These plans with no run timed: no gate judges seconds.
pub fn without_timings(mut plans: Plans) -> Plans {
    plans.iter_mut().flat_map(|(_, plan)| plan).for_each(|planned| planned.timed = false);
    plans
}

/// Makes the missing runs of a store, on a pool, with a bar, and refuses to judge interrupted runs.
pub fn run(
    plans: Plans,
    tier: Tier,
    store: &Store,
    asked: arguments::MakeArguments,
    early: Option<&Early>,
    session: &Session,
) -> Result<Suite, Failure> {
    let jobs = make::jobs(plans.clone());
    let arguments::MakeArguments { any_build: reuse_other, fresh, threads } = asked;
    let making = BatchOptions { store: Some(store), reuse_other, fresh, ..session.making(tier) };
    let mut made = session.make(&jobs, making, threads, early)?;
    if made.interrupted {
        let (kept, all) = (made.records.len() - made.not_kept.len(), jobs.len());
        return Err(Failure::interrupted(match fresh {
            true => format!(
                "nothing is judged; runs made again: {kept} of {all}; the other records are unchanged"
            ),
            false => format!(
                "nothing is judged; records stored: {kept} of {all}; the same command makes the others"
            ),
        }));
    }
    peers::add(&mut made, &plans);
    Ok(suite::judge(plans, tier, made))
}

/// Judges the runs of a store without making any.
pub fn of_store(
    cases: &[&'static dyn Case],
    tier: Tier,
    path: &Path,
    any_build: bool,
    session: &Session,
) -> Result<Suite, Failure> {
    let (mut plans, stored) = stored(cases, tier, path, any_build, session)?;
    if has_submissions_alone(&stored) {
        plans.iter_mut().for_each(|(_, plan)| plan.clear());
        return Ok(partial(plans, tier, path, stored).0);
    }
    Ok(of_stored(plans, tier, stored))
}

/// Whether a store holds only runs of other codes; missing runs are no failure then.
pub fn has_submissions_alone(stored: &StoredRuns) -> bool {
    let StoredRuns { made, other, .. } = stored;
    let is_alone = made.records.is_empty() && made.unsound.is_empty() && *other == 0;
    if is_alone && !made.submissions.is_empty() {
        output::say("note: the store has runs of other codes alone; only these are judged");
    }
    is_alone && !made.submissions.is_empty()
}

/// Judges the stored runs of plans; gates of missing runs fail.
pub fn of_stored(
    plans: Plans,
    tier: Tier,
    StoredRuns { made, missing, other }: StoredRuns,
) -> Suite {
    if !missing.is_empty() {
        let (all, missing) = (made.reused + missing.len(), missing.len() - other);
        output::say(&format!(
            "note: runs of the {} tier: {all}; the store lacks {missing}, and has {other} made by a build of \
             other sources (--any-build accepts them); the gates of both fail",
            judged::tier_name(tier)
        ));
    }
    suite::judge(plans, tier, made)
}

/// The plans of a tier, and the stored runs.
pub fn stored(
    cases: &[&'static dyn Case],
    tier: Tier,
    path: &Path,
    any_build: bool,
    session: &Session,
) -> Result<(Plans, StoredRuns), Failure> {
    let plans = plans(cases, tier, session)?;
    if !path.is_dir() {
        return Err(Failure::usage(format!("the store {} does not exist", path.display())));
    }
    let mut stored = session.stored(&plans, &Store::to_read(path), any_build);
    if stored.made.interrupted {
        let words = "nothing is judged; the same command reads the store from its beginning";
        return Err(Failure::interrupted(words));
    }
    report_problems(&stored.made);
    peers::add(&mut stored.made, &plans);
    Ok((plans, stored))
}
