//! Tables whose cells may carry a verdict.

use super::inline::inline;
use super::number;
use maud::{Markup, PreEscaped, html};
use touchstone_base::gate::Verdict;

/// A verdict as a class of the style sheet.
pub(super) fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "pass",
        Verdict::Limitation => "limitation",
        Verdict::ExpectedFailure => "expected",
        Verdict::Fail => "fail",
    }
}

/// The mark of a verdict, which needs no colour.
pub(super) fn mark(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "✓",
        Verdict::Limitation => "△",
        Verdict::ExpectedFailure => "⊘",
        Verdict::Fail => "✗",
    }
}

/// One cell: text, the value to sort by, a verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Plain text, or inline markup as in [`super::Block::Prose`].
    pub text: String,
    /// Is it inline markup?
    pub is_marked: bool,
    /// Sorts the column; without it the text does.
    pub value: Option<f64>,
    /// Colours the cell.
    pub status: Option<Verdict>,
    /// A remark in small letters below it, such as the reason of a dash; inline markup.
    pub remark: String,
    /// Name under which links lead to it, unique on the page; none if empty.
    pub anchor: String,
}

impl Cell {
    /// Plain text, shown as it is.
    pub fn text(text: impl Into<String>) -> Self {
        let [remark, anchor] = [const { String::new() }; 2];
        Self { text: text.into(), is_marked: false, value: None, status: None, remark, anchor }
    }

    /// Text of ours with inline markup.
    pub fn marked(text: impl Into<String>) -> Self {
        Self { is_marked: true, ..Self::text(text) }
    }

    /// The value as `show` has it; a dash where there is none.
    pub fn or_dash(value: f64, show: impl Fn(f64) -> Self) -> Self {
        if value.is_finite() { show(value) } else { Self::text("–") }
    }

    /// A number with this many significant digits.
    pub fn num(value: f64, digits: usize) -> Self {
        Self::formatted(value, number::sig(value, digits))
    }

    /// A number that was chosen, with the digits that it has and no more: `20`, `0.0125`.
    pub fn exact(value: f64) -> Self {
        Self::formatted(value, number::exact(value))
    }

    /// A whole number, in full.
    pub fn count(value: u64) -> Self {
        Self::formatted(value as f64, value.to_string())
    }

    /// A number as `1.2·10⁻⁴`.
    pub fn sci(value: f64, digits: usize) -> Self {
        Self::formatted(value, number::sci(value, digits))
    }

    /// A fraction as per cent.
    pub fn percent(value: f64, digits: usize) -> Self {
        Self::formatted(value, number::percent(value, digits))
    }

    /// A duration in a unit that suits it.
    pub fn seconds(value: f64) -> Self {
        Self::formatted(value, number::seconds(value))
    }

    /// A verdict in words.
    pub fn status(status: Verdict) -> Self {
        Self::text(status.to_string()).with(status)
    }

    /// Adds a remark.
    pub fn because(self, remark: impl Into<String>) -> Self {
        Self { remark: remark.into(), ..self }
    }

    /// Adds a verdict.
    pub fn with(self, status: Verdict) -> Self {
        Self { status: Some(status), ..self }
    }

    /// The cell without the unit that the head of its column states.
    fn without(&self, unit: &str) -> Self {
        let bare = self.text.strip_suffix(unit).filter(|_| !unit.is_empty());
        let bare = bare.map(|text| text.trim_end_matches(NO_BREAK).to_string());
        Self { text: bare.unwrap_or_else(|| self.text.clone()), ..self.clone() }
    }

    /// A number that is missing is a dash.
    fn formatted(value: f64, text: String) -> Self {
        if value.is_nan() {
            Self::text("–")
        } else {
            Self { value: Some(value), ..Self::text(text) }
        }
    }

    pub(super) fn html(&self, numeric: bool) -> Markup {
        self.markup(numeric, None)
    }

    /// The cell with the head of its column as a label, for screens that are too narrow for columns.
    pub(super) fn labelled(&self, column: &TableColumn) -> Markup {
        self.markup(column.numeric, Some(&column.head))
    }

