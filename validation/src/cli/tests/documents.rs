//! Commands in the text of documents, and in blocks that `validation/tests/pages.rs` does not run: each is
//! valid, and names what there is.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use clap::{Parser, error::ErrorKind};
use rayon::prelude::*;
use touchstone_base::{record::Status, spec::RunSpec};
use touchstone_harness::{
    case::{self, Case, Planned, Tier},
    make::{BatchOptions, Job},
    plan,
    runner::Context,
};

use super::super::arguments::{Arguments, Command};

/// Replacement for `touchstone` before installation.
const FROM_SOURCES: &str = "cargo run --release -- ";

/// Path and text of each document.
fn documents() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let of = |folder: &str| fs::read_dir(root.join(folder)).expect(folder);
    let all = ["", "docs", "references", "reports", ".github/ISSUE_TEMPLATE"].map(of);
    let paths = all.into_iter().flatten().map(|entry| entry.expect("an entry").path());
    let pages = paths.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    pages.map(|path| (path.clone(), fs::read_to_string(path).expect("a text"))).collect()
}

/// A document without the blocks that are run.
fn without_run(text: &str) -> String {
    let (mut kept, mut before) = (String::new(), "");
    for (index, part) in text.split("```").enumerate() {
        let last = before.trim_end().lines().last().unwrap_or_default();
        let is_run = (part.starts_with("sh\n") || part.starts_with("console\n"))
            && !last.starts_with("<!-- not run: ");
        kept += if index % 2 == 1 && is_run { "sh\n" } else { part };
        kept += "```";
        before = part;
    }
    kept
}

/// Lines of code blocks, and text in backquotes, that call the program: without comment and pipe.
fn commands(text: &str) -> Vec<String> {
    commented(text).into_iter().map(|(line, _)| line).collect()
}

