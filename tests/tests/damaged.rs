//! Judging incomplete or unexpected records must not panic.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use rayon::prelude::*;
use touchstone_base::record::{Profile, Record, Status};
use touchstone_base::spec::RunSpec;
use touchstone_cases::{CASES, page};
use touchstone_harness::{
    batch,
    case::{Case, Planned, Tier},
    context::Context,
    estimate::estimate,
    gates::GateIndex,
    make::{BatchOptions, BatchResult, Job},
    plan, suite,
};

use crate::tidy::assert_none;

/// A change of each profile of a record, and of each metric.
type Damage = (&'static str, fn(&mut Profile), fn(f64) -> Option<f64>);

const DAMAGES: [Damage; 6] = [
    ("no metrics and no columns", |profile| profile.columns.clear(), |_| None),
    ("one column", |profile| profile.columns.truncate(1), Some),
    ("empty columns", |profile| each(profile, |_, values| values.clear()), Some),
    ("columns of different lengths", |profile| each(profile, cut), Some),
    ("NaN", |profile| each(profile, |_, values| values.fill(f64::NAN)), |_| Some(f64::NAN)),
    ("infinity", |profile| each(profile, |_, v| v.fill(f64::INFINITY)), |_| Some(f64::INFINITY)),
];

fn each(profile: &mut Profile, damage: fn(usize, &mut Vec<f64>)) {
    profile.columns.iter_mut().enumerate().for_each(|(k, column)| damage(k, &mut column.values));
}

/// Later columns lose more.
fn cut(k: usize, values: &mut Vec<f64>) {
    values.truncate(values.len() / (k + 1));
}

fn damaged(record: &Record, (_, of_profile, of_metric): Damage) -> Record {
    let mut record = record.clone();
    record.profiles.values_mut().for_each(of_profile);
    record.metrics.retain(|_, metric| of_metric(metric.value).is_some());
    for metric in record.metrics.values_mut() {
        metric.value = of_metric(metric.value).unwrap_or(metric.value);
    }
    record
}

/// Simulations of a variant that are tried until one reaches its end.
const TRIED: usize = 4;

/// Runs of a case, the shortest first.
pub fn shortest_first(case: &'static dyn Case, planned: Vec<Planned>) -> Vec<Planned> {
    let mut jobs: Vec<Job> = planned.into_iter().map(|planned| Job { case, planned }).collect();
    estimate(&mut jobs, &BatchOptions::new(Tier::Quick, &|_| String::new()));
    jobs.sort_by(|a, b| a.planned.seconds.total_cmp(&b.planned.seconds));
    jobs.into_iter().map(|job| job.planned).collect()
}

/// The record of the cheapest planned run that reaches its end, of two variants of a case: of the best and of
/// the paper's, if they have one.
fn cheapest(case: &'static dyn Case) -> BTreeMap<String, Record> {
    let planned = shortest_first(case, plan::of_case(case, Tier::Quick));
    let (recommended, index) = (case.recommended(), GateIndex::of(case));
    let of = |variant: &'static str| {
        let is_one = |spec: &RunSpec| spec.variant == variant && spec.is_simulation();
        let specs = planned.iter().map(|planned| planned.spec.clone()).filter(is_one);
        let run = |spec: RunSpec| batch::run(&index, &spec.measure_all(), &Context::default()).ok();
        let mut records = specs.take(TRIED).filter_map(run);
        let record = records.find(|record| record.status == Status::Completed)?;
        Some((variant.to_string(), record))
    };
    let named = [Some(recommended.variant), recommended.papers].into_iter().flatten();
    let others = case.variants().into_iter().map(|variant| variant.name);
    named.chain(others).filter_map(of).take(2).collect()
}

/// Damaged records of a case as the records of all its runs.
fn made(
    case: &'static dyn Case,
    damage: Damage,
    records: &BTreeMap<String, Record>,
) -> BatchResult {
    let of = |planned: Planned| {
        let any = || records.values().next();
        let mut record = damaged(records.get(&planned.spec.variant).or_else(any)?, damage);
        record.run = RunSpec { measure: <_>::default(), ..planned.spec.clone() };
        Some((planned.spec.key(), record))
    };
    let records = plan::of_case(case, Tier::Quick).into_iter().filter_map(of).collect();
    BatchResult { records, ..BatchResult::default() }
}

/// Faults of judging these records: a panic, or a gate that is none.
fn faults(case: &'static dyn Case, damage: &str, made: BatchResult) -> Vec<String> {
    let tier = Tier::Quick;
    let plans = suite::plans(&[case], tier);
    let judged = catch_unwind(AssertUnwindSafe(|| {
        let suite = suite::judge(plans, tier, made);
        page::assemble(&suite, "now").html();
        let refused = suite.judged().filter_map(|of| of.judged.gate.check().err());
        refused.map(|error| error.to_string()).collect()
    }));
    let told = |panic: Box<dyn std::any::Any + Send>| -> Vec<String> {
        let words = panic.downcast_ref::<String>().cloned();
        vec![words.unwrap_or_else(|| "a panic without words".into())]
    };
    let faults: Vec<String> = judged.unwrap_or_else(told);
    faults.into_iter().map(|fault| format!("{}, {}: {fault}", case.name(), damage)).collect()
}

/// `judge` ended with 4: an index out of bounds in a study of the rings, and a bound "at most inf".
#[test]
fn no_record_makes_a_study_panic() {
    let of_case = |case: &&'static dyn Case| {
        let records = cheapest(*case);
        assert!(!records.is_empty(), "no run of {} reaches its end", case.name());
        let of = move |damage: Damage| faults(*case, damage.0, made(*case, damage, &records));
        DAMAGES.into_iter().flat_map(of).collect::<Vec<_>>()
    };
    assert_none("records of any content are judged", CASES.par_iter().flat_map(of_case).collect());
}
