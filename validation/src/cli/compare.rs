//! `compare`: changes between two reports or two stores.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::Serialize;
use serde_json::json;
use touchstone_base::{
    files,
    functions::ln,
    gate::Verdict,
    record::{Record, Status},
    submission::MACHINE,
};
use touchstone_exchange::submission::METHOD;
use touchstone_harness::{gates::GateIndex, runs::Judged, store::Store, suite};

use super::{
    Exit, Failure, Outcome, Session, arguments, baseline, exchange,
    judged::{self, SubmissionVerdicts, VERDICTS, Verdicts},
    metrics::{self, Change, MetricChange, SHARE},
    output,
};

/// A report, whose records may be elsewhere, or a store without verdicts.
struct Side {
    verdicts: Option<BTreeMap<String, Judged>>,
    records: Option<BTreeMap<String, Record>>,
    submissions: Vec<Submitted>,
}

impl Side {
    fn read(path: &Path, session: &Session) -> Result<Self, Failure> {
        let mut submissions = Vec::new();
        let verdicts = match judged::read(path)? {
            Some(text) => {
                let file = path.join(VERDICTS);
                let all: Verdicts = serde_json::from_str(&text)
                    .map_err(|_| Failure::usage(format!("{} holds no verdicts", file.display())))?;
                let own = all.submissions.iter().filter(|of| !of.embedded).cloned();
                submissions.extend(own.map(|of| Submitted { of, record: None }));
                Some(by_name(all.judged()))
            }
            None => None,
        };
        let below = path.join("records");
        let records = match (below.is_dir(), &verdicts) {
            (true, _) => Some(Store::all(&below)?),
            (false, None) => Some(Store::all(path)?),
            (false, Some(_)) => None,
        };
        if verdicts.is_none() && records.as_ref().is_none_or(Vec::is_empty) {
            let words = format!("{} is neither a report nor a store", path.display());
            return Err(Failure::usage(words));
        }
        let name = |r: Record| (format!("{} {} {}", r.run.case, r.run.variant, r.run.key()), r);
        let records = records.map(|records| {
            let (others, ours): (Vec<Record>, Vec<Record>) =
                records.into_iter().partition(|record| record.run.submission.is_some());
            others.into_iter().for_each(|record| add(&mut submissions, record, session));
            ours.into_iter().map(name).collect()
        });
        Ok(Self { verdicts, records, submissions })
    }
}

fn by_name<'a>(all: impl Iterator<Item = &'a Judged>) -> BTreeMap<String, Judged> {
    all.map(|judged| (judged.gate.id.clone(), judged.clone())).collect()
}

/// A run of another code: how it was judged, and its record.
struct Submitted {
    of: SubmissionVerdicts,
    record: Option<Record>,
}

/// Adds a record to the verdicts on it, or judges it where they are missing.
fn add(all: &mut Vec<Submitted>, record: Record, session: &Session) {
    let key = record.run.key().to_string();
    if let Some(known) = all.iter_mut().find(|known| known.of.key == key) {
        known.record = Some(record);
        return;
    }
    let judged = verdicts(&record, session);
    all.extend(judged.map(|of| Submitted { of, record: Some(record) }));
}

/// The verdicts on a run of another code, if its case is known.
fn verdicts(record: &Record, session: &Session) -> Option<SubmissionVerdicts> {
    let case = session.cases.iter().find(|case| case.name() == record.run.case)?;
    let run = suite::submitted(&GateIndex::of(*case), record.clone());
    SubmissionVerdicts::of(*case, &run, false)
}

