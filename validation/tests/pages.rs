//! The commands of documents, as a reader types them: the commands of a page run in sequence in one folder.
//!
//! - `sh`: each line runs, unless `<!-- not run: REASON -->` stands before the block. It ends with exit code
//!   0, with 3 if its comment says that it diverges, or with the code that its comment states.
//! - `console`: the command after `$` runs, and prints the lines below it, in which `…` is any text.
//! - `yaml`: the commands after `run:` run.
//! - `python`, `json`: the file that the line before the block names in backquotes, there for every page.

#![cfg(unix)]

use std::env;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use rayon::prelude::*;

/// How README calls the program before it is installed.
const FROM_SOURCES: &str = "cargo run --release -- ";
/// These build the program, which a test that cargo runs cannot do; `.ci/run` does.
const BUILDS: [&str; 2] = ["cargo ", ".ci/"];

/// A block of code: its language, the line before it, its lines.
struct Block {
    language: String,
    before: String,
    lines: Vec<String>,
}

impl Block {
    fn all(text: &str) -> Vec<Self> {
        let (mut found, mut open, mut before) = (Vec::new(), None::<Self>, String::new());
        for line in text.lines() {
            match (&mut open, line.strip_prefix("```")) {
                (None, Some(language)) => {
                    let (language, before) = (language.to_string(), std::mem::take(&mut before));
                    open = Some(Self { language, before, lines: Vec::new() });
                }
                (Some(_), Some(_)) => found.extend(open.take()),
                (Some(block), None) => block.lines.push(line.to_string()),
                (None, None) if !line.trim().is_empty() => before = line.to_string(),
                _ => {}
            }
        }
        found
    }

    /// Name and text of the file that the block is.
    fn file(&self) -> Option<(String, String)> {
        let is_file = ["python", "json"].contains(&&*self.language);
        let name = self.before.split('`').nth(1).filter(|_| is_file)?;
        Some((name.to_string(), self.lines.join("\n") + "\n"))
    }

    /// The commands of the block, each with the exit code that is expected.
    fn commands(&self) -> Vec<(String, i32)> {
        let is_run = !self.before.starts_with("<!-- not run: ");
        let lines = self.lines.iter().filter_map(|line| match &*self.language {
            "sh" if is_run => Some(line.as_str()),
            "yaml" => line.split_once("run: ").map(|(_, command)| command),
            "console" => line.strip_prefix("$ "),
            _ => None,
        });
        let lines = lines.map(|line| line.split_once(" #").unwrap_or((line, "")));
        let called = lines.map(|(line, comment)| {
            (line.trim().replace(FROM_SOURCES, "touchstone "), exit_code(comment))
        });
        let builds = |line: &str| BUILDS.iter().any(|tool| line.starts_with(tool));
        called.filter(|(line, _)| !line.is_empty() && !builds(line)).collect()
    }

    /// The lines of output that the block shows.
    fn printed(&self) -> impl Iterator<Item = &String> {
        let is_shown = self.language == "console";
        self.lines.iter().filter(move |line| is_shown && !line.starts_with("$ "))
    }
}

/// The exit code that a comment states.
fn exit_code(comment: &str) -> i32 {
    let stated = comment.split_once("exit code ").map_or("", |(_, code)| code);
    let digits = stated.split(|c: char| !c.is_ascii_digit()).next().unwrap_or_default();
    let diverges = if comment.contains("diverges") { 3 } else { 0 };
    digits.parse().unwrap_or(diverges)
}

/// Is this line, in which `…` is any text, in an output? Blanks count as one.
fn is_printed(line: &str, output: &str) -> bool {
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let wanted = words(line);
    let (first, rest) = wanted.split_once('…').unwrap_or((&wanted, ""));
    output.lines().map(words).any(|found| match found.strip_prefix(first.trim()) {
        Some(left) if wanted.contains('…') => left.ends_with(rest.trim()),
        left => left == Some(""),
    })
}

/// Documents and the folder in which their commands find the program.
struct Reader {
    program: PathBuf,
    files: Vec<(String, String)>,
}

impl Reader {
    fn types(&self, command: &str, folder: &Path) -> Output {
        let path = env::var("PATH").unwrap_or_default();
        let path = format!("{}:{path}", self.program.display());
        let mut shell = Command::new("sh");
        shell.args(["-c", command]).current_dir(folder).env("PATH", path).output().unwrap()
    }

    /// The faults of a page, and the number of its executed commands.
    fn reads(&self, page: &str) -> (Vec<String>, usize) {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in &self.files {
            fs::write(folder.path().join(name), text).unwrap();
        }
        let (mut wrong, mut count) = (Vec::new(), 0);
        for block in Block::all(page) {
            let mut output = String::new();
            for (command, expected) in block.commands() {
                let ended = self.types(&command, folder.path());
                let message = String::from_utf8_lossy(&ended.stderr).into_owned();
                if ended.status.code() != Some(expected) {
                    let code = ended.status.code().unwrap_or(-1);
                    wrong.push(format!("{command}: exit code {code}: {}", message.trim()));
                }
                output += &(String::from_utf8_lossy(&ended.stdout) + &*message);
                count += 1;
            }
            wrong.extend(
                block
                    .printed()
                    .filter(|line| !is_printed(line, &output))
                    .map(|line| format!("not printed: {line}")),
            );
        }
        (wrong, count)
    }
}

#[test]
fn commands_of_documents_run_and_print_what_these_show() {
    if Command::new("python3").arg("--version").output().is_err() {
        return eprintln!("skipped: python3 is not installed");
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let in_folder = |folder| fs::read_dir(root.join(folder)).unwrap();
    let paths = ["", "docs", "reports", "references/peers"]
        .into_iter()
        .flat_map(in_folder)
        .map(|entry| entry.unwrap().path());
    let paths: Vec<_> =
        paths.filter(|path| path.extension().is_some_and(|of| of == "md")).collect();
    let texts: Vec<_> = paths.iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    let folder = tempfile::tempdir().unwrap();
    symlink(env!("CARGO_BIN_EXE_touchstone"), folder.path().join("touchstone")).unwrap();
    let files = texts.iter().flat_map(|text| Block::all(text)).filter_map(|block| block.file());
    let reader = Reader { program: folder.path().to_path_buf(), files: files.collect() };
    let read: Vec<_> = texts.par_iter().map(|text| reader.reads(text)).collect();
    let count: usize = read.iter().map(|(_, count)| count).sum();
    let wrong = paths.iter().zip(read).flat_map(|(path, (wrong, _))| {
        wrong.into_iter().map(move |text| format!("{}: {text}", path.display()))
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(count > 40, "{count} commands");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The reader itself, on a page with each kind of fault.
#[test]
fn faults_of_a_page_are_seen() {
    let page = "```text\nno command\n```\n`a.json`:\n\n```json\n1\n```\n```sh\necho x  # exit code 1: wrong\n\
        false\ncat b\n```\n```console\n$ echo one\none\no…e\ntwo\nne\n```\n<!-- not run: slow -->\n```sh\n\
        false\n```\n```yaml\n - run: exit 3  # diverges\n```\n```sh\ncargo x\n```\n";
    let files = vec![("b".into(), "1\n".into())];
    let (wrong, count) = Reader { program: PathBuf::new(), files }.reads(page);
    let expected =
        ["echo x: exit code 0: ", "false: exit code 1: ", "not printed: two", "not printed: ne"];
    assert_eq!((wrong, count), (expected.map(String::from).into(), 5));
    let file = Block::all(page).iter().find_map(Block::file);
    assert_eq!(file, Some(("a.json".into(), "1\n".into())));
}
