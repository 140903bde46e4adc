//! `report --partial`: what a store has so far is judged, and what it lacks is listed.

use std::collections::BTreeMap;
use std::path::Path;

use ::report::counted;
use base::spec::RunKey;
use harness::{
    case::{self, Case, Tier},
    columns::Columns,
    make::{Job, Stored},
    store::{Pending, Store},
    study::Study,
    suite::{self, CaseResults, Suite},
};

use super::{Failure, World, verify};

/// Runs of a case without a record that its page names; all of them are in the list.
const SHOWN: usize = 50;

/// A run without a record, and why it has none.
type Lacking = (Job, Pending);

/// The suite of what a store has of a tier, and a line for each run that it lacks. Runs without a record are
/// not judged, and neither are the studies of a case that lacks one.
pub fn of_store(
    cases: &[&'static dyn Case],
    tier: Tier,
    path: &Path,
    any_build: bool,
    world: &World,
) -> Result<(Suite, String), Failure> {
    let (mut plans, Stored { made, missing, .. }) =
        verify::stored(cases, tier, path, any_build, world)?;
    let store = Store::to_read(path);
    let why = |job: &Job| match made.unsound.get(&job.planned.spec.key()) {
        Some(error) => Pending::Failed(error.to_string()),
        None => store.pending(&job.planned.spec),
    };
    let lacking: BTreeMap<RunKey, Lacking> =
        missing.into_iter().map(|job| (job.planned.spec.key(), (job.clone(), why(&job)))).collect();
    for planned in plans.iter_mut().flat_map(|(_, plan)| plan) {
        if lacking.contains_key(&planned.spec.key()) {
            planned.gates.clear();
        }
    }
    let mut suite = suite::judge(plans, tier, made);
    for results in &mut suite.cases {
        let of_case = |(job, _): &&Lacking| job.case.name() == results.case.name();
        let of_case: Vec<&Lacking> = lacking.values().filter(of_case).collect();
        if !of_case.is_empty() {
            leave_open(results, &of_case);
        }
    }
    Ok((suite, list(lacking.values().collect())))
}

/// What became of a run, in a word.
fn word(why: &Pending) -> &'static str {
    match why {
        Pending::Missing => "missing",
        Pending::Running => "running",
        Pending::Stopped => "stopped",
        Pending::Failed(_) => "failed",
    }
}

/// Runs by what became of them, as `3 missing, 1 running`.
fn counts(lacking: &[&Lacking]) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    lacking.iter().for_each(|(_, why)| *counts.entry(word(why)).or_default() += 1);
    counts.iter().map(|(word, count)| format!("{count} {word}")).collect::<Vec<_>>().join(", ")
}

/// A line a run, those that failed last, with the reasons, and then how many there are of each kind.
fn list(mut lacking: Vec<&Lacking>) -> String {
    lacking.sort_by(|(_, a), (_, b)| a.cmp(b));
    let line = |(job, why): &&Lacking| {
        let (spec, set) = (&job.planned.spec, case::changed(job.case, &job.planned.spec));
        let reason = if let Pending::Failed(reason) = why { reason.as_str() } else { "" };
        let words = [word(why), &spec.key().to_string(), &spec.case, &spec.variant];
        format!("{} {} {reason}", words.join(" "), set.join(" ")).trim().to_string() + "\n"
    };
    let lines: String = lacking.iter().map(line).collect();
    match lacking.len() {
        0 => "every run has a record\n".into(),
        all => {
            let all = counted(all, "run without a record", "runs without a record");
            format!("{lines}{all}: {}\n", counts(&lacking))
        }
    }
}

/// Names the missing runs of a case on its page, and leaves the gates of its studies open.
fn leave_open(results: &mut CaseResults, lacking: &[&Lacking]) {
    // A study of half of its runs has a number too, which says nothing.
    let open: usize = results.studies.iter_mut().map(|study| study.judged.drain(..).count()).sum();
    let table = Columns::<&Lacking>::default()
        .text("state", |(_, why)| word(why))
        .code("run", |(job, _)| job.planned.spec.key())
        .text("variant", |(job, _)| &job.planned.spec.variant)
        .text("settings", |(job, _)| case::changed(job.case, &job.planned.spec).join(" "));
    let shown = &lacking[..lacking.len().min(SHOWN)];
    let words = format!(
        "This report is of a store that is not complete. Of the runs of this case are without a record: \
         {}. They are not judged. The {open} gates of its studies are open until every run has a record.",
        counts(lacking)
    );
    let name = results.case.name().replace('_', "-");
    let study = Study::new(&format!("{name}-lacking"), "Runs without a record").prose(words);
    let caption = format!("The first {SHOWN} of them at most.");
    results.studies.insert(0, study.block(table.table(caption, shown)));
}