/// The verdicts on one submission: in its folder, its record or the output of `submit --json`. None of a
/// folder of something else.
///
/// # Errors
/// If the submission is refused, or a file has none.
fn submission(path: &Path, session: &Session) -> Result<Option<SubmissionVerdicts>, Failure> {
    if path.join(METHOD).exists() {
        let (_, record) = exchange::measured(None, path, &Default::default(), session)?;
        return Ok(verdicts(&record, session));
    }
    if !path.is_file() {
        return Ok(None);
    }
    let of_record = match baseline::read(path) {
        Ok(record) => verdicts(&record, session),
        Err(_) => None,
    };
    let text = || files::read_text(path, baseline::MOST_BYTES).ok();
    let found = of_record.or_else(|| serde_json::from_str(&text()?).ok());
    let none =
        || format!("{} is neither a record nor the output of `submit --json`", path.display());
    found.map(Some).ok_or_else(|| Failure::usage(none()))
}

/// Compares all metrics of two submissions of one problem, and the verdicts on them.
fn of_two(
    [was, is]: [&SubmissionVerdicts; 2],
    arguments: &arguments::Compare,
    session: &Session,
) -> Outcome {
    let [before, after] = [was, is].map(SubmissionVerdicts::problem);
    if before != after {
        let words = format!("the submissions solve two problems: {before}, and {after}");
        return Err(Failure::usage(words));
    }
    let case = touchstone_cases::find_in(session.cases, &is.case)?;
    let gates = is.judged.iter().map(|of| &of.gate);
    let metrics = metrics::changes(Some(&GateIndex::of(case)), gates, [&was.metrics, &is.metrics]);
    let [old, new] = [was, is].map(|of| by_name(of.judged.iter()));
    let mut changes = paired(&old, &new, |_, was, is| of_gate(was, is));
    changes.retain(|change| !change.kind.is_of_value()); // the table has the values
    changes.sort_by_key(|change| change.kind);
    let gone = metrics.iter().filter(|of| of.change == Change::Gone).count();
    let losses = gone + changes.iter().filter(|change| change.kind.is_loss()).count();
    let failures = changes.iter().filter(|change| change.kind == ChangeKind::Failing).count();
    let json = || {
        json!({
            "problem": after, "before": was.submission, "after": is.submission, "metrics": metrics,
            "new_failures": failures, "losses": losses, "changes": changes,
        })
    };
    let text = || {
        let ended = |of: &SubmissionVerdicts| format!("{}, {}", of.submission, of.status);
        let head = format!("{after}\nbefore  {}\nnow     {}\n\n", ended(was), ended(is));
        head + &metrics::table(&metrics) + &of_kinds(&changes)
    };
    output::answer(arguments.json, json, text)?;
    Ok(if losses > 0 { Exit::GateFailed } else { Exit::Pass })
}

impl Submitted {
    /// Version and digests, by which two runs of one code differ.
    fn who(&self) -> String {
        let by = &self.of.submission;
        let first = |digest: &str| digest.chars().take(12).collect::<String>();
        let results = by.results.as_deref().map_or("unknown".into(), first);
        format!("version {}, method {}, results {results}", by.version, first(&by.method))
    }

    /// Changes of gates and metrics against the earlier run of the code.
    fn changes(&self, was: Option<&Self>, cases: &Cases) -> Vec<VerdictChange> {
        let name = self.of.name();
        let gates = |of: &Self| by_name(of.of.judged.iter());
        let old = was.map(gates).unwrap_or_default();
        let mut changes = paired(&old, &gates(self), |_, was, is| of_gate(was, is));
        changes.iter_mut().for_each(|change| change.name += &format!(" of {name}"));
        let mut add = |kind, words| changes.push(VerdictChange { kind, name: name.clone(), words });
        match was {
            None => add(ChangeKind::New, self.who()),
            Some(was) if was.of.key != self.of.key => {
                add(ChangeKind::State, format!("{} to {}", was.who(), self.who()));
            }
            Some(_) => {}
        }
        if let Some((was, is)) = was.and_then(|was| was.record.as_ref().zip(self.record.as_ref())) {
            let gates = self.of.judged.iter().map(|of| &of.gate);
            let case = cases.get(&*is.run.case);
            let metrics = metrics::changes(case, gates, [&was.metrics, &is.metrics]);
            of_both(was, is, &metrics).into_iter().for_each(|(kind, words)| add(kind, words));
        }
        changes
    }
}

