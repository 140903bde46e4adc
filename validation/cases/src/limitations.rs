//! The known limitations, grouped by cause.

use touchstone_harness::{
    case::{self, Planned},
    runs::{JudgedRun, by_cause},
    suite::{JudgedOf, Of, Suite},
};
use touchstone_report::{Block, Section};

/// A part of the page for each cause.
pub fn section(suite: &Suite) -> Section {
    let causes = by_cause(suite.judged(), |found| found.judged);
    let section = Section::new("limitations", "Limitations by cause").prose(
        "Each gate below is outside its bound and inside a wider one, beyond which it fails. The wider \
         bound follows from the cause or is marked as fitted to own runs. Unexplained causes state where \
         numbers are wrong, not why.",
    );
    let blocks = causes.iter().map(|(cause, found)| {
        let command = found.first().map(command).unwrap_or_default();
        let link = |found: &JudgedOf| format!("[{0}](#{0})", found.judged.gate.id);
        let gates = found.iter().map(link).collect::<Vec<_>>().join(", ");
        Block::Details {
            summary: cause.to_string(),
            blocks: vec![Block::Prose(vec![format!("`{command}` shows it. Gates: {gates}.")])],
        }
    });
    let blocks = blocks.collect();
    let summary = touchstone_report::counted(causes.len(), "cause", "causes");
    section.block(Block::Details { summary, blocks })
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
