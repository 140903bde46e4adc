//! Runs and what must come of them: the rows of a table of gates.

use base::{
    record::{MetricKey, Record, Status},
    spec::RunSpec,
};
use harness::{
    extremes::{self, Entry},
    planned::Planned,
    runs::Runs,
    study::Study,
};

/// What the records of some runs must show.
type Judge = Box<dyn Fn(&[&Record]) -> Vec<Entry>>;

/// Runs and what they must show.
pub struct Experiment {
    runs: Vec<RunSpec>,
    /// Roughly how long one of them takes \[s\].
    seconds: f64,
    judge: Judge,
}

impl Experiment {
    /// What these runs must show; `judge` is given their records in the same order.
    pub fn new(
        runs: Vec<RunSpec>,
        seconds: f64,
        judge: impl Fn(&[&Record]) -> Vec<Entry> + 'static,
    ) -> Self {
        Self { runs, seconds, judge: Box::new(judge) }
    }

    /// What one run must show.
    pub fn of(run: RunSpec, seconds: f64, judge: impl Fn(&Record) -> Entry + 'static) -> Self {
        let judge = move |records: &[&Record]| records.iter().map(|one| judge(one)).collect();
        Self::new(vec![run], seconds, judge)
    }
}

/// A metric, of a run that reached its end; the words say more of it.
pub fn measured(entry: Entry, record: &Record, metric: MetricKey, more: &str) -> Entry {
    match completed(record, metric) {
        Some(value) => entry.found(value, format!("{}{more}", sci(value))),
        None => entry.found(f64::NAN, record.status.to_string()),
    }
}

/// The runs of some experiments.
pub fn plan(experiments: Vec<Experiment>) -> Vec<Planned> {
    let planned = |Experiment { runs, seconds, .. }: Experiment| {
        runs.into_iter().map(move |run| Planned::new(run).taking(seconds))
    };
    experiments.into_iter().flat_map(planned).collect()
}

/// The table of some experiments with its gates; one whose runs are not in the plan has none.
pub fn study(
    [id, title]: [&str; 2],
    lead: &str,
    experiments: Vec<Experiment>,
    runs: &Runs,
) -> Study {
    let of = |experiment: &Experiment| {
        let records: Option<Vec<&Record>> =
            experiment.runs.iter().map(|spec| runs.record(spec)).collect();
        records.map_or(Vec::new(), |records| (experiment.judge)(&records))
    };
    extremes::study(id, title, lead, experiments.iter().flat_map(of).collect())
}

/// A metric of a run that reached its end.
pub fn completed(record: &Record, metric: MetricKey) -> Option<f64> {
    if record.status == Status::Completed { record.value(metric) } else { None }
}

/// A number as in tables, a dash if there is none.
pub fn sci(x: impl Into<Option<f64>>) -> String {
    x.into().map_or("–".into(), |x| report::sci(x, 3))
}