/// The changes of runs of other codes. A run is compared with the run of equal results or, without one, with
/// a run of the same code, scheme and problem, in any version.
fn of_submissions(old: &[Submitted], new: &[Submitted], cases: &Cases) -> Vec<VerdictChange> {
    let is_same = |a: &Submitted, b: &Submitted| a.of.key == b.of.key;
    let was = |is: &Submitted| {
        let alike = || old.iter().find(|was| was.of.name() == is.of.name());
        old.iter().find(|was| is_same(was, is)).or_else(alike)
    };
    let mut changes: Vec<VerdictChange> =
        new.iter().flat_map(|is| is.changes(was(is), cases)).collect();
    let is_there =
        |was: &Submitted| new.iter().any(|is| is_same(was, is) || was.of.name() == is.of.name());
    let gone = |was: &Submitted| VerdictChange {
        kind: ChangeKind::Gone,
        name: was.of.name(),
        words: was.who(),
    };
    changes.extend(old.iter().filter(|was| !is_there(was)).map(gone));
    changes
}

/// Kinds of changes, the worst first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
enum ChangeKind {
    /// A gate that did not fail.
    Failing,
    /// A run that was completed.
    Stopped,
    /// A gate, a run or metrics of one.
    Gone,
    /// Metrics or numbers of gates, further outside their bounds.
    Worse,
    /// Metrics or numbers of gates, if no gate states which direction is better.
    Changed,
    Verdict,
    Status,
    New,
    /// Metrics or numbers of gates, further inside their bounds.
    Better,
    State,
    Work,
    Seconds,
}

impl ChangeKind {
    /// Does something fail that did not, or is something not known any more that was?
    fn is_loss(self) -> bool {
        self <= Self::Gone
    }

    fn is_of_value(self) -> bool {
        matches!(self, Self::Worse | Self::Changed | Self::Better)
    }

    /// The kind of a change of a metric; `None` for an unchanged one.
    fn of(change: Change) -> Option<Self> {
        Some(match change {
            Change::Same => return None,
            Change::Better => Self::Better,
            Change::New => Self::New,
            Change::Changed => Self::Changed,
            Change::Worse => Self::Worse,
            Change::Gone => Self::Gone,
        })
    }
}

/// A change of one gate or run, in words and as data.
#[derive(Serialize)]
struct VerdictChange {
    kind: ChangeKind,
    name: String,
    #[serde(rename = "change")]
    words: String,
}

/// Changes of seconds by more than this factor are reported.
const NOTABLE: f64 = 1.1;

/// Number of metrics of a run that are named.
const MOST_SHOWN: usize = 3;

pub fn compare(arguments: &arguments::Compare, session: &Session) -> Outcome {
    let (before, after) =
        (submission(&arguments.before, session)?, submission(&arguments.after, session)?);
    match (before, after) {
        (Some(before), Some(after)) => return of_two([&before, &after], arguments, session),
        (None, None) => {}
        _ => {
            let words = "one is a submission and the other is not; expected two submissions, or two reports \
                         or stores";
            return Err(Failure::usage(words));
        }
    }
    let (before, after) =
        (Side::read(&arguments.before, session)?, Side::read(&arguments.after, session)?);
    let mut changes = Vec::new();
    match (&before.verdicts, &after.verdicts) {
        (Some(old), Some(new)) => changes.extend(paired(old, new, |_, was, is| of_gate(was, is))),
        (None, None) => {}
        _ => {
            let words =
                "one has verdicts, the other only records; touchstone verify --no-runs makes them";
            output::say(&format!("note: no gates are compared: {words}"));
        }
    }
    let cases: Cases =
        session.cases.iter().map(|case| (case.name(), GateIndex::of(*case))).collect();
    match (&before.records, &after.records) {
        (Some(old), Some(new)) => {
            changes.extend(paired(old, new, |_, was, is| of_run(was, is, &cases)));
        }
        (None, None) => {}
        _ => output::say("note: no runs are compared: only one of the reports holds its records"),
    }
    changes.extend(of_submissions(&before.submissions, &after.submissions, &cases));
    changes.sort_by_key(|change| change.kind);
    let count =
        |of: fn(ChangeKind) -> bool| changes.iter().filter(|change| of(change.kind)).count();
    let (losses, failures) =
        (count(ChangeKind::is_loss), count(|kind| kind == ChangeKind::Failing));
    let json = || json!({"new_failures": failures, "losses": losses, "changes": changes});
    output::answer(arguments.json, json, || in_words(&changes, &before, &after))?;
    Ok(if losses > 0 { Exit::GateFailed } else { Exit::Pass })
}

