//! `explain`: the quantity, bound and reason of a gate.

use std::collections::BTreeSet;
use std::path::Path;

use touchstone_base::gate::{Evidence, Gate, Verdict};
use touchstone_base::record;
use touchstone_base::settings::by_similarity;
use touchstone_base::text::short;
use touchstone_harness::case::{self, Case, Tier};
use touchstone_harness::make::StoredRuns;
use touchstone_harness::plan;
use touchstone_harness::runs::{self, Judged};
use touchstone_harness::store::Store;
use touchstone_harness::suite::{self, JudgedOf, Of};

use super::{
    Failure, Session, arguments,
    judged::{self, Verdicts, tier_name},
    output,
};

/// A gate, its runs, and its last verdict.
struct ExplainedGate {
    gate: Gate,
    case: String,
    tiers: Vec<String>,
    on: String,
    last: Option<Judged>,
    status: Option<record::Status>,
    /// How runs of other codes were judged by it last.
    others: Vec<String>,
}

impl ExplainedGate {
    /// Not judged yet.
    fn new(gate: Gate, case: &str, on: String) -> Self {
        let (tiers, others) = (Vec::new(), Vec::new());
        Self { gate, case: case.into(), tiers, on, last: None, status: None, others }
    }
}

pub fn explain(arguments: &arguments::Explain, session: &Session) -> Result<(), Failure> {
    let asked = arguments.gate.as_deref().unwrap_or_default();
    let verdicts = last_verdicts(&arguments.reports, asked, session)?;
    if let Some(status) = arguments.status {
        let Some(verdicts) = verdicts else {
            return Err(Failure::usage(format!(
                "{} holds neither verdicts.json nor records; touchstone report, or touchstone verify without \
                 --store, makes them",
                arguments.reports.display()
            )));
        };
        let begins = |judged: &&Judged| judged.gate.id.starts_with(asked);
        let of_name: Vec<&Judged> = verdicts.judged().filter(begins).collect();
        if of_name.is_empty() {
            return Err(unknown(asked, &all(session, Some(&verdicts))));
        }
        return output::print(&listed(of_name, status));
    }
    let gates = all(session, verdicts.as_ref());
    let mut chosen: Vec<&ExplainedGate> =
        gates.iter().filter(|known| known.gate.id == asked).collect();
    if chosen.is_empty() {
        chosen.extend(gates.iter().filter(|known| known.gate.id.starts_with(asked)));
    }
    if chosen.is_empty() {
        return Err(unknown(asked, &gates));
    }
    let texts: Vec<String> = chosen.into_iter().map(words).collect();
    output::print(&texts.join("\n"))
}

/// The verdicts of the last report or, without one, of the records that `verify` keeps: for the cases with
/// gates that may begin with `asked`, if all runs of the quick tier are stored.
fn last_verdicts(
    reports: &Path,
    asked: &str,
    session: &Session,
) -> Result<Option<Verdicts>, Failure> {
    let text = judged::read(reports)?.unwrap_or_default();
    if let Ok(verdicts) = serde_json::from_str(&text) {
        return Ok(Some(verdicts)); // of another version: none
    }
    let is_asked =
        |case: &&'static dyn Case| case.name().starts_with(asked) || asked.starts_with(case.name());
    let cases: Vec<&'static dyn Case> = session.cases.iter().copied().filter(is_asked).collect();
    let mut plans = suite::plans(&cases, Tier::Quick);
    let store = Store::to_read(&reports.join("records"));
    let StoredRuns { made, missing, .. } = session.stored(&plans, &store, false);
    if made.interrupted {
        return Err(Failure::interrupted("no gate is shown"));
    }
    plans.retain(|(case, _)| missing.iter().all(|job| job.case.name() != case.name()));
    let is_complete = !plans.is_empty();
    Ok(is_complete.then(|| Verdicts::of(&suite::judge(plans, Tier::Quick, made))))
}

/// A judgement, with all that is known of its gate.
pub fn in_full(JudgedOf { case, of, judged }: &JudgedOf) -> String {
    let (on, status) = match of {
        Of::Run(run) => (case::command(*case, &run.planned.spec), Some(run.record.status.clone())),
        Of::Section(section) => (of_study(&section.title, case.name()), None),
    };
    let last = Some(Judged::clone(judged));
    words(&ExplainedGate {
        last,
        status,
        ..ExplainedGate::new(judged.gate.clone(), case.name(), on)
    })
}

fn of_study(title: &str, case: &str) -> String {
    format!("the study \"{title}\" of {case}")
}

/// Gates of the plans, then gates on several runs, whose names only a report has.
fn all(session: &Session, verdicts: Option<&Verdicts>) -> Vec<ExplainedGate> {
    let mut gates: Vec<ExplainedGate> = Vec::new();
    for case in session.cases {
        for tier in [Tier::Quick, Tier::Full] {
            for planned in plan::of_case(*case, tier) {
                let on = case::command(*case, &planned.spec);
                for gate in planned.gates {
                    match gates.iter_mut().find(|known| known.gate.id == gate.id) {
                        Some(known) => known.tiers.push(tier_name(tier)),
                        None => {
                            let tiers = vec![tier_name(tier)];
                            gates.push(ExplainedGate {
                                tiers,
                                ..ExplainedGate::new(gate, case.name(), on.clone())
                            });
                        }
                    }
                }
            }
        }
    }
    for run in verdicts.iter().flat_map(|verdicts| &verdicts.runs) {
        for judged in &run.judged {
            if let Some(known) = gates.iter_mut().find(|known| known.gate == judged.gate) {
                (known.last, known.status) = (Some(judged.clone()), Some(run.status.clone()));
            }
        }
    }
    for of in verdicts.iter().flat_map(|verdicts| &verdicts.submissions) {
        for judged in &of.judged {
            let found = gates.iter_mut().find(|known| known.gate.id == judged.gate.id);
            let value = judged::value(&judged.judgement);
            let words = || format!("{}: {value}: {}", of.submission, judged.words());
            found.into_iter().for_each(|known| known.others.push(words()));
        }
    }
    for study in verdicts.iter().flat_map(|verdicts| &verdicts.studies) {
        let on = of_study(&study.title, &study.case);
        gates.extend(study.judged.iter().map(|judged| ExplainedGate {
            last: Some(judged.clone()),
            ..ExplainedGate::new(judged.gate.clone(), &study.case, on.clone())
        }));
    }
    gates
}

