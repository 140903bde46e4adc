//! The runs of a plan, and their records, looked up by the spec of the run.

use std::{cmp::Reverse, collections::BTreeMap};

pub use touchstone_base::gate::Judged;
use touchstone_base::{
    gate::{Cause, Gate},
    record::{MetricName, Record, Status},
    spec::{RunKey, RunSpec},
};
use touchstone_report::Counts;

/// How much to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Tier {
    /// About half a minute on two cores.
    Quick,
    /// About twenty minutes.
    Full,
    /// About fifteen hours on one core, for clusters. Cases declare two tiers; the harness extends the full
    /// one, see [`Study::deepen`](crate::study::Study::deepen).
    Deep,
}

impl Tier {
    /// The tier that cases declare for this one.
    pub fn declared(self) -> Tier {
        if self == Tier::Quick { Tier::Quick } else { Tier::Full }
    }
}

/// A run of the plan and how it is judged.
#[derive(Clone, Debug)]
pub struct Planned {
    /// The run.
    pub spec: RunSpec,
    /// Judged on the record of this run.
    pub gates: Vec<Gate>,
    /// Are its seconds shown? Then it is made in the quiet phase, while this program does nothing else.
    pub timed: bool,
    /// How long it takes on one thread \[s\], by [`estimate`](crate::estimate::estimate); long runs start
    /// first, so that no core waits for the last one.
    pub seconds: f64,
    /// Whether it is large enough to benefit from threads.
    pub is_large: bool,
}

impl Planned {
    /// A run without gates.
    pub fn new(spec: RunSpec) -> Self {
        Self { spec, gates: Vec::new(), timed: false, seconds: 1.0, is_large: false }
    }

    /// This run with gates.
    pub fn judged(mut self, gates: Vec<Gate>) -> Self {
        self.gates.extend(gates);
        self
    }

    /// This run, timed.
    pub fn timed(self) -> Self {
        Self { timed: true, ..self }
    }
}

/// A run of a plan with its record and its judgements.
#[derive(Clone, Debug)]
pub struct JudgedRun {
    /// The plan.
    pub planned: Planned,
    /// The result of the run.
    pub record: Record,
    /// One judgement per gate.
    pub judged: Vec<Judged>,
    /// For a run of another code: gates that judge our own method only.
    pub not_of_others: Vec<String>,
}

/// Why a gate does not apply whose bound rests on our own method.
const NOT_OF_OTHERS: &str = "its bound follows from our own kernel, support and step, which method.json does \
                             not state (settings kernel, support, dt)";

impl JudgedRun {
    /// For a run of another code: the gates that apply, and the names of the others, each with the reason.
    /// All gates apply except those that cannot apply to any numbers of this code: a gate whose metric the
    /// numbers do not determine fails.
    pub fn applicable(&self) -> (Vec<&Judged>, Vec<(&str, String)>) {
        let absent = |judged: &Judged| {
            let absent = self.record.absent_as(&judged.gate.metric)?;
            absent.is_known_before().then(|| absent.to_string())
        };
        let (others, apply): (Vec<&Judged>, Vec<&Judged>) =
            self.judged.iter().partition(|judged| absent(judged).is_some());
        let absent = others.iter().filter_map(|one| Some((&*one.gate.id, absent(one)?)));
        let of_ours = self.not_of_others.iter().map(|id| (&**id, NOT_OF_OTHERS.to_string()));
        (apply, absent.chain(of_ours).collect())
    }

    /// Whether its plan expects that it may diverge: the run is allowed to be unstable, or no gate of it
    /// fails, such as a control.
    pub fn may_diverge(&self) -> bool {
        let fails = self.judged.iter().any(|judged| judged.judgement.verdict.is_failure());
        !fails && (self.planned.spec.allow_unstable || !self.judged.is_empty())
    }

    /// Judges a record by the gates of its plan.
    pub fn new(planned: Planned, record: Record) -> Self {
        let judged =
            planned.gates.iter().map(|gate| Judged::of_record(gate.clone(), &record)).collect();
        Self { planned, record, judged, not_of_others: Vec::new() }
    }
}