/// The gates of cases, by name.
type Cases = BTreeMap<&'static str, GateIndex<'static>>;

fn in_words(changes: &[VerdictChange], before: &Side, after: &Side) -> String {
    let mut text = String::new();
    if let (Some(old), Some(new)) = (&before.records, &after.records) {
        let shared = new.keys().filter(|name| old.contains_key(*name)).count();
        let before = touchstone_report::counted(old.len(), "run", "runs");
        text += &format!("{before} before, {} after, {shared} in both\n", new.len());
    }
    let [old, new] = [before, after].map(|side| side.submissions.len());
    if old + new > 0 {
        text += &format!("runs of other codes: {old} before, {new} after\n");
    }
    text += &of_kinds(changes);
    if changes.is_empty() { text + "nothing changed\n" } else { text }
}

/// Sorted changes, below a line for each kind.
fn of_kinds(changes: &[VerdictChange]) -> String {
    let mut text = String::new();
    for of_kind in changes.chunk_by(|a, b| a.kind == b.kind) {
        let kind = format!("{:?}", of_kind[0].kind).to_lowercase();
        text += &format!("\n{kind}: {}\n", of_kind.len());
        of_kind.iter().for_each(|change| text += &format!("  {}: {}\n", change.name, change.words));
    }
    text
}

/// The changes of items with a name in either or both.
fn paired<T>(
    old: &BTreeMap<String, T>,
    new: &BTreeMap<String, T>,
    of: impl Fn(&str, Option<&T>, Option<&T>) -> Vec<(ChangeKind, String)>,
) -> Vec<VerdictChange> {
    let mut changes = Vec::new();
    for name in old.keys().chain(new.keys()).collect::<BTreeSet<_>>() {
        let found = of(name, old.get(name), new.get(name)).into_iter();
        changes.extend(found.map(|(kind, words)| VerdictChange {
            kind,
            name: name.clone(),
            words,
        }));
    }
    changes
}

fn of_gate(was: Option<&Judged>, is: Option<&Judged>) -> Vec<(ChangeKind, String)> {
    let number =
        |value: Option<f64>| value.map_or("not measured".to_string(), |v| format!("{v:?}"));
    let fails = |judged: &Judged| judged.judgement.verdict == Verdict::Fail;
    let (was, is) = match (was, is) {
        (Some(was), Some(is)) => (was, is),
        (was, None) => return was.map(|was| (ChangeKind::Gone, was.words())).into_iter().collect(),
        (None, Some(is)) => {
            let kind = if fails(is) { ChangeKind::Failing } else { ChangeKind::New };
            return vec![(kind, format!("{}; {}", is.words(), number(is.judgement.value)))];
        }
    };
    let [from, to] = [&was.judgement, &is.judgement];
    let values = format!("{} to {}", number(from.value), number(to.value));
    if fails(is) && !fails(was) {
        vec![(
            ChangeKind::Failing,
            format!("{}; {values}; bound {}", was.words(), is.gate.bounds()),
        )]
    } else if from.verdict != to.verdict {
        vec![(ChangeKind::Verdict, format!("{} to {}; {values}", was.words(), is.words()))]
    } else {
        let [before, now] = [from, to].map(|of| of.value.unwrap_or(f64::NAN));
        let bound = is.gate.bound;
        let change = Change::of(Some(bound), before, now, SHARE * bound.scale());
        ChangeKind::of(change).map(|kind| (kind, values)).into_iter().collect()
    }
}

