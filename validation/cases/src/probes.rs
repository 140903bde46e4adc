//! Answers of codes to the questions of `touchstone probe`, as `probe --json` printed them: the documents of
//! `references/peers/probes`, which the program contains. The name of a document is the code.

use serde::Deserialize;
use touchstone_base::{gate::Verdict, pack};
use touchstone_report::{Block, Cell, Section, Table, TableColumn, plain};

/// Packed by the build script.
const ANSWERS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/probes"));

/// An answer of a code.
#[derive(Debug, Deserialize)]
pub struct Answered {
    /// Name of the question.
    pub id: String,
    /// The question.
    pub question: String,
    /// `pass`, `fail` or `not applicable`.
    pub verdict: String,
    /// The answer.
    pub answer: String,
}

/// The codes and their answers, in the order of their names. A test reads each.
pub fn answers() -> Vec<(String, Vec<Answered>)> {
    let code = |path: &str| {
        let name = path.rsplit('/').next().unwrap_or(path);
        name.trim_end_matches(".json").replace('_', " ")
    };
    let all = pack::read(ANSWERS).into_iter();
    all.filter_map(|(path, text)| Some((code(&path), serde_json::from_str(&text).ok()?))).collect()
}

/// Codes against questions, and below it each answer.
pub fn section() -> Section {
    let all = answers();
    let mut columns = vec![TableColumn::text("question")];
    columns.extend(all.iter().map(|(code, _)| TableColumn::text(code.clone())));
    let caption = "Answers of codes to the same questions";
    let mut table = Table::new(caption, columns);
    for first in all.first().map_or(&[][..], |(_, answers)| answers) {
        let of = |answers: &[Answered]| answers.iter().find(|of| of.id == first.id).map(verdict);
        let mut row = vec![Cell::text(first.question.clone())];
        row.extend(all.iter().map(|(_, answers)| of(answers).unwrap_or(Cell::text("not asked"))));
        table = table.row(row);
    }
    let section = Section::new("probes", "Twenty questions").prose(
        "Each question has one short problem, criteria with reasons, and named errors that it finds; \
         `touchstone probe -- COMMAND` asks them of any code. Not applicable is no pass.",
    );
    let of_code = |(code, answers): &(String, Vec<Answered>)| {
        let columns = ["question", "verdict", "answer"].map(TableColumn::text);
        let row = |of: &Answered| {
            vec![Cell::text(of.id.clone()), verdict(of), Cell::text(plain(&of.answer))]
        };
        let table = Table::new(format!("Answers of {}", plain(code)), columns.into());
        Block::Table(answers.iter().map(row).fold(table, Table::row))
    };
    all.iter().map(of_code).fold(section.block(Block::Table(table)), Section::block)
}

fn verdict(of: &Answered) -> Cell {
    match &*of.verdict {
        "pass" => Cell::status(Verdict::Pass),
        "fail" => Cell::status(Verdict::Fail),
        _ => Cell::text("–"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The documents are complete, and of the same questions.
    #[test]
    fn every_code_has_an_answer_to_every_question() {
        let all = answers();
        let folder =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../references/peers/probes");
        assert_eq!(all.len(), std::fs::read_dir(folder).unwrap().count());
        let ids = |answers: &[Answered]| answers.iter().map(|of| of.id.clone()).collect::<Vec<_>>();
        for (code, answers) in &all {
            assert_eq!(ids(answers), ids(&all[0].1), "{code}");
            let verdicts = ["pass", "fail", "not applicable"];
            assert!(answers.iter().all(|of| verdicts.contains(&&*of.verdict)), "{code}");
        }
    }
}
