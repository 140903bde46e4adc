//! Judgements as tables, as JSON that `explain` reads back, and for other programs as JUnit XML.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::Path;

use base::files::{self, write_atomically};
use base::gate::{Judgement, Verdict};
use base::record;
use base::text::escaped;
use harness::case::{self, Case, Tier};
use harness::notes::Notes;
use harness::runs::{Judged, JudgedRun};
use harness::study::Study;
use harness::suite::{JudgedOf, Suite};
use serde::{Deserialize, Serialize};

use super::comparisons::{self, ComparisonVerdict};
use super::{Failure, output};

/// Judgements as a table: the worst come last, next to the prompt. Reasons of limitations are notes.
pub fn table<'a>(all: impl IntoIterator<Item = &'a Judged>) -> String {
    table_of(all.into_iter().collect())
}

fn table_of<'a>(mut judged: Vec<&'a Judged>) -> String {
    judged.sort_by_key(|judged| judged.judgement.verdict);
    let mut notes = Notes::default();
    let mut words = |judged: &'a Judged| match judged.limitation() {
        Some(reason) => format!("known limitation [{}]", notes.number(reason)),
        None => judged.words(),
    };
    let number = |number: Option<f64>| number.map_or("-".into(), |number| report::sig(number, 4));
    let row = |judged: &'a Judged| {
        let Judged { gate, judgement, .. } = judged;
        vec![
            words(judged),
            gate.id.clone(),
            number(judgement.value),
            gate.bounds(),
            number(judgement.margin),
        ]
    };
    let heads = ["verdict", "gate", "value", "bound", "margin"];
    let mut text = output::table(&heads, judged.into_iter().map(row));
    for (k, reason) in notes.all() {
        text += &output::hanging(&format!("[{k}]"), 5, reason);
    }
    text
}

/// The table of those that did not pass, or of all, and an empty line; nothing if there are none.
pub fn shown<'a>(judged: impl IntoIterator<Item = &'a Judged>, all: bool) -> String {
    let judged =
        judged.into_iter().filter(|judged| all || judged.judgement.verdict != Verdict::Pass);
    let judged: Vec<&Judged> = judged.collect();
    if judged.is_empty() { String::new() } else { table_of(judged) + "\n" }
}

/// Name of the file of the verdicts in the folder of a report.
pub const VERDICTS: &str = "verdicts.json";

/// More than this are no verdicts \[bytes\].
const MOST_BYTES: u64 = 1 << 28;

/// The text of the verdicts of a report, if it has them.
///
/// # Errors
/// If they are there and cannot be read: a report without verdicts is another thing.
pub fn read(folder: &Path) -> Result<Option<String>, Failure> {
    let path = folder.join(VERDICTS);
    match files::read_text(&path, MOST_BYTES) {
        Ok(text) => Ok(Some(text)),
        Err(reason) if [ErrorKind::NotFound, ErrorKind::NotADirectory].contains(&reason.kind()) => {
            Ok(None)
        }
        Err(reason) => Err(Failure::usage(format!("cannot read {}: {reason}", path.display()))),
    }
}

/// Everything that a suite decided: `verify --json` and `verdicts.json` of a report.
#[derive(Debug, Serialize, Deserialize)]
pub struct Verdicts {
    /// `quick`, `full` or `deep`
    pub tier: String,
    /// commit of the program
    pub commit: String,
    /// gates by verdict
    pub counts: BTreeMap<Verdict, usize>,
    /// runs of all cases
    pub runs: Vec<RunVerdicts>,
    /// studies of all cases and of the method
    pub studies: Vec<StudyVerdicts>,
    /// comparisons of all cases with references; builds of before have none
    #[serde(default)]
    pub comparisons: Vec<ComparisonVerdict>,
}

/// A run and the judgements on it.
#[derive(Debug, Serialize, Deserialize)]
pub struct RunVerdicts {
    /// name of the case
    pub case: String,
    /// name of the variant
    pub variant: String,
    /// `key=value` of settings that differ from the defaults of the variant
    pub set: Vec<String>,
    /// names the record
    pub key: String,
    /// how it ended
    pub status: record::Status,
    /// wall time in seconds
    #[serde(with = "base::number")]
    pub wall_s: f64,
    /// the judgements
    pub judged: Vec<Judged>,
}

/// A study and the judgements on it.
#[derive(Debug, Serialize, Deserialize)]
pub struct StudyVerdicts {
    /// the case, or `method`
    pub case: String,
    /// anchor in the report
    pub id: String,
    /// its title
    pub title: String,
    /// the judgements
    pub judged: Vec<Judged>,
}

/// The name of a tier on the command line.
pub fn tier_name(tier: Tier) -> String {
    format!("{tier:?}").to_lowercase()
}

impl Verdicts {
    /// Every judgement.
    pub fn judged(&self) -> impl Iterator<Item = &Judged> {
        let of_runs = self.runs.iter().flat_map(|run| &run.judged);
        of_runs.chain(self.studies.iter().flat_map(|study| &study.judged))
    }

    /// The verdicts of a suite.
    pub fn of(suite: &Suite) -> Self {
        let of_run = |case: &dyn Case, run: &JudgedRun| RunVerdicts {
            case: case.name().into(),
            variant: run.planned.spec.variant.clone(),
            set: case::changed(case, &run.planned.spec),
            key: run.record.key().to_string(),
            status: run.record.status.clone(),
            wall_s: run.record.cost.wall_s,
            judged: run.judged.clone(),
        };
        let of_study = |case: &str, study: &Study| StudyVerdicts {
            case: case.into(),
            id: study.id.clone(),
            title: study.title.clone(),
            judged: study.judged.clone(),
        };
        let of_cases = suite.cases.iter().flat_map(|results| {
            results.studies.iter().map(|study| of_study(results.case.name(), study))
        });
        let counts = suite.counts();
        let there_are = Verdict::ALL.into_iter().filter(|of| counts.count(*of) > 0);
        Verdicts {
            tier: tier_name(suite.tier),
            commit: super::SOURCE.commit.into(),
            counts: there_are.map(|of| (of, counts.count(of))).collect(),
            runs: suite
                .cases
                .iter()
                .flat_map(|of| of.runs.all.iter().map(|run| of_run(of.case, run)))
                .collect(),
            studies: of_cases.collect(),
            comparisons: comparisons::of(suite),
        }
    }
}

/// The verdicts of a suite as JSON.
pub fn json(suite: &Suite) -> Result<String, Failure> {
    Ok(serde_json::to_string_pretty(&Verdicts::of(suite)).map_err(Failure::bug)? + "\n")
}

/// Writes the verdicts as JUnit XML into a file, if it was asked for.
pub fn write_junit(suite: &Suite, path: Option<&Path>) -> Result<(), Failure> {
    Ok(path.map_or(Ok(()), |path| write_atomically(path, junit(suite).as_bytes()))?)
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
        let counts = results.counts();
        let [pass, failed] = [Verdict::Pass, Verdict::Fail].map(|verdict| counts.count(verdict));
        let (name, all) = (escaped(results.case.name()), results.judged().count());
        let skipped = all - pass - failed;
        text += &format!(
            "  <testsuite name=\"{name}\" tests=\"{all}\" failures=\"{failed}\" skipped=\"{skipped}\">\n"
        );
        for JudgedOf { judged, .. } in results.judged() {
            let Judged { gate, judgement, .. } = judged;
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