fn of_run(was: Option<&Record>, is: Option<&Record>, cases: &Cases) -> Vec<(ChangeKind, String)> {
    let status = |kind, record: &Record| vec![(kind, format!("the run, {}", record.status))];
    match (was, is) {
        (Some(was), Some(is)) => {
            let case = cases.get(&*is.run.case);
            let gates = case.map(|case| case.gates(&is.spec())).unwrap_or_default();
            of_both(was, is, &metrics::changes(case, &gates, [&was.metrics, &is.metrics]))
        }
        (was, None) => was.map_or(Vec::new(), |was| status(ChangeKind::Gone, was)),
        (None, Some(is)) => status(ChangeKind::New, is),
    }
}

/// The changes of a run with these changes of its metrics.
fn of_both(was: &Record, is: &Record, metrics: &[MetricChange]) -> Vec<(ChangeKind, String)> {
    let mut changes = Vec::new();
    let statuses = format!("{} to {}", was.status, is.status);
    if was.status != is.status {
        let is_worse = was.status == Status::Completed;
        let kind = if is_worse { ChangeKind::Stopped } else { ChangeKind::Status };
        changes.push((kind, statuses.clone()));
    }
    changes.extend(of_metrics(was, is, metrics));
    if was.state != is.state {
        changes.push((ChangeKind::State, format!("other bits at the end ({statuses})")));
    }
    let (from, to) = (&was.cost, &is.cost);
    if (from.steps, from.pair_interactions) != (to.steps, to.pair_interactions) {
        let words = format!(
            "{} to {} steps, {} to {} pair interactions",
            from.steps, to.steps, from.pair_interactions, to.pair_interactions
        );
        changes.push((ChangeKind::Work, words));
    }
    if let Some((before, after)) = from.alone_median().zip(to.alone_median())
        && ln(after / before).abs() > ln(NOTABLE)
        && was.manifest.is_same_machine(&is.manifest)
        && was.numerics.get(MACHINE) == is.numerics.get(MACHINE)
    {
        let words = format!("{before:.4} to {after:.4} s, {:.3} times", after / before);
        changes.push((ChangeKind::Seconds, words));
    }
    changes
}

/// One change for each kind of change of metrics, with the first [`MOST_SHOWN`] metrics.
fn of_metrics(
    was: &Record,
    is: &Record,
    metrics: &[MetricChange],
) -> impl Iterator<Item = (ChangeKind, String)> {
    let words = |MetricChange { metric, before, now, change, .. }: &MetricChange| {
        let lacking = if now.is_none() { is } else { was };
        match (before, now, lacking.absent.get(metric)) {
            (Some(_), Some(_), _) if *change == Change::Gone => {
                format!("{metric} {}", change.in_words(true))
            }
            (Some(before), Some(now), _) => format!("{metric} {before:?} to {now:?}"),
            (.., Some(why)) => format!("{metric} ({why})"),
            (.., None) => metric.clone(),
        }
    };
    let mut shown = BTreeMap::<ChangeKind, Vec<String>>::new();
    for of in metrics {
        let kind = ChangeKind::of(of.change).map(|kind| shown.entry(kind).or_default());
        kind.into_iter().for_each(|all| all.push(words(of)));
    }
    shown.into_iter().map(|(kind, all)| {
        let shown = all[..all.len().min(MOST_SHOWN)].join(", ");
        let more = all.len().saturating_sub(MOST_SHOWN);
        (kind, if more == 0 { shown } else { format!("{shown} and {more} more") })
    })
}

