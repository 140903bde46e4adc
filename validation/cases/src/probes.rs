//! Answers of codes to the questions of `touchstone probe`, as `probe --json` printed them: the documents of
//! `references/peers/probes`, which the program contains. The name of a document is the code.

use serde::Deserialize;
use touchstone_base::{gate::Verdict, pack};
use touchstone_report::{Cell, Section, Table, TableColumn, plain};

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

/// Codes against questions, and the answers.
pub fn section() -> Section {
    let all = answers();
    Section::new("probes", "Questions for any code")
        .prose(
            "Each question has one short problem, criteria with reasons, and named errors that it finds; \
             `touchstone probe -- COMMAND` asks them of any code. n/a: not applicable, which is no pass.",
        )
        .block(verdicts(&all))
        .block(texts(&all))
}

/// A question, and the answer of each code that was asked.
type Asked<'a> = (&'a Answered, Vec<(&'a str, Option<&'a Answered>)>);

fn questions<'a>(all: &'a [(String, Vec<Answered>)]) -> impl Iterator<Item = Asked<'a>> {
    let first = all.first().map_or(&[][..], |(_, answers)| answers);
    first.iter().map(move |question| {
        let of = |(code, answers): &'a (String, Vec<Answered>)| {
            (&**code, answers.iter().find(|of| of.id == question.id))
        };
        (question, all.iter().map(of).collect())
    })
}

/// A verdict for each question and code, which leads to the answer.
fn verdicts(all: &[(String, Vec<Answered>)]) -> Table {
    let mut columns = vec![TableColumn::text("question")];
    columns.extend(all.iter().map(|(code, _)| TableColumn::text(plain(code))));
    let table = Table::new("Answers of codes to the same questions", columns);
    let link = |of: &Answered| {
        let text = format!("[{}](#{})", verdict(of).text, anchor(of));
        Cell { text, is_marked: true, ..verdict(of) }
    };
    let row = |(question, answers): Asked| {
        let answers = answers.iter().map(|(_, of)| of.map_or(Cell::text("not asked"), link));
        [Cell::text(&question.question)].into_iter().chain(answers).collect()
    };
    questions(all).map(row).fold(table, Table::row)
}

/// Each answer once, with the codes that gave it.
fn texts(all: &[(String, Vec<Answered>)]) -> Table {
    let columns = ["question", "verdict", "codes", "answer"].map(TableColumn::text);
    let table = Table::new("Answers, with the codes that gave them", columns.into());
    let rows = |(question, answers): Asked| {
        let mut rows: Vec<Vec<Cell>> = Vec::new();
        for (code, of) in answers.iter().filter_map(|(code, of)| Some((code, (*of)?))) {
            let [id, answer] = [&question.id, &of.answer].map(Cell::text);
            match rows.iter_mut().find(|row| row[1] == verdict(of) && row[3] == answer) {
                Some(row) => row[2].text += &format!(", {code}"),
                None => rows.push(vec![id, verdict(of), Cell::text(*code), answer]),
            }
        }
        if let Some(first) = rows.first_mut() {
            first[0].anchor = anchor(question);
        }
        rows
    };
    questions(all).flat_map(rows).fold(table, Table::row)
}

/// Where the answers to its question are.
fn anchor(of: &Answered) -> String {
    format!("probes-{}", of.id)
}

fn verdict(of: &Answered) -> Cell {
    match &*of.verdict {
        "pass" => Cell::status(Verdict::Pass),
        "fail" => Cell::status(Verdict::Fail),
        _ => Cell::text("n/a"),
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