/// The gates with this verdict, one per line; limitations by cause.
pub fn listed(gates: Vec<&Judged>, verdict: Verdict) -> String {
    let has = |judged: &&Judged| judged.judgement.verdict == verdict;
    let chosen: Vec<&Judged> = gates.into_iter().filter(has).collect();
    if chosen.is_empty() {
        return "no gate has this verdict\n".into();
    }
    if verdict == Verdict::Limitation { by_cause(&chosen) } else { table(&chosen) }
}

fn table(gates: &[&Judged]) -> String {
    let row = |judged: &&Judged| {
        let value =
            judged.judgement.value.map_or("-".into(), |value| touchstone_report::sig(value, 5));
        vec![judged.gate.id.clone(), value, judged.gate.bounds()]
    };
    output::table(&["gate", "value", "bound"], gates.iter().map(row))
}

/// Each cause, in order of decreasing number of gates, with its remedy and its gates.
fn by_cause(gates: &[&Judged]) -> String {
    let mut text = String::new();
    for (cause, gates) in runs::by_cause(gates.iter().copied(), |judged| judged) {
        text += &output::wrap(&cause.to_string(), "");
        text += &table(&gates).lines().map(|line| format!("    {line}\n")).collect::<String>();
        text.push('\n');
    }
    text + "`touchstone explain GATE` gives the reason of each bound and a command that shows it.\n"
}

/// Names that an error suggests, at most.
const SUGGESTED: usize = 5;

fn unknown(asked: &str, gates: &[ExplainedGate]) -> Failure {
    let ids: BTreeSet<&str> = gates.iter().map(|known| known.gate.id.as_str()).collect();
    let mut near = by_similarity(&ids.iter().copied().collect::<Vec<_>>(), asked);
    near.truncate(SUGGESTED);
    let hint = match near.as_slice() {
        [] => "the plans have no gates".to_string(),
        near => format!("the nearest of {} names: {}", ids.len(), near.join(", ")),
    };
    Failure::usage(format!(
        "no gate is called {:?}, and no name begins with it; {hint} (gates of studies are known \
         only after touchstone verify or report)",
        short(asked)
    ))
}

fn words(known: &ExplainedGate) -> String {
    let ExplainedGate { gate, case, on, last, others, .. } = known;
    let judged_as = |judged: &Judged| {
        let words = output::painted(judged.judgement.verdict, &judged.words());
        format!("{}: {words}", judged::value(&judged.judgement))
    };
    let lines = [
        ("checks", format!("metric {}", gate.metric)),
        ("bound", gate.bound.to_string()),
        ("evidence", evidence(gate, case)),
        ("because", gate.because.clone()),
        ("purpose", purpose(gate)),
        ("judged on", on.clone()),
        ("in tiers", known.tiers.join(", ")),
        ("last", last.as_ref().map(judged_as).unwrap_or_default()),
        ("that run", known.status.as_ref().map(ToString::to_string).unwrap_or_default()),
        ("others", others.join("; ")),
    ];
    let mut text = format!("{}\n", gate.id);
    for (head, words) in lines.iter().filter(|(_, words)| !words.is_empty()) {
        text += &output::hanging(&format!("  {head}"), 13, words);
    }
    text
}

fn evidence(gate: &Gate, case: &str) -> String {
    let words = match gate.evidence {
        Evidence::Analytic => "analytic: an exact solution of the equations",
        Evidence::Invariant => "invariant: a law that holds for every solution",
        Evidence::Theory => "theory of the method",
        Evidence::Reference => "reference: an experiment or an independent computation",
        Evidence::Regression => "regression: an earlier result of this program",
    };
    let grades = if gate.evidence == Evidence::Reference {
        touchstone_cases::graded(case)
    } else {
        Vec::new()
    };
    let grades = grades.into_iter().map(|(name, grade)| format!("; {name}: {grade}"));
    words.to_string() + &grades.collect::<String>()
}

fn purpose(gate: &Gate) -> String {
    let Gate { known, reason, cause, .. } = gate;
    match known {
        _ if gate.control => {
            "a control: our run must lie outside; a run of another code passes inside and fails outside"
                .into()
        }
        None => "inside passes, outside fails".into(),
        Some(known) => {
            let cause = cause.as_ref().map(|cause| &*cause.what);
            let reasons: Vec<&str> = cause.into_iter().chain(reason.as_deref()).collect();
            format!(
                "known limitation of our method, allowed {known}; a run of another code fails outside the \
                 bound: {}",
                reasons.join(" ")
            )
        }
    }
}
