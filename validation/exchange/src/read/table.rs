//! Tidy tables of comma-separated values: one line a particle and time.

use super::{Head, MOST_FLAWS, MOST_ROWS, Renamed, Rows, places, too_many};
use crate::flaw::Flaw;

pub fn rows(
    file: &str,
    text: &str,
    renamed: &Renamed,
    columns: &[Head],
) -> Result<Rows, Vec<Flaw>> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let unread = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        vec![Flaw::of(file, error.to_string()).at(line)]
    };
    let heads = reader.headers().map_err(unread)?.clone();
    // Of a byte order mark, which some programs put before a table, nothing is said.
    let heads: Vec<&str> = heads.iter().map(|head| head.trim_start_matches('\u{feff}')).collect();
    let places = places(file, 1, &heads, renamed, columns)?;
    let (mut rows, mut flaws) = (Rows::new(file, 2, &places), Vec::new());
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
