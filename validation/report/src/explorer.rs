//! The table of all verdicts, which the page's script searches, filters and sorts.

use super::inline::inline;
use super::table::{Cell, Column, class};
use base::gate::Verdict;
use maud::{Markup, html};

/// All verdicts of a page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Explorer {
    /// One row a gate, in the order in which they are shown first.
    pub gates: Vec<GateRow>,
    /// The reasons that rows refer to by number, from 1; inline markup.
    pub reasons: Vec<String>,
}

/// One gate and its verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct GateRow {
    /// Name, also its anchor; what stands before the first dot names the case.
    pub id: String,
    /// How it ended.
    pub status: Verdict,
    /// The run or the study that it judges; inline markup.
    pub of: String,
    /// The number that is judged.
    pub value: Cell,
    /// Where the number must lie.
    pub bound: String,
    /// Share of the allowance that is left.
    pub margin: Cell,
    /// The kind of evidence behind the bound.
    pub evidence: String,
    /// Numbers of its reasons.
    pub reasons: Vec<usize>,
}

/// Anchor of the table; the script appends `?` and its state.
pub const VERDICTS: &str = "verdicts";

/// The address of the table with a filter, such as `case=couette&status=fail`.
pub fn verdicts_where(filter: &str) -> String {
    format!("#{VERDICTS}?{filter}")
}

impl Explorer {
    pub(super) fn markup(&self) -> Markup {
        let heads = [
            Column::text("verdict"),
            Column::text("gate"),
            Column::text("run or study"),
            Column::num("value", ""),
            Column::text("bound"),
            Column::num("margin", ""),
            Column::text("evidence"),
            Column::text("reasons"),
        ];
        html! {
            div.scroll.explorer tabindex="0" role="region" aria-label="All verdicts" {
                table id="gates" {
                    thead { tr { @for head in &heads { (head.markup()) } } }
                    tbody { @for gate in &self.gates { (gate.markup()) } }
                }
            }
            details {
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

impl GateRow {
    fn markup(&self) -> Markup {
        let reasons: Vec<String> = self.reasons.iter().map(usize::to_string).collect();
        html! {
            tr id=(self.id) data-status=(class(self.status)) {
                (Cell::status(self.status).html(false))
                td { (self.id) }
                td { (inline(&self.of)) }
                (self.value.html(true))
                td { (self.bound) }
                (self.margin.html(true))
                td { (self.evidence) }
                td { (reasons.join(" ")) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gate_can_be_linked_and_names_its_reasons() {
        let row = GateRow {
            id: "couette.a<b".into(),
            status: Verdict::Limitation,
            of: "`seed`".into(),
            value: Cell::num(0.5, 2),
            bound: "at most 0.4".into(),
            margin: Cell::percent(0.1, 2),
            evidence: "theory".into(),
            reasons: vec![1, 2],
        };
        let reasons = vec!["one".into(), "*two*".into()];
        let html = Explorer { gates: vec![row], reasons }.markup().into_string();
        assert!(html.contains("<tr id=\"couette.a&lt;b\" data-status=\"limitation\">"), "{html}");
        assert!(html.contains("<td>couette.a&lt;b</td>") && html.contains("<td>1 2</td>"));
        assert!(html.contains("<li id=\"r2\"><em>two</em></li>"));
    }
}
