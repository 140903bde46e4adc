//! Exported problems: what they must state, numbers of the files for other codes, and results that only look
//! right.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const TOUCHSTONE: &str = env!("CARGO_BIN_EXE_touchstone");

fn touchstone(folder: &Path, line: &str) -> Output {
    Command::new(TOUCHSTONE).current_dir(folder).args(line.split(' ')).output().unwrap()
}

/// What a command that ends with 0 says on standard output.
#[track_caller]
fn done(folder: &Path, line: &str) -> String {
    let output = touchstone(folder, line);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{line}: {told}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A table of numbers: columns by name without unit.
struct Table {
    head: String,
    columns: BTreeMap<String, usize>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    fn read(path: &Path) -> Self {
        let text = read(path);
        let (head, rows) = text.split_once('\n').unwrap();
        let name = |cell: &str| cell.split('[').next().unwrap().to_string();
        let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
        Self {
            head: head.into(),
            columns: head.split(',').enumerate().map(|(k, cell)| (name(cell), k)).collect(),
            rows: rows.lines().map(row).collect(),
        }
    }

    fn write(&self, path: &Path) {
        let row = |row: &Vec<f64>| row.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        let rows: Vec<String> = self.rows.iter().map(row).collect();
        fs::write(path, format!("{}\n{}\n", self.head, rows.join("\n"))).unwrap();
    }
}

/// The rows of a table at other times, by linear interpolation between the frames, each of so many rows.
fn at_times(table: &Table, count: usize, times: &[f64], scale: f64) -> Vec<Vec<f64>> {
    let frames: Vec<&[Vec<f64>]> = table.rows.chunks(count).collect();
    let [t, u, v] = ["t", "u", "v"].map(|name| table.columns[name]);
    let mut all = Vec::new();
    for time in times {
        let wanted = time * scale;
        let next = frames.partition_point(|frame| frame[0][t] < wanted).clamp(1, frames.len() - 1);
        let (a, b) = (frames[next - 1], frames[next]);
        let share = (wanted - a[0][t]) / (b[0][t] - a[0][t]);
        for (a, b) in a.iter().zip(b) {
            let mix = |(a, b): (&f64, &f64)| a + share * (b - a);
            let mut row: Vec<f64> = a.iter().zip(b).map(mix).collect();
            row[t] = *time;
            row[u] *= scale;
            row[v] *= scale;
            all.push(row);
        }
    }
    all
}

/// Fronts, heights and levels are areas over x: water 1 mm high, or ten times as high, and water that falls
/// with 3 % more or less gravity passed every gate that applies to results of particles.
#[test]
fn heights_and_gravity_of_a_dam_break_are_judged() {
    let folder = tempfile::tempdir().unwrap();
    let of = folder.path();
    done(of, "export dam_break --out asked --solve");
    let judged =
        |name: &str| touchstone(of, &format!("submit dam_break {name} --all --store store"));
    let honest = judged("asked");
    assert_eq!(honest.status.code(), Some(0), "{}", String::from_utf8_lossy(&honest.stdout));
    let results = of.join("asked/results.csv");
    let mut table = Table::read(&results);
    let (t, y) = (table.columns["t"], table.columns["y"]);
    let count = table.rows.partition_point(|row| row[t] == 0.0);
    let times: Vec<f64> = table.rows.chunks(count).map(|frame| frame[0][t]).collect();
    let whole = table.rows.clone();
    let fails = |table: &Table, what: &str| {
        table.write(&results);
        let found = judged("asked");
        let told = String::from_utf8_lossy(&found.stdout).into_owned();
        assert_eq!(found.status.code(), Some(1), "{what}: {told}");
        let failed = told.lines().filter(|line| line.starts_with("FAIL"));
        let failed: Vec<&str> = failed.collect();
        assert!(failed.iter().any(|line| line.contains("potential_away")), "{what}: {failed:?}");
    };
    type Height = fn(f64) -> f64;
    for (what, height) in
        [("on one line", (|_| 1e-3) as Height), ("ten times as high", |y| 10.0 * y)]
    {
        table.rows.iter_mut().zip(&whole).for_each(|(row, was)| row[y] = height(was[y]));
        fails(&table, what);
    }
    // A fall with more gravity is the same fall with a faster clock. A longer one has all times that it needs.
    done(of, "export dam_break --set end=1.85 --out longer --solve");
    let longer = Table::read(&of.join("longer/results.csv"));
    for factor in [0.97_f64, 1.03] {
        table.rows = at_times(&longer, count, &times, factor.sqrt());
        fails(&table, &format!("gravity times {factor}"));
    }
}
