//! `explain`: what a gate checks and why.

use std::collections::BTreeSet;
use std::fs;

use ::report;
use base::gate::{Evidence, Gate, Purpose, Verdict};
use base::record;
use base::settings::by_similarity;
use harness::case::{Tier, changed};
use harness::plan;

use super::{
    Exit, Failure, Outcome, World, arguments,
    judged::{Judged, Verdicts, tier_name},
    output,
};

/// A gate, what it is judged on, and what came of it last.
struct Known {
    gate: Gate,
    tiers: Vec<&'static str>,
    on: String,
    last: Option<Judged>,
    status: Option<record::Status>,
}

pub fn explain(arguments: &arguments::Explain, world: &World) -> Outcome {
    let path = arguments.reports.join("verdicts.json");
    let text = fs::read_to_string(&path).unwrap_or_default();
    let verdicts: Option<Verdicts> = serde_json::from_str(&text).ok(); // of another version: none
    let asked = arguments.gate.as_deref().unwrap_or_default();
    if let Some(status) = arguments.status {
        let Some(verdicts) = verdicts else {
            let words =
                format!("{} holds no verdicts; touchstone report writes them", path.display());
            return Err(Failure::usage(anyhow::anyhow!(words)));
        };
        output::print(&listed(&verdicts, status, asked))?;
        return Ok(Exit::Pass);
    }
    let gates = all(world, verdicts.as_ref());
    let mut chosen: Vec<&Known> = gates.iter().filter(|known| known.gate.id == asked).collect();
    if chosen.is_empty() {
        chosen.extend(gates.iter().filter(|known| known.gate.id.starts_with(asked)));
    }
    match chosen.as_slice() {
        [] => Err(unknown(asked, &gates)),
        [known] => {
            output::print(&words(known))?;
            Ok(Exit::Pass)
        }
        several => {
            let all: Vec<String> = several.iter().map(|known| words(known)).collect();
            output::print(&all.join("\n"))?;
            Ok(Exit::Pass)
        }
    }
}

/// Gates of the plans; then those on many runs, which only a report names.
fn all(world: &World, verdicts: Option<&Verdicts>) -> Vec<Known> {
    let mut gates: Vec<Known> = Vec::new();
    for case in world.cases {
        for tier in [Tier::Quick, Tier::Full] {
            for planned in plan::of_case(*case, tier) {
                let spec = &planned.spec;
                let set: String =
                    changed(*case, spec).iter().map(|set| format!(" --set {set}")).collect();
                let on = format!("touchstone run {} --variant {}{set}", case.name(), spec.variant);
                for gate in planned.gates {
                    match gates.iter_mut().find(|known| known.gate.id == gate.id) {
                        Some(known) => known.tiers.push(tier_name(tier)),
                        None => gates.push(Known {
                            gate,
                            tiers: vec![tier_name(tier)],
                            on: on.clone(),
                            last: None,
                            status: None,
                        }),
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
    for study in verdicts.iter().flat_map(|verdicts| &verdicts.studies) {
        let on = format!("the study \"{}\" of {}", study.title, study.case);
        gates.extend(study.judged.iter().map(|judged| Known {
            gate: judged.gate.clone(),
            tiers: Vec::new(),
            on: on.clone(),
            last: Some(judged.clone()),
            status: None,
        }));
    }
    gates
}

/// The gates whose name begins with `asked` and that have this verdict, one per line.
fn listed(verdicts: &Verdicts, status: arguments::Status, begins: &str) -> String {
    let of_runs = verdicts.runs.iter().flat_map(|run| &run.judged);
    let all = of_runs.chain(verdicts.studies.iter().flat_map(|study| &study.judged));
    let chosen = all.filter(|judged| {
        judged.gate.id.starts_with(begins) && is(&judged.judgement.verdict, status)
    });
    let row = |judged: &Judged| {
        let value = judged.judgement.value.map_or("-".into(), |value| report::sig(value, 5));
        vec![judged.gate.id.clone(), value, judged.gate.bounds()]
    };
    output::table(&["gate", "value", "bound"], &chosen.map(row).collect::<Vec<_>>())
}

fn is(verdict: &Verdict, status: arguments::Status) -> bool {
    use arguments::Status;
    let of_verdict = match verdict {
        Verdict::Pass => Status::Pass,
        Verdict::Fail => Status::Fail,
        Verdict::Limitation(_) => Status::Limitation,
        Verdict::ExpectedFailure => Status::ExpectedFailure,
    };
    of_verdict == status
}

/// Names that an error suggests, at most.
const SUGGESTED: usize = 5;

fn unknown(asked: &str, gates: &[Known]) -> Failure {
    let ids: BTreeSet<&str> = gates.iter().map(|known| known.gate.id.as_str()).collect();
    let mut near = by_similarity(&ids.iter().copied().collect::<Vec<_>>(), asked);
    near.truncate(SUGGESTED);
    let hint = match near.as_slice() {
        [] => "there are none in the plans".to_string(),
        near => format!("the nearest of {} names: {}", ids.len(), near.join(", ")),
    };
    Failure::usage(anyhow::anyhow!(
        "no gate is called {asked:?}, and no name begins with it; {hint} (gates of studies are known \
         only after touchstone report)"
    ))
}

fn words(known: &Known) -> String {
    let Known { gate, on, last, .. } = known;
    let lines = [
        ("checks", format!("metric {}", gate.metric)),
        ("bound", gate.bound.to_string()),
        ("evidence", evidence(gate.evidence).to_string()),
        ("because", gate.because.clone()),
        ("purpose", purpose(&gate.purpose)),
        ("judged on", on.clone()),
        ("in tiers", known.tiers.join(", ")),
        ("last", last.as_ref().map(last_words).unwrap_or_default()),
        ("that run", known.status.as_ref().map(ToString::to_string).unwrap_or_default()),
    ];
    let mut text = format!("{}\n", gate.id);
    for (head, words) in lines.iter().filter(|(_, words)| !words.is_empty()) {
        let body = output::wrap(words, 100, "             ");
        text += &format!("  {head:<11}{}", body.trim_start());
    }
    text
}

fn last_words(judged: &Judged) -> String {
    let Judged { judgement, .. } = judged;
    let value = judgement.value.map_or("not measured".into(), |value| report::sig(value, 5));
    format!("{value}: {}", judgement.verdict)
}

fn evidence(evidence: Evidence) -> &'static str {
    match evidence {
        Evidence::Analytic => "analytic: an exact solution of the equations",
        Evidence::Invariant => "invariant: a law that holds whatever the solution",
        Evidence::Theory => "theory of the method",
        Evidence::Reference => "reference: an experiment or an independent computation",
        Evidence::Regression => "regression: what this program computed before",
    }
}

fn purpose(purpose: &Purpose) -> String {
    match purpose {
        Purpose::Judge => "inside passes, outside fails".into(),
        Purpose::Limitation(known) => {
            format!("known limitation, may lie outside, but {}: {}", known.bound, known.reason)
        }
        Purpose::ExpectFailure => "a control, which must lie outside".into(),
    }
}
