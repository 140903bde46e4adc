//! Runs whose records are made up by hand, for the tests of studies.

use std::collections::BTreeMap;

use serde_json::json;
use touchstone_base::{record::Record, spec::RunSpec};
use touchstone_report::{Block, Table};

use crate::{
    runs::{JudgedRun, Planned, Runs},
    section::Section,
    studies::{Comparison, Level, Resolution, Study},
};

touchstone_base::metrics! {
    ERROR = "error" ["-"] "as it was made up";
}

/// The run of a variant at a resolution n.
pub fn spec(variant: &str, n: usize) -> RunSpec {
    RunSpec::new("case", variant, json!({ "n": n }))
}

/// Runs that reached their end with these errors.
pub fn runs(errors: impl IntoIterator<Item = (RunSpec, f64)>) -> Runs {
    records(
        errors.into_iter().map(|(spec, error)| (spec, move |r: &mut Record| r.put(ERROR, error))),
    )
}

/// Runs that reached their end, with the content of their records.
pub fn records<F: FnOnce(&mut Record)>(of: impl IntoIterator<Item = (RunSpec, F)>) -> Runs {
    Runs::new(of.into_iter().map(|(spec, fill)| run(spec, fill)).collect())
}

/// A run that reached its end, with the content of its record.
pub fn run(spec: RunSpec, fill: impl FnOnce(&mut Record)) -> JudgedRun {
    let mut record = Record::of(&spec, 1);
    fill(&mut record);
    JudgedRun::new(Planned::new(spec), record)
}

/// The section of a study from these runs; its other runs count as refused.
pub fn evaluate(study: &impl Study, made: Runs) -> Section {
    study.evaluate("case", &whole(study.runs(), made)).expect("a section")
}

/// The runs of a plan: the given ones, and all others as refused.
pub fn whole(plan: Vec<Planned>, made: Runs) -> Runs {
    let mut all = Runs::of(crate::runs::merged(plan), &mut BTreeMap::new()).all;
    let is_made = |run: &JudgedRun| {
        made.all.iter().any(|made| made.planned.spec.key() == run.planned.spec.key())
    };
    all.retain(|run| !is_made(run));
    Runs::new(made.all.into_iter().chain(all).collect())
}

/// The comparison of the error of a variant at these resolutions with a reference that is exact, without
/// inputs.
pub fn comparison(variant: &str, resolutions: &[usize]) -> Comparison {
    let level = |n: &usize| Level {
        run: Planned::new(spec(variant, *n)),
        spacing: 1.0 / *n as f64,
        resolution: Resolution::default(),
    };
    Comparison {
        what: "made up".into(),
        against: "nothing",
        metric: ERROR.into(),
        levels: resolutions.iter().map(level).collect(),
        inputs: Vec::new(),
        reference: 0.0,
        because: "made up",
    }
}

/// The tables of a section, in its order.
pub fn tables(section: &Section) -> Vec<&Table> {
    let tables = section.blocks.iter().filter_map(|block| match block {
        Block::Table(table) => Some(table),
        _ => None,
    });
    tables.collect()
}

/// The cells of a column of a table, from top to bottom, with ordinary blanks.
pub fn column(table: &Table, head: &str) -> Vec<String> {
    let of = table.columns.iter().position(|column| column.head == head);
    let of = of.unwrap_or_else(|| panic!("a column `{head}` of {:?}", table.columns));
    table.rows.iter().map(|row| row[of].text.replace('\u{a0}', " ")).collect()
}
