//! The page of a store with runs of no tier, such as a sweep: a table and a figure for each case, and no
//! verdict.

use std::collections::BTreeSet;
use std::path::Path;

use touchstone_base::{files::FileError, record::Record, spec::RunKey};
use touchstone_harness::{
    case::{Case, Tier},
    make::StoredRuns,
    plan, section,
    store::Store,
    studies::sweep,
    suite::Plans,
};
use touchstone_report::{Block, Page, Section, Table, counted};

use super::{Failure, Session, output, print_problems};

/// The runs of a store with runs that no tier plans and without a complete case of this tier; `None` for
/// another store, whose runs are judged.
pub fn of(
    plans: &Plans,
    stored: &StoredRuns,
    tier: Tier,
    path: &Path,
    session: &Session,
) -> Option<Vec<(&'static dyn Case, Vec<Record>)>> {
    let lacks = |case: &dyn Case| stored.missing.iter().any(|job| job.case.name() == case.name());
    if !plans.iter().all(|(case, _)| lacks(*case)) {
        return None;
    }
    let (records, unread) = read(path);
    let tiers = [Tier::Quick, Tier::Full].into_iter().chain((tier == Tier::Deep).then_some(tier));
    let planned = |case: &dyn Case| -> BTreeSet<RunKey> {
        let plans = tiers.clone().flat_map(|tier| plan::of_case(case, tier));
        plans.map(|planned| planned.spec.key()).collect()
    };
    let of_case = |case: &&'static dyn Case| {
        let of = records.iter().filter(|record| record.run.case == case.name());
        (*case, of.cloned().collect::<Vec<Record>>())
    };
    let cases: Vec<_> =
        session.cases.iter().map(of_case).filter(|(_, records)| !records.is_empty()).collect();
    let is_other = |(case, records): &(&'static dyn Case, Vec<Record>)| {
        let planned = planned(*case);
        records.iter().any(|record| !planned.contains(&record.run.key()))
    };
    if !cases.iter().any(is_other) {
        return None;
    }
    print_problems(unread.iter().map(|error| format!("{error}; it is not shown")));
    Some(cases)
}

/// Our own simulations of a store, sorted by file name, and the files that could not be read.
fn read(path: &Path) -> (Vec<Record>, Vec<FileError>) {
    let (mut records, mut unread) = (Vec::new(), Vec::new());
    for read in Store::each(path) {
        match read {
            Ok(record) if record.run.submission.is_some() => {}
            Ok(record) if !record.run.is_simulation() => {}
            Ok(record) => records.push(record),
            Err(error) => unread.push(error),
        }
    }
    (records, unread)
}

/// The page of these runs; their tables are printed.
pub fn page(cases: &[(&'static dyn Case, Vec<Record>)], made: &str) -> Result<Page, Failure> {
    let mut sections = Vec::new();
    for (case, records) in cases {
        let of_case = sweep::section(*case, records);
        output::print(&format!("{}\n{}\n", case.name(), text(&of_case)))?;
        let section = Section::new(&of_case.id, &of_case.title);
        sections.push(of_case.blocks.into_iter().fold(section, Section::block));
    }
    let runs = cases.iter().map(|(_, records)| records.len()).sum();
    let runs = counted(runs, "run", "runs");
    Ok(Page {
        title: format!("touchstone: {runs} of a store"),
        lead: vec![format!(
            "{made}. Errors and costs of {runs} that no tier plans. No gate is judged."
        )],
        sections,
        figure_folder: "figures".into(),
        ..Page::default()
    })
}

/// The tables of a section for a terminal.
fn text(section: &section::Section) -> String {
    let table = |block: &Block| match block {
        Block::Table(table) => Some(lines(table)),
        _ => None,
    };
    section.blocks.iter().filter_map(table).collect()
}

fn lines(table: &Table) -> String {
    let plain = |text: &str| text.replace('`', "").replace('\u{a0}', " ");
    let heads: Vec<String> = table.columns.iter().map(|column| plain(&column.head)).collect();
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let row =
        |row: &Vec<touchstone_report::Cell>| row.iter().map(|cell| plain(&cell.text)).collect();
    let rows: Vec<Vec<String>> = table.rows.iter().map(row).collect();
    output::table(&heads, rows) + &output::wrap(&plain(&table.caption), "")
}
