//! Tidy tables of comma-separated values: one line a particle and time.

use super::{
    Head, MOST_FLAWS, MOST_ROWS, Renamed, Rows,
    columns::{self, Heads},
    too_many,
};
use crate::flaw::{CUT, Flaw};

/// Separators of columns in other programs.
const SEPARATORS: [(char, &str); 3] = [(';', "semicolons"), ('\t', "tabs"), (' ', "blanks")];

pub fn rows(
    file: &str,
    text: &str,
    renamed: &Renamed,
    columns: &[Head],
) -> Result<Rows, Vec<Flaw>> {
    if !text.is_empty() && !text.ends_with(['\n', '\r']) {
        return Err(vec![Flaw::of(file, CUT).at(text.lines().count() as u64)]);
    }
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let unread = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        vec![Flaw::of(file, error.to_string()).at(line)]
    };
    let heads = reader.headers().map_err(unread)?.clone();
    // A byte order mark, which some programs put before a table, is ignored.
    let heads: Vec<&str> = heads.iter().map(|head| head.trim_start_matches('\u{feff}')).collect();
    if let [head] = heads[..]
        && let Some((_, by)) = SEPARATORS.iter().find(|(sign, _)| head.contains(*sign))
    {
        let what =
            format!("its columns are separated by {by}; expected commas, and points in numbers");
        return Err(vec![Flaw::of(file, what).at(1)]);
    }
    let heads = Heads::new(&heads, renamed, &[]);
    let places = columns::places(file, 1, &heads, columns)?;
    let (mut rows, mut flaws) = (Rows::new(file, 2, &heads, &places), Vec::new());
    for record in reader.records() {
        let record = record.map_err(unread)?;
        let line = record.position().map_or(0, csv::Position::line);
        rows.add(line, &places, &record.iter().collect::<Vec<_>>(), &mut flaws);
        if rows.len() > MOST_ROWS {
            return Err(vec![too_many(file)]);
        }
        if flaws.len() >= MOST_FLAWS {
            break;
        }
    }
    if flaws.is_empty() { Ok(rows) } else { Err(flaws) }
}