/// Commands, each with its comment.
fn commented(text: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for (index, part) in text.split("```").enumerate() {
        let pieces: Vec<&str> = match index % 2 {
            0 => part.split('`').skip(1).step_by(2).collect(),
            _ => part.lines().collect(),
        };
        let lines = pieces.iter().map(|piece| {
            let comment = piece.split_once('#').map_or("", |(_, comment)| comment);
            (piece.split(['#', '>', '|']).next().unwrap_or(""), comment.to_string())
        });
        let called = lines.filter_map(|(line, comment)| {
            let line = line.strip_prefix("$ ").unwrap_or(line);
            let line = line
                .strip_prefix(FROM_SOURCES)
                .map(|rest| format!("touchstone {rest}"))
                .unwrap_or_else(|| line.to_string());
            line.starts_with("touchstone ").then(|| (line.trim().to_string(), comment))
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
    touchstone_cases::find(name).map_err(|error| error.to_string())
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
    let of = |tier| touchstone_cases::CASES.iter().flat_map(move |case| plan::of_case(*case, tier));
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
    for (path, text) in documents() {
        for line in commands(&without_run(&text)) {
            count += 1;
            if let Err(reason) = check(&line) {
                wrong.push(format!("{}: {line}: {reason}", path.display()));
            }
        }
    }
    assert!(count > 60, "{count} commands");
    assert!(wrong.is_empty(), "a command in a document is valid:\n  {}", wrong.join("\n  "));
}

/// Processor time of a run that a test of documents can make \[s\].
const SHORT: f64 = 2.0;

/// The run of a case that a command makes, if it makes one.
fn run_of(line: &str) -> Option<RunSpec> {
    let arguments = Arguments::try_parse_from(line.split_whitespace()).ok()?;
    let Command::Run(run) = arguments.command else { return None };
    let case = touchstone_cases::find(&run.case.filter(|name| !is_placeholder(name))?).ok()?;
    let variant = run.variant.unwrap_or_else(|| case.recommended().variant.to_string());
    let set: Vec<String> =
        run.set.into_iter().chain(run.rows.map(|rows| format!("rows={rows}"))).collect();
    let spec = case::spec(case, &variant, &set).ok()?;
    Some(if run.allow_unstable { spec.allow_unstable() } else { spec })
}

/// `limits.md` must not state that a completing run diverges. A comment states which commands diverge; all
/// others must complete. Long ones are left out.
#[test]
fn short_runs_in_documents_end_as_documents_say() {
    let texts = documents().into_iter().map(|(_, text)| without_run(&text));
    let mut jobs: Vec<(Job, bool, String)> = Vec::new();
    for (line, comment) in texts.flat_map(|text| commented(&text)) {
        let Some(spec) = run_of(&line) else { continue };
        let case = touchstone_cases::find(&spec.case).expect("a case");
        let job = Job { case, planned: Planned::new(spec) };
        jobs.push((job, comment.contains("diverges"), line));
    }
    let mut timed: Vec<Job> = jobs.iter().map(|(job, ..)| job.clone()).collect();
    touchstone_harness::estimate::estimate(
        &mut timed,
        &BatchOptions::new(Tier::Quick, &|_| String::new()),
    );
    let short = jobs.into_iter().zip(timed).filter(|(_, timed)| timed.planned.seconds <= SHORT);
    let short: Vec<(Job, bool, String)> = short.map(|(job, _)| job).collect();
    let wrong = short.par_iter().filter_map(|(job, diverges, line)| {
        let record = case::record_of(job.case, &job.planned.spec, &Context::default());
        let ended = record.map(|record| record.status).expect(line);
        let is_right = match diverges {
            true => matches!(ended, Status::Diverged { .. }),
            false => ended == Status::Completed,
        };
        (!is_right).then(|| format!("{line}: {ended}"))
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(short.len() >= 5, "{} short runs", short.len());
    assert!(wrong.is_empty(), "a run ends as its document says:\n  {}", wrong.join("\n  "));
}

/// After `run couette`, which is of `modern`, documents explained the gates of `plain`: in blocks of code,
/// which a reader types one after another.
#[test]
fn gates_that_documents_explain_are_of_variants_that_they_run() {
    let mut wrong = Vec::new();
    for (path, text) in documents() {
        let mut run: Vec<(String, String)> = Vec::new();
        let blocks = text.split("```").skip(1).step_by(2).map(|block| format!("```{block}```"));
        for line in commands(&blocks.collect::<String>()) {
            run.extend(run_of(&line).map(|spec| (spec.case, spec.variant)));
            let gate = line.strip_prefix("touchstone explain ").unwrap_or_default();
            let Some((name, rest)) = gate.split_once('.') else { continue };
            let Ok(case) = touchstone_cases::find(name) else { continue };
            let variant = rest.split('.').next().unwrap_or_default();
            let is_variant = case.variants().iter().any(|of| of.name == variant);
            let mut of_case = run.iter().filter(|(of, _)| of == name).peekable();
            if is_variant && of_case.peek().is_some() && !of_case.any(|(_, of)| of == variant) {
                wrong.push(format!("{}: {line}", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "a document explains what it runs:\n  {}", wrong.join("\n  "));
}

#[test]
fn a_command_that_is_wrong_is_seen() {
    let text = "Say `touchstone run couette`:\n```sh\ncargo run --release -- verify  # all\n```\n";
    assert_eq!(commands(text), ["touchstone run couette", "touchstone verify"]);
    assert_eq!(commented(text)[1].1, " all");
    assert_eq!(commands(&without_run(text)), ["touchstone run couette"]);
    let marked = text.replace("```sh", "<!-- not run: slow -->\n```sh");
    assert_eq!(commands(&without_run(&marked)), commands(text));
    let spec = run_of("touchstone run couette --rows 30").expect("a run");
    assert_eq!((&*spec.variant, spec.settings["rows"].as_u64()), ("consistent", Some(30)));
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