/// How many of these gates ended how.
pub fn counts<'a>(judged: impl IntoIterator<Item = &'a Judged>) -> Counts {
    let (mut verdicts, mut unexplained) = (Vec::new(), 0);
    for one in judged {
        let cause = one.gate.cause.as_ref().filter(|_| one.limitation().is_some());
        unexplained += usize::from(cause.is_some_and(|cause| cause.unexplained));
        verdicts.push(one.judgement.verdict);
    }
    Counts { unexplained, ..Counts::of(verdicts) }
}

/// The gates outside their bounds for a known reason, by cause, in order of decreasing number of gates. Gates
/// of a file without causes get a cause that states this.
pub fn by_cause<'a, T>(
    all: impl IntoIterator<Item = T>,
    judged: impl Fn(&T) -> &'a Judged,
) -> Vec<(&'a Cause, Vec<T>)> {
    static UNSTATED: Cause = Cause::new("No cause is stated.", "Stating one.");
    let mut causes: BTreeMap<&Cause, Vec<T>> = BTreeMap::new();
    for one in all.into_iter().filter(|one| judged(one).limitation().is_some()) {
        let cause = judged(&one).gate.cause.as_ref().unwrap_or(&UNSTATED);
        causes.entry(cause).or_default().push(one);
    }
    let mut causes: Vec<_> = causes.into_iter().collect();
    causes.sort_by_key(|(_, gates)| Reverse(gates.len()));
    causes
}

/// Each run once, at its first place, with all gates; timed if one of them is, and all of it measured if one
/// of them asks for all.
pub fn merged(all: Vec<Planned>) -> Vec<Planned> {
    let mut merged: Vec<Planned> = Vec::new();
    let mut places = BTreeMap::new();
    for planned in all {
        let place = *places.entry(planned.spec.key()).or_insert(merged.len());
        let Some(first) = merged.get_mut(place) else {
            merged.push(planned);
            continue;
        };
        // A run of a table occurs in the plan and in a ladder, with equal gates.
        let others = planned.gates.into_iter().filter(|gate| !first.gates.contains(gate));
        let others: Vec<Gate> = others.collect();
        first.gates.extend(others);
        first.timed |= planned.timed;
        first.spec.measure = first.spec.measure.max(planned.spec.measure);
    }
    merged
}

/// The judged runs of a case. A study looks up by its [`RunSpec`] a run that is among its
/// [`runs`](crate::study::Study::runs). To look up another run, or one with fewer measurements, is a fault
/// of the program, and panics: no page has a gap where a study reads an unplanned run.
#[derive(Debug, Default)]
pub struct Runs {
    /// All runs in the order of the plan.
    pub all: Vec<JudgedRun>,
    by_key: BTreeMap<RunKey, usize>,
    /// The runs that other codes made, as the store has them.
    pub submissions: Vec<JudgedRun>,
    /// The runs that other codes made, as the program contains them: they are shown, and decide nothing.
    pub peers: Vec<JudgedRun>,
}

impl Runs {
    /// Runs in the order of the plan.
    pub fn new(all: Vec<JudgedRun>) -> Self {
        let by_key = all.iter().enumerate().map(|(k, run)| (run.planned.spec.key(), k)).collect();
        Self { all, by_key, ..Self::default() }
    }

    /// The runs of a plan with their records, which it takes; a run without one is refused.
    pub fn of(plan: Vec<Planned>, records: &mut BTreeMap<RunKey, Record>) -> Self {
        let judged = |planned: Planned| {
            let why = || "the store has no record of this run".into();
            let record = records.remove(&planned.spec.key());
            let record = record.unwrap_or_else(|| Record::refused(&planned.spec, why()));
            JudgedRun::new(planned, record)
        };
        Self::new(plan.into_iter().map(judged).collect())
    }

    /// All runs that other codes made.
    pub fn of_others(&self) -> impl Iterator<Item = &JudgedRun> {
        self.submissions.iter().chain(&self.peers)
    }

