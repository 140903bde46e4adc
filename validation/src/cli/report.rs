//! `report`: run what is missing, judge, render; the page is there as soon as one case is complete.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant, SystemTime};

use ::report::{self, check_page};
use base::files::{FileError, OutputFolder};
use harness::{
    case::Tier,
    make::Made,
    store::Store,
    suite::{Plans, Suite},
};
use validation::{page, peers};

use super::{
    Failure, Outcome, World, arguments, export,
    judged::{VERDICTS, Verdicts},
    output, partial,
    summary::summary,
    verify,
};

pub fn report(arguments: &arguments::Report, world: &World) -> Outcome {
    let start = Instant::now();
    export::check(&arguments.export)?;
    let folder = OutputFolder::create(&arguments.out)?;
    let (tier, mut listed, mut lacking) = (arguments.tier, String::new(), None);
    let suite = match &arguments.store {
        Some(store) if arguments.partial => {
            let any_build = arguments.reuse.any_build;
            let (suite, list, told) =
                partial::of_store(world.cases, tier, store, any_build, world)?;
            (listed, lacking) = (list, told);
            suite
        }
        Some(store) => {
            verify::of_store(world.cases, tier, store, arguments.reuse.any_build, world)?
        }
        None => {
            let store = Store::open(&folder.path().join("records"))?;
            let plans = verify::plans(world.cases, tier, world)?;
            let last = Mutex::new(None);
            let early = |made| early(plans.clone(), tier, &store, made, &folder, &last);
            let (reuse, threads) = (arguments.reuse, arguments.threads);
            verify::run(plans.clone(), tier, &store, reuse, threads, Some(&early), world)?
        }
    };
    // A file that cannot be written keeps none of the others from being written: the runs took minutes.
    let exported = export::write(&suite, &arguments.export);
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
    let failures: Vec<Failure> =
        [exported, written, page_written].into_iter().filter_map(Result::err).collect();
    if !failures.is_empty() {
        output::print(&summary(&suite))?;
        let reasons: Vec<String> =
            failures.iter().map(|failure| failure.reason.to_string()).collect();
        return Err(Failure::usage(reasons.join("\n")));
    }
    let took = report::seconds(start.elapsed().as_secs_f64());
    output::print(&format!("{listed}{}\n{}\n", suite.counts().headline(), path.display()))?;
    output::say(&format!("the page shows {} in {took}", verify::runs(&suite)));
    match sound {
        Ok(_) => Ok(verify::exit(&suite)),
        Err(reason) => Err(Failure::bug(format!(
            "the page was written, but a browser may fail to open it: {reason}"
        ))),
    }
}

fn write_verdicts(folder: &OutputFolder, suite: &Suite) -> Result<(), Failure> {
    let verdicts = serde_json::to_string_pretty(&Verdicts::of(suite))? + "\n";
    folder.write(VERDICTS, verdicts.as_bytes())?;
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
    let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
    if last.is_some_and(|(at, took)| at.elapsed() < SHARE_OF_EARLY * took) {
        return None;
    }
    let start = Instant::now();
    peers::add(&mut made, &plans);
    let (suite, lacking) = partial::of_made(plans, tier, store.path(), made);
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
