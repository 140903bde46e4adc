//! Answers of codes to the questions of `touchstone probe`, as `probe --json` printed them: the documents of
//! `references/peers/probes`, which the program contains. The name of a document is the code.

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};
use touchstone_base::{gate::Verdict, pack};
use touchstone_report::{Block, Cell, DataFile, Section, Table, TableColumn, plain};

/// Packed by the build script.
const ANSWERS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/probes"));

/// The verdict on an answer.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub enum Outcome {
    /// All criteria pass.
    #[serde(rename = "pass")]
    Pass,
    /// A criterion fails, or there are no results.
    #[serde(rename = "fail")]
    Fail,
    /// The code cannot be asked.
    #[serde(rename = "not applicable")]
    NotApplicable,
}

/// An answer of a code.
#[derive(Debug, Deserialize)]
pub struct Answered {
    /// Name of the question.
    pub id: String,
    /// The question.
    pub question: String,
    /// The verdict.
    pub verdict: Outcome,
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
        .block(file(&all))
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

/// Answers that differ only in numbers.
struct Group<'a> {
    first: &'a Answered,
    /// Names of the codes.
    codes: Vec<&'a str>,
    /// The words of each answer.
    words: Vec<Vec<&'a str>>,
}

/// The value of a word that is a number, with or without a punctuation mark behind it.
fn number(word: &str) -> Option<f64> {
    word.trim_end_matches([',', ';', ':']).parse().ok()
}

impl<'a> Group<'a> {
    fn of(code: &'a str, first: &'a Answered) -> Self {
        Self { first, codes: vec![code], words: vec![first.answer.split(' ').collect()] }
    }

    /// Whether the answers have equal verdicts, and equal words except for numbers; failures also have
    /// equal numbers.
    fn is_like(&self, other: &Self) -> bool {
        let (own, others) = (&self.words[0], &other.words[0]);
        let is_failure = self.first.verdict == Outcome::Fail;
        let is_like =
            |(a, b): (&&str, &&str)| a == b || !is_failure && number(a).and(number(b)).is_some();
        self.first.verdict == other.first.verdict
            && own.len() == others.len()
            && own.iter().zip(others).all(is_like)
    }

    /// The answer, with the range of each number, and the largest value of each uncertainty.
    fn answer(&self) -> String {
        let word = |k: usize| {
            let mut all: Vec<&str> = self.words.iter().map(|words| words[k]).collect();
            all.sort_by(|a, b| number(a).partial_cmp(&number(b)).unwrap_or(Ordering::Equal));
            let (least, most) = (all[0], all[all.len() - 1]);
            let is_uncertainty = k > 0 && self.words[0][k - 1] == "±";
            match number(least) == number(most) || is_uncertainty {
                true => most.to_string(),
                false => format!("{} to {most}", least.trim_end_matches([',', ';', ':'])),
            }
        };
        (0..self.words[0].len()).map(word).collect::<Vec<_>>().join(" ")
    }
}

/// Groups of the answers to a question, the group of the most codes last.
fn groups<'a>(answers: &[(&'a str, Option<&'a Answered>)]) -> Vec<Group<'a>> {
    let mut groups: Vec<Group> = Vec::new();
    for one in answers.iter().filter_map(|(code, of)| Some(Group::of(code, (*of)?))) {
        match groups.iter_mut().find(|group| group.is_like(&one)) {
            Some(group) => {
                group.codes.extend(one.codes);
                group.words.extend(one.words);
            }
            None => groups.push(one),
        }
    }
    groups.sort_by_key(|group| group.codes.len());
    groups
}

/// Groups of answers, with the codes that gave them.
fn texts(all: &[(String, Vec<Answered>)]) -> Table {
    let columns = ["question", "verdict", "codes", "answer"].map(TableColumn::text);
    let table = Table::new("Answers, with the range of numbers of several codes.", columns.into());
    let rows = |(question, answers): Asked| {
        let groups = groups(&answers);
        let of_group = |(k, group): (usize, &Group)| {
            let is_last = k + 1 == groups.len() && group.codes.len() > 2;
            let codes = match (is_last, groups.len()) {
                (true, 1) => "all".into(),
                (true, _) => "all others".into(),
                _ => group.codes.join(", "),
            };
            let mut id = Cell::text(&question.id);
            if k == 0 {
                id.anchor = anchor(question);
            }
            vec![id, verdict(group.first), Cell::text(codes), Cell::text(group.answer())]
        };
        groups.iter().enumerate().map(of_group).collect::<Vec<_>>()
    };
    questions(all).flat_map(rows).fold(table, Table::row)
}

/// An answer as a line of a file.
#[derive(Serialize)]
struct Line {
    code: String,
    question: String,
    verdict: Outcome,
    answer: String,
}

/// All answers, word by word.
fn file(all: &[(String, Vec<Answered>)]) -> Block {
    let rows = all.iter().flat_map(|(code, answers)| answers.iter().map(move |of| (code, of)));
    let line = |(code, of): (&String, &Answered)| Line {
        code: code.clone(),
        question: of.id.clone(),
        verdict: of.verdict,
        answer: of.answer.clone(),
    };
    Block::File(DataFile::of_rows("All answers (CSV)".into(), "answers.csv".into(), rows.map(line)))
}

/// Anchor of the answers to a question.
fn anchor(of: &Answered) -> String {
    format!("probes-{}", of.id)
}

fn verdict(of: &Answered) -> Cell {
    match of.verdict {
        Outcome::Pass => Cell::status(Verdict::Pass),
        Outcome::Fail => Cell::status(Verdict::Fail),
        Outcome::NotApplicable => Cell::text("n/a"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of several codes become a range; other words and other verdicts stay apart.
    #[test]
    fn answers_that_differ_in_their_numbers_are_one() {
        let of = |verdict: Outcome, answer: &str| Answered {
            id: "shear".into(),
            question: "Is it?".into(),
            verdict,
            answer: answer.into(),
        };
        let all = [
            of(Outcome::Pass, "it is 0.99 ± 0.02 of it, 7 rows"),
            of(Outcome::Fail, "it is 1.97 ± 0.02 of it, 7 rows"),
            of(Outcome::Pass, "it is 0.9 ± 0.3 of it, 7 rows"),
            of(Outcome::Pass, "it is 1.02 ± 0.1 of it, 7 rows"),
            of(Outcome::Pass, "equal"),
            of(Outcome::Fail, "it is 2.50 ± 0.02 of it, 7 rows"),
        ];
        let answers = ["a", "b", "c", "d", "e", "f"].into_iter().zip(all.iter().map(Some));
        let groups = groups(&answers.collect::<Vec<_>>());
        let found: Vec<_> = groups.iter().map(|of| (of.codes.join(" "), of.answer())).collect();
        let expected = [
            ("b", "it is 1.97 ± 0.02 of it, 7 rows"),
            ("e", "equal"),
            ("f", "it is 2.50 ± 0.02 of it, 7 rows"),
            ("a c d", "it is 0.9 to 1.02 ± 0.3 of it, 7 rows"),
        ];
        assert_eq!(found, expected.map(|(codes, text)| (codes.into(), text.into())));
    }

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
        }
    }
}
