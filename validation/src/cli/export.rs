//! Verdicts for other programs: JUnit XML and Markdown.

use base::{
    files::write_atomically,
    gate::{Judgement, Verdict},
    text::escaped,
};
use harness::suite::Suite;

use super::{Failure, arguments};

/// Refuses one file for both, of which only the later one would be left.
pub fn check(export: &arguments::Export) -> Result<(), Failure> {
    match (&export.junit, &export.markdown) {
        (Some(junit), Some(markdown)) if junit == markdown => Err(Failure::usage(format!(
            "--junit and --markdown name the same file, {}; name two",
            junit.display()
        ))),
        _ => Ok(()),
    }
}

/// Writes the files that were asked for; if the first one cannot be written, the other one is all the same.
pub fn write(suite: &Suite, export: &arguments::Export) -> Result<(), Failure> {
    let mut written = Ok(());
    for (path, text) in [
        (&export.junit, junit as fn(&Suite) -> String),
        (&export.markdown, markdown as fn(&Suite) -> String),
    ] {
        if let Some(path) = path {
            written = written.and(write_atomically(path, text(suite).as_bytes()));
        }
    }
    Ok(written?)
}

/// The number that was judged, for people.
pub fn value(judgement: &Judgement) -> String {
    judgement.value.map_or("not measured".into(), |value| report::sig(value, 5))
}

/// A test case a gate, by case. Failing gates are failures; a limitation and an expected failure are
/// skipped, with the verdict as the message.
fn junit(suite: &Suite) -> String {
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n");
    for results in &suite.cases {
        let runs = results.runs.all.iter().flat_map(|run| &run.judged);
        let all: Vec<_> = runs.chain(results.studies.iter().flat_map(|s| &s.judged)).collect();
        let failed = all.iter().filter(|j| j.judgement.verdict.is_failure()).count();
        let passed = all.iter().filter(|j| j.judgement.verdict == Verdict::Pass).count();
        let (name, skipped) = (escaped(results.case.name()), all.len() - failed - passed);
        text += &format!(
            "  <testsuite name=\"{name}\" tests=\"{}\" failures=\"{failed}\" skipped=\"{skipped}\">\n",
            all.len()
        );
        for judged in all {
            let (gate, judgement) = (&judged.gate, &judged.judgement);
            let message = format!("{} {}; {}", value(judgement), gate.bounds(), judged.words());
            let body = match judgement.verdict {
                Verdict::Pass => String::new(),
                Verdict::Fail => format!(
                    "<failure message=\"{}\">{}</failure>",
                    escaped(&message),
                    escaped(&gate.because)
                ),
                _ => format!("<skipped message=\"{}\"/>", escaped(&message)),
            };
            let id = escaped(&gate.id);
            text +=
                &format!("    <testcase classname=\"{name}\" name=\"{id}\">{body}</testcase>\n");
        }
        text += "  </testsuite>\n";
    }
    text + "</testsuites>\n"
}

/// Counts, then a table of every gate that did not simply pass.
fn markdown(suite: &Suite) -> String {
    let mut text = format!("# Verdicts\n\n{}\n\n", suite.counts().headline());
    text += "| verdict | gate | value | bound |\n|---|---|---|---|\n";
    let mut rows: Vec<_> =
        suite.judged().filter(|j| j.judgement.verdict != Verdict::Pass).collect();
    rows.sort_by_key(|j| !j.judgement.verdict.is_failure());
    for judged in rows {
        let verdict = judged.words().replace('|', "\\|");
        let (id, bound) = (&judged.gate.id, judged.gate.bounds());
        text += &format!("| {verdict} | `{id}` | {} | {bound} |\n", value(&judged.judgement));
    }
    text
}
