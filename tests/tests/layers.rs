//! Imports go in one direction. The table states the imports between crates; inside a crate no two modules
//! may import each other, directly or indirectly.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::tidy::root;

/// A crate, its folder, and the crates of this project that it may know.
const LAYERS: [(&str, &str, &[&str]); 12] = [
    ("lanes", "solver/lanes", &[]),
    ("solver", "solver", &["lanes"]),
    ("lagrangian", "solver/lagrangian", &["lanes", "solver"]),
    ("base", "validation/base", &[]),
    ("report", "validation/report", &["base"]),
    ("maths", "validation/maths", &["solver", "lagrangian", "base"]),
    ("harness", "validation/harness", &["solver", "base", "report", "maths"]),
    ("exchange", "validation/exchange", &["solver", "base", "harness"]),
    ("schemes", "validation/schemes", &["solver", "lagrangian", "base", "maths", "harness"]),
    (
        "cases",
        "validation/cases",
        &["solver", "lagrangian", "base", "report", "maths", "harness", "schemes"],
    ),
    ("touchstone", "validation", &EVERY),
    ("tests", "tests", &EVERY),
];
const EVERY: [&str; 8] =
    ["solver", "base", "exchange", "report", "maths", "harness", "schemes", "cases"];

/// Names in the section `[dependencies]` of a manifest.
fn dependencies(manifest: &str) -> BTreeSet<String> {
    let section = manifest.split("\n[").find(|section| section.starts_with("dependencies]"));
    let lines = section.unwrap_or_default().lines().skip(1);
    let name = |line: &str| {
        let name = line.split(['.', ' ', '=']).next().unwrap_or_default();
        name.trim_start_matches("touchstone-").to_string()
    };
    lines.map(name).filter(|name| !name.is_empty() && !name.starts_with('#')).collect()
}

/// Edges that the table does not allow.
fn forbidden(dependencies_of: impl Fn(&str) -> BTreeSet<String>) -> Vec<String> {
    let mut found = Vec::new();
    for (name, folder, may_know) in LAYERS {
        for known in dependencies_of(folder) {
            let is_ours = LAYERS.iter().any(|(layer, ..)| *layer == known);
            if is_ours && !may_know.contains(&known.as_str()) {
                found.push(format!("{name} imports {known}"));
            }
        }
    }
    found
}

#[test]
fn crates_know_only_those_below_them() {
    let read = |folder: &str| {
        let text = fs::read_to_string(root().join(folder).join("Cargo.toml")).expect("a manifest");
        dependencies(&text)
    };
    assert_eq!(forbidden(read), Vec::<String>::new());
    assert!(read("validation/harness").contains("report"), "the manifests were read");
}

/// The test of the test: an edge in the wrong direction is found.
#[test]
fn an_edge_the_wrong_way_is_seen() {
    let wrong = |folder: &str| match folder {
        "validation/base" => {
            dependencies("[package]\n[dependencies]\ntouchstone-harness.workspace = true\n")
        }
        _ => BTreeSet::new(),
    };
    assert_eq!(forbidden(wrong), ["base imports harness"]);
}

/// Rust files below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries =
        fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("a file").path());
    let mut paths: Vec<PathBuf> = entries.collect();
    paths.sort();
    let below = |path: PathBuf| if path.is_dir() { files(&path) } else { vec![path] };
    let all = paths.into_iter().flat_map(below);
    all.filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

/// The source without comments and tests.
fn code(source: &str) -> String {
    let code = source.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let lines = code.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// First names of the paths that follow `crate::`, or `super::` in a file at the top, in or out of braces.
fn imported(code: &str, prefix: &str) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for rest in code.split(prefix).skip(1) {
        if let Some(group) = rest.strip_prefix('{') {
            let mut depth = 0;
            for item in group.split_inclusive([',', '{', '}']) {
                if depth == 0 {
                    names.insert(first_word(item.trim()));
                }
                match item.chars().last() {
                    Some('{') => depth += 1,
                    Some('}') => depth -= 1,
                    _ => {}
                }
                if depth < 0 {
                    break;
                }
            }
        } else {
            names.insert(first_word(rest));
        }
    }
    names.remove("");
    names
}

