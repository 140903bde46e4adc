//! Output of `submit`: gates, reasons for absent numbers and for gates that do not apply, and hints for the
//! submitter.

use touchstone_base::{gate::Gate, record::Status, spec::RunSpec};
use touchstone_harness::{
    case::{self, Case, Tier},
    gates::GateIndex,
    runs::{Judged, JudgedRun},
    studies::{Studies, card::cost as cost_in_words},
};
use touchstone_report::Counts;

use super::{
    Exit, judged, output,
    summary::{bound, error_of, finer, in_words, nearest, worst},
};

/// The verdict on a submission, and the exit code.
pub fn verdict(index: &GateIndex, run: &JudgedRun, all: bool) -> (String, Exit) {
    let (apply, others) = run.applicable();
    let verdicts: Vec<Judged> = apply.into_iter().cloned().collect();
    let mut text = judged::shown(&verdicts, all);
    let rows = without_number(run, &verdicts);
    if !rows.is_empty() {
        text += &(output::table(&["no number", "because"], rows) + "\n");
    }
    if !others.is_empty() {
        let rows = others.into_iter().map(|(id, why)| vec![id.to_string(), why]);
        text += &(output::table(&["not applicable", "because"], rows) + "\n");
    }
    let (lines, exit) = lines(index, run, &verdicts);
    (text + &lines, exit)
}

/// The lines after the tables of a submission, and its exit code.
fn lines(index: &GateIndex, run: &JudgedRun, verdicts: &[Judged]) -> (String, Exit) {
    let (case, record) = (index.case, &run.record);
    let studies = case.studies(Tier::Quick);
    let (mut error, mut metric) = error_of(&studies, record);
    let states = record.run.submission.as_ref().is_some_and(|of| of.states_our_method);
    let judges = |gate: Gate| gate.for_submission(states);
    let nearest =
        if verdicts.is_empty() { nearest(index, &studies, record, &judges) } else { None };
    let judged = worst(verdicts.iter()).map(|judged| &judged.gate);
    let other = judged.or(nearest.as_ref().map(|nearest| &nearest.gate));
    let has_error = record.metrics.contains_key(&metric) || record.status != Status::Completed;
    if let (false, Some(gate)) = (has_error, other)
        && let Some(found) = record.metrics.get(&gate.metric)
    {
        (error, metric) = (in_words(&gate.metric, found), gate.metric.clone());
    }
    let (mut bound, mut gates) = (bound(&studies, record, verdicts, &metric), counted(verdicts));
    if verdicts.is_empty() {
        gates = "Nothing was judged: no gate applies to this submission.".into();
        bound = match &nearest {
            Some(nearest) => nearest.in_words(case, &studies),
            None => "none for this variant with these settings".into(),
        };
    }
    let ended = match &record.status {
        Status::Completed => String::new(),
        status => format!("{status}; nothing after it is measured"),
    };
    let next = next(case, &studies, run, verdicts, nearest.map(|nearest| nearest.spec));
    let cost = cost_in_words(record);
    let lines = [ended, error, bound, gates, cost, next];
    let heads = ["ended", "error", "bound", "gates", "cost", "next"];
    let told = heads.iter().zip(&lines).filter(|(_, words)| !words.is_empty());
    let exit = match verdicts.iter().any(|judged| judged.judgement.verdict.is_failure()) {
        _ if verdicts.is_empty() => Exit::Usage,
        true => Exit::GateFailed,
        false => Exit::Pass,
    };
    (told.map(|(head, words)| output::hanging(head, 7, words)).collect(), exit)
}

fn counted(verdicts: &[Judged]) -> String {
    Counts::of(verdicts.iter().map(|judged| judged.judgement.verdict)).headline()
}

/// The command that is of use to a submitter.
fn next(
    case: &dyn Case,
    studies: &Studies,
    run: &JudgedRun,
    verdicts: &[Judged],
    nearest: Option<RunSpec>,
) -> String {
    let export = |run: &str| run.replacen("touchstone run", "touchstone export", 1);
    let spec = &run.planned.spec;
    let worst = worst(verdicts.iter()).filter(|judged| judged.judgement.verdict.is_failure());
    match (worst, nearest) {
        _ if run.record.status != Status::Completed => {
            export(&case::command(case, spec))
                + " --solve --out DIR (our own results of this problem)"
        }
        (Some(judged), _) => format!("touchstone explain {}", judged.gate.id),
        (None, Some(of)) => {
            export(&case::command(case, &of)) + " --out DIR (a problem that is judged)"
        }
        (None, None) => finer(case, studies, spec)
            .map(|finer| export(&finer) + " --out DIR")
            .unwrap_or_default(),
    }
}

/// The gates of a submission that reached its end and whose metric is not finite, and why.
fn without_number(run: &JudgedRun, judged: &[Judged]) -> Vec<Vec<String>> {
    let record = &run.record;
    let without = |judged: &&Judged| {
        let value = judged.judgement.value;
        record.status == Status::Completed && !value.is_some_and(f64::is_finite)
    };
    let why =
        |judged: &Judged| match (record.absent.get(&judged.gate.metric), judged.judgement.value) {
            (Some(why), _) => why.to_string(),
            (None, Some(value)) => format!("it is {value}"),
            (None, None) => "the particles of the submission determine no value".into(),
        };
    judged.iter().filter(without).map(|one| vec![one.gate.id.clone(), why(one)]).collect()
}
