//! The known limitations, grouped by cause.

use touchstone_harness::{
    case::{self, Planned},
    runs::{Judged, JudgedRun, by_cause},
    suite::{JudgedOf, Of, Suite},
};
use touchstone_report::{Block, Section, sig};

/// A part of the page for each cause.
pub fn section(suite: &Suite) -> Section {
    let causes = by_cause(suite.judged(), |found| found.judged);
    let section = Section::new("limitations", "Limitations by cause").prose(
        "Each gate below is outside its bound and inside a wider one, beyond which it fails. The wider \
         bound follows from the cause or is marked as fitted to own runs. Unexplained causes state where \
         numbers are wrong, not why.",
    );
    let blocks = causes.iter().flat_map(|(cause, found)| {
        let mut cases: Vec<&str> = found.iter().map(|found| found.case.name()).collect();
        cases.dedup();
        let command = found.first().map(command).unwrap_or_default();
        let text = format!("{cause} Cases: {}. To see it: `{command}`.", cases.join(", "));
        let summary = touchstone_report::counted(found.len(), "gate", "gates");
        let gates = vec![Block::List(found.iter().map(gate).collect())];
        [Block::Prose(vec![text]), Block::Details { summary, blocks: gates }]
    });
    let blocks = blocks.collect();
    let summary = touchstone_report::counted(causes.len(), "cause", "causes");
    section.block(Block::Details { summary, blocks })
}

/// The gate, its value and its bound.
fn gate(found: &JudgedOf) -> String {
    let Judged { gate, judgement, .. } = found.judged;
    let value = judgement.value.map_or("not measured".into(), |value| sig(value, 4));
    format!("[{0}](#{0}): {value}; {1}", gate.id, gate.bounds())
}

/// The command that shows it: the run, or the verdict of a search or of a study.
fn command(found: &JudgedOf) -> String {
    match found.of {
        Of::Run(JudgedRun { planned: Planned { spec, .. }, .. })
            if spec.is_simulation() && spec.mutation.is_none() =>
        {
            case::command(found.case, spec)
        }
        _ => format!("touchstone explain {}", found.judged.gate.id),
    }
}
