//! The table of step limits describes the steps of runs.

use std::sync::{Mutex, atomic::AtomicBool};

use rayon::prelude::*;
use touchstone_base::{
    mutation::{Constant, Mutation},
    spec::RunSpec,
};
use touchstone_cases::stiffness::StiffnessRow;
use touchstone_harness::{
    case::{self, Case, PLANNED_DT},
    context::{Context, RunProgress},
    limits::{ADVISED_SHARE, Mechanism},
};

/// The step that a stopped run was driven with, the step in its record, and the first step that it made.
fn first_step(case: &dyn Case, variant: &str, fault: Option<Mutation>) -> (f64, Option<f64>, f64) {
    let (driven, stop) = (Mutex::new(f64::NAN), AtomicBool::new(true));
    let show = |progress: RunProgress| {
        if progress.time == 0.0 {
            *driven.lock().unwrap() = progress.dt;
        }
    };
    let (progress, interrupt) = (Some(&show as _), Some(&stop));
    let context = Context { progress, interrupt, allow_long: true, ..Context::default() };
    let spec = case::spec(case, variant, &[]).unwrap().allow_unstable();
    let spec = RunSpec { mutation: fault, ..spec };
    let record = case.run(&spec, &context).unwrap();
    assert_eq!(record.cost.steps, 1, "{} {variant}", case.name());
    let planned = record.numerics.get(PLANNED_DT).and_then(|dt| dt.as_f64());
    (driven.into_inner().unwrap(), planned, record.cost.largest_dt_s)
}

fn check(case: &dyn Case, row: &StiffnessRow) {
    let name = format!("{} {}", row.case, row.variant);
    let (dt, limits) = (row.rules.dt(), &row.rules.limits);
    let (driven, planned, taken) = first_step(case, row.variant, None);
    assert_eq!(driven, dt, "{name}: the step with which the run is driven");
    assert!(planned.is_none_or(|planned| planned == dt), "{name}: planned {planned:?}, not {dt}");
    assert!(taken > 0.0 && taken <= dt * (1.0 + 1e-12), "{name}: a step of {taken}, not {dt}");
    let waves = [
        Mechanism::Waves,
        Mechanism::Viscosity,
        Mechanism::ArtificialViscosity,
        Mechanism::Diffusion,
    ];
    let least =
        waves.map(|mechanism| limits.alone(mechanism)).into_iter().fold(f64::INFINITY, f64::min);
    assert!(dt <= ADVISED_SHARE * limits.together, "{name}: beyond the share that is advised");
    let is_super_stepped = limits.sweeps(1e3 * dt) > limits.sweeps(1e-3 * dt);
    assert!(limits.together <= least * (1.0 + 1e-9) || is_super_stepped, "{name}: {limits:?}");
}

/// Every variant of every case: the step of the table is the one with which its run is driven.
#[test]
fn the_step_of_the_table_is_that_of_the_run() {
    let rows = |case: &&'static dyn Case| -> Vec<(&'static dyn Case, StiffnessRow)> {
        StiffnessRow::of(*case).unwrap().into_iter().map(|row| (*case, row)).collect()
    };
    let all: Vec<_> = touchstone_cases::CASES.iter().flat_map(rows).collect();
    all.par_iter().for_each(|(case, row)| check(*case, row));
    let lacks = |case: &&&dyn Case| !all.iter().any(|(_, row)| row.case == case.name());
    let lacking: Vec<&str> =
        touchstone_cases::CASES.iter().filter(lacks).map(|case| case.name()).collect();
    assert_eq!(lacking, ["extremes"], "experiments with steps of their own have no rule");
    assert!(all.len() > 80, "{}", all.len());
}

/// A run that takes a step 1 % longer than its rules say does not pass for the step of the table.
#[test]
fn a_run_with_another_step_is_seen() {
    let case = touchstone_cases::find("taylor_green").unwrap();
    let longer = Mutation { of: Constant::TimeStep, factor: 1.01 };
    for row in StiffnessRow::of(case).unwrap() {
        let (driven, planned, _) = first_step(case, row.variant, Some(longer));
        assert_eq!(planned, Some(row.rules.dt()));
        assert_ne!(driven, row.rules.dt(), "{}", row.variant);
    }
}
