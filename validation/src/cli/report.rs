//! `report`: run what is missing, judge, render. The page is there as soon as one case is complete: before
//! all runs are made, what there is so far is judged, and what is lacking is listed.

use std::sync::Mutex;
use std::time::{Duration, Instant, SystemTime};

use touchstone_base::files::{FileError, OutputFolder};
use touchstone_cases::{page, peers};
use touchstone_harness::{
    case::Tier,
    make::Made,
    store::Store,
    suite::{Plans, Suite},
};
use touchstone_report::{self, check_page};

use super::{
    Failure, Outcome, World, arguments,
    judged::{self, VERDICTS},
    output,
    partial::{of_made, partial},
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
            } else if verify::has_submissions_alone(&stored) {
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
    let took = touchstone_report::seconds(start.elapsed().as_secs_f64());
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
    let mut last = touchstone_base::lock(last);
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
