//! The table of all verdicts, which the page's script searches, filters and sorts.

use super::inline::inline;
use super::table::Table;
use maud::{Markup, html};

/// All verdicts of a page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Explorer {
    /// One row for each gate, in the initial order. The script addresses columns by position: verdict; name
    /// of the gate, which is also its anchor, and begins with the case and a dot; value; bound; margin; run,
    /// with the variant first, or study; evidence; numbers of the reasons. It shows the last three of a gate
    /// that is selected.
    pub gates: Table,
    /// The reasons that rows refer to by number, from 1, a list where no script runs; inline markup.
    pub reasons: Vec<String>,
}

/// Anchor of the table; the script appends `?` and its state.
pub const VERDICTS: &str = "verdicts";

/// The column of the names of gates.
const NAME: usize = 1;

/// The address of the table with a filter, such as `case=couette&status=fail`.
pub fn verdicts_where(filter: &str) -> String {
    format!("#{VERDICTS}?{filter}")
}

impl Explorer {
    pub(super) fn markup(&self) -> Markup {
        html! {
            div.scroll.explorer tabindex="0" role="region" aria-label="All verdicts" {
                table id="gates" { (self.gates.body(Some(NAME))) }
            }
            details.reasons {
                summary { "Reasons for the bounds and for the limitations, by number" }
                ol id="reasons" {
                    @for (k, reason) in self.reasons.iter().enumerate() {
                        li id=(format!("r{}", k + 1)) { (inline(reason)) }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, TableColumn};
    use touchstone_base::gate::Verdict;

    #[test]
    fn a_gate_can_be_linked_and_names_its_reasons() {
        let columns = ["verdict", "gate", "reasons"].map(TableColumn::text);
        let cells = ["couette.a<b", "1 2"].map(Cell::text);
        let row = [vec![Cell::status(Verdict::Limitation)], cells.into()].concat();
        let gates = Table::new("", columns.into()).row(row);
        let reasons = vec!["one".into(), "*two*".into()];
        let html = Explorer { gates, reasons }.markup().into_string();
        assert!(html.contains("<tr id=\"couette.a&lt;b\" data-status=\"limitation\">"), "{html}");
        assert!(html.contains("<td>couette.a&lt;b</td>") && html.contains("<td>1 2</td>"));
        assert!(html.contains("<li id=\"r2\"><em>two</em></li>"));
    }
}
