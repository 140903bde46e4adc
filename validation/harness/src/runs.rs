//! The records of a plan, looked up by the spec of the run.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, PoisonError};

use base::{
    gate::{Gate, Judgement, Verdict},
    record::{Record, Status},
    spec::{RunKey, RunSpec, Task},
};

use crate::planned::Planned;

/// A run of a plan with its record and its judgements.
#[derive(Clone, Debug)]
pub struct JudgedRun {
    /// What was planned.
    pub planned: Planned,
    /// The result of the run.
    pub record: Record,
    /// One judgement per gate.
    pub judged: Vec<Judged>,
}

impl JudgedRun {
    /// Judges a record by the gates of its plan.
    pub fn new(planned: Planned, record: Record) -> Self {
        let judged =
            planned.gates.iter().map(|gate| Judged::of_record(gate.clone(), &record)).collect();
        Self { planned, record, judged }
    }
}

/// A gate and its judgement.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The gate.
    pub gate: Gate,
    /// The judgement.
    pub judgement: Judgement,
}

impl Judged {
    /// Judges a value.
    pub fn new(gate: Gate, value: Option<f64>) -> Self {
        let judgement = gate.judge(value);
        Self { gate, judgement }
    }

    /// Judges the record of a run.
    pub fn of_record(gate: Gate, record: &Record) -> Self {
        let judgement = gate.judge_record(record);
        Self { gate, judgement }
    }

    /// How the verdict is shown.
    pub fn status(&self) -> report::Status {
        use report::Status;
        match self.judgement.verdict {
            Verdict::Pass => Status::Pass,
            Verdict::Fail => Status::Fail,
            Verdict::Limitation(_) => Status::Limitation,
            Verdict::ExpectedFailure => Status::ExpectedFailure,
        }
    }
}

/// The judged runs of a case. A study looks a run up by its [`RunSpec`]; one that is asked for and was not
/// planned, or of which less is measured than the study asks for, is a fault of the study, which
/// [`Runs::unplanned`] tells, so that it cannot pass in silence.
#[derive(Debug, Default)]
pub struct Runs {
    runs: Vec<JudgedRun>,
    by_key: BTreeMap<RunKey, usize>,
    unplanned: Mutex<BTreeSet<String>>,
}

impl Runs {
    /// Runs in the order of the plan.
    pub fn new(runs: Vec<JudgedRun>) -> Self {
        let key = |(k, run): (usize, &JudgedRun)| (run.planned.spec.key(), k);
        let by_key = runs.iter().enumerate().map(key).collect();
        Self { runs, by_key, unplanned: Mutex::default() }
    }

    /// All of them in the order of the plan.
    pub fn all(&self) -> &[JudgedRun] {
        &self.runs
    }

    /// The judged run of a spec.
    pub fn judged(&self, spec: &RunSpec) -> Option<&JudgedRun> {
        let found = self.by_key.get(&spec.key()).map(|k| &self.runs[*k]);
        let found = found.filter(|run| run.planned.spec.measure >= spec.measure);
        if found.is_none() {
            let mut unplanned = self.unplanned.lock().unwrap_or_else(PoisonError::into_inner);
            unplanned.insert(spec.canonical());
        }
        found
    }

    /// The record of a spec, however the run ended.
    pub fn record(&self, spec: &RunSpec) -> Option<&Record> {
        self.judged(spec).map(|run| &run.record)
    }

    /// The records of these specs, of those that were planned.
    pub fn records(&self, specs: impl IntoIterator<Item = RunSpec>) -> Vec<&Record> {
        specs.into_iter().filter_map(|spec| self.record(&spec)).collect()
    }

    /// The records of all simulations, in the order of the plan.
    pub fn simulations(&self) -> impl Iterator<Item = &Record> {
        self.runs.iter().map(|run| &run.record).filter(|record| record.task == Task::Simulate)
    }

    /// The record of a run that reached its end.
    pub fn completed(&self, spec: &RunSpec) -> Option<&Record> {
        self.record(spec).filter(|record| record.status == Status::Completed)
    }

    /// Runs that were asked for and not planned, in their canonical form.
    pub fn unplanned(&self) -> Vec<String> {
        self.unplanned.lock().unwrap_or_else(PoisonError::into_inner).iter().cloned().collect()
    }
}
