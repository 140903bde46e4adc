//! `report`: run what is missing, judge, render. The page is there as soon as one case is complete: before
//! all runs are made, what there is so far is judged, and what is lacking is listed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant, SystemTime};

use ::report::{self, check_page, counted};
use base::files::{FileError, OutputFolder};
use base::spec::RunKey;
use harness::{
    case::{self, Tier},
    make::{self, Job, Made, Stored},
    runs,
    store::{Pending, Store},
    study::Study,
    suite::{self, Plans, Suite},
};
use validation::{page, peers};

use super::{
    Failure, Outcome, World, arguments,
    judged::{self, VERDICTS},
    output,
    summary::summary,
    verify,
};

pub fn report(arguments: &arguments::Report, world: &World) -> Outcome {
    let start = Instant::now();
    let folder = OutputFolder::create(&arguments.out)?;
    let (tier, any_build) = (arguments.tier, arguments.making.any_build);
    let (suite, listed, lacking) = match &arguments.store {
        Some(store) => {
            let (plans, stored) = verify::stored(world.cases, tier, store, any_build, world)?;
            if arguments.partial {
                partial(plans, tier, store, stored)
            } else if verify::has_submissions_alone(&stored, tier) {
                let (suite, _, told) = partial(plans, tier, store, stored);
                (suite, String::new(), told)
            } else {
                (verify::of_stored(plans, tier, stored), String::new(), None)
            }
        }
        None => {
            let store = Store::open(&folder.path().join("records"))?;
            let plans = verify::plans(world.cases, tier, world)?;
            let last = Mutex::new(None);
            let early = |made| early(plans.clone(), tier, &store, made, &folder, &last);
            let (making, early) = (arguments.making, Some(&early as _));
            let suite = verify::run(plans.clone(), tier, &store, making, early, world)?;
            (suite, String::new(), None)
        }
    };
    // A file that cannot be written keeps none of the others from being written: the runs took minutes.
    let exported = judged::write_junit(&suite, arguments.junit.as_deref());
    let written = write_verdicts(&folder, &suite);
    let path = folder.path().join("index.html");
    let mut page = page::assemble(&suite, &now());
    page.lead.extend(lacking.map(not_complete));
    let html = page.html();
    let sound = check_page(&html);
    // The page last: once it is there, everything that it speaks of is. It is kept even if it is found to
    // be unsound.
    let page_written = page
        .write_html(&path, &html)
        .map_err(|reason| Failure::from(FileError::File { path: path.clone(), reason }));
    let all = [exported, written, page_written].into_iter();
    let reasons: Vec<String> = all.filter_map(|written| Some(written.err()?.reason)).collect();
    if !reasons.is_empty() {
        output::print(&summary(&suite))?;
        return Err(Failure::usage(reasons.join("\n")));
    }
    let took = report::seconds(start.elapsed().as_secs_f64());
    let (headline, others) = (judged::headline(&suite), judged::submissions(&suite));
    output::print(&format!("{listed}{others}{headline}\n{}\n", path.display()))?;
    output::say(&format!("the page shows {} in {took}", verify::runs(&suite)));
    match sound {
        Ok(_) => Ok(verify::exit(&suite)),
        Err(reason) => Err(Failure::bug(format!(
            "the page was written, but a browser may fail to open it: {reason}"
        ))),
    }
}

fn write_verdicts(folder: &OutputFolder, suite: &Suite) -> Result<(), Failure> {
    folder.write(VERDICTS, judged::json(suite)?.as_bytes())?;
    Ok(())
}

/// What stands on a page that lacks runs.
fn not_complete([words, names]: [String; 2]) -> String {
    format!("**Not complete when this page was written:** {words}. Still to come: {names}.")
}

/// Early pages take at most this part of the time.
const SHARE_OF_EARLY: u32 = 20;

/// Writes verdicts and page, without PNG files, of what is made so far, and says so; not each time that a
/// case is complete if that would take long. That it cannot be written is told of the last page.
fn early(
    plans: Plans,
    tier: Tier,
    store: &Store,
    mut made: Made,
    folder: &OutputFolder,
    last: &Mutex<Option<(Instant, Duration)>>,
) -> Option<String> {
    let mut last = base::lock(last);
    if last.is_some_and(|(at, took)| at.elapsed() < SHARE_OF_EARLY * took) {
        return None;
    }
    let start = Instant::now();
    peers::add(&mut made, &plans);
    let (suite, lacking) = of_made(plans, tier, store.path(), made);
    let lacking = lacking?; // all are there: the page that lacks nothing follows
    let mut page = page::assemble(&suite, &now());
    let path = folder.path().join("index.html");
    let words = format!("{}: {}", path.display(), lacking[0]);
    page.lead.push(not_complete(lacking));
    page.png_folder.clear();
    write_verdicts(folder, &suite).ok()?;
    page.write_html(&path, &page.html()).ok()?;
    *last = Some((Instant::now(), start.elapsed()));
    Some(words)
}

/// The time, such as `2026-11-23 05:41 UTC`.
fn now() -> String {
    let text = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
    let minutes: String = text.chars().take("2026-11-23T05:41".len()).collect();
    minutes.replace('T', " ") + " UTC"
}

