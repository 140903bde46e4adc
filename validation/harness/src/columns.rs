//! Tables with one row per run. The name of a column and what it shows are stated in one place.

use base::record::{MetricName, Record, Status};
use report::{Cell, Column, Table};

/// What a column shows of a record.
type Shown<'a> = dyn Fn(&Record) -> Cell + 'a;

/// Columns of a table of runs.
#[derive(Default)]
pub struct Columns<'a> {
    heads: Vec<Column>,
    cells: Vec<Box<Shown<'a>>>,
}

impl<'a> Columns<'a> {
    /// One column: the name of the variant.
    pub fn of_variants() -> Self {
        Self::default().text("variant", |record| format!("`{}`", record.variant))
    }

    /// One more column.
    #[must_use]
    pub fn with(mut self, head: Column, cell: impl Fn(&Record) -> Cell + 'a) -> Self {
        self.heads.push(head);
        self.cells.push(Box::new(cell));
        self
    }

    /// One more column, of text.
    #[must_use]
    pub fn text(self, head: &str, text: impl Fn(&Record) -> String + 'a) -> Self {
        self.with(Column::text(head), move |record| Cell::text(text(record)))
    }

    /// One more column, of numbers in a unit; a dash where one is not finite.
    #[must_use]
    pub fn of(
        self,
        [head, unit]: [&str; 2],
        value: impl Fn(&Record) -> f64 + 'a,
        show: impl Fn(f64) -> Cell + 'a,
    ) -> Self {
        self.with(Column::num(head, unit), move |record| Cell::or_dash(value(record), &show))
    }

    /// One more column, of a metric; a dash where it was not measured.
    #[must_use]
    pub fn metric(
        self,
        head: [&str; 2],
        metric: impl Into<MetricName>,
        show: impl Fn(f64) -> Cell + 'a,
    ) -> Self {
        let metric = metric.into();
        self.of(head, move |record| record.value(metric.clone()).unwrap_or(f64::NAN), show)
    }

    /// The same with three digits.
    #[must_use]
    pub fn number(self, head: &str, unit: &str, metric: impl Into<MetricName>) -> Self {
        self.metric([head, unit], metric, |value| Cell::num(value, 3))
    }

    /// The same as a percentage with two digits, times a sign.
    #[must_use]
    pub fn percent(self, head: &str, unit: &str, metric: impl Into<MetricName>, sign: f64) -> Self {
        self.metric([head, unit], metric, move |value| Cell::percent(sign * value, 2))
    }

    /// One more column: how the run ended.
    #[must_use]
    pub fn ended(self) -> Self {
        self.text("ended", |record| match &record.status {
            Status::Completed => "completed".into(),
            Status::Diverged { step, field, .. } => format!("diverged at step {step}: {field}"),
            Status::Refused { reason } => reason.clone(),
            Status::Interrupted { .. } => "interrupted".into(),
        })
    }

    /// One more column: how many time steps.
    #[must_use]
    pub fn steps(self) -> Self {
        self.with(Column::num("steps", "1"), |record| Cell::count(record.cost.steps))
    }

    /// The table of these runs.
    pub fn table<'r>(
        self,
        caption: impl Into<String>,
        records: impl IntoIterator<Item = &'r Record>,
    ) -> Table {
        let row = |record: &Record| self.cells.iter().map(|cell| cell(record)).collect();
        let rows: Vec<Vec<Cell>> = records.into_iter().map(row).collect();
        rows.into_iter().fold(Table::new(caption, self.heads), Table::row)
    }
}
