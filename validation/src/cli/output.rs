//! Text for people and for programs.

use std::io::{self, ErrorKind, Write};
use std::panic::PanicHookInfo;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::Value;

use super::Failure;

/// Before the words of a bug.
pub const BUG: &str = "touchstone: this is a bug of touchstone, not of your settings. Please report it \
                       with the command line and these lines:";

/// A line or more for a person, on standard error. Nobody listening is no error.
pub fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{}", visible(text.trim_end_matches('\n')));
}

/// Text whose control characters are seen and not obeyed, as `\u{1b}`: that of a file or of an argument must
/// not move a cursor or change a title.
fn visible(text: &str) -> String {
    let seen = |char: char| match char {
        '\n' | '\t' => char.to_string(),
        char if char.is_control() => char.escape_default().to_string(),
        char => char.to_string(),
    };
    text.chars().map(seen).collect()
}

/// A result, on standard output. A reader that has had enough (`| head`) is no error.
pub fn print(text: &str) -> Result<(), Failure> {
    taken(write(&visible(text)))
}

/// What came of writing to standard output, which a reader may leave before the end.
pub fn taken(written: io::Result<()>) -> Result<(), Failure> {
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(refused(&error)),
        _ => Ok(()),
    }
}

/// A document for a program, on standard output. A reader that goes away before its end has no document,
/// which is an error; so is standard output that was closed.
pub fn print_whole(document: &str) -> Result<(), Failure> {
    let written = if is_closed() { Err(ErrorKind::NotConnected.into()) } else { write(document) };
    written.map_err(|error| refused(&error))
}

/// The answer to a question, for a program as JSON or for a person.
pub fn answer(
    as_json: bool,
    json: impl FnOnce() -> Value,
    text: impl FnOnce() -> String,
) -> Result<(), Failure> {
    if as_json { print_whole(&format!("{:#}\n", json())) } else { print(&text()) }
}

fn write(text: &str) -> io::Result<()> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush())
}

/// Was standard output closed before the program began? Before `main`, Rust opens `/dev/null` in its place,
/// for reading and writing; a shell's `>/dev/null` is opened for writing alone.
fn is_closed() -> bool {
    let is_null =
        std::fs::read_link("/proc/self/fd/1").is_ok_and(|to| to == Path::new("/dev/null"));
    let info = std::fs::read_to_string("/proc/self/fdinfo/1").unwrap_or_default();
    let flags = info.lines().find_map(|line| line.strip_prefix("flags:"));
    is_null && flags.is_some_and(|octal| octal.ends_with('2'))
}

fn refused(error: &io::Error) -> Failure {
    let closed =
        "standard output is closed, or is /dev/null opened for reading too; the document is lost";
    match error.kind() {
        ErrorKind::NotConnected => Failure::usage(closed),
        _ => Failure::usage(format!("cannot write to standard output: {error}")),
    }
}

/// Set while a run goes on from numbers of a file, which anybody can change.
pub static GOES_ON: AtomicBool = AtomicBool::new(false);
/// Before the words of a panic then.
const OTHER_RUN: &str = "touchstone: the run cannot go on from these numbers of the checkpoint, which no run \
                         has. If nobody changed the file, please report it with these lines:";

/// The hook of a panic.
pub fn report_bug(info: &PanicHookInfo) {
    let message = info.payload_as_str().unwrap_or("no message");
    let (version, commit) = (env!("CARGO_PKG_VERSION"), super::SOURCE.commit);
    let place = info.location().map(ToString::to_string).unwrap_or_default();
    let what = if GOES_ON.load(Ordering::Relaxed) { OTHER_RUN } else { BUG };
    say(&format!("{what}\n{message}\nat {place}, touchstone {version}, commit {commit}"));
}

/// Rows under their heads, columns two spaces apart; a column of numbers stands on the right.
pub fn table(heads: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    laid_out(heads, &rows.into_iter().collect::<Vec<_>>())
}

fn laid_out(heads: &[&str], rows: &[Vec<String>]) -> String {
    let width = |text: &str| text.chars().count();
    let cells = |k: usize| rows.iter().filter_map(move |row| row.get(k)).map(String::as_str);
    let widths: Vec<usize> = (0..heads.len())
        .map(|k| cells(k).map(width).max().unwrap_or(0).max(width(heads[k])))
        .collect();
    let numeric: Vec<bool> = (0..heads.len())
        .map(|k| {
            let starts_like_a_number =
                |cell: &str| cell.starts_with(|c: char| c.is_ascii_digit() || "-−+.∞".contains(c));
            cells(k).any(starts_like_a_number)
                && cells(k).all(|cell| starts_like_a_number(cell) || ["", "NaN"].contains(&cell))
        })
        .collect();
    let mut text = String::new();
    let heads: Vec<String> = heads.iter().map(ToString::to_string).collect();
    for row in std::iter::once(&heads).chain(rows) {
        let mut line = String::new();
        for (k, cell) in row.iter().enumerate() {
            let padding = " ".repeat(widths[k].saturating_sub(width(cell)));
            let (left, right) = if numeric[k] { (&*padding, "") } else { ("", &*padding) };
            line += &format!("{}{left}{cell}{right}", if k == 0 { "" } else { "  " });
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// Longest line of text.
const COLUMNS: usize = 100;

/// Text in lines, each after `indent`.
pub fn wrap(text: &str, indent: &str) -> String {
    let (mut lines, mut line) = (Vec::new(), String::new());
    for word in text.split_whitespace() {
        let length = indent.chars().count() + line.chars().count() + 1 + word.chars().count();
        if !line.is_empty() && length > COLUMNS {
            lines.push(std::mem::take(&mut line));
        }
        line += &format!("{}{word}", if line.is_empty() { "" } else { " " });
    }
    lines.push(line);
    lines.iter().map(|line| format!("{indent}{line}\n")).collect()
}

/// Text in lines after a head, of which those after the first begin so many characters from the left.
pub fn hanging(head: &str, width: usize, text: &str) -> String {
    format!("{head:<width$}{}", wrap(text, &" ".repeat(width)).trim_start())
}