    fn markup(&self, numeric: bool, label: Option<&str>) -> Markup {
        // The sort key of a column: six digits. The style sheet shows a cell with a key as a number.
        let six = |value: f64| format!("{value:.5e}").parse().unwrap_or(value);
        let value: Option<f64> = self.value.filter(|value| value.is_finite()).map(six);
        let number = (numeric && value.is_none()).then_some("number");
        let classes: Vec<&str> = number.into_iter().chain(self.status.map(class)).collect();
        html! {
            td id=[(!self.anchor.is_empty()).then_some(&self.anchor)]
                class=[(!classes.is_empty()).then(|| classes.join(" "))] data-v=[value]
                data-label=[label] {
                @if self.is_marked { (inline(&self.text)) } @else { (self.text) }
                @if !self.remark.is_empty() { small { (inline(&self.remark)) } }
            }
        }
    }
}

/// Cells of a table that is shown at once; one with more of them opens by a click.
const SHORT: usize = 12;

/// Rows of a table that repeat a text often enough for a sentence in place of a column.
const MANY: usize = 3;

/// A text up to the end of its first sentence, and the rest.
pub fn first_sentence(text: &str) -> (&str, &str) {
    let is_end = |at: &usize| {
        let (before, after) = (&text[..*at], &text[at + 2..]);
        let word = before.rsplit([' ', '(']).next().unwrap_or_default();
        after.starts_with(char::is_uppercase) && !["al", "cf", "no", "e.g", "i.e"].contains(&word)
    };
    match text.match_indices(". ").map(|(at, _)| at).find(is_end) {
        Some(at) => (&text[..=at], &text[at + 2..]),
        None => (text, ""),
    }
}

/// Head of a column.
#[derive(Debug, Clone, PartialEq)]
pub struct TableColumn {
    /// Name; inline markup.
    pub head: String,
    /// Unit, shown in brackets; empty for none.
    pub unit: String,
    /// Numbers are aligned right.
    pub numeric: bool,
}

impl TableColumn {
    /// A column of text.
    pub fn text(head: impl Into<String>) -> Self {
        Self { head: head.into(), unit: String::new(), numeric: false }
    }

    /// A column of numbers in a unit (empty for none).
    pub fn num(head: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { head: head.into(), unit: unit.into(), numeric: true }
    }

    pub(super) fn markup(&self) -> Markup {
        self.with_unit(&self.unit)
    }

    /// The head with another unit.
    fn with_unit(&self, unit: &str) -> Markup {
        html! {
            th class=[self.numeric.then_some("number")] scope="col" {
                (inline(&self.head))
                @if !unit.is_empty() { span.unit { " [" (unit) "]" } }
            }
        }
    }
}

