//! Tells the library which compiler built it and for what. Never fails: what cannot be known is `unknown`.

use std::env;
use std::process::Command;

fn main() {
    set("RUSTC", env::var("RUSTC").ok().and_then(|rustc| output(&rustc, &["--version"])));
    for (name, variable) in [
        ("PROFILE", "PROFILE"),
        ("OPT_LEVEL", "OPT_LEVEL"),
        ("TARGET", "TARGET"),
        ("FEATURES", "CARGO_CFG_TARGET_FEATURE"),
    ] {
        set(name, env::var(variable).ok());
    }
    println!("cargo:rerun-if-changed=build.rs");
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
