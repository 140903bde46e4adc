//! The first screen of a page: a table with a row a case.

use super::figure::Figure;
use super::inline::{aloud, inline};
use super::render;
use super::table::{Cell, TableColumn};
use maud::{Markup, PreEscaped, html};

/// A row of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// Anchor of its section.
    pub id: String,
    /// Name; inline markup.
    pub title: String,
    /// The conditions of the numbers; inline markup.
    pub about: String,
    /// A small picture, and its caption, which is read aloud.
    pub picture: Option<Figure>,
    /// A cell for each column.
    pub cells: Vec<Cell>,
}

/// Subjects side by side.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Overview {
    /// Description of the table for screen readers.
    pub caption: String,
    /// Columns behind picture and name.
    pub columns: Vec<TableColumn>,
    /// A row each.
    pub rows: Vec<Subject>,
}

impl Overview {
    pub(super) fn markup(&self) -> Markup {
        let has_pictures = self.rows.iter().any(|row| row.picture.is_some());
        html! {
            table.overview aria-label=(self.caption) {
                thead {
                    tr {
                        @if has_pictures { td {} }
                        th scope="col" { "case" }
                        @for column in &self.columns { (column.markup()) }
                    }
                }
                tbody { @for row in &self.rows { (self.row(row, has_pictures)) } }
            }
        }
    }

    fn row(&self, row: &Subject, has_pictures: bool) -> Markup {
        html! {
            tr {
                @if has_pictures {
                    td.picture { @if let Some(picture) = &row.picture { (drawn(picture)) } }
                }
                th scope="row" {
                    a href=(format!("#{}", row.id)) { (inline(&row.title)) }
                    @if !row.about.is_empty() { small { (inline(&row.about)) } }
                }
                @for (cell, column) in row.cells.iter().zip(&self.columns) {
                    (cell.labelled(column))
                }
            }
        }
    }
}

/// The panels of a picture.
fn drawn(picture: &Figure) -> Markup {
    PreEscaped(render::parts(picture, &aloud(&picture.caption)).panels.concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_its_name_first_and_a_cell_a_column() {
        let cells = vec![Cell::marked("**[1 %](#gate)**"), Cell::text("–").because("no order")];
        let row = Subject {
            id: "case".into(),
            title: "Case".into(),
            about: "at Re 1".into(),
            picture: None,
            cells,
        };
        let columns = vec![TableColumn::num("error", ""), TableColumn::num("order", "")];
        let html = Overview { caption: "All".into(), columns, rows: vec![row] }.markup();
        let html = html.into_string();
        assert!(html.contains("<a href=\"#case\">Case</a><small>at Re 1</small>"), "{html}");
        assert!(html.contains("<strong><a href=\"#gate\">1 %</a></strong>"), "{html}");
        assert!(html.contains("data-label=\"order\">–<small>no order</small>"), "{html}");
        assert!(!html.contains("picture"), "{html}");
    }
}
