//! Tables with one row per item. The name of a column and its content are stated in one place.

use std::borrow::Borrow;

use touchstone_report::{Cell, Table, TableColumn, code};

/// The content of a column for an item.
type Shown<'a, T> = dyn Fn(&T) -> Cell + 'a;

/// Columns of a table with a row an item.
pub struct TableColumns<'a, T> {
    heads: Vec<TableColumn>,
    cells: Vec<Box<Shown<'a, T>>>,
}

impl<T> Default for TableColumns<'_, T> {
    fn default() -> Self {
        Self { heads: Vec::new(), cells: Vec::new() }
    }
}

impl<'a, T> TableColumns<'a, T> {
    /// One more column.
    #[must_use]
    pub fn with(mut self, head: TableColumn, cell: impl Fn(&T) -> Cell + 'a) -> Self {
        self.heads.push(head);
        self.cells.push(Box::new(cell));
        self
    }

    /// One more column, of plain text.
    #[must_use]
    pub fn text<S: Into<String>>(self, head: &str, text: impl Fn(&T) -> S + 'a) -> Self {
        self.with(TableColumn::text(head), move |item| Cell::text(text(item)))
    }

    /// One more column, of text of ours with inline markup.
    #[must_use]
    pub fn marked(self, head: &str, text: impl Fn(&T) -> String + 'a) -> Self {
        self.with(TableColumn::text(head), move |item| Cell::marked(text(item)))
    }

    /// One more column, of names as they are written in a command.
    #[must_use]
    pub fn code<S: std::fmt::Display>(self, head: &str, name: impl Fn(&T) -> S + 'a) -> Self {
        self.marked(head, move |item| code(&name(item).to_string()))
    }

    /// One more column, of numbers in a unit.
    #[must_use]
    pub fn num(self, [head, unit]: [&str; 2], cell: impl Fn(&T) -> Cell + 'a) -> Self {
        self.with(TableColumn::num(head, unit), cell)
    }

    /// One more column, of numbers in a unit; a dash where one is not finite.
    #[must_use]
    pub fn of(
        self,
        head: [&str; 2],
        value: impl Fn(&T) -> f64 + 'a,
        show: impl Fn(f64) -> Cell + 'a,
    ) -> Self {
        self.num(head, move |item| Cell::or_dash(value(item), &show))
    }

    /// The table of these items.
    pub fn table(
        self,
        caption: impl Into<String>,
        items: impl IntoIterator<Item: Borrow<T>>,
    ) -> Table {
        let mut table = Table::new(caption, self.heads);
        for item in items {
            table.rows.push(self.cells.iter().map(|cell| cell(item.borrow())).collect());
        }
        table
    }
}
