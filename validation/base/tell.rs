//! For build scripts: instructions to the compiler, `unknown` for unknown values.

use std::process::Command;

/// Sets an environment variable of the crate.
pub fn set(name: &str, value: Option<String>) {
    println!("cargo:rustc-env=TOUCHSTONE_{name}={}", value.as_deref().unwrap_or("unknown"));
}

/// The output of a command, if it exists and succeeds.
pub fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    // Only the first line: a second one would be a separate cargo instruction.
    output.status.success().then(|| text.trim().lines().next().unwrap_or_default().to_string())
}
