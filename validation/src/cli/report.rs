//! `report`: run what is missing, judge, render. The page is there as soon as one case is complete: before
//! all runs are made, what there is so far is judged, and what is lacking is listed. Runs of a sweep are
//! shown and not judged.

use std::io::ErrorKind;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant, SystemTime};

use touchstone_base::{
    files::{self, FileError, OutputFolder},
    record::Record,
    reference::sha256,
};
use touchstone_cases::{page, peers};
use touchstone_harness::{
    case::{Case, Tier},
    make::BatchResult,
    store::Store,
    suite::{Plans, Suite},
};
use touchstone_report::{Page, check_page};

use super::{
    Exit, Failure, Outcome, Session, arguments,
    judged::{self, VERDICTS},
    output,
    partial::{of_made, partial},
    summary::summary,
    sweep, verify,
};

/// Folder of a report, unless another one is named.
const REPORTS: &str = "reports";
/// Name of the page in its folder.
const PAGE: &str = "index.html";
/// Largest page \[bytes\].
const MOST_BYTES: u64 = 1 << 28;

pub fn report(arguments: &arguments::Report, session: &Session) -> Outcome {
    let start = Instant::now();
    let (tier, any_build) = (arguments.tier, arguments.making.any_build);
    let reports = || arguments.out.as_deref().unwrap_or(Path::new(REPORTS));
    let (folder, suite, listed, lacking, made_from);
    match &arguments.store {
        Some(store) => {
            let (plans, stored) = verify::stored(session.cases, tier, store, any_build, session)?;
            let judges = arguments.partial || arguments.junit.is_some();
            let sweep = || sweep::of(&plans, &stored, tier, store, session);
            if let Some(cases) = (!judges).then(sweep).flatten() {
                return report_sweep(&cases, store, arguments);
            }
            (folder, made_from) = place(reports(), Some(store), arguments)?;
            (suite, listed, lacking) = if arguments.partial {
                partial(plans, tier, store, stored)
            } else if verify::has_submissions_alone(&stored) {
                let (suite, _, told) = partial(plans, tier, store, stored);
                (suite, String::new(), told)
            } else {
                (verify::of_stored(plans, tier, stored), String::new(), None)
            };
        }
        None => {
            (folder, made_from) = place(reports(), None, arguments)?;
            let store = Store::open(&folder.path().join(RECORDS))?;
            let plans = verify::plans(session.cases, tier, session)?;
            let last = Mutex::new(None);
            let early = |made| early(plans.clone(), tier, &store, made, &folder, &last);
            let (making, early) = (arguments.making, Some(&early as _));
            suite = verify::run(plans.clone(), tier, &store, making, early, session)?;
            (listed, lacking) = (String::new(), None);
        }
    }
    // A file that cannot be written does not keep the others from being written: the runs took minutes.
    let exported = judged::write_junit(&suite, arguments.junit.as_deref());
    let written = write_verdicts(&folder, &suite);
    let path = folder.path().join(PAGE);
    let mut page = Page { made_from, ..page::assemble(&suite, &now()) };
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

/// Name of the folder of records in the folder of their report.
const RECORDS: &str = "records";

/// The folder of a report, and the name of its records on the page: their folder inside the report's, or a
/// digest of the folder of another store. A page of other records is replaced only on request.
fn place(
    folder: &Path,
    store: Option<&Path>,
    arguments: &arguments::Report,
) -> Result<(OutputFolder, String), Failure> {
    let output = OutputFolder::create(folder)?;
    let whole = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let name = match store.map(|store| (whole(store), whole(folder))) {
        None => RECORDS.to_string(),
        Some((store, folder)) => match store.strip_prefix(folder) {
            Ok(inside) => inside.to_string_lossy().replace(['"', '&', '<', '>'], "-"),
            Err(_) => sha256(store.as_os_str().as_encoded_bytes()),
        },
    };
    let path = folder.join(PAGE);
    let shows_others = match files::read_text(&path, MOST_BYTES) {
        Ok(html) => touchstone_report::made_from(&html) != Some(&name),
        Err(reason) => reason.kind() != ErrorKind::NotFound,
    };
    if shows_others && !arguments.overwrite {
        return Err(Failure::usage(format!(
            "{} was made from other records and would be lost; name another folder by --out, or give \
             --overwrite",
            path.display()
        )));
    }
    Ok((output, name))
}

/// Writes the page of runs that are not judged.
fn report_sweep(
    cases: &[(&'static dyn Case, Vec<Record>)],
    store: &Path,
    arguments: &arguments::Report,
) -> Outcome {
    output::say(
        "note: the store has runs that no tier plans, and not all runs of any case; their errors and costs \
         are shown, and nothing is judged (--partial judges what is planned)",
    );
    let folder = arguments.out.as_deref().unwrap_or(store);
    let (output, made_from) = place(folder, Some(store), arguments)?;
    let page = Page { made_from, ..sweep::page(cases, &now())? };
    let path = output.path().join(PAGE);
    let written = page.write_html(&path, &page.html());
    written.map_err(|reason| FileError::File { path: path.clone(), reason })?;
    output::print(&format!("{}\n", path.display()))?;
    Ok(Exit::Pass)
}

fn write_verdicts(folder: &OutputFolder, suite: &Suite) -> Result<(), Failure> {
    folder.write(VERDICTS, judged::json(suite)?.as_bytes())?;
    Ok(())
}

/// The note on a page with missing runs.
fn not_complete([words, names]: [String; 2]) -> String {
    format!("**Not complete when this page was written:** {words}. Still to come: {names}.")
}

/// Early pages take at most this part of the time.
const SHARE_OF_EARLY: u32 = 20;

/// Writes verdicts and page, without PNG files, of the runs so far, and prints a message; not at every
/// completed case if this would take long. Errors of writing are reported with the final page only.
fn early(
    plans: Plans,
    tier: Tier,
    store: &Store,
    mut made: BatchResult,
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
    let mut page = Page { made_from: RECORDS.into(), ..page::assemble(&suite, &now()) };
    let path = folder.path().join(PAGE);
    let words = format!("{}: {}", path.display(), lacking[0]);
    page.lead.push(not_complete(lacking));
    page.figure_folder.clear();
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