fn first_word(text: &str) -> String {
    text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// The modules at the top of a crate, and which of them each imports.
fn modules(folder: &Path) -> BTreeMap<String, BTreeSet<String>> {
    let top = |path: &Path| {
        let inside = path.strip_prefix(folder).expect("below the folder");
        let first = inside.components().next().expect("a name").as_os_str().to_string_lossy();
        first.trim_end_matches(".rs").to_string()
    };
    let mut edges: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for path in files(folder) {
        let (name, text) = (top(&path), code(&fs::read_to_string(&path).expect("a source")));
        let mut known = imported(&text, "crate::");
        if path.parent() == Some(folder) {
            known.extend(imported(&text, "super::"));
        }
        edges.entry(name).or_default().extend(known);
    }
    edges.retain(|name, _| !["lib", "main"].contains(&name.as_str()));
    let all: BTreeSet<String> = edges.keys().cloned().collect();
    for (name, known) in &mut edges {
        known.retain(|other| other != name && all.contains(other));
    }
    edges
}

/// The files of a folder of a crate, and which of them each imports by `super::`.
fn siblings(folder: &Path) -> BTreeMap<String, BTreeSet<String>> {
    let name = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let own = files(folder).into_iter().filter(|path| path.parent() == Some(folder));
    let edges = own.filter_map(|path| {
        let text = code(&fs::read_to_string(&path).expect("a source"));
        Some((name(&path)?, imported(&text, "super::")))
    });
    let mut edges: BTreeMap<String, BTreeSet<String>> =
        edges.filter(|(name, _)| name != "mod").collect();
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
            for known in edges.get(next).into_iter().flatten() {
                if seen.insert(known) {
                    open.push(known);
                }
            }
        }
        seen.contains(from)
    };
    edges.keys().filter(|name| reaches(name)).cloned().collect()
}

#[test]
fn modules_of_a_crate_form_no_circle() {
    let mut found = Vec::new();
    for (name, folder, _) in LAYERS.iter().filter(|(name, ..)| *name != "tests") {
        let of_crate = circles(&modules(&root().join(folder).join("src")));
        found.extend(of_crate.into_iter().map(|module| format!("{name}: {module}")));
        let source = root().join(folder).join("src");
        let folders: BTreeSet<PathBuf> =
            files(&source).iter().filter_map(|path| path.parent()).map(PathBuf::from).collect();
        for inside in folders.iter().filter(|inside| **inside != source) {
            let of_folder = circles(&siblings(inside)).into_iter();
            found.extend(of_folder.map(|file| format!("{}: {file}", inside.display())));
        }
    }
    assert_eq!(found, Vec::<String>::new());
}

/// A change of a case reaches no case of another family.
#[test]
fn families_of_cases_do_not_know_each_other() {
    let families = ["fluids", "waters", "solids", "lattice"];
    for family in families {
        let folder = root().join("validation/cases/src").join(family);
        let read = |path: PathBuf| code(&fs::read_to_string(path).expect("a source"));
        let known = files(&folder).into_iter().flat_map(|path| imported(&read(path), "crate::"));
        let others = known.filter(|name| families.contains(&&**name) && name != family);
        assert_eq!(others.collect::<Vec<_>>(), Vec::<String>::new(), "{family}");
    }
}

#[test]
fn a_circle_of_modules_is_seen() {
    let imports =
        imported("use crate::{\n    a::{B, C},\n    d,\n};\nlet x = crate::e::f();", "crate::");
    assert_eq!(imports.iter().map(String::as_str).collect::<Vec<_>>(), ["a", "d", "e"]);
    let edge = |from: &str, to: &[&str]| {
        (from.to_string(), to.iter().map(|name| name.to_string()).collect::<BTreeSet<_>>())
    };
    let edges = BTreeMap::from([
        edge("a", &["b"]),
        edge("b", &["c"]),
        edge("c", &["a"]),
        edge("d", &["a"]),
    ]);
    assert_eq!(circles(&edges), ["a", "b", "c"]);
}
