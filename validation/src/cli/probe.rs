//! `probe`: plain questions for any code, each with one short problem.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::Deserialize;
use serde_json::json;
use touchstone_base::{
    files::{self, OutputFolder},
    gate,
    text::short,
};
use touchstone_exchange::probe::{self, Answer, Code, Question, Verdict, code};

use super::{
    Exit, Failure, Outcome, Session, arguments,
    exchange::renamed,
    junit::{self, Tested},
    output,
};

/// Name of the document in the folder of a code.
const DOCUMENT: &str = "probe.toml";
/// A complete document.
const EXAMPLE: &str = r#"command = ["python", "run.py"]"#;
/// Largest document \[bytes\].
const MOST_BYTES: u64 = 1 << 16;

/// The document of a code.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    /// the program and its first arguments; it is called in the folder of the document
    command: Vec<String>,
}

pub fn probe(arguments: &arguments::Probe, session: &Session) -> Outcome {
    let questions = chosen(&arguments.only)?;
    if arguments.list {
        output::answer(arguments.json, || list_json(&questions), || list(&questions))?;
        return Ok(Exit::Pass);
    }
    let code = code_of(arguments, session)?;
    let folder = Folder::of(arguments.keep.as_deref())?;
    let (started, mut number) = (Instant::now(), 0);
    let mut stopped = Ok(());
    let solve = |pose: &probe::Pose| {
        if stopped.is_ok() {
            stopped = session.go_on("no verdict is printed");
        }
        if stopped.is_err() {
            return probe::Ran::Failed("not called".into());
        }
        number += 1;
        let ran = code.solve(session.cases, pose, &code::folder_of(&folder.path, number, pose));
        if let probe::Ran::NotCalled(why) = &ran {
            stopped = Err(Failure::usage(why));
        }
        ran
    };
    let print_answer = |question: &Question, answer: &Answer| {
        if !arguments.json && !session.is_interrupted() {
            output::say(&format!("{}: {}", question.id, answer.verdict().words()));
        }
    };
    let answers = probe::ask(&questions, solve, print_answer);
    stopped.and_then(|()| session.go_on("no verdict is printed"))?;
    let took = started.elapsed().as_secs_f64();
    let junit = arguments
        .junit
        .as_deref()
        .map(|path| files::write_atomically(path, junit(&questions, &answers).as_bytes()));
    let all = || questions.iter().zip(&answers);
    output::answer(
        arguments.json,
        || json!(all().map(|(question, answer)| answer.to_json(question)).collect::<Vec<_>>()),
        || table(&questions, &answers),
    )?;
    let count = |of| answers.iter().filter(|answer| answer.verdict() == of).count();
    let [pass, fail, skipped] = [Verdict::Pass, Verdict::Fail, Verdict::NotApplicable].map(count);
    output::say(&format!(
        "{pass} pass, {fail} fail, {skipped} not applicable; {number} problems in {}",
        touchstone_report::seconds(took)
    ));
    junit.transpose()?;
    Ok(match (pass, fail) {
        (0, 0) => Exit::Usage,
        (_, 0) => Exit::Pass,
        _ => Exit::GateFailed,
    })
}

/// The named questions, or all.
fn chosen(only: &[String]) -> Result<Vec<Question>, Failure> {
    let mut all = probe::questions();
    let ids: Vec<&str> = all.iter().map(|question| question.id).collect();
    if let Some(other) = only.iter().find(|name| !ids.contains(&name.as_str())) {
        let words = format!("--only {}: there are {}", short(other), ids.join(", "));
        return Err(Failure::usage(words));
    }
    all.retain(|question| only.is_empty() || only.iter().any(|name| name == question.id));
    Ok(all)
}

/// The code under test.
fn code_of(arguments: &arguments::Probe, session: &Session) -> Result<Code, Failure> {
    let arguments::Probe { command, code, variant, mutate, .. } = arguments;
    let mut command = command.clone();
    let mut folder = None;
    if let Some(path) = code {
        let file = path.join(DOCUMENT);
        command = command_in(&file)
            .map_err(|why| Failure::usage(format!("{file:?}{why}; expected {EXAMPLE}")))?;
        folder = Some(path.clone());
    }
    if variant.is_some() {
        command = vec![env::current_exe()?.into(), "solve".into()];
        let mutate = mutate.iter().map(|of| format!("--mutate={}={}", of.of, of.factor));
        command.extend(mutate.map(OsString::from));
    }
    Ok(Code {
        command,
        folder,
        timeout: Duration::from_secs(arguments.timeout.into()),
        walls_of_particles: arguments.wall_particles,
        map: renamed(&arguments.map)?,
        interrupt: session.interrupt,
        variant: variant.clone(),
    })
}

/// The command in the document of a code; otherwise where the document is wrong, and why.
fn command_in(file: &Path) -> Result<Vec<OsString>, String> {
    let text =
        files::read_text(file, MOST_BYTES).map_err(|why| format!(" cannot be read: {why}"))?;
    let Document { command } = basic_toml::from_str(&text).map_err(|why| format!(": {why}"))?;
    match command.first().is_none_or(String::is_empty) {
        true => Err(" names no command".into()),
        false => Ok(command.into_iter().map(OsString::from).collect()),
    }
}

/// The folder of all problems.
struct Folder {
    path: PathBuf,
    is_kept: bool,
}

impl Folder {
    fn of(keep: Option<&Path>) -> Result<Self, Failure> {
        let (path, is_kept) = match keep {
            Some(path) => (path.to_path_buf(), true),
            None => {
                (env::temp_dir().join(format!("touchstone-probe-{}", std::process::id())), false)
            }
        };
        if path.exists() {
            return Err(Failure::usage(format!("the folder {path:?} exists; expected a new one")));
        }
        OutputFolder::create(&path)?;
        Ok(Self { path: std::path::absolute(path)?, is_kept })
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if !self.is_kept {
            drop(std::fs::remove_dir_all(&self.path));
        }
    }
}

/// Questions, answers and verdicts, one screen.
fn table(questions: &[Question], answers: &[Answer]) -> String {
    let mut text = String::new();
    for (question, answer) in questions.iter().zip(answers) {
        let verdict = answer.verdict();
        let painted = match verdict {
            Verdict::Fail => output::painted(gate::Verdict::Fail, verdict.words()),
            _ => verdict.words().into(),
        };
        text += &format!("{painted}  {}\n", question.text);
        text += &output::wrap(&answer.words(), "    ");
        answer.failures().iter().for_each(|why| text += &output::wrap(why, "    ! "));
    }
    text
}

/// The questions, and the errors that each of them finds.
fn list(questions: &[Question]) -> String {
    let rows = questions.iter().map(|of| vec![of.id.into(), of.text.into(), of.finds.join(", ")]);
    output::table(&["name", "question", "errors that it finds"], rows)
}

fn list_json(questions: &[Question]) -> serde_json::Value {
    let one = |of: &Question| json!({ "id": of.id, "question": of.text, "finds": of.finds });
    questions.iter().map(one).collect()
}

/// A test case a question.
fn junit(questions: &[Question], answers: &[Answer]) -> String {
    let test = |(question, answer): (&Question, &Answer)| {
        let test = match answer.verdict() {
            Verdict::Pass => Tested::Pass,
            Verdict::Fail => {
                Tested::Fail { message: answer.words(), why: answer.failures().join("\n") }
            }
            Verdict::NotApplicable => Tested::Skipped(answer.words()),
        };
        (question.id, test)
    };
    let tests: Vec<_> = questions.iter().zip(answers).map(test).collect();
    junit::document([junit::suite("probe", &tests)])
}
