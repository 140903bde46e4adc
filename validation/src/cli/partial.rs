//! Reports of an incomplete store: the complete cases judged, and the missing runs listed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use touchstone_base::spec::RunKey;
use touchstone_harness::{
    case::{self, Tier},
    make::{self, BatchResult, Job, StoredRuns},
    section::Section,
    store::{Pending, Store},
    suite::{self, Plans, Suite},
};
use touchstone_report::counted;

/// A run without a record, and the reason.
type MissingRun = (Job, Pending);

/// Message about missing runs: their number and their cases; `None` if all records exist.
type MissingNote = Option<[String; 2]>;

/// The suite of the complete cases, and a message about the others, which are not drawn because this would
/// take seconds each time.
pub fn of_made(
    mut plans: Plans,
    tier: Tier,
    path: &Path,
    made: BatchResult,
) -> (Suite, MissingNote) {
    let mut missing = make::jobs(plans.clone());
    missing.retain(|job| !made.records.contains_key(&job.planned.spec.key()));
    let lacking = lacking(missing, path, &made);
    let note = missing_note(&plans, &lacking);
    let lacks = |name: &str| lacking.values().any(|(job, _)| job.case.name() == name);
    plans.retain(|(case, _)| !lacks(case.name()));
    (suite::judge(plans, tier, made), note)
}

/// The suite of the stored runs, a list of the missing ones, and a message about them.
pub fn partial(
    plans: Plans,
    tier: Tier,
    store: &Path,
    stored: StoredRuns,
) -> (Suite, String, MissingNote) {
    let StoredRuns { made, missing, .. } = stored;
    let lacking = lacking(missing, store, &made);
    let note = missing_note(&plans, &lacking);
    (judge(plans, tier, made, &lacking), list(lacking.values().collect()), note)
}

fn lacking(missing: Vec<Job>, path: &Path, made: &BatchResult) -> BTreeMap<RunKey, MissingRun> {
    let why = |job: &Job| match made.unsound.get(&job.planned.spec.key()) {
        Some(error) => Pending::Failed(error.to_string()),
        None => Store::to_read(path).pending(&job.planned.spec),
    };
    let lack = |job: Job| (job.planned.spec.key(), (job.clone(), why(&job)));
    missing.into_iter().map(lack).collect()
}

/// Runs without a record are not judged, nor are the studies of a case that lacks one: a study of half its
/// runs would give a meaningless number.
fn judge(
    mut plans: Plans,
    tier: Tier,
    made: BatchResult,
    lacking: &BTreeMap<RunKey, MissingRun>,
) -> Suite {
    let planned = plans.iter_mut().flat_map(|(_, plan)| plan);
    let without = planned.filter(|planned| lacking.contains_key(&planned.spec.key()));
    without.for_each(|planned| planned.gates.clear());
    let mut suite = suite::judge(plans, tier, made);
    for results in &mut suite.cases {
        let name = results.case.name();
        let of_case: Vec<&MissingRun> =
            lacking.values().filter(|(job, _)| job.case.name() == name).collect();
        if of_case.is_empty() {
            continue;
        }
        let open: usize =
            results.sections.iter_mut().map(|section| section.judged.drain(..).len()).sum();
        let words = format!(
            "This report is not complete. Of the runs of this case are without a record: {}. They are not \
             judged. The {open} gates of its studies are open until every run has a record.",
            counts(&of_case)
        );
        let id = format!("{}-lacking", name.replace('_', "-"));
        results.sections.insert(0, Section::new(&id, "Runs without a record").prose(words));
    }
    suite
}

fn missing_note(plans: &Plans, lacking: &BTreeMap<RunKey, MissingRun>) -> MissingNote {
    let of: BTreeSet<&str> = lacking.values().map(|(job, _)| job.case.name()).collect();
    let names: Vec<&str> =
        plans.iter().map(|(case, _)| case.name()).filter(|name| of.contains(name)).collect();
    let (all, complete) = (plans.len(), plans.len() - names.len());
    let runs = counted(lacking.len(), "run without a record", "runs without a record");
    let each = counts(&lacking.values().collect::<Vec<_>>());
    let words = format!("{complete} of {all} cases complete; {runs}: {each}");
    (!names.is_empty()).then(|| [words, names.join(", ")])
}

/// The state of a run in a word, and the reason for a failure.
fn word(why: &Pending) -> (&'static str, &str) {
    match why {
        Pending::Missing => ("missing", ""),
        Pending::Running => ("running", ""),
        Pending::Stopped => ("stopped", ""),
        Pending::Failed(reason) => ("failed", reason),
    }
}

/// Numbers of runs by state, as `3 missing, 1 running`.
fn counts(lacking: &[&MissingRun]) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    lacking.iter().for_each(|(_, why)| *counts.entry(word(why).0).or_default() += 1);
    counts.iter().map(|(word, count)| format!("{count} {word}")).collect::<Vec<_>>().join(", ")
}

/// A line for each run, failed runs with their reasons last, then the number of each kind.
fn list(mut lacking: Vec<&MissingRun>) -> String {
    lacking.sort_by(|(_, a), (_, b)| a.cmp(b));
    let line = |(job, why): &&MissingRun| {
        let (spec, set) = (&job.planned.spec, case::changed(job.case, &job.planned.spec).join(" "));
        let (word, reason) = word(why);
        let words = format!("{word} {} {} {} {set} {reason}", spec.key(), spec.case, spec.variant);
        words.trim_end().to_string() + "\n"
    };
    let lines: String = lacking.iter().map(line).collect();
    let all = counted(lacking.len(), "run without a record", "runs without a record");
    if lacking.is_empty() { all + "\n" } else { format!("{lines}{all}: {}\n", counts(&lacking)) }
}
