//! Tables of runs whose columns are metrics.

use base::{
    record::{MetricKey, Record, Status},
    spec::Task,
};
use harness::{
    case::{self, Case},
    runs::{JudgedRun, Runs},
};
use report::{Cell, Column, Table};

/// Columns that show metrics: head, unit, metric, how its value is shown.
pub type MetricColumns = [(&'static str, &'static str, MetricKey, fn(f64) -> Cell)];

/// A table without rows: columns of its own, then metrics.
pub fn table(caption: &str, first: Vec<Column>, columns: &MetricColumns) -> Table {
    let heads = columns.iter().map(|(head, unit, ..)| Column::num(*head, *unit));
    Table::new(caption, first.into_iter().chain(heads).collect())
}

/// A row: its first cells, then metrics; a dash where there is no value.
pub fn row(
    first: impl Into<Vec<Cell>>,
    columns: &MetricColumns,
    value: impl Fn(MetricKey) -> Option<f64>,
) -> Vec<Cell> {
    let cell = |&(.., metric, show): &(&str, &str, MetricKey, fn(f64) -> Cell)| {
        value(metric).map_or_else(|| Cell::text("–"), show)
    };
    first.into().into_iter().chain(columns.iter().map(cell)).collect()
}

/// Heads of what [`all`] says of a run before its metrics.
pub const ABOUT: [&str; 3] = ["variant", "settings", "ended"];

/// Adds every simulation of a case to a table.
pub fn all(table: Table, case: &dyn Case, columns: &MetricColumns, runs: &Runs) -> Table {
    let simulated = runs.all().iter().filter(|run| run.planned.spec.task == Task::Simulate);
    let row = |JudgedRun { planned, record, .. }: &JudgedRun| {
        let settings = case::changed(case, &planned.spec).join(", ");
        let about = [format!("`{}`", record.variant), settings, ended(record)].map(Cell::text);
        row(about, columns, |metric| record.value(metric))
    };
    simulated.map(row).fold(table, Table::row)
}

/// How a run ended.
pub fn ended(record: &Record) -> String {
    match &record.status {
        Status::Completed => "completed".into(),
        Status::Diverged { time, field, .. } => format!("diverged at {time:.2} s: {field}"),
        Status::Refused { reason } => reason.clone(),
        Status::Interrupted { .. } => "interrupted".into(),
    }
}

/// Places of the particles at the end with what is drawn there.
pub fn points(record: &Record, name: &str) -> Vec<(f64, f64, f64)> {
    let [x, y, values] = ["x", "y", name].map(|name| record.column("particles", name));
    x.iter().zip(y).zip(values).map(|((x, y), value)| (*x, *y, *value)).collect()
}
