//! Style as tests: what the project asks of its sources, checked and not remembered.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Lines that a function may have, from `fn` to its closing brace.
const FUNCTION_LINES: usize = 70;
/// Columns that a line of Rust may have.
const COLUMNS: usize = 110;
/// The solver, and the crate beside it.
const SOLVER: [&str; 2] = ["solver/src", "solver/lagrangian/src"];
/// What is tracked in the root beside folders: documents, licences and the settings of tools.
const ROOT_FILES: &[&str] = &[
    ".gitignore",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "CITATION.cff",
    "CONTRIBUTING.md",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "SECURITY.md",
    "clippy.toml",
    "deny.toml",
    "rustfmt.toml",
];
/// Folders of the root that are tracked.
const ROOT_FOLDERS: &[&str] =
    &[".ci", ".github", "docs", "references", "reports", "solver", "tests", "validation"];
/// Functions that may be longer, as `file.rs: name`, with a reason beside each.
const LONG_FUNCTIONS: &[&str] = &[];
/// Split, so that this file does not contain what it looks for.
const BANNED: &[&str] = &[
    concat!("to", "do!"),
    concat!("unimple", "mented!"),
    concat!("db", "g!"),
    concat!("FIX", "ME"),
];
const MACHINE_PATHS: &[&str] =
    &[concat!("/wo", "rk/"), concat!("/tm", "p/wt"), concat!("/ro", "ot/")];

/// The folder of the project.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All files below a folder, sorted; neither those of git nor what is built or ignored.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{folder:?}: {error}"));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths {
        let name = path.file_name().unwrap().to_string_lossy();
        // Cargo puts this tag into what it builds into, wherever that is.
        let is_output = folder.ends_with("..") && ["target", "reports"].contains(&&*name)
            || path.join("CACHEDIR.TAG").exists();
        if path.is_dir() && ![".git", "node_modules"].contains(&&*name) && !is_output {
            found.extend(files(&path));
        } else if path.is_file() && name != ".git" {
            found.push(path);
        }
    }
    found
}

/// Path relative to the root, and content, of the Rust files below the given folders.
fn sources(folders: &[&str]) -> Vec<(String, String)> {
    let below = |folder: &&str| files(&root().join(folder));
    let is_rust = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "rs");
    let read = |path: PathBuf| (relative(&path), fs::read_to_string(&path).unwrap());
    folders.iter().flat_map(below).filter(is_rust).map(read).collect()
}

fn relative(path: &Path) -> String {
    path.strip_prefix(root()).unwrap().to_string_lossy().replace('\\', "/")
}

/// The source with comments and the contents of strings and characters blanked out,
/// lines kept; so that a brace is a brace.
fn code(source: &str) -> String {
    let chars: Vec<char> = source.chars().collect();
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    let mut code = String::with_capacity(source.len());
    let mut i = 0;
    while i < chars.len() {
        let end = match (at(i), at(i + 1)) {
            ('/', '/') => line_end(&chars, i),
            ('/', '*') => comment_end(&chars, i),
            ('r', '"' | '#') if !is_word(at(i.wrapping_sub(1))) => raw_end(&chars, i),
            ('"', _) => quote_end(&chars, i, '"'),
            ('\'', '\\') => quote_end(&chars, i, '\''),
            ('\'', _) if at(i + 2) == '\'' => i + 3,
            _ => i,
        };
        if end > i {
            code.extend(chars[i..end.min(chars.len())].iter().filter(|char| **char == '\n'));
            code.push(' ');
            i = end;
        } else {
            code.push(at(i));
            i += 1;
        }
    }
    code
}

fn is_word(char: char) -> bool {
    char.is_alphanumeric() || char == '_'
}

fn line_end(chars: &[char], start: usize) -> usize {
    (start..chars.len()).find(|i| chars[*i] == '\n').unwrap_or(chars.len())
}

fn comment_end(chars: &[char], start: usize) -> usize {
    let (mut depth, mut i) = (0, start);
    while i + 1 < chars.len() {
        match (chars[i], chars[i + 1]) {
            ('/', '*') => (depth, i) = (depth + 1, i + 2),
            ('*', '/') => (depth, i) = (depth - 1, i + 2),
            _ => i += 1,
        }
        if depth == 0 {
            return i;
        }
    }
    chars.len()
}

/// The end of `r"…"` or `r#"…"#`; the start itself if this is neither (`r#name`).
fn raw_end(chars: &[char], start: usize) -> usize {
    let hashes = chars[start + 1..].iter().take_while(|char| **char == '#').count();
    if chars.get(start + 1 + hashes) != Some(&'"') {
        return start;
    }
    let close: Vec<char> = std::iter::once('"').chain(vec!['#'; hashes]).collect();
    let from = start + 2 + hashes;
    let found = chars[from..].windows(close.len()).position(|window| window == close);
    found.map_or(chars.len(), |offset| from + offset + close.len())
}

