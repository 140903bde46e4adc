//! The commands that the documents tell their readers to type: each is valid, and names what there is.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use clap::{Parser, error::ErrorKind};
use harness::{
    case::{self, Case, Tier},
    plan,
};
use validation::cases;

use super::super::arguments::{Arguments, Command};

/// What stands for `touchstone` before it is installed.
const FROM_SOURCES: &str = "cargo run --release -- ";

/// The documents, from the root of the project.
fn documents() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let of = |folder: &str| fs::read_dir(root.join(folder)).expect(folder);
    let all = ["", "docs", "references", "reports", ".github/ISSUE_TEMPLATE"].map(of);
    let paths = all.into_iter().flatten().map(|entry| entry.expect("an entry").path());
    paths.filter(|path| path.extension().is_some_and(|extension| extension == "md")).collect()
}

/// Lines of blocks of code, and what is in backquotes, that call the program: without comment and pipe.
fn commands(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (index, part) in text.split("```").enumerate() {
        let pieces: Vec<&str> = match index % 2 {
            0 => part.split('`').skip(1).step_by(2).collect(),
            _ => part.lines().collect(),
        };
        let lines = pieces.iter().map(|piece| piece.split(['#', '>', '|']).next().unwrap_or(""));
        let called = lines.filter_map(|line| {
            let line = line
                .strip_prefix(FROM_SOURCES)
                .map(|rest| format!("touchstone {rest}"))
                .unwrap_or_else(|| line.to_string());
            line.starts_with("touchstone ").then(|| line.trim().to_string())
        });
        found.extend(called);
    }
    found
}

/// A name that the reader is to fill in.
fn is_placeholder(name: &str) -> bool {
    name.chars().all(|c| c.is_ascii_uppercase())
}

fn find(name: &str) -> Result<&'static dyn Case, String> {
    cases::find(name).map_err(|error| error.to_string())
}

/// Does the first of these variants have these settings, the first of several values each?
fn check_run(name: &str, variant: Option<&String>, set: &[String]) -> Result<(), String> {
    let case = find(name)?;
    let variant = variant.map_or(case.recommended().variant, String::as_str);
    let first = |set: &String| set.split(',').next().unwrap_or_default().to_string();
    let set: Vec<String> = set.iter().map(first).collect();
    case::spec(case, variant, &set).map(|_| ()).map_err(|error| error.to_string())
}

/// Names of the gates of both plans.
static GATES: LazyLock<Vec<String>> = LazyLock::new(|| {
    let of = |tier| cases::CASES.iter().flat_map(move |case| plan::of_case(*case, tier));
    let gates = [Tier::Quick, Tier::Full].into_iter().flat_map(of).flat_map(|run| run.gates);
    gates.map(|gate| gate.id).collect()
});

/// Does a gate of a plan begin with this name?
fn check_gate(name: &str) -> Result<(), String> {
    let found = GATES.iter().any(|gate| gate.starts_with(name));
    found.then_some(()).ok_or_else(|| format!("no gate begins with {name}"))
}

fn check(line: &str) -> Result<(), String> {
    let arguments = match Arguments::try_parse_from(line.split_whitespace()) {
        Err(error) if error.kind() == ErrorKind::DisplayHelp => return Ok(()),
        parsed => parsed.map_err(|error| error.to_string())?,
    };
    let all = |names: &[String]| names.iter().try_for_each(|name| find(name).map(|_| ()));
    match arguments.command {
        Command::Run(run) => match run.case {
            Some(name) if !is_placeholder(&name) => {
                let rows = run.rows.map(|rows| format!("rows={rows}"));
                let set: Vec<String> = run.set.into_iter().chain(rows).collect();
                check_run(&name, run.variant.as_ref(), &set)
            }
            _ => Ok(()),
        },
        Command::Plan(plan) => {
            let of = |name: &String| check_run(name, plan.variant.first(), &plan.set);
            plan.cases.iter().try_for_each(of)
        }
        Command::List(list) => {
            let named = list.case.filter(|name| !is_placeholder(name));
            named.map_or(Ok(()), |name| find(&name).map(|_| ()))
        }
        Command::Verify(verify) => all(&verify.of.cases),
        Command::Stability(stability) => all(&stability.cases),
        Command::Explain(explain) => explain.gate.map_or(Ok(()), |name| check_gate(&name)),
        _ => Ok(()),
    }
}

#[test]
fn commands_in_documents_are_valid() {
    let (mut wrong, mut count) = (Vec::new(), 0);
    for path in documents() {
        let text = fs::read_to_string(&path).expect("a text");
        for line in commands(&text) {
            count += 1;
            if let Err(reason) = check(&line) {
                wrong.push(format!("{}: {line}: {reason}", path.display()));
            }
        }
    }
    assert!(count > 60, "{count} commands");
    assert!(wrong.is_empty(), "a command in a document is valid:\n  {}", wrong.join("\n  "));
}

#[test]
fn a_command_that_is_wrong_is_seen() {
    let text = "Say `touchstone run couette`:\n```sh\ncargo run --release -- verify  # all\n```\n";
    assert_eq!(commands(text), ["touchstone run couette", "touchstone verify"]);
    for wrong in [
        "touchstone frobnicate",
        "touchstone run couette --set row=3",
        "touchstone run couette --variant none",
        "touchstone plan couette --set rows=1,2",
        "touchstone verify couete",
        "touchstone explain no.such.gate",
    ] {
        assert!(check(wrong).is_err(), "{wrong}");
    }
}