#[cfg(test)]
mod tests {
    use touchstone_base::absent::Absent;
    use touchstone_base::gate::{Bound, Evidence, Gate};
    use touchstone_base::record::{Metric, MetricKey};

    use super::*;

    const L2: MetricKey = MetricKey::new("l2", "-", "staged");
    const DRIFT: MetricKey = MetricKey::new("drift", "-", "staged");

    /// Runs 0 to 2 with the metrics `l2` and `drift`.
    fn records() -> BTreeMap<String, Record> {
        let record = |k: usize| {
            let mut record = Record::new("c", "v", json!({ "k": k }), 1);
            record.put(L2, 0.1);
            record.put(DRIFT, 1e-9);
            record.state = Some("same".into());
            record.cost.alone_s = vec![1.0];
            record.manifest.cpu = "staged".into();
            (k.to_string(), record)
        };
        (0..3).map(record).collect()
    }

    /// The changes of a run, whose `l2` has a gate of at most 0.5 and whose `drift` has none.
    fn of_run(was: Option<&Record>, is: Option<&Record>) -> Vec<(ChangeKind, String)> {
        let (Some(was), Some(is)) = (was, is) else {
            return super::of_run(was, is, &Cases::new());
        };
        let gate = Gate::new("c.l2", "l2", Bound::Below(0.5), Evidence::Theory, "staged");
        let metrics = metrics::changes(None, [&gate], [&was.metrics, &is.metrics]);
        of_both(was, is, &metrics)
    }

    /// The changes after something was done to the record of run 1.
    fn changes(change: impl Fn(&mut Record)) -> Vec<(ChangeKind, String)> {
        let old = records();
        let mut new = old.clone();
        change(new.get_mut("1").expect("run 1"));
        let changes = paired(&old, &new, |_, was, is| of_run(was, is)).into_iter();
        changes.map(|change| (change.kind, format!("{}: {}", change.name, change.words))).collect()
    }

    #[track_caller]
    fn one(change: impl Fn(&mut Record), kind: ChangeKind, words: &str) {
        assert_eq!(changes(change), [(kind, format!("1: {words}"))]);
    }

    /// 87 records with all metrics 123.0 must not count as unchanged.
    #[test]
    fn a_metric_that_moved_by_more_than_the_resolution_of_its_gate_is_told() {
        assert_eq!(changes(|_| ()), []);
        assert_eq!(changes(|record| record.put(L2, 0.1049)), [], "0.98 % of the bound 0.5");
        one(|record| record.put(L2, 0.1051), ChangeKind::Worse, "l2 0.1 to 0.1051");
        one(|record| record.put(L2, 123.0), ChangeKind::Worse, "l2 0.1 to 123.0");
        one(|record| record.put(L2, f64::NAN), ChangeKind::Worse, "l2 0.1 to NaN");
        assert_eq!(changes(|record| record.put(DRIFT, 1.009e-9)), [], "0.9 % of itself");
        one(|record| record.put(DRIFT, 1.02e-9), ChangeKind::Changed, "drift 1e-9 to 1.02e-9");
        let all = |record: &mut Record| {
            record.metrics.values_mut().for_each(|metric| metric.value = 123.0);
        };
        let shown = ["1: l2 0.1 to 123.0", "1: drift 1e-9 to 123.0"].map(String::from);
        let kinds = [ChangeKind::Worse, ChangeKind::Changed];
        assert!(changes(all).into_iter().eq(kinds.into_iter().zip(shown)));
        one(|record| record.put(L2, 0.01), ChangeKind::Better, "l2 0.1 to 0.01");
    }

