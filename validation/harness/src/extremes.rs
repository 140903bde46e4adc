//! A table of settings far outside the usual range: what is extreme, the required outcome, the observed one.
//! Each entry has its own criterion; if a run cannot succeed, the criterion is that it reports the failure.

use base::gate::{Bound, Evidence, Gate};
use report::{Cell, Column};

use crate::{columns::Columns, runs::Judged, study::Study};

/// One setting, the required outcome, and the observed one.
#[derive(Clone)]
pub struct Entry {
    /// What is extreme.
    what: String,
    /// The values of the setting.
    setting: String,
    /// The observed outcome, in words.
    found: String,
    /// The judged value.
    value: f64,
    gate: Gate,
}

impl Entry {
    /// `name` ends the gate's name; `metric` is what the judged value is.
    pub fn new(name: &str, [what, setting]: [String; 2], metric: &str, bound: Bound) -> Self {
        let because = "see the column what must come";
        let id = format!("extremes.{name}");
        let gate = Gate::new(id, metric, bound, Evidence::Invariant, because);
        Self { what, setting, found: "not run".into(), value: f64::NAN, gate }
    }

    /// Why the bound is where it is, and what stands behind it.
    pub fn because(mut self, evidence: Evidence, because: &str) -> Self {
        (self.gate.evidence, self.gate.because) = (evidence, because.into());
        self
    }

    /// A control, which must lie outside its bound.
    pub fn expected_to_fail(self) -> Self {
        Self { gate: self.gate.expected_to_fail(), ..self }
    }

    /// What came: the judged value, and words.
    pub fn found(self, value: f64, found: impl Into<String>) -> Self {
        Self { value, found: found.into(), ..self }
    }
}

/// Entries as a study.
pub fn study(id: &str, title: &str, lead: &str, entries: Vec<Entry>) -> Study {
    let judge = |entry: &Entry| Judged::new(entry.gate.clone(), Some(entry.value));
    let judged: Vec<Judged> = entries.iter().map(judge).collect();
    let expected =
        |Gate { metric, bound, because, .. }: &Gate| format!("{metric} {bound}: {because}");
    let table = Columns::<(&Entry, &Judged)>::default()
        .text("what", |(entry, _)| entry.what.clone())
        .text("setting", |(entry, _)| entry.setting.clone())
        .text("what must come", |(entry, _)| expected(&entry.gate))
        .text("what came", |(entry, _)| entry.found.clone())
        .with(Column::text("verdict"), |(_, judged)| Cell::status(judged.status()))
        .table(format!("{title}."), entries.iter().zip(&judged));
    Study { judged, ..Study::new(id, title).prose(lead).block(table) }
}
