//! Imports go one way. Cargo refuses circles of crates, and imports that a manifest does not name; the table
//! says what a manifest may name. Modules of a crate form no circle either.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::tidy::{assert_none, root};

/// A crate below the harness, and what it may know of the crates of this project.
const MAY_KNOW: [(&str, &[&str]); 5] = [
    ("touchstone-solver", &[]),
    ("touchstone-base", &[]),
    ("touchstone-report", &["touchstone-base"]),
    ("touchstone-maths", &["touchstone-solver", "touchstone-base"]),
    (
        "touchstone-harness",
        &["touchstone-solver", "touchstone-base", "touchstone-report", "touchstone-maths"],
    ),
];
/// Folders of all crates but the tests.
const CRATES: [&str; 9] = [
    "solver",
    "validation/base",
    "validation/report",
    "validation/maths",
    "validation/harness",
    "validation/exchange",
    "validation/schemes",
    "validation/cases",
    "validation",
];
/// Libraries of files and formats, which the solver does without.
const FORMATS: [&str; 4] = ["serde", "serde_json", "csv", "plotters"];

#[test]
fn crates_know_only_those_below_them() {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.current_dir(root()).args(["metadata", "--no-deps", "--offline", "--format-version", "1"]);
    let metadata = cargo.output().expect("cargo").stdout;
    let metadata: Value = serde_json::from_slice(&metadata).expect("metadata");
    let list = |of: &Value| of.as_array().expect("a list").clone();
    let (mut found, mut count) = (Vec::new(), 0);
    for package in list(&metadata["packages"]) {
        let name = package["name"].as_str().expect("a name");
        let Some((_, may_know)) = MAY_KNOW.iter().find(|(of, _)| *of == name) else { continue };
        let dependencies = list(&package["dependencies"]).into_iter();
        for of in dependencies.filter(|of| of["kind"] != "dev").map(|of| of["name"].clone()) {
            let of = of.as_str().expect("a name");
            let is_format = name == "touchstone-solver" && FORMATS.contains(&of);
            if is_format || of.starts_with("touchstone-") && !may_know.contains(&of) {
                found.push(format!("{name} imports {of}"));
            }
            count += 1;
        }
    }
    assert!(count > 20, "only {count} dependencies were read");
    assert_none("a crate knows those below it alone, and the solver no files", found);
}

/// Rust files below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("a file").path())
        .collect();
    paths.sort();
    let below = |path: PathBuf| if path.is_dir() { files(&path) } else { vec![path] };
    let all = paths.into_iter().flat_map(below);
    all.filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

/// The source without comments and without what follows its tests.
fn code(path: &Path) -> String {
    let source = fs::read_to_string(path).expect("a source");
    let code = source.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let lines = code.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// First names of the paths that follow a prefix such as `crate::`, in or out of braces.
fn imported(code: &str, prefix: &str) -> BTreeSet<String> {
    let word = |text: &str| -> String {
        text.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
    };
    let mut names = BTreeSet::new();
    for rest in code.split(prefix).skip(1) {
        let Some(group) = rest.strip_prefix('{') else {
            names.insert(word(rest));
            continue;
        };
        let mut depth = 0;
        for item in group.split_inclusive([',', '{', '}']) {
            names.extend((depth == 0).then(|| word(item)));
            depth += i32::from(item.ends_with('{')) - i32::from(item.ends_with('}'));
            if depth < 0 {
                break;
            }
        }
    }
    names
}

/// The modules of a folder of sources, and which of them each imports: by `crate::` at the top of a crate,
/// by `super::` in the files of the folder itself.
fn edges(folder: &Path, is_top: bool) -> BTreeMap<String, BTreeSet<String>> {
    let mut edges: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for path in files(folder) {
        let inside = path.strip_prefix(folder).expect("below the folder");
        let first = inside.components().next().expect("a name").as_os_str().to_string_lossy();
        let known = edges.entry(first.trim_end_matches(".rs").to_string()).or_default();
        let text = code(&path);
        known.extend(if is_top { imported(&text, "crate::") } else { BTreeSet::new() });
        let is_own = path.parent() == Some(folder);
        known.extend(if is_own { imported(&text, "super::") } else { BTreeSet::new() });
    }
    edges.retain(|name, _| !["lib", "main", "mod"].contains(&name.as_str()));
    let all: BTreeSet<String> = edges.keys().cloned().collect();
    for (name, known) in &mut edges {
        known.retain(|other| other != name && all.contains(other));
    }
    edges
}

/// Modules that know themselves by way of others.
fn circles(edges: &BTreeMap<String, BTreeSet<String>>) -> Vec<String> {
    let reaches = |from: &String| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(next) = open.pop() {
            open.extend(edges.get(next).into_iter().flatten().filter(|known| seen.insert(*known)));
        }
        seen.contains(from)
    };
    edges.keys().filter(|name| reaches(name)).cloned().collect()
}

#[test]
fn modules_of_a_crate_form_no_circle() {
    let mut found = Vec::new();
    for folder in CRATES {
        let source = root().join(folder).join("src");
        let folders: BTreeSet<PathBuf> =
            files(&source).iter().filter_map(|path| path.parent()).map(PathBuf::from).collect();
        assert!(folders.contains(&source), "{folder}");
        for inside in folders {
            let circles = circles(&edges(&inside, inside == source)).into_iter();
            found.extend(circles.map(|module| format!("{}: {module}", inside.display())));
        }
    }
    assert_none("modules form no circle", found);
}

/// A change of a case reaches no case of another family.
#[test]
fn families_of_cases_do_not_know_each_other() {
    let families = ["fluids", "waters", "solids", "lattice"];
    let edges = edges(&root().join("validation/cases/src"), true);
    for family in families {
        let others = edges[family].iter().filter(|name| families.contains(&name.as_str()));
        assert_none(family, others.cloned().collect());
    }
}

#[test]
fn a_circle_of_modules_is_seen() {
    let text = "use crate::{\n    a::{B, C},\n    d,\n};\nlet x = crate::e::f();";
    assert_eq!(Vec::from_iter(imported(text, "crate::")), ["", "a", "d", "e"]);
    let edge = |from: &str, to: &str| (from.to_string(), BTreeSet::from([to.to_string()]));
    let edges = BTreeMap::from([edge("a", "b"), edge("b", "c"), edge("c", "a"), edge("d", "a")]);
    assert_eq!(circles(&edges), ["a", "b", "c"]);
}
