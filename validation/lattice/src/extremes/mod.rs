//! Settings far outside of the usual: each with a pass criterion of its own, or with the typed
//! failure that must come.
//!
//! Common to all: nothing hangs, nothing panics, and a run that leaves its bounds ends as
//! [`solver::Outcome::Diverged`] with step, time, particle and quantity.

mod channel;
mod odd;
mod rubber;
mod step;
mod vortex;

use rayon::prelude::*;

use base::gate::{Bound, Evidence, Gate, Verdict};
use harness::{
    case::Tier,
    suite::{Judged, Study},
};
use report::{Cell, Column, Status, Table};

/// One setting, what must come, and what came.
pub struct Entry {
    /// What is extreme.
    what: String,
    /// The numbers of it.
    setting: String,
    /// What came, in words.
    found: String,
    /// The judged value.
    value: f64,
    gate: Gate,
}

impl Entry {
    /// `name` ends the gate's name; `metric` is what `value` is, `because` why the bound is there.
    fn new(name: &str, [what, setting]: [String; 2], metric: &str, bound: Bound) -> Self {
        let because = "see the column what must come";
        let id = format!("extremes.{name}");
        let gate = Gate::new(id, metric, bound, Evidence::Invariant, because);
        Self { what, setting, found: String::new(), value: f64::NAN, gate }
    }

    /// Why the bound is where it is, and what stands behind it.
    fn because(mut self, evidence: Evidence, because: &str) -> Self {
        (self.gate.evidence, self.gate.because) = (evidence, because.into());
        self
    }

    /// Shown, not judged.
    fn reported(self) -> Self {
        Self { gate: self.gate.reported(), ..self }
    }

    /// What came.
    fn found(self, value: f64, found: String) -> Self {
        Self { value, found, ..self }
    }
}

impl From<Entry> for Vec<Entry> {
    fn from(entry: Entry) -> Self {
        vec![entry]
    }
}

/// The groups of entries; each is one task.
type Group = fn(Tier) -> Vec<Entry>;
const GROUPS: &[Group] = &[
    odd::rest,
    channel::stiff_sound,
    vortex::stiff_sound,
    channel::slow,
    channel::smoothing,
    step::beyond_the_limit,
    vortex::fast,
    vortex::jittered,
    odd::coincident,
    odd::alone,
    odd::fast_blocks,
    odd::refused,
    rubber::incompressible,
    rubber::stiffer,
    rubber::fast,
    rubber::alone,
    rubber::overlapping,
];

/// The study.
pub fn study(tier: Tier) -> Study {
    let entries: Vec<Vec<Entry>> = GROUPS.par_iter().map(|group| group(tier)).collect();
    let columns = vec![
        Column::text("what"),
        Column::text("setting"),
        Column::text("what must come"),
        Column::text("what came"),
        Column::text("verdict"),
    ];
    let mut table = Table::new("Extreme settings.", columns);
    let mut judged = Vec::new();
    for entry in entries.into_iter().flatten() {
        let Gate { metric, bound, because, .. } = &entry.gate;
        let expected = format!("{metric} {bound}: {because}");
        let judgement = Judged::new(entry.gate, Some(entry.value));
        table = table.row(vec![
            Cell::text(entry.what),
            Cell::text(entry.setting),
            Cell::text(expected),
            Cell::text(entry.found),
            Cell::status(status(&judgement.judgement.verdict)),
        ]);
        judged.push(judgement);
    }
    let mut study = Study::new("extremes", "Extreme settings").prose(LEAD).block(table);
    study.judged = judged;
    study
}

const LEAD: &str = "What breaks a naive program: vanishing and huge Reynolds numbers, steps beyond \
    the limit, sound a thousand times too fast, particles on top of each other or far from all \
    others. Each entry has a criterion of its own; where a run cannot succeed, the criterion is that \
    it says so, in time. Of a disturbed lattice only the energy is judged, which must not rise; the errors \
    of energy and velocity beside it are reported.";

fn status(verdict: &Verdict) -> Status {
    match verdict {
        Verdict::Pass => Status::Pass,
        Verdict::Fail => Status::Fail,
        Verdict::Reported | Verdict::NotMeasured => Status::Reported,
        Verdict::Limitation(_) => Status::Limitation,
        Verdict::ExpectedFailure => Status::ExpectedFailure,
    }
}

/// A number as in tables.
fn sci(x: f64) -> String {
    report::sci(x, 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quick_tier_survives_its_extremes() {
        let study = study(Tier::Quick);
        let gates: Vec<Gate> = study.judged.iter().map(|judged| judged.gate.clone()).collect();
        assert_eq!(base::gate::check_all(&gates), Ok(()));
        for Judged { gate, judgement } in &study.judged {
            assert!(!judgement.verdict.is_failure(), "{}: {:?}", gate.id, judgement.value);
        }
    }
}
