//! Tells the command which commit it was built from. Never fails: what cannot be known is `unknown`.

use std::process::Command;

fn main() {
    let commit = git(&["rev-parse", "HEAD"]).filter(|commit| !commit.is_empty());
    // Without the optional lock git leaves its index alone, whose time we watch below.
    let changes = git(&["--no-optional-locks", "status", "--porcelain", "--untracked-files=no"]);
    let is_dirty = changes.map(|changes| if changes.is_empty() { "no" } else { "yes" });
    set("COMMIT", commit);
    set("DIRTY", is_dirty.map(String::from));
    for watched in ["HEAD", "refs", "packed-refs", "index"] {
        if let Some(path) = git(&["rev-parse", "--git-path", watched])
            && std::path::Path::new(&path).exists()
        {
            println!("cargo:rerun-if-changed={path}");
        }
    }
    for watched in ["build.rs", "src", "Cargo.toml"] {
        println!("cargo:rerun-if-changed={watched}");
    }
}

fn set(name: &str, value: Option<String>) {
    println!("cargo:rustc-env=TOUCHSTONE_{name}={}", value.as_deref().unwrap_or("unknown"));
}

fn git(arguments: &[&str]) -> Option<String> {
    output("git", arguments)
}

/// What a command prints, if it is there and succeeds.
fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    // Only the first line: a second one would be a cargo instruction of its own.
    output.status.success().then(|| text.trim().lines().next().unwrap_or_default().to_string())
}
