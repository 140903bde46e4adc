//! `report`: run what is missing, judge, render.

use std::time::Instant;

use ::report::{self, check_page};
use base::files::{FileError, OutputFolder};
use harness::store::Store;
use validation::page;

use super::{
    Failure, Outcome, World, arguments, export,
    judged::{self, Verdicts},
    output, verify,
};

pub fn report(arguments: &arguments::Report, world: &World) -> Outcome {
    let start = Instant::now();
    let folder = OutputFolder::create(&arguments.out)?;
    let tier = arguments.tier.into();
    let mut suite = match &arguments.store {
        Some(store) => {
            verify::of_store(world.cases, tier, store, arguments.reuse.any_build, world)?
        }
        None => {
            let store = Store::open(&folder.path().join("records"))?;
            verify::run(world.cases, tier, &store, arguments.reuse, arguments.threads, world)?
        }
    };
    verify::add_method(&mut suite, &[]);
    export::write(&suite, &arguments.export)?;
    let verdicts = serde_json::to_string_pretty(&Verdicts::of(&suite))? + "\n";
    folder.write("verdicts.json", verdicts.as_bytes())?;
    let path = folder.path().join("index.html");
    let page = page::assemble(&suite);
    let html = page.html();
    let sound = check_page(&html);
    // The page last: once it is there, everything that it speaks of is. It is kept even if it is found to
    // be unsound: the runs took minutes.
    page.write_html(&path, &html)
        .map_err(|reason| FileError::File { path: path.clone(), reason })?;
    let took = report::seconds(start.elapsed().as_secs_f64());
    let records: usize = suite.cases.iter().map(|results| results.runs.all().len()).sum();
    output::say(&format!(
        "{}{}\nreport: {} from {records} records, in {took}",
        judged::in_words(&suite),
        verify::reused(&suite),
        path.display()
    ));
    match sound {
        Ok(_) => Ok(verify::exit(&suite)),
        Err(reason) => {
            Err(Failure::bug(anyhow::anyhow!("the page is there, but may not open: {reason}")))
        }
    }
}
