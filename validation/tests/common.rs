//! The program as a user runs it, and files that tests read and change.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output};

/// The program.
pub const TOUCHSTONE: &str = env!("CARGO_BIN_EXE_touchstone");

/// A command line of the program in a folder.
pub fn touchstone(folder: &Path, line: &str) -> Output {
    Command::new(TOUCHSTONE).current_dir(folder).args(line.split(' ')).output().unwrap()
}

/// Standard error.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Standard output.
pub fn printed(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Both outputs of a command, and its exit code; -1 of one that a signal ended.
pub fn of(folder: &Path, line: &str) -> (String, i32) {
    let output = touchstone(folder, line);
    (printed(&output) + &said(&output), output.status.code().unwrap_or(-1))
}

/// Standard output of a command that ends with 0.
#[track_caller]
pub fn done(folder: &Path, line: &str) -> String {
    let output = touchstone(folder, line);
    assert!(output.status.success(), "{line}: {}", said(&output));
    printed(&output)
}

/// A text.
#[track_caller]
pub fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The files of a folder by name, none if it is not there.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Sends a signal, such as `-INT`, to a process that a test started.
pub fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(status.unwrap().success());
}