/// A table with a caption; a click on a head sorts it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Inline markup.
    pub caption: String,
    /// Heads.
    pub columns: Vec<TableColumn>,
    /// Cells, row by row; missing ones stay empty.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub fn new(caption: impl Into<String>, columns: Vec<TableColumn>) -> Self {
        Self { caption: caption.into(), columns, rows: Vec::new() }
    }

    /// Adds a row.
    pub fn row(mut self, cells: Vec<Cell>) -> Self {
        self.rows.push(cells);
        self
    }

    /// The table without the columns in which no row has a value.
    fn without_empty_columns(&self) -> Self {
        let has_value = |k: usize| {
            let mut cells = self.rows.iter().filter_map(|row| row.get(k));
            cells.any(|cell| !matches!(&*cell.text, "" | "–") || !cell.remark.is_empty())
        };
        self.with_columns(has_value)
    }

    /// The table without the columns in which many rows have one text, and a sentence with these texts.
    fn without_equal_columns(&self) -> (Self, String) {
        let common = |k: usize| {
            let first = self.rows.first()?.get(k)?;
            let is_first = |row: &Vec<Cell>| row.get(k) == Some(first);
            let is_plain = first.status.is_none() && first.anchor.is_empty();
            (is_plain && self.rows.len() >= MANY && self.rows.iter().all(is_first)).then_some(first)
        };
        let stated = |(k, column): (usize, &TableColumn)| {
            let cell = common(k)?;
            let unit = if ["-", "1"].contains(&&*column.unit) { "" } else { &column.unit };
            Some(format!("{} {} {unit}", column.head, cell.text).trim_end().to_string())
        };
        let stated: Vec<String> = self.columns.iter().enumerate().filter_map(stated).collect();
        if stated.is_empty() || stated.len() == self.columns.len() {
            return (self.clone(), String::new());
        }
        let words = format!("In all rows: {}.", stated.join("; "));
        (self.with_columns(|k| common(k).is_none()), words)
    }

    /// The table of the columns that `is_shown` accepts by their numbers.
    fn with_columns(&self, is_shown: impl Fn(usize) -> bool) -> Self {
        fn kept<T: Clone>(all: &[T], is_shown: impl Fn(usize) -> bool) -> Vec<T> {
            let shown = all.iter().enumerate().filter(|(k, _)| is_shown(*k));
            shown.map(|(_, one)| one.clone()).collect()
        }
        Self {
            caption: self.caption.clone(),
            columns: kept(&self.columns, &is_shown),
            rows: self.rows.iter().map(|row| kept(row, &is_shown)).collect(),
        }
    }

    /// The table with its caption, without empty columns and with the texts that all rows have in a
    /// sentence; behind a click if it is long.
    pub(super) fn markup(&self, name: &str) -> Markup {
        let (table, common) = self.without_empty_columns().without_equal_columns();
        let caption = format!("{} {common}", self.caption);
        Self { caption: caption.trim().into(), ..table }.captioned(name)
    }

    fn captioned(&self, name: &str) -> Markup {
        let cells = self.rows.len() * self.columns.len();
        let (first, rest) = first_sentence(&self.caption);
        let table = html! {
            div.scroll tabindex="0" role="region" aria-label=(name) {
                table {
                    @if cells <= SHORT { caption { b { (name) ". " } (inline(&self.caption)) } }
                    (self.body(None))
                }
            }
        };
        if cells <= SHORT {
            return table;
        }
        html! {
            details {
                summary { b { (name) ". " } (inline(first)) }
                @if !rest.is_empty() { p { (inline(rest)) } }
                (table)
            }
        }
    }

    /// Heads and rows; the text in the column of this number is the anchor of its row. A unit that all
    /// numbers of a column have is in its head.
    pub(super) fn body(&self, anchor: Option<usize>) -> Markup {
        let units: Vec<&str> = (0..self.columns.len()).map(|k| self.common_unit(k)).collect();
        html! {
            thead {
                tr {
                    @for (column, unit) in self.columns.iter().zip(&units) {
                        (column.with_unit(if unit.is_empty() { &column.unit } else { unit }))
                    }
                }
            }
            tbody { @for row in &self.rows { (self.row_markup(row, anchor, &units)) } }
        }
    }

    /// The unit behind all numbers of a column, if it is one.
    fn common_unit(&self, column: usize) -> &str {
        let numbers = self.rows.iter().filter_map(|row| row.get(column));
        let mut numbers = numbers.filter(|cell| self.columns[column].numeric && cell.text != "–");
        let unit = |cell: &Cell| cell.text.rfind(NO_BREAK).map(|at| at + NO_BREAK.len_utf8());
        let Some(first) = numbers.next() else { return "" };
        let Some(own) = unit(first).map(|at| &first.text[at..]) else { return "" };
        let is_own = |cell: &Cell| unit(cell).is_some_and(|at| &cell.text[at..] == own);
        if numbers.all(is_own) { own } else { "" }
    }

    fn row_markup(&self, row: &[Cell], anchor: Option<usize>, units: &[&str]) -> Markup {
        let id = anchor.and_then(|k| row.get(k)).map(|cell| &cell.text);
        let worst = row.iter().filter_map(|c| c.status).max();
        html! {
            tr id=[id] data-status=[worst.map(class)] {
                @for (i, column) in self.columns.iter().enumerate() {
                    @match row.get(i) {
                        Some(cell) => (cell.without(units[i]).html(column.numeric)),
                        None => (PreEscaped("<td></td>")),
                    }
                }
            }
        }
    }
}

