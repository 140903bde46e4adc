//! Text for people and for programs.

use std::env;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::panic::PanicHookInfo;
use std::path::Path;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::Value;
use terminal_size::{Width, terminal_size_of};
use touchstone_base::gate::Verdict;

use super::Failure;

/// Before the words of a bug.
pub const BUG: &str = "touchstone: this is a bug of touchstone, not of your settings. Please report it \
                       with the command line and these lines:";

/// Prints one or more lines on standard error. A closed standard error is not an error.
pub fn say(text: &str) {
    let _ = writeln!(io::stderr(), "{}", visible(text.trim_end_matches('\n')));
}

/// Escape sequences of the colours in which verdicts are shown: red, yellow, and the end of either.
const RED: &str = "\u{1b}[31m";
const YELLOW: &str = "\u{1b}[33m";
const END: &str = "\u{1b}[0m";

/// Are results shown in colour? On a terminal, unless `NO_COLOR` is set (<https://no-color.org>).
static HAS_COLOUR: LazyLock<bool> = LazyLock::new(|| {
    let is_set = |name| env::var_os(name).is_some_and(|value| !value.is_empty());
    let is_dumb = env::var_os("TERM").is_some_and(|name| name == "dumb");
    io::stdout().is_terminal() && !is_set("NO_COLOR") && !is_dumb
});

/// Text in the colour of a verdict: red if it fails, yellow for a known limitation.
pub fn painted(verdict: Verdict, text: &str) -> String {
    paint(verdict, text, *HAS_COLOUR)
}

fn paint(verdict: Verdict, text: &str, has_colour: bool) -> String {
    match verdict {
        Verdict::Fail if has_colour => format!("{RED}{text}{END}"),
        Verdict::Limitation if has_colour => format!("{YELLOW}{text}{END}"),
        _ => text.to_string(),
    }
}

/// Columns that a text takes.
fn width(text: &str) -> usize {
    if !text.contains('\u{1b}') {
        return text.chars().count();
    }
    [RED, YELLOW, END]
        .iter()
        .fold(text.to_string(), |text, of| text.replace(of, ""))
        .chars()
        .count()
}

/// Text with visible control characters, such as `\u{1b}`: text from a file or an argument must not move the
/// cursor or change the title of the window. Colours of [`painted`] stay.
fn visible(text: &str) -> String {
    visible_with(text, *HAS_COLOUR)
}

fn visible_with(text: &str, has_colour: bool) -> String {
    let mut visible = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(char) = rest.chars().next() {
        let colour = [RED, YELLOW, END].into_iter().find(|of| has_colour && rest.starts_with(of));
        let length = colour.map_or(char.len_utf8(), str::len);
        match (colour, char) {
            (None, '\n' | '\t') => visible.push(char),
            (None, char) if char.is_control() => visible.extend(char.escape_default()),
            _ => visible += &rest[..length],
        }
        rest = &rest[length..];
    }
    visible
}

/// A result, on standard output. A reader that has had enough (`| head`) is not an error.
pub fn print(text: &str) -> Result<(), Failure> {
    taken(write(&visible(text)))
}

/// The result of writing to standard output; a reader may close it early.
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

/// Set while a run continues from numbers of a file, which anybody can change.
pub static GOES_ON: AtomicBool = AtomicBool::new(false);
/// Before the words of a panic then.
const OTHER_RUN: &str = "touchstone: the run cannot continue from the numbers of this checkpoint, which are \
                         invalid. If nobody changed the file, please report it with these lines:";

/// The hook of a panic.
pub fn report_bug(info: &PanicHookInfo) {
    let message = info.payload_as_str().unwrap_or("no message");
    let (version, commit) = (env!("CARGO_PKG_VERSION"), super::SOURCE.commit);
    let place = info.location().map(ToString::to_string).unwrap_or_default();
    let what = if GOES_ON.load(Ordering::Relaxed) { OTHER_RUN } else { BUG };
    say(&format!("{what}\n{message}\nat {place}, touchstone {version}, commit {commit}"));
}

/// Rows under their heads, columns two spaces apart; numbers are aligned right.
pub fn table(heads: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    laid_out(heads, &rows.into_iter().collect::<Vec<_>>())
}

fn laid_out(heads: &[&str], rows: &[Vec<String>]) -> String {
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

/// Length of lines: the width of the terminal, or 100 where standard output is none.
pub fn columns() -> usize {
    terminal_size_of(io::stdout()).map_or(100, |(Width(columns), _)| columns.into())
}

/// Text in lines, each after `indent`. No line ends at a no-break space.
pub fn wrap(text: &str, indent: &str) -> String {
    let (mut lines, mut line) = (Vec::new(), String::new());
    for word in text.split([' ', '\n']).filter(|word| !word.is_empty()) {
        let length = width(indent) + width(&line) + 1 + width(word);
        if !line.is_empty() && length > columns() {
            lines.push(std::mem::take(&mut line));
        }
        line += &format!("{}{word}", if line.is_empty() { "" } else { " " });
    }
    lines.push(line);
    lines.iter().map(|line| format!("{indent}{}\n", line.replace('\u{a0}', " "))).collect()
}

/// Text in lines after a head, of which later lines are indented to `width` characters.
pub fn hanging(head: &str, width: usize, text: &str) -> String {
    format!("{head:<width$}{}", wrap(text, &" ".repeat(width)).trim_start())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Colours are ours alone: every other control character is shown, and all of them are where there is no
    /// terminal.
    #[test]
    fn only_verdicts_have_a_colour_and_only_on_a_terminal() {
        let [fail, limited, pass] = [Verdict::Fail, Verdict::Limitation, Verdict::Pass]
            .map(|verdict| paint(verdict, "text", true));
        assert_eq!(
            [&*fail, &limited, &pass],
            ["\u{1b}[31mtext\u{1b}[0m", "\u{1b}[33mtext\u{1b}[0m", "text"]
        );
        assert_eq!((visible_with(&fail, true), width(&fail)), (fail.clone(), 4));
        assert_eq!(paint(Verdict::Fail, "text", false), "text");
        assert_eq!(visible_with(&fail, false), "\\u{1b}[31mtext\\u{1b}[0m");
        assert_eq!(visible_with("\u{1b}[2Ja\u{9b}b\tc\n", true), "\\u{1b}[2Ja\\u{9b}b\tc\n");
    }
}
