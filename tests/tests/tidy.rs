//! Rules of style for the sources, as tests.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Columns that a line of Rust may have.
const COLUMNS: usize = 110;
/// Tracked files in the root: documents, licences and settings of tools.
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
const MACHINE_PATHS: &[&str] =
    &[concat!("/wo", "rk/"), concat!("/tm", "p/wt"), concat!("/ro", "ot/")];

/// The folder of the project.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All files below a folder, sorted, without git data, build outputs and ignored files.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{folder:?}: {error}"));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths {
        let name = path.file_name().unwrap().to_string_lossy();
        // Cargo puts this tag into every output folder.
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

/// Fails with the rule if anything breaks it.
#[track_caller]
pub fn assert_none(rule: &str, found: Vec<String>) {
    assert!(found.is_empty(), "{rule}:\n  {}", found.join("\n  "));
}

/// Profiling costs nothing unless it is requested: clocks are in the harness, which then watches the phases.
#[test]
fn the_solver_reads_no_clock() {
    let mut found = Vec::new();
    for (path, source) in sources(&["solver/src"]) {
        let code = source.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
        let clocks = code.lines().filter(|l| l.contains("Instant") || l.contains("time::"));
        found.extend(clocks.map(|line| format!("{path}: {}", line.trim())));
    }
    assert_none("no clock in the solver", found);
}

/// Crates without unsafe code forbid it. The solver denies it, but for the vector registers.
#[test]
fn one_file_of_the_solver_has_unsafe_code() {
    let of_registers = "solver/src/lane/registers.rs";
    let allow = |(path, source): (String, String)| source.contains("unsafe_code").then_some(path);
    let allowed: Vec<_> = sources(&["solver"]).into_iter().filter_map(allow).collect();
    assert_eq!(allowed, [of_registers]);
}

#[test]
fn lines_are_short() {
    let mut found = Vec::new();
    for (path, source) in sources(&["solver", "validation", "tests", "references"]) {
        for (number, line) in source.lines().enumerate() {
            let columns = line.chars().count();
            if columns > COLUMNS {
                found.push(format!("{path}:{}: {columns} columns", number + 1));
            }
        }
    }
    assert_none(&format!("a line has at most {COLUMNS} columns"), found);
}

/// A file that is not a module of the test program would not run, without any message.
#[test]
fn every_file_of_tests_is_run() {
    let mut found = Vec::new();
    // The others are programs of their own.
    for (folder, others) in [
        ("tests", &["main", "allocation"][..]),
        ("solver", &["main", "sharing", "symbols", "couette_only", "rings_only"]),
        ("validation", &["main"]),
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

/// Files tracked by git; all files in an archive of the sources, without git.
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