fn quote_end(chars: &[char], start: usize, quote: char) -> usize {
    let mut i = start + 1;
    while i < chars.len() && chars[i] != quote {
        i += if chars[i] == '\\' { 2 } else { 1 };
    }
    i + 1
}

/// Index of the line that closes the first brace opened at or after a line; `None` if a `;` at
/// depth 0 comes first, as in a declaration without a body.
fn block_end(lines: &[&str], start: usize) -> Option<usize> {
    let (mut braces, mut others) = (0_i32, 0_i32);
    for (index, line) in lines.iter().enumerate().skip(start) {
        for char in line.chars() {
            match char {
                '{' => braces += 1,
                '}' => braces -= 1,
                '(' | '[' => others += 1,
                ')' | ']' => others -= 1,
                ';' if braces == 0 && others == 0 => return None,
                _ => {}
            }
            if char == '}' && braces <= 0 {
                return Some(index);
            }
        }
    }
    None
}

/// Name, first line (from 1) and number of lines of every function with a body.
fn functions(source: &str) -> Vec<(String, usize, usize)> {
    let code = code(source);
    let lines: Vec<&str> = code.lines().collect();
    let mut functions = Vec::new();
    for (start, line) in lines.iter().enumerate() {
        let named = line.match_indices("fn ").find(|(at, _)| !line[..*at].ends_with(is_word));
        let Some((at, _)) = named else { continue };
        let name = line[at + 3..].split(|char| !is_word(char)).next().unwrap_or_default();
        if let Some(end) = block_end(&lines, start) {
            functions.push((name.to_string(), start + 1, end - start + 1));
        }
    }
    functions
}

/// The lines of a source outside `#[cfg(test)]` items.
fn without_tests(source: &str) -> Vec<String> {
    let code = code(source);
    let lines: Vec<&str> = code.lines().collect();
    let (mut kept, mut index) = (Vec::new(), 0);
    for (number, line) in source.lines().enumerate() {
        if number < index {
            continue;
        }
        if lines[number].trim() == "#[cfg(test)]" {
            index = block_end(&lines, number).map_or(number + 2, |end| end + 1);
        } else {
            kept.push(line.to_string());
        }
    }
    kept
}

/// Fails with the rule if anything breaks it.
#[track_caller]
pub fn assert_none(rule: &str, found: Vec<String>) {
    assert!(found.is_empty(), "{rule}:\n  {}", found.join("\n  "));
}

#[test]
fn functions_are_short() {
    let mut long = Vec::new();
    for (path, source) in sources(&["solver/src", "solver/lagrangian/src", "validation"]) {
        for (name, line, length) in functions(&source) {
            let is_excepted = LONG_FUNCTIONS.contains(&format!("{path}: {name}").as_str());
            if length > FUNCTION_LINES && !is_excepted {
                long.push(format!("{path}:{line}: {name} has {length} lines"));
            }
        }
    }
    assert_none(&format!("a function has at most {FUNCTION_LINES} lines"), long);
}

/// A profile costs nothing unless it is asked for: clocks are in the harness, which is told of phases then.
#[test]
fn the_solver_reads_no_clock() {
    let mut found = Vec::new();
    for (path, source) in sources(&SOLVER) {
        let lines = without_tests(&source);
        let clocks =
            lines.iter().filter(|line| line.contains("Instant") || line.contains("time::"));
        found.extend(clocks.map(|line| format!("{path}: {}", line.trim())));
    }
    assert_none("no clock in the solver", found);
}

#[test]
fn lines_are_short_and_carry_no_banned_word() {
    let mut found = Vec::new();
    for (path, source) in sources(&["solver", "validation", "tests", "references"]) {
        for (number, line) in source.lines().enumerate() {
            let columns = line.chars().count();
            if columns > COLUMNS {
                found.push(format!("{path}:{}: {columns} columns", number + 1));
            }
            for word in BANNED.iter().filter(|word| line.contains(**word)) {
                found.push(format!("{path}:{}: {word}", number + 1));
            }
        }
    }
    assert_none(&format!("a line has at most {COLUMNS} columns and no banned word"), found);
}

#[test]
fn the_command_line_does_not_unwrap() {
    let mut found = Vec::new();
    for (path, source) in sources(&["validation/src"]) {
        let is_command_line = ["validation/src/main.rs", "validation/src/cli.rs"].contains(&&*path);
        if is_command_line || path.starts_with("validation/src/cli/") {
            let lines = without_tests(&source);
            let unwraps = lines.iter().filter(|line| line.contains(".unwrap()"));
            found.extend(unwraps.map(|line| format!("{path}: {}", line.trim())));
        }
    }
    assert_none("an error on the command line is a message, not a panic", found);
}