    #[test]
    fn a_metric_that_vanished_or_came_is_told_with_its_reason() {
        let gone = |record: &mut Record| {
            record.metrics.remove("l2");
            record.absent.insert("l2".into(), Absent::because("no reference"));
        };
        one(gone, ChangeKind::Gone, "l2 (no reference)");
        one(|record| record.metrics.clear(), ChangeKind::Gone, "drift, l2");
        let new = |record: &mut Record| record.put(MetricKey::new("new", "-", "staged"), 1.0);
        one(new, ChangeKind::New, "new");
        let other = |record: &mut Record| {
            record.metrics.insert("l2".into(), Metric::new(0.1, "-", "of another norm"));
        };
        one(other, ChangeKind::Gone, "l2 has another unit or formula");
        assert!(ChangeKind::Gone.is_loss() && !ChangeKind::New.is_loss());
    }

    #[test]
    fn a_run_that_vanished_or_ended_otherwise_is_told() {
        let old = records();
        let mut new = old.clone();
        new.remove("1");
        for (from, to, kind) in [(&old, &new, ChangeKind::Gone), (&new, &old, ChangeKind::New)] {
            let found = paired(from, to, |_, was, is| of_run(was, is));
            let found: Vec<_> = found.iter().map(|c| (c.kind, c.name.as_str())).collect();
            assert_eq!(found, [(kind, "1")]);
        }
        let refused = |record: &mut Record| record.status = Status::Refused { reason: "x".into() };
        one(refused, ChangeKind::Stopped, "completed to refused: x");
        assert!(
            ChangeKind::Gone.is_loss()
                && ChangeKind::Stopped.is_loss()
                && !ChangeKind::New.is_loss()
        );
    }

    /// Slower and faster runs are both reported.
    #[test]
    fn seconds_work_and_bits_are_told() {
        one(|r| r.cost.alone_s = vec![0.8], ChangeKind::Seconds, "1.0000 to 0.8000 s, 0.800 times");
        one(|r| r.cost.alone_s = vec![1.2], ChangeKind::Seconds, "1.0000 to 1.2000 s, 1.200 times");
        assert_eq!(changes(|record| record.cost.alone_s = vec![1.09]), []);
        let elsewhere = |record: &mut Record| {
            record.cost.alone_s = vec![3.0];
            record.manifest.cpu = "another".into();
        };
        assert_eq!(changes(elsewhere), [], "seconds of another machine say nothing");
        one(|r| r.cost.steps = 7, ChangeKind::Work, "0 to 7 steps, 0 to 0 pair interactions");
        let other = "other bits at the end (completed to completed)";
        one(|record| record.state = Some("other".into()), ChangeKind::State, other);
    }

    /// `compare` must not end with 0 when all gates are missing.
    #[test]
    fn a_gate_that_is_gone_or_fails_is_a_loss() {
        let judged = |value: f64| {
            let gate = Gate::new("c.l2", "l2", Bound::Below(0.5), Evidence::Theory, "staged");
            let judged = Judged::new(gate, Some(value));
            BTreeMap::from([("c.l2".to_string(), judged)])
        };
        let kinds = |old: &BTreeMap<_, _>, new: &BTreeMap<_, _>| -> Vec<ChangeKind> {
            paired(old, new, |_, was, is| of_gate(was, is))
                .iter()
                .map(|change| change.kind)
                .collect()
        };
        assert_eq!(kinds(&judged(0.1), &BTreeMap::new()), [ChangeKind::Gone]);
        assert_eq!(kinds(&BTreeMap::new(), &judged(0.1)), [ChangeKind::New]);
        assert_eq!(kinds(&BTreeMap::new(), &judged(0.6)), [ChangeKind::Failing]);
        assert_eq!(kinds(&judged(0.1), &judged(0.6)), [ChangeKind::Failing]);
        assert_eq!(kinds(&judged(0.6), &judged(0.1)), [ChangeKind::Verdict]);
        assert_eq!(kinds(&judged(0.1), &judged(0.1049)), [], "0.98 % of the bound");
        assert_eq!(kinds(&judged(0.1), &judged(0.1051)), [ChangeKind::Worse]);
        assert!(
            ChangeKind::Gone.is_loss()
                && ChangeKind::Failing.is_loss()
                && !ChangeKind::Worse.is_loss()
        );
    }
}
