//! `compare`: what changed between two reports or two stores.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context as _;
use base::{
    functions::ln,
    gate::{Bound, Verdict},
    record::Record,
};
use harness::store::Store;
use serde_json::{Value, json};

use super::{
    Exit, Failure, Outcome, arguments,
    judged::{Judged, Verdicts},
    output,
};

/// A report, or a store without verdicts.
struct Side {
    verdicts: Option<BTreeMap<String, Judged>>,
    records: BTreeMap<String, Record>,
}

impl Side {
    fn read(path: &Path) -> Result<Self, Failure> {
        let file = path.join("verdicts.json");
        let verdicts = match std::fs::read_to_string(&file) {
            Ok(text) => {
                let all: Verdicts = serde_json::from_str(&text)
                    .with_context(|| format!("{} holds no verdicts", file.display()))
                    .map_err(Failure::usage)?;
                let judged = all.runs.into_iter().flat_map(|run| run.judged);
                let judged = judged.chain(all.studies.into_iter().flat_map(|study| study.judged));
                Some(judged.map(|judged| (judged.gate.id.clone(), judged)).collect())
            }
            Err(_) => None,
        };
        let below = path.join("records");
        let records = match (below.is_dir(), &verdicts) {
            (true, _) => Store::all(&below)?,
            (false, None) => Store::all(path)?,
            (false, Some(_)) => Vec::new(), // a report whose records are elsewhere
        };
        if verdicts.is_none() && records.is_empty() {
            let words = format!("{} is neither a report nor a store", path.display());
            return Err(Failure::usage(anyhow::anyhow!(words)));
        }
        let name = |r: Record| (format!("{} {} {}", r.case, r.variant, r.key()), r);
        Ok(Self { verdicts, records: records.into_iter().map(name).collect() })
    }
}

/// A change of one gate or run, in words and as data.
struct Change {
    kind: &'static str,
    name: String,
    words: String,
}

/// A value moved if it did by more than this share of the scale of its gate's bound.
const RESOLUTION: f64 = 0.01;

/// Seconds of a run are told if they differ by more than this factor.
const NOTABLE: f64 = 1.1;

pub fn compare(arguments: &arguments::Compare) -> Outcome {
    let (before, after) = (Side::read(&arguments.before)?, Side::read(&arguments.after)?);
    let mut changes = Vec::new();
    if let (Some(old), Some(new)) = (&before.verdicts, &after.verdicts) {
        changes.extend(of_verdicts(old, new));
    }
    changes.extend(of_records(&before.records, &after.records));
    let failures = changes.iter().filter(|change| change.kind == NEW_FAILURE).count();
    if arguments.json {
        let all: Vec<Value> = changes
            .iter()
            .map(|c| json!({"kind": c.kind, "name": c.name, "change": c.words}))
            .collect();
        output::print_whole(&format!("{:#}\n", json!({"new_failures": failures, "changes": all})))?;
    } else {
        output::print(&in_words(&changes, &before, &after))?;
    }
    Ok(if failures > 0 { Exit::GateFailed } else { Exit::Pass })
}

const NEW_FAILURE: &str = "new failure";
const KINDS: [&str; 8] =
    [NEW_FAILURE, "verdict", "gate gone", "gate new", "value", "state", "work", "seconds"];

fn in_words(changes: &[Change], before: &Side, after: &Side) -> String {
    let shared = after.records.keys().filter(|name| before.records.contains_key(*name)).count();
    let mut text = format!(
        "{} runs before, {} after, {shared} in both\n",
        before.records.len(),
        after.records.len()
    );
    for kind in KINDS {
        let of_kind: Vec<&Change> = changes.iter().filter(|change| change.kind == kind).collect();
        if !of_kind.is_empty() {
            text += &format!("\n{kind}: {}\n", of_kind.len());
            for change in of_kind {
                text += &format!("  {}: {}\n", change.name, change.words);
            }
        }
    }
    if changes.is_empty() { text + "nothing changed\n" } else { text }
}

fn of_verdicts(old: &BTreeMap<String, Judged>, new: &BTreeMap<String, Judged>) -> Vec<Change> {
    let mut changes = Vec::new();
    let mut add = |kind, name: &str, words: String| {
        changes.push(Change { kind, name: name.to_string(), words });
    };
    let number =
        |value: Option<f64>| value.map_or("not measured".to_string(), |v| format!("{v:?}"));
    for (id, was) in old {
        let Some(is) = new.get(id) else {
            add("gate gone", id, was.judgement.verdict.to_string());
            continue;
        };
        let [from, to] = [&was.judgement, &is.judgement];
        let values = format!("{} to {}", number(from.value), number(to.value));
        if to.verdict == Verdict::Fail && from.verdict != Verdict::Fail {
            add(NEW_FAILURE, id, format!("{}; {values}; bound {}", from.verdict, is.gate.bounds()));
        } else if kind_of(&from.verdict) != kind_of(&to.verdict) {
            add("verdict", id, format!("{} to {}; {values}", from.verdict, to.verdict));
        } else if moved(is.gate.bound, from.value, to.value) {
            add("value", id, values);
        }
    }
    for (id, is) in new.iter().filter(|(id, _)| !old.contains_key(*id)) {
        let kind = if is.judgement.verdict == Verdict::Fail { NEW_FAILURE } else { "gate new" };
        add(kind, id, format!("{}; {}", is.judgement.verdict, number(is.judgement.value)));
    }
    changes
}

/// The verdict without its reason.
fn kind_of(verdict: &Verdict) -> std::mem::Discriminant<Verdict> {
    std::mem::discriminant(verdict)
}

fn moved(bound: Bound, from: Option<f64>, to: Option<f64>) -> bool {
    match (from, to) {
        (Some(from), Some(to)) => (from - to).abs() > RESOLUTION * bound.scale(),
        _ => from.is_some() != to.is_some(),
    }
}

fn of_records(old: &BTreeMap<String, Record>, new: &BTreeMap<String, Record>) -> Vec<Change> {
    let mut changes = Vec::new();
    let mut add = |kind, name: &str, words: String| {
        changes.push(Change { kind, name: name.to_string(), words });
    };
    for (name, is) in new {
        let Some(was) = old.get(name) else { continue };
        if was.state != is.state {
            let words = format!("other bits at the end ({} to {})", was.status, is.status);
            add("state", name, words);
        }
        let (from, to) = (&was.cost, &is.cost);
        if (from.steps, from.pair_interactions) != (to.steps, to.pair_interactions) {
            let words = format!(
                "{} to {} steps, {} to {} pair interactions",
                from.steps, to.steps, from.pair_interactions, to.pair_interactions
            );
            add("work", name, words);
        }
        let (Some(before), Some(after)) = (from.alone_median(), to.alone_median()) else {
            continue;
        };
        let is_other = ln(after / before).abs() > ln(NOTABLE);
        if is_other && was.manifest.is_same_machine(&is.manifest) {
            let words = format!("{before:.4} to {after:.4} s, {:.3} times", after / before);
            add("seconds", name, words);
        }
    }
    changes
}
