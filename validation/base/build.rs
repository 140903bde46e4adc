//! Tells the library which compiler built it and for what, where what cannot be known is `unknown`, and packs
//! the references.

use std::process::Command;
use std::{env, io, path::Path};

mod pack;

fn main() -> io::Result<()> {
    set("RUSTC", env::var("RUSTC").ok().and_then(|rustc| output(&rustc, &["--version"])));
    for (name, variable) in [
        ("PROFILE", "PROFILE"),
        ("OPT_LEVEL", "OPT_LEVEL"),
        ("TARGET", "TARGET"),
        ("FEATURES", "CARGO_CFG_TARGET_FEATURE"),
    ] {
        set(name, env::var(variable).ok());
    }
    println!("cargo:rerun-if-changed=build.rs\ncargo:rerun-if-changed=pack.rs");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../references");
    let mut paths = Vec::new();
    for folder in pack::entries(&root)? {
        if folder.join("datapackage.json").exists() {
            paths.extend(pack::entries(&folder)?);
        }
    }
    paths.retain(|path| path.extension().is_some_and(|kind| kind == "csv" || kind == "json"));
    pack::write("references", &paths)
}

fn set(name: &str, value: Option<String>) {
    println!("cargo:rustc-env=TOUCHSTONE_{name}={}", value.as_deref().unwrap_or("unknown"));
}

/// What a command prints, if it is there and succeeds.
fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    // Only the first line: a second one would be a cargo instruction of its own.
    output.status.success().then(|| text.trim().lines().next().unwrap_or_default().to_string())
}
