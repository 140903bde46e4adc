//! Judgements as tables, as JSON that `explain` reads back, and for other programs as JUnit XML.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::Path;

use serde::{Deserialize, Serialize};
use touchstone_base::files::{self, write_atomically};
use touchstone_base::gate::{Judgement, Verdict};
use touchstone_base::record;
use touchstone_base::submission::Submission;
use touchstone_harness::case::{self, Case, Tier};
use touchstone_harness::notes::Notes;
use touchstone_harness::runs::{Judged, JudgedRun};
use touchstone_harness::section::Section;
use touchstone_harness::suite::{CaseResults, Suite};
use touchstone_report::Counts;

use super::comparisons::{self, ComparisonVerdict};
use super::{
    Failure, baseline,
    junit::{self, Tested},
    metrics::{MetricChange, Metrics},
    output,
};

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
    let number =
        |number: Option<f64>| number.map_or("-".into(), |number| touchstone_report::sig(number, 4));
    let row = |judged: &'a Judged| {
        let Judged { gate, judgement, .. } = judged;
        vec![
            output::painted(judgement.verdict, &words(judged)),
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

/// The table of the gates that did not pass, or of all gates, and an empty line; nothing without gates.
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
    /// runs of other codes
    #[serde(default)]
    pub submissions: Vec<SubmissionVerdicts>,
    /// comparisons of all cases with references; empty in verdicts of earlier builds
    #[serde(default)]
    pub comparisons: Vec<ComparisonVerdict>,
}

/// A run of another code and the judgements on it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SubmissionVerdicts {
    /// name of the case
    pub case: String,
    /// name of the variant of the problem
    pub variant: String,
    /// `key=value` of settings that differ from the defaults of the variant
    pub set: Vec<String>,
    /// names the record
    pub key: String,
    /// the code of the run
    pub submission: Submission,
    /// does the program contain the record? Then it decides no exit code
    pub embedded: bool,
    /// how it ended
    pub status: record::Status,
    /// the judgements by the gates that apply
    pub judged: Vec<Judged>,
    /// gates that do not apply, and why
    pub not_applicable: BTreeMap<String, String>,
    /// all metrics; empty of a record that the program contains
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub metrics: Metrics,
    /// comparison with the baseline of the code, if there is one
    #[serde(default, skip_serializing_if = "Option::is_none", skip_deserializing)]
    pub baseline: Option<Vec<MetricChange>>,
}

impl SubmissionVerdicts {
    /// The verdicts on a run of another code; `None` for our own run.
    pub fn of(case: &dyn Case, run: &JudgedRun, embedded: bool) -> Option<Self> {
        let (apply, others) = run.applicable();
        Some(Self {
            case: case.name().into(),
            variant: run.planned.spec.variant.clone(),
            set: case::changed(case, &run.planned.spec),
            key: run.record.run.key().to_string(),
            submission: run.record.run.submission.as_deref()?.clone(),
            embedded,
            status: run.record.status.clone(),
            judged: apply.into_iter().cloned().collect(),
            not_applicable: others.into_iter().map(|(id, why)| (id.into(), why)).collect(),
            metrics: if embedded { Metrics::new() } else { run.record.metrics.clone() },
            baseline: None,
        })
    }

    /// The parts that a new version of a code keeps: code, scheme, division and problem.
    pub fn name(&self) -> String {
        let by = &self.submission;
        let sealed = by.seed.map_or(String::new(), |seed| format!(", sealed by seed {seed}"));
        format!("{}, {} ({}) of {}{sealed}", by.code, by.scheme, by.division, self.problem())
    }

    /// The problem in words.
    pub fn problem(&self) -> String {
        format!("{} {} {}", self.case, self.variant, self.set.join(" ")).trim_end().into()
    }
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
    #[serde(with = "touchstone_base::number")]
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
    /// Every judgement on our own runs.
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
            key: run.record.run.key().to_string(),
            status: run.record.status.clone(),
            wall_s: run.record.cost.wall_s,
            judged: run.judged.clone(),
        };
        let of_study = |case: &str, section: &Section| StudyVerdicts {
            case: case.into(),
            id: section.id.clone(),
            title: section.title.clone(),
            judged: section.judged.clone(),
        };
        let of_cases = suite.cases.iter().flat_map(|results| {
            results.sections.iter().map(|section| of_study(results.case.name(), section))
        });
        let of_others = suite.cases.iter().flat_map(|of| {
            let all = [(&of.runs.submissions, false), (&of.runs.peers, true)].into_iter();
            let all = all.flat_map(|(runs, embedded)| runs.iter().map(move |run| (run, embedded)));
            all.filter_map(|(run, embedded)| SubmissionVerdicts::of(of.case, run, embedded))
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
            submissions: of_others.collect(),
            comparisons: comparisons::of(suite),
        }
    }
}

/// The verdicts of a suite as JSON.
pub fn json(suite: &Suite) -> Result<String, Failure> {
    Ok(serde_json::to_string_pretty(&Verdicts::of(suite)).map_err(Failure::bug)? + "\n")
}

/// Writes the verdicts as JUnit XML into a file, if requested.
pub fn write_junit(suite: &Suite, path: Option<&Path>) -> Result<(), Failure> {
    Ok(path.map_or(Ok(()), |path| write_atomically(path, junit(suite).as_bytes()))?)
}

