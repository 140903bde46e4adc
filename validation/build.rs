//! Passes the commit of the build to the command, and digests of the sources that determine the results of
//! each family of cases. Never fails: unknown values are `unknown`.

use std::fs;
use std::path::{Path, PathBuf};

use hmac_sha256::Hash;

#[path = "base/tell.rs"]
mod tell;

use tell::{output, set};

/// Sources of every result.
const SHARED: [&str; 7] =
    ["../solver", "base", "maths", "harness", "schemes", "../references", "../Cargo.lock"];
/// Folders of cases; a result depends on the folder of its case and on the shared sources.
const FAMILIES: [&str; 4] = ["fluids", "waters", "solids", "lattice"];
const CASES: &str = "cases/src";

fn main() {
    let commit = git(&["rev-parse", "HEAD"]).filter(|commit| !commit.is_empty());
    // Without the optional lock git leaves its index alone, whose time we watch below.
    let changes = git(&["--no-optional-locks", "status", "--porcelain", "--untracked-files=no"]);
    let is_dirty = changes.map(|changes| if changes.is_empty() { "no" } else { "yes" });
    set("COMMIT", commit);
    set("DIRTY", is_dirty.map(String::from));
    set(
        "SOURCES",
        Some(
            FAMILIES
                .map(|family| format!("{family}={}", digest(&format!("{CASES}/{family}"))))
                .join(" "),
        ),
    );
    for watched in ["HEAD", "refs", "packed-refs", "index"] {
        if let Some(path) = git(&["rev-parse", "--git-path", watched])
            && Path::new(&path).exists()
        {
            println!("cargo:rerun-if-changed={path}");
        }
    }
    for watched in ["build.rs", "src", "Cargo.toml"].iter().chain(&SHARED).chain(&[CASES]) {
        println!("cargo:rerun-if-changed={watched}");
    }
}

/// SHA-256 of compiler, profile and sources, 16 hexadecimal digits.
fn digest(family: &str) -> String {
    let mut hash = Hash::new();
    for variable in ["PROFILE", "OPT_LEVEL", "TARGET", "CARGO_CFG_TARGET_FEATURE"] {
        hash.update(std::env::var(variable).unwrap_or_default());
    }
    let rustc = std::env::var("RUSTC").unwrap_or_default();
    hash.update(output(&rustc, &["--version"]).unwrap_or_default());
    for place in SHARED.iter().chain([&family]) {
        for path in files(Path::new(place)) {
            hash.update(path.to_string_lossy().as_bytes());
            hash.update(fs::read(&path).unwrap_or_default());
        }
    }
    hash.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}

/// The files below a place that are compiled or read, sorted.
fn files(place: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(place) else { return vec![place.to_path_buf()] };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    let is_test = |path: &Path| path.ends_with("tests") || path.ends_with("examples");
    paths.into_iter().filter(|path| !is_test(path)).flat_map(|path| files(&path)).collect()
}

fn git(arguments: &[&str]) -> Option<String> {
    output("git", arguments)
}
