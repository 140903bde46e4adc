//! Which errors the gates detect: solvers and references with one deliberate error each, and the gates that
//! fail. `tests/tests/gate_power.rs` measures these results and compares them exactly with those shown here.

use crate::{columns::Columns, study::Study};
use report::{Block, Cell, Column, Status, Table};

/// A mutant a line: its name, what it spoils, a group of gates a column, the first gate it fails.
pub const MUTANTS: &str = include_str!("../../../tests/gate_power.csv");
/// A gate a line: its group, its name, how many mutants fail it.
pub const GATES: &str = include_str!("../../../tests/gate_power_gates.csv");

/// The same for rubber, for [`of_one_scene`].
pub const RUBBER: &str = include_str!("../../../tests/ring_power.csv");

const ABOUT: &str = "A gate that passes says little until something fails it. Each line is the \
    program with one thing spoiled, run through planned runs of the quick tier (Couette and \
    Poiseuille flow at 10 and 20 rows, at Re 0.5 and 20, the waves, and some points of the \
    stability study), the same measuring and the same gates. A cell counts the gates that it fails \
    of those that it could; a dash marks what the mutant does not touch. The tables are recomputed \
    by `cargo test`, which fails if a mutant passes every gate or if a number here is another one.";

/// Head and rows of a table of the tests: plain commas, no quotes.
fn rows(text: &str) -> (Vec<&str>, Vec<Vec<&str>>) {
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<&str>>());
    (lines.next().unwrap_or_default(), lines.collect())
}

/// `3 of 9` where it fails gates, `0 of 9` where it passes all of them, `-` where neither.
fn cell(text: &str) -> Cell {
    match text.split_once(" of ") {
        Some(("0", all)) => Cell::text(format!("passes {all}")).with(Status::Limitation),
        Some(_) => Cell::text(text).with(Status::ExpectedFailure),
        None => Cell::text("–"),
    }
}

fn mutants() -> Table {
    let (head, rows) = rows(MUTANTS);
    let caption = "Mutants, and how many gates of each group they fail.";
    let last = head.len().saturating_sub(1);
    let mut columns = Columns::<Vec<&str>>::default();
    for (k, name) in head.into_iter().enumerate() {
        columns = columns.with(Column::text(name), move |row| match row.get(k).copied() {
            Some(text) if k < 2 => Cell::text(text),
            Some(text) if k == last => Cell::text(format!("`{text}`")),
            text => cell(text.unwrap_or_default()),
        });
    }
    columns.table(caption, rows)
}

fn gates() -> Table {
    let count = |row: &Vec<&str>| row.get(2).and_then(|text| text.parse().ok());
    Columns::<Vec<&'static str>>::default()
        .text("group", |row| row[0])
        .code("gate", |row| row.get(1).copied().unwrap_or_default())
        .num(["mutants that fail it", ""], move |row| Cell::num(count(row).unwrap_or(f64::NAN), 3))
        .table("Gates, and how many mutants fail them.", rows(GATES).1)
}

/// The mutants of one scene: a line has the mutant, how many gates it fails, of how many, and which.
pub fn of_one_scene(what: &str, text: &str, caption: &str) -> Table {
    let count = |row: &Vec<&str>, k: usize| row.get(k).and_then(|n| n.parse().ok()).unwrap_or(0);
    let which = |row: &Vec<&str>| {
        let gates = row.get(3).unwrap_or(&"").split(' ').map(|gate| format!("`{gate}`"));
        gates.collect::<Vec<String>>().join(" ")
    };
    Columns::<Vec<&str>>::default()
        .text(what, |row| row[0])
        .num(["gates that it fails", "1"], |row| Cell::count(count(row, 1)))
        .num(["of", "1"], |row| Cell::count(count(row, 2)))
        .text("which", which)
        .table(caption, rows(text).1)
}

const OF_RUBBER: &str = "The same for the elastic solid: the rings at spacing 0.2 L, elastic waves, and a \
    block that begins to turn. Measured by `tests/tests/ring_power.rs`.";

/// The study: tables without judgement, for the test is the judge.
pub fn study() -> Study {
    let (_, rows) = rows(GATES);
    let idle: Vec<String> = rows
        .iter()
        .filter(|row| row.get(2) == Some(&"0"))
        .map(|row| format!("`{}`", row[1]))
        .collect();
    let idle = if idle.is_empty() {
        "Every gate is failed by some mutant.".to_string()
    } else {
        format!("No mutant of the list is for these gates: {}.", idle.join(", "))
    };
    Study::new("gate-power", "What the gates are worth")
        .prose(ABOUT)
        .block(mutants())
        .prose(idle)
        .block(of_one_scene("rubber with", RUBBER, OF_RUBBER))
        .block(Block::Details { summary: "Gate by gate".into(), blocks: vec![gates().into()] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_are_whole() {
        for text in [MUTANTS, GATES] {
            let (head, rows) = rows(text);
            assert!(head.len() >= 3 && rows.len() > 20);
            assert!(rows.iter().all(|row| row.len() == head.len()), "a line has another length");
        }
        let survivors = rows(MUTANTS).1.into_iter().filter(|row| row.last() == Some(&"none"));
        assert_eq!(survivors.count(), 0, "a mutant that no gate sees");
        assert!(rows(RUBBER).1.iter().all(|row| row.len() == 4 && row[1] != "0"));
        assert_eq!(study().blocks.len(), 5);
    }
}
