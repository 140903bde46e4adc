//! `report`: the page, its figures, and the record of every run.

use std::time::Instant;

use validation::files::{FileError, OutputFolder};
use validation::page;
use validation::report::{self, check_page};
use validation::suite::Suite;

use super::{
    Failure, Outcome, World, arguments,
    judged::{self, Verdicts},
    output, verify,
};

pub fn report(arguments: &arguments::Report, world: &World) -> Outcome {
    let start = Instant::now();
    let folder = OutputFolder::create(&arguments.out)?;
    let suite = verify::run(world.cases, arguments.tier.into(), true, arguments.threads, world)?;
    let path = folder.path().join("index.html");
    let records = write_records(&suite, &folder)?;
    let verdicts = serde_json::to_string_pretty(&Verdicts::of(&suite))? + "\n";
    folder.write("verdicts.json", verdicts.as_bytes())?;
    let page = page::assemble(&suite);
    let html = page.html();
    let sound = check_page(&html);
    // The page last: once it is there, everything that it speaks of is. It is kept even if it is found to
    // be unsound: the runs took minutes.
    page.write_html(&path, &html)
        .map_err(|reason| FileError::File { path: path.clone(), reason })?;
    let took = report::seconds(start.elapsed().as_secs_f64());
    output::say(&format!(
        "{}\nreport: {} and {records} records beside it, in {took}",
        judged::in_words(&suite),
        path.display()
    ));
    match sound {
        Ok(_) => Ok(verify::exit(&suite)),
        Err(reason) => {
            Err(Failure::bug(anyhow::anyhow!("the page is there, but may not open: {reason}")))
        }
    }
}

/// One file a run: `records/CASE-VARIANT-KEY.json`. Returns how many.
fn write_records(suite: &Suite, folder: &OutputFolder) -> Result<usize, Failure> {
    let mut names = std::collections::BTreeSet::new();
    for run in suite.cases.iter().flat_map(|results| &results.runs) {
        let record = &run.record;
        let name = format!("records/{}-{}-{}.json", record.case, record.variant, record.key());
        folder.write(&name, record.to_json()?.as_bytes())?;
        names.insert(name);
    }
    Ok(names.len())
}
