//! Where the time of the main cases goes.

use touchstone_base::{breakdown::Breakdown, record::Record};
use touchstone_harness::{
    columns::TableColumns,
    profile::{BOTH, DRIFT, FORCES, REFRESH, REST, SEARCH, SORTING, WALLS},
    suite::{CaseResults, Suite},
};
use touchstone_report::{Cell, Section};

/// A run with its profile.
type Profiled<'a> = (&'a Record, &'a Breakdown);

/// The largest profiled run of the recommended variant of a case.
fn largest(results: &CaseResults) -> Option<Profiled<'_>> {
    let recommended = results.recommended()?;
    let profiled =
        results.runs.simulations().filter(|record| record.run.variant == recommended.run.variant);
    profiled
        .filter_map(|record| Some((record, record.cost.breakdown.as_ref()?)))
        .max_by_key(|(record, _)| record.cost.pair_interactions)
}

/// A row for each main case whose recommended variant was profiled.
pub fn section(suite: &Suite) -> Section {
    let share = |names: &'static [&str]| move |(_, b): &Profiled| Cell::percent(b.share(names), 3);
    let each = |record: &Record, seconds: f64| {
        let Record { cost, .. } = record;
        Cell::num(1e9 * seconds / (cost.particles as f64 * cost.steps as f64), 3)
    };
    let table = TableColumns::<Profiled>::default()
        .code("run", |(record, _)| format!("{} {}", record.run.case, record.run.variant))
        .num(["particles", "1"], |(record, _)| Cell::count(record.cost.particles as u64))
        .num(["stepping", "ns"], move |(record, b)| each(record, b.stepping_seconds()))
        .num(["force sweep", ""], share(&[FORCES, BOTH]))
        .num(["drift sweep", ""], share(&[DRIFT]))
        .num(["wall sweep", ""], share(&[WALLS]))
        .num(["refresh", ""], share(&[REFRESH]))
        .num(["search and sorting", ""], share(&[SEARCH, SORTING]))
        .num(["rest", ""], share(&[REST]))
        .num(["observing", "ns"], move |(record, b)| each(record, b.observing_seconds()))
        .num(["inside the support", ""], |(_, b)| Cell::percent(b.inside, 3))
        .num(["moved", "kB/step"], |(_, b)| Cell::num(1e-3 * b.bytes_a_step, 3))
        .table(
            "Where the time goes, in the largest run of the recommended variant of each main case that was \
             timed alone. Stepping and observing: nanoseconds of wall time a fluid particle and time \
             step. Sweeps, refresh, search and rest: shares of the stepping. Inside the support: the share \
             of the neighbours visited that are nearer than the support of the kernel. `touchstone run CASE \
             --profile` shows the same of any run.",
            suite.cases.iter().filter_map(largest),
        );
    Section::new("time", "Where the time goes").block(table)
}