/// A run without a record, and why it has none.
type Lacking = (Job, Pending);

/// What is told of runs that are lacking: how many, and of which cases; empty if all are there.
type Told = Option<[String; 2]>;

/// The suite of the cases that are complete, and what is told of the others: to draw these too would take
/// seconds each time.
pub fn of_made(mut plans: Plans, tier: Tier, path: &Path, made: Made) -> (Suite, Told) {
    let mut missing = make::jobs(plans.clone());
    missing.retain(|job| !made.records.contains_key(&job.planned.spec.key()));
    let lacking = lacking(missing, path, &made);
    let told = tell(&plans, &lacking);
    let lacks = |name: &str| lacking.values().any(|(job, _)| job.case.name() == name);
    plans.retain(|(case, _)| !lacks(case.name()));
    (suite::judge(plans, tier, made), told)
}

/// The suite of what a store has, a list of what it lacks, and what is told of that.
pub fn partial(plans: Plans, tier: Tier, store: &Path, stored: Stored) -> (Suite, String, Told) {
    let Stored { made, missing, .. } = stored;
    let lacking = lacking(missing, store, &made);
    let told = tell(&plans, &lacking);
    (judge(plans, tier, made, &lacking), list(lacking.values().collect()), told)
}

fn lacking(missing: Vec<Job>, path: &Path, made: &Made) -> BTreeMap<RunKey, Lacking> {
    let why = |job: &Job| match runs::find(&made.unsound, &job.planned.spec.key()) {
        Some(error) => Pending::Failed(error.to_string()),
        None => Store::to_read(path).pending(&job.planned.spec),
    };
    let lack = |job: Job| (job.planned.spec.key(), (job.clone(), why(&job)));
    missing.into_iter().map(lack).collect()
}

/// Runs without a record are not judged, and neither are the studies of a case that lacks one: of half its
/// runs a study has a number too, which says nothing.
fn judge(mut plans: Plans, tier: Tier, made: Made, lacking: &BTreeMap<RunKey, Lacking>) -> Suite {
    let planned = plans.iter_mut().flat_map(|(_, plan)| plan);
    let without = planned.filter(|planned| lacking.contains_key(&planned.spec.key()));
    without.for_each(|planned| planned.gates.clear());
    let mut suite = suite::judge(plans, tier, made);
    for results in &mut suite.cases {
        let name = results.case.name();
        let of_case: Vec<&Lacking> =
            lacking.values().filter(|(job, _)| job.case.name() == name).collect();
        if of_case.is_empty() {
            continue;
        }
        let open: usize =
            results.studies.iter_mut().map(|study| study.judged.drain(..).len()).sum();
        let words = format!(
            "This report is not complete. Of the runs of this case are without a record: {}. They are not \
             judged. The {open} gates of its studies are open until every run has a record.",
            counts(&of_case)
        );
        let id = format!("{}-lacking", name.replace('_', "-"));
        results.studies.insert(0, Study::new(&id, "Runs without a record").prose(words));
    }
    suite
}

fn tell(plans: &Plans, lacking: &BTreeMap<RunKey, Lacking>) -> Told {
    let of: BTreeSet<&str> = lacking.values().map(|(job, _)| job.case.name()).collect();
    let names: Vec<&str> =
        plans.iter().map(|(case, _)| case.name()).filter(|name| of.contains(name)).collect();
    let (all, complete) = (plans.len(), plans.len() - names.len());
    let runs = counted(lacking.len(), "run without a record", "runs without a record");
    let each = counts(&lacking.values().collect::<Vec<_>>());
    let words = format!("{complete} of {all} cases complete; {runs}: {each}");
    (!names.is_empty()).then(|| [words, names.join(", ")])
}

/// What became of a run, in a word, and the reason for a failure.
fn word(why: &Pending) -> (&'static str, &str) {
    match why {
        Pending::Missing => ("missing", ""),
        Pending::Running => ("running", ""),
        Pending::Stopped => ("stopped", ""),
        Pending::Failed(reason) => ("failed", reason),
    }
}

/// Runs by what became of them, as `3 missing, 1 running`.
fn counts(lacking: &[&Lacking]) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    lacking.iter().for_each(|(_, why)| *counts.entry(word(why).0).or_default() += 1);
    counts.iter().map(|(word, count)| format!("{count} {word}")).collect::<Vec<_>>().join(", ")
}

/// A line a run, those that failed last, with the reasons, and then how many there are of each kind.
fn list(mut lacking: Vec<&Lacking>) -> String {
    lacking.sort_by(|(_, a), (_, b)| a.cmp(b));
    let line = |(job, why): &&Lacking| {
        let (spec, set) = (&job.planned.spec, case::changed(job.case, &job.planned.spec).join(" "));
        let (word, reason) = word(why);
        let words = format!("{word} {} {} {} {set} {reason}", spec.key(), spec.case, spec.variant);
        words.trim_end().to_string() + "\n"
    };
    let lines: String = lacking.iter().map(line).collect();
    let all = counted(lacking.len(), "run without a record", "runs without a record");
    if lacking.is_empty() { all + "\n" } else { format!("{lines}{all}: {}\n", counts(&lacking)) }
}