/// What is no module of the program is not run, and nothing says so.
#[test]
fn every_file_of_tests_is_run() {
    let mut found = Vec::new();
    // The others are programs of their own.
    for (folder, others) in [
        ("tests", &["main", "allocation"][..]),
        ("solver", &["main", "sharing", "symbols", "couette_only", "rings_only"]),
        ("solver/lagrangian", &["main"]),
    ] {
        let folder = root().join(folder).join("tests");
        let all = fs::read_to_string(folder.join("main.rs")).unwrap();
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            let is_source = path.extension().is_some_and(|extension| extension == "rs");
            let is_run = others.contains(&&*name) || all.contains(&format!("\nmod {name};\n"));
            if (is_source || path.join("mod.rs").exists()) && !is_run {
                found.push(path.display().to_string());
            }
        }
    }
    assert_none("a file of tests is a module of the main.rs beside it", found);
}

#[test]
fn the_solver_knows_no_files_and_no_formats() {
    let manifest = fs::read_to_string(root().join("solver/Cargo.toml")).unwrap();
    let (mut section, mut found) = (String::new(), Vec::new());
    for line in manifest.lines().map(str::trim) {
        if line.starts_with('[') {
            section = line.to_string();
        }
        // `[dependencies]`, `[target.….dependencies]` and `[dependencies.name]` alike
        let is_dependency = section.contains("dependencies") && !section.contains("dev-");
        let name = if line.starts_with('[') {
            line.trim_matches(['[', ']']).rsplit('.').next().unwrap_or_default()
        } else {
            line.split(['.', '=', ' ']).next().unwrap_or_default()
        };
        if is_dependency && ["serde", "serde_json", "csv", "plotters"].contains(&name) {
            found.push(name.to_string());
        }
    }
    assert_none("the solver does no input and no output", found);
}

#[test]
fn no_text_names_a_machine() {
    let mut found = Vec::new();
    for path in files(&root()) {
        let Ok(text) = fs::read_to_string(&path) else { continue }; // not a text
        for (number, line) in text.lines().enumerate() {
            if MACHINE_PATHS.iter().any(|machine| line.contains(machine)) {
                found.push(format!("{}:{}", relative(&path), number + 1));
            }
        }
    }
    assert_none("a text that is committed holds no path of one machine", found);
}

/// What git tracks, or all files where it tracks nothing: in an archive of the sources.
fn tracked() -> Vec<String> {
    let git = Command::new("git").arg("-C").arg(root()).args(["ls-files", "-z"]).output();
    let of_git = git.ok().filter(|output| output.status.success() && !output.stdout.is_empty());
    of_git.map_or_else(
        || files(&root()).iter().map(|path| relative(path)).collect(),
        |output| {
            String::from_utf8_lossy(&output.stdout)
                .split_terminator('\0')
                .map(String::from)
                .collect()
        },
    )
}

/// A profile of 2.3 MB, with paths of the machine that made it, was tracked in the root by accident.
#[test]
fn no_output_of_a_tool_is_tracked_in_the_root() {
    let tracked = tracked();
    assert!(tracked.len() > 500, "only {} files are tracked", tracked.len());
    let is_strange = |path: &String| match path.split_once('/') {
        Some((folder, _)) => !ROOT_FOLDERS.contains(&folder),
        None => !ROOT_FILES.contains(&path.as_str()),
    };
    let strange = tracked.into_iter().filter(is_strange).collect();
    assert_none("a file in the root is a document, a licence or a tool's settings", strange);
}

#[test]
fn the_reader_of_code_is_not_fooled() {
    let source = r##"
fn short() -> char { '{' }
/* { /* nested { */ } */
fn texts<'a>(x: &'a str) {
    let _ = ("}", r#"} " }"#, '\'', b'{', "\"}"); // }
    let _: fn(i32) = |_| {};
}
fn taking(f: fn(i32)) {}
trait T {
    fn declared(&self, x: [u8; 3]);
    fn given(&self) -> [u8; 2] {
        [0; 2]
    }
}
#[cfg(test)]
mod tests {
    fn inside() {}
}
fn last() {
}
"##;
    let found: Vec<_> = functions(source);
    let names: Vec<_> = found.iter().map(|(name, _, lines)| (name.as_str(), *lines)).collect();
    let expected =
        [("short", 1), ("texts", 4), ("taking", 1), ("given", 3), ("inside", 1), ("last", 2)];
    assert_eq!(names, expected);
    let kept = without_tests(source).join("\n");
    assert!(kept.contains("fn last") && !kept.contains("inside"), "{kept}");
    let long = format!("fn long() {{\n{}}}\n", "    step();\n".repeat(80));
    assert_eq!(functions(&long), [("long".to_string(), 1, 82)]);
}
