//! `report`: run what is missing, judge, render.

use std::time::{Instant, SystemTime};

use ::report::{self, check_page};
use base::files::{FileError, OutputFolder};
use harness::store::Store;
use validation::page;

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
    let (tier, mut listed) = (arguments.tier.into(), String::new());
    let suite = match &arguments.store {
        Some(store) if arguments.partial => {
            let any_build = arguments.reuse.any_build;
            let (suite, list) = partial::of_store(world.cases, tier, store, any_build, world)?;
            listed = list;
            suite
        }
        Some(store) => {
            verify::of_store(world.cases, tier, store, arguments.reuse.any_build, world)?
        }
        None => {
            let store = Store::open(&folder.path().join("records"))?;
            verify::run(world.cases, tier, &store, arguments.reuse, arguments.threads, world)?
        }
    };
    // A file that cannot be written keeps none of the others from being written: the runs took minutes.
    let exported = export::write(&suite, &arguments.export);
    let verdicts = serde_json::to_string_pretty(&Verdicts::of(&suite))? + "\n";
    let written = folder.write(VERDICTS, verdicts.as_bytes()).map_err(Failure::from);
    let path = folder.path().join("index.html");
    let page = page::assemble(&suite, &now());
    let html = page.html();
    let sound = check_page(&html);
    // The page last: once it is there, everything that it speaks of is. It is kept even if it is found to
    // be unsound.
    let page_written = page
        .write_html(&path, &html)
        .map_err(|reason| Failure::from(FileError::File { path: path.clone(), reason }));
    let failures: Vec<Failure> =
        [exported, written.map(drop), page_written].into_iter().filter_map(Result::err).collect();
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

/// The time, such as `2026-11-23 05:41 UTC`.
fn now() -> String {
    let text = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
    let minutes: String = text.chars().take("2026-11-23T05:41".len()).collect();
    minutes.replace('T', " ") + " UTC"
}
