//! Faults that users have met, each as a script in `cases`: `# exit:` states its exit code (0 without one),
//! `# says:` a regular expression that its output must match, `# never:` one that it must not match.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Mutex;
use std::thread;

const CASES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/cases");

/// The values of a header of a script.
fn headers<'a>(script: &'a str, name: &str) -> Vec<&'a str> {
    script.lines().filter_map(|line| line.strip_prefix(&format!("# {name}: "))).collect()
}

/// Does the output have this extended regular expression, by grep?
fn has(output: &Path, expression: &str) -> bool {
    Command::new("grep").args(["-qE", "--", expression]).arg(output).status().unwrap().success()
}

/// Why the script did not end as it states.
fn flaws(script: &Path) -> Vec<String> {
    let text = fs::read_to_string(script).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let program = Path::new(env!("CARGO_BIN_EXE_touchstone")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let output = folder.path().join("output");
    let both = fs::File::create(&output).unwrap();
    let status = Command::new("sh")
        .args(["-c", r#". "$0/lib.sh"; . "$1""#, CASES])
        .arg(script)
        .current_dir(folder.path())
        .env("PATH", path)
        .env("CONTRIB", concat!(env!("CARGO_MANIFEST_DIR"), "/contrib"))
        .stdin(std::process::Stdio::null())
        .stdout(both.try_clone().unwrap())
        .stderr(both)
        .status()
        .unwrap();
    let expected = headers(&text, "exit").first().map_or(0, |code| code.parse().unwrap());
    let mut flaws = Vec::new();
    if status.code() != Some(expected) {
        flaws.push(format!("it ends with {status}; expected {expected}"));
    }
    let says = headers(&text, "says").into_iter().filter(|words| !has(&output, words));
    flaws.extend(says.map(|words| format!("it does not say {words:?}")));
    let never = headers(&text, "never").into_iter().filter(|words| has(&output, words));
    flaws.extend(never.map(|words| format!("it says {words:?}")));
    if !flaws.is_empty() {
        flaws.push(
            String::from_utf8_lossy(&fs::read(&output).unwrap()).chars().take(3000).collect(),
        );
    }
    flaws
}

/// All scripts, two at a time; `CASE=name` runs one.
#[test]
fn every_case_ends_as_it_states() {
    let only = std::env::var("CASE").unwrap_or_default();
    let scripts = fs::read_dir(CASES).unwrap().flatten().map(|entry| entry.path());
    let is_case = |path: &std::path::PathBuf| {
        let name = path.file_stem().unwrap().to_string_lossy();
        name != "lib" && (only.is_empty() || name == only)
    };
    let queue = Mutex::new(scripts.filter(is_case).collect::<Vec<_>>());
    let failed = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let Some(script) = queue.lock().unwrap().pop() else { return };
                    let flaws = flaws(&script);
                    if !flaws.is_empty() {
                        let name = script.file_name().unwrap().to_string_lossy().into_owned();
                        failed.lock().unwrap().push(format!("{name}: {}", flaws.join("\n  ")));
                    }
                }
            });
        }
    });
    let failed = failed.into_inner().unwrap();
    assert!(failed.is_empty(), "{} failed\n{}", failed.len(), failed.join("\n\n"));
}
