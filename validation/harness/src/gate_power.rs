//! Which errors the gates detect: solvers and references with one deliberate error each, and the gates that
//! fail. `tests/tests/gate_power.rs` measures these results and compares them exactly with those shown here.

use crate::study::Study;
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
    let columns = head.iter().map(|name| Column::text(*name)).collect();
    let caption = "Mutants, and how many gates of each group they fail.";
    let last = head.len().saturating_sub(1);
    rows.iter().fold(Table::new(caption, columns), |table, row| {
        let cells = row.iter().enumerate().map(|(k, text)| match k {
            0 | 1 => Cell::text(*text),
            k if k == last => Cell::text(format!("`{text}`")),
            _ => cell(text),
        });
        table.row(cells.collect())
    })
}

fn gates() -> Table {
    let columns =
        vec![Column::text("group"), Column::text("gate"), Column::num("mutants that fail it", "")];
    let table = Table::new("Gates, and how many mutants fail them.", columns);
    let (_, rows) = rows(GATES);
    rows.iter().fold(table, |table, row| {
        let count = row.get(2).and_then(|text| text.parse().ok()).unwrap_or(f64::NAN);
        let name = Cell::text(format!("`{}`", row.get(1).unwrap_or(&"")));
        table.row(vec![Cell::text(row[0]), name, Cell::num(count, 3)])
    })
}

/// The mutants of one scene: a line has the mutant, how many gates it fails, of how many, and which.
pub fn of_one_scene(what: &str, text: &str, caption: &str) -> Table {
    let columns = vec![
        Column::text(what),
        Column::num("gates that it fails", "1"),
        Column::num("of", "1"),
        Column::text("which"),
    ];
    rows(text).1.iter().fold(Table::new(caption, columns), |table, row| {
        let count = |k: usize| Cell::count(row.get(k).and_then(|n| n.parse().ok()).unwrap_or(0));
        let which = row.get(3).unwrap_or(&"").split(' ').map(|gate| format!("`{gate}`"));
        let which = Cell::text(which.collect::<Vec<String>>().join(" "));
        table.row(vec![Cell::text(row[0]), count(1), count(2), which])
    })
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