    /// The judged run of a spec.
    pub fn judged(&self, spec: &RunSpec) -> Option<&JudgedRun> {
        let found = self.by_key.get(&spec.key()).map(|k| &self.all[*k]);
        let found = found.filter(|run| run.planned.spec.measure >= spec.measure);
        // Without a plan, a store of submissions alone is judged.
        let is_planned = found.is_some() || self.all.is_empty();
        assert!(is_planned, "a study reads what it does not plan: {}", spec.canonical());
        found
    }

    /// The record of a spec, however the run ended.
    pub fn record(&self, spec: &RunSpec) -> Option<&Record> {
        self.judged(spec).map(|run| &run.record)
    }

    /// The records of these specs, as far as planned.
    pub fn records(&self, specs: impl IntoIterator<Item = RunSpec>) -> Vec<&Record> {
        specs.into_iter().filter_map(|spec| self.record(&spec)).collect()
    }

    /// The records of all simulations, in the order of the plan.
    pub fn simulations(&self) -> impl Iterator<Item = &Record> {
        self.all.iter().map(|run| &run.record).filter(|record| record.run.is_simulation())
    }

    /// The record of a run that reached its end.
    pub fn completed(&self, spec: &RunSpec) -> Option<&Record> {
        self.record(spec).filter(|record| record.status == Status::Completed)
    }

    /// A metric of a run that reached its end; NaN if there is no such run or it was not measured.
    pub fn value(&self, spec: &RunSpec, metric: impl Into<MetricName>) -> f64 {
        let record = self.completed(spec);
        record.and_then(|record| record.value(metric)).unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use touchstone_base::gate::{Bound, Evidence, Verdict};
    use touchstone_base::record::Metric;

    use super::*;

    fn gate(metric: &str) -> Gate {
        let id = format!("made_up.{metric}");
        Gate::new(id, metric, Bound::Below(1.0), Evidence::Theory, "made up")
    }

    /// Gates of metrics that a record lacks could be dropped, and no test failed.
    #[test]
    fn a_gate_whose_metric_is_missing_fails_and_is_there() {
        let spec = RunSpec::new("made_up", "plain", serde_json::json!({}));
        let mut record = Record::new("made_up", "plain", spec.settings.clone(), 1);
        record.metrics.insert("there".into(), Metric::new(0.5, "m", "made up"));
        let planned = Planned::new(spec).judged(["there", "missing"].map(gate).to_vec());
        let run = JudgedRun::new(planned, record);
        let found: Vec<_> =
            run.judged.iter().map(|j| (&*j.gate.metric, j.judgement.verdict, &j.unit)).collect();
        let unit = Some("m".to_string());
        let expected =
            [("there", Verdict::Pass, &unit), ("missing", Verdict::Fail, &None::<String>)];
        assert_eq!(found, expected);
    }

    /// A study showed gaps, and no gate failed.
    #[test]
    #[should_panic(expected = "a study reads what it does not plan")]
    fn a_run_of_which_less_is_measured_than_a_study_reads_is_not_planned() {
        let spec = RunSpec::new("made_up", "plain", serde_json::json!({}));
        let record = Record::new("made_up", "plain", spec.settings.clone(), 1);
        let runs = Runs::new(vec![JudgedRun::new(Planned::new(spec.clone()), record)]);
        assert!(runs.record(&spec).is_some());
        runs.record(&spec.measure_all());
    }

    /// A study would measure a state that is not a result.
    #[test]
    fn a_run_that_ended_early_has_a_record_and_is_not_completed() {
        let spec = RunSpec::new("made_up", "plain", serde_json::json!({}));
        let mut record = Record::new("made_up", "plain", spec.settings.clone(), 1);
        record.status = Status::Interrupted { step: 1, time: 0.1 };
        let runs = Runs::new(vec![JudgedRun::new(Planned::new(spec.clone()), record)]);
        assert!(runs.record(&spec).is_some(), "the record is there");
        assert!(runs.completed(&spec).is_none(), "its run did not reach its end");
    }
}