/// The verdicts on one run of another code as JSON.
pub fn json_of_submission(of: &SubmissionVerdicts) -> Result<String, Failure> {
    Ok(serde_json::to_string_pretty(of).map_err(Failure::bug)? + "\n")
}

/// Writes the verdicts on one run of another code as JUnit XML into a file, if requested.
pub fn write_junit_of_submission(
    of: &SubmissionVerdicts,
    path: Option<&Path>,
) -> Result<(), Failure> {
    let text = || junit::document([submission_testsuite(of)]);
    Ok(path.map_or(Ok(()), |path| write_atomically(path, text().as_bytes()))?)
}

/// The number that was judged, for people.
pub fn value(judgement: &Judgement) -> String {
    judgement.value.map_or("not measured".into(), |value| touchstone_report::sig(value, 5))
}

/// Runs of other codes in the store as a table of limited length, runs with failing gates first.
pub fn submissions(suite: &Suite) -> String {
    let of = |(results, run): (&CaseResults, &JudgedRun)| {
        SubmissionVerdicts::of(results.case, run, false)
    };
    let mut all: Vec<SubmissionVerdicts> = suite.submissions().filter_map(of).collect();
    let failing = |of: &SubmissionVerdicts| -> Vec<String> {
        let failing = of.judged.iter().filter(|judged| judged.judgement.verdict.is_failure());
        failing.map(|judged| judged.gate.id.clone()).collect()
    };
    all.sort_by_key(|of| (failing(of).is_empty(), !of.judged.is_empty()));
    let row = |of: &SubmissionVerdicts| {
        let failing = failing(of);
        let [passed, failed, others] =
            [of.judged.len() - failing.len(), failing.len(), of.not_applicable.len()];
        let failing = failing.join(" ");
        let counts = [failed, passed, others].map(|count| count.to_string());
        [
            &[format!("{} ({})", of.submission, of.submission.division), of.problem()],
            &counts[..],
            &[failing],
        ]
        .concat()
    };
    let heads =
        ["runs of other codes", "problem", "fail", "pass", "not applicable", "gates that fail"];
    let table = output::table(&heads, all.iter().take(MOST_SHOWN).map(row));
    let unjudged = all.iter().filter(|of| of.judged.is_empty()).count();
    let words = match (all.len().saturating_sub(MOST_SHOWN), unjudged) {
        (0, 0) => String::new(),
        (more, unjudged) => format!("{more} more; judged by no gate: {unjudged}\n"),
    };
    if all.is_empty() { String::new() } else { format!("\n{table}{words}") }
}

/// Counts of the verdicts of all gates, of our own runs and of other codes in the store.
pub fn headline(suite: &Suite) -> String {
    let painted = |counts: Counts| match counts.count(Verdict::Fail) {
        0 => counts.headline(),
        _ => output::painted(Verdict::Fail, &counts.headline()),
    };
    let ours = painted(suite.counts());
    let others = painted(Counts::of(suite.submitted().map(|of| of.judged.judgement.verdict)));
    match suite.submissions().next() {
        None => ours,
        Some(_) if suite.cases.iter().all(|of| of.runs.all.is_empty()) => {
            format!("Runs of other codes: {others}.")
        }
        Some(_) => format!("Our own runs: {ours}. Runs of other codes: {others}."),
    }
}

/// Number of runs of other codes with a line each.
const MOST_SHOWN: usize = 20;

/// A test case a gate, by case, and a suite for each run of another code in the store. Failing gates are
/// failures; a limitation, an expected failure and a gate that does not apply are skipped, with the reason.
fn junit(suite: &Suite) -> String {
    let none = BTreeMap::new();
    junit::document(suite.cases.iter().flat_map(|results| {
        let judged = results.judged().map(|of| of.judged);
        let own = junit::suite(results.case.name(), &tests(judged, &none));
        let others = results.runs.submissions.iter();
        let others = others.filter_map(|run| SubmissionVerdicts::of(results.case, run, false));
        [own].into_iter().chain(others.map(|of| submission_testsuite(&of)))
    }))
}

/// The suite of a run of another code.
fn submission_testsuite(of: &SubmissionVerdicts) -> String {
    let name = format!("{} by {}", of.problem(), of.submission);
    let mut tests = tests(of.judged.iter(), &of.not_applicable);
    tests.extend(of.baseline.as_deref().map(|changes| ("baseline", baseline::tested(changes))));
    junit::suite(&name, &tests)
}

/// Judgements as test cases, and gates that are skipped, each with the reason.
fn tests<'a>(
    judged: impl Iterator<Item = &'a Judged>,
    skipped: &'a BTreeMap<String, String>,
) -> Vec<(&'a str, Tested)> {
    let of_gate = |Judged { gate, judgement, .. }: &Judged, words: &str| {
        let message = format!("{} {}; {words}", value(judgement), gate.bounds());
        match judgement.verdict {
            Verdict::Pass => Tested::Pass,
            Verdict::Fail => Tested::Fail { message, why: gate.because.clone() },
            _ => Tested::Skipped(message),
        }
    };
    let mut tests: Vec<(&str, Tested)> =
        judged.map(|judged| (&*judged.gate.id, of_gate(judged, &judged.words()))).collect();
    let skip = |why: &String| Tested::Skipped(format!("not applicable: {why}"));
    tests.extend(skipped.iter().map(|(id, why)| (&**id, skip(why))));
    tests
}