/// Between a number and its unit.
const NO_BREAK: char = '\u{a0}';

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_ends_before_a_capital_letter() {
        assert_eq!(first_sentence("See et al. There. Three."), ("See et al. There.", "Three."));
        assert_eq!(first_sentence("Errors fall. Orders too."), ("Errors fall.", "Orders too."));
        let text = "Front of Lobovsky et al. 2014, no. 3 [m]. Lines.";
        assert_eq!(first_sentence(text), ("Front of Lobovsky et al. 2014, no. 3 [m].", "Lines."));
    }

    #[test]
    fn a_long_table_opens_by_a_click() {
        let columns = || vec![TableColumn::text("a"); 8];
        let row = || vec![Cell::text("1"); 8];
        let with = |rows: usize| Table {
            rows: vec![row(); rows],
            ..Table::new("Errors fall. Orders too.", columns())
        };
        assert!(!with(1).markup("Table").into_string().contains("<details>"));
        let long = with(2).markup("Table").into_string();
        assert!(long.contains("<summary><b>Table. </b>Errors fall.</summary><p>Orders too.</p>"));
    }

    #[test]
    fn a_column_without_values_is_omitted() {
        let columns = ["a", "b", "c"].map(TableColumn::text).into();
        let row = |c: Cell| vec![Cell::text("1"), Cell::text("–"), c];
        let table = Table::new("Errors", columns).row(row(Cell::text("")));
        let shown = |table: &Table| table.markup("Table").into_string().matches("<th ").count();
        assert_eq!(shown(&table), 1);
        assert_eq!(shown(&table.row(row(Cell::text("–").because("not measured")))), 2);
    }

    /// A sentence has the text that all rows of a column have; verdicts and anchors stay in their rows.
    #[test]
    fn a_text_of_all_rows_is_stated_once() {
        let columns = vec![
            TableColumn::text("run"),
            TableColumn::num("rows", "1"),
            TableColumn::num("error", "-"),
            TableColumn::text("verdict"),
        ];
        let row = |k: usize| {
            let cells = [Cell::count(k as u64), Cell::count(20), Cell::percent(0.03, 2)];
            [cells.to_vec(), vec![Cell::status(Verdict::Pass)]].concat()
        };
        let of = |count: usize| Table {
            rows: (0..count).map(row).collect(),
            ..Table::new("Errors", columns.clone())
        };
        let html = of(3).markup("Table").into_string();
        assert!(html.contains("In all rows: rows 20; error 3.0\u{a0}%."), "{html}");
        assert_eq!(html.matches("<th ").count(), 2, "{html}");
        assert_eq!(of(2).markup("Table").into_string().matches("<th ").count(), 4);
    }

    #[test]
    fn a_unit_that_all_numbers_have_is_in_the_head() {
        let columns = ["same", "other"].map(|head| TableColumn::num(head, "-")).into();
        let row = |same: Cell, other: Cell| vec![same, other];
        let table = Table::new("Errors", columns)
            .row(row(Cell::percent(0.012, 2), Cell::seconds(2.0)))
            .row(row(Cell::text("–"), Cell::seconds(2e-3)))
            .row(row(Cell::percent(0.3, 2), Cell::text("–")));
        let html = table.markup("Table").into_string();
        assert!(html.contains("same<span class=\"unit\"> [%]</span>"), "{html}");
        assert!(html.contains(">1.2</td>") && html.contains(">30</td>"), "{html}");
        assert!(html.contains(">2.00\u{a0}ms</td>") && html.contains("[-]"), "{html}");
    }

    #[test]
    fn cells_carry_value_and_verdict() {
        let table =
            Table::new("Errors", vec![TableColumn::text("case"), TableColumn::num("L2", "1")])
                .row(vec![Cell::text("a < b"), Cell::sci(1.2e-4, 2).with(Verdict::Fail)])
                .row(vec![Cell::text("short"), Cell::sci(0.123456789, 2)])
                .row(vec![Cell::text("none"), Cell::text("–")]);
        let html = table.markup("Table").into_string();
        assert!(html.contains("<td data-v=\"0.123457\">1.2·10⁻¹</td>"), "{html}");
        assert!(html.contains("<td class=\"number\">–</td>"));
        assert!(html.contains("a &lt; b"));
        assert!(html.contains("1.2·10⁻⁴"));
        assert!(html.contains("data-v=\"0.00012\""));
        assert!(html.contains("<tr data-status=\"fail\">"));
    }
}
