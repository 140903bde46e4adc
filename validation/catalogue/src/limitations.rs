//! What lies outside of its bound for a known reason, grouped by cause.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use base::{gate::Cause, spec::Task};
use harness::{
    case::{self, Planned},
    runs::{Judged, JudgedRun},
    suite::{CaseResults, Of, Suite},
};
use report::{Block, Section, sig};

/// One gate outside of its bound.
struct Found<'a> {
    results: &'a CaseResults,
    of: Of<'a>,
    judged: &'a Judged,
}

/// The gates that are outside of their bounds for a known reason by its cause, that of most gates first, and
/// last those whose cause is their own.
pub fn by_cause<'a, T>(
    all: impl IntoIterator<Item = T>,
    judged: impl Fn(&T) -> &'a Judged,
) -> Vec<(Option<&'a Cause>, Vec<T>)> {
    let mut causes: BTreeMap<Option<&Cause>, Vec<T>> = BTreeMap::new();
    for one in all {
        if let Some(known) = judged(&one).limitation() {
            causes.entry(known.cause.as_ref()).or_default().push(one);
        }
    }
    let mut causes: Vec<_> = causes.into_iter().collect();
    causes.sort_by_key(|(cause, gates)| (cause.is_none(), Reverse(gates.len())));
    causes
}

/// A part of the page for each cause.
pub fn section(suite: &Suite) -> Section {
    let of_case = |results| {
        let judged = CaseResults::judged(results);
        judged.map(move |(of, judged)| Found { results, of, judged })
    };
    let causes = by_cause(suite.cases.iter().flat_map(of_case), |found| found.judged);
    let section = Section::new("limitations", "Limitations by cause").prose(
        "Each gate below is outside of its bound, and inside the wider bound that its cause explains; \
         beyond that it would fail.",
    );
    causes.iter().fold(section, |section, (cause, found)| {
        let mut cases: Vec<&str> = found.iter().map(|found| found.results.case.name()).collect();
        cases.dedup();
        let what = cause.map_or("Other causes.".into(), Cause::to_string);
        let command = found.first().map(command).unwrap_or_default();
        let text = format!("{what} Cases: {}. To see it: `{command}`.", cases.join(", "));
        section.prose(text).block(Block::Details {
            summary: format!("The gates ({})", found.len()),
            blocks: vec![Block::List(found.iter().map(gate).collect())],
        })
    })
}

/// The gate, its value and its bound.
fn gate(found: &Found) -> String {
    let Judged { gate, judgement, .. } = found.judged;
    let value = judgement.value.map_or("not measured".into(), |value| sig(value, 4));
    format!("[{0}](#{0}): {value}; {1}", gate.id, gate.bounds())
}

/// The command that shows it: the run, or the verdict of a search or of a study.
fn command(found: &Found) -> String {
    let case = found.results.case;
    match found.of {
        Of::Run(JudgedRun { planned: Planned { spec, .. }, .. })
            if spec.task == Task::Simulate && spec.mutation.is_none() =>
        {
            case::command(case, &spec.variant, &case::changed(case, spec))
        }
        _ => format!("touchstone explain {}", found.judged.gate.id),
    }
}
