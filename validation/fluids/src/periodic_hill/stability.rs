//! How far the flow over hills can be pushed: the time step against theory, and the Reynolds number.

use rayon::prelude::*;

use super::{NAME, plan::BEST, studies::shown};
use base::{
    gate::{Bound, Evidence, Gate},
    record::{Record, Status},
};
use harness::{bisect::largest_stable, case::Case, runner::Context, suite::Study};
use report::{Cell, Column, Table};

/// Spacings along the height of the hill in all of these runs.
const N: usize = 10;

/// Variant, and its longest stable step over the default one when this study was introduced: not the
/// truth, but the margin must not shrink unnoticed.
const MARGINS: [(&str, f64); 3] = [("modern", 1.577), (BEST, 1.577), ("consistent", 1.577)];

/// Resolution of the bisection, relative to the theoretical limit.
const RESOLUTION: f64 = 0.02;

/// Variant and the Reynolds number it is tried at. 1000 is the most that the setting allows, and all but
/// `plain` hold it: lower ones would say nothing more. `plain` is a control, tried at the lowest alone.
const TRIED: [(&str, f64); 6] = [
    ("plain", 10.0),
    ("interface-wall", 1000.0),
    ("modern", 1000.0),
    (BEST, 1000.0),
    ("mixed", 1000.0),
    ("consistent", 1000.0),
];

/// End of these runs \[H/U_b\]: the flux has filled the period 0.96 times. `plain` diverges before.
const TRIED_TO: f64 = 12.0;

fn run(case: &dyn Case, variant: &str, set: &[String]) -> Option<Record> {
    let context = Context { allow_unstable: true, ..Context::default() };
    let mut all = vec![format!("n={N}")];
    all.extend_from_slice(set);
    case.run(variant, &all, &context).ok()
}

/// Ended, and no sample of the kinetic energy is above twice that of the start, which is near the answer.
fn is_stable(record: &Record) -> bool {
    let energy = record.column("series", "kinetic energy");
    let bounded = |first: &f64| energy.iter().all(|e| *e <= 2.0 * first);
    record.status == Status::Completed && energy.first().is_some_and(bounded)
}

/// Default step and longest stable one, over the theoretical limit.
fn longest(case: &dyn Case, variant: &str) -> [f64; 2] {
    let short = run(case, variant, &["end=0.05".into()]);
    let [courant, default] =
        short.map_or([f64::NAN; 2], |r| [r.setting("courant"), r.chose("dt/limit")]);
    // The step is proportional to the Courant number: the viscous limit is ten times as far at Re 50.
    let stable = |of_theory: f64| {
        let courant = format!("courant={}", courant * of_theory / default);
        let set = ["from_reference=true".into(), courant, "end=3".into()];
        run(case, variant, &set).is_some_and(|record| is_stable(&record))
    };
    let bracket = largest_stable(1.0, RESOLUTION, stable);
    [default, bracket.map_or(f64::NAN, |b| b.stable)]
}

/// The longest stable step over the theoretical one, by bisection.
pub fn limits(case: &'static dyn Case) -> Study {
    let columns = vec![
        Column::text("variant"),
        Column::num("measured/theory", "-"),
        Column::num("default/theory", "-"),
        Column::num("measured/default", "-"),
    ];
    let caption = "The longest time step with which the flow at Re 50, H/dx = 10, goes on for 3 H/U_b from \
                   the interpolated reference without diverging or doubling its kinetic energy, by bisection \
                   to 2 %, over the limit of linear theory for a periodic lattice at rest. Walls, curvature \
                   and particles in disorder are not in that theory. Of six variants three: one each with \
                   sums over pairs, with shifted velocities and with consistent sums; `plain`, \
                   `interface-wall` and `mixed` were not tried.";
    let mut table = Table::new(caption, columns);
    let mut study = Study::new("periodic-hill-time-step", "Largest stable time step");
    let found: Vec<[f64; 2]> =
        MARGINS.par_iter().map(|(variant, _)| longest(case, variant)).collect();
    for ((variant, margin), [default, measured]) in MARGINS.into_iter().zip(found) {
        table = table.row(vec![
            Cell::text(format!("`{variant}`")),
            Cell::num(measured, 3),
            Cell::num(default, 3),
            Cell::num(measured / default, 3),
        ]);
        let gate = |what: &str, metric: &str, bound: Bound, evidence: Evidence, because: &str| {
            Gate::new(format!("{NAME}.step.{variant}.{what}"), metric, bound, evidence, because)
        };
        let theory = gate(
            "theory",
            "measured/theory",
            Bound::Within(default, 1.2),
            Evidence::Theory,
            "the default must be stable, and nothing in disorder makes sound slower or the stencil softer by \
             a fifth: a limit far above that of the lattice would be a wrong theory",
        );
        let kept = gate(
            "margin",
            "longest stable dt/default dt",
            Bound::Above(margin - RESOLUTION / default),
            Evidence::Regression,
            "what was measured when this study was introduced, less the resolution of the bisection",
        );
        study = study.judge(theory, measured).judge(kept, measured / default);
    }
    study.block(table)
}

/// Completed, no particle behind a wall, and the force that holds the flux is one against a drag.
fn holds(record: &Record) -> bool {
    record.status == Status::Completed
        && record.measured("outside") == 0.0
        && record.measured("force") > 0.0
}

/// A Reynolds number that variants hold.
pub fn reynolds(case: &'static dyn Case) -> Study {
    let columns = vec![
        Column::text("variant"),
        Column::num("Re", "-"),
        Column::num("U_b dx/ν", "-"),
        Column::text("ended"),
        Column::num("outside", "1"),
        Column::num("force", "U_b^2/H"),
        Column::num("ripple of it", "-"),
        Column::num("flux of sections", "-"),
        Column::num("windows differ by", "U_b"),
    ];
    let caption = format!(
        "Every variant at the highest Reynolds number that the setting allows, 1000, a lower bound of what \
         it holds, and `plain` at 10, the lowest tried: H/dx = 10, from rest to {TRIED_TO} H/U_b. A variant \
         holds a Reynolds number if its run completes with no particle behind a wall and a force along the \
         flow. Force, ripple and flux are of the last {window} H/U_b; windows differ by: rms over ten \
         stations of the change of mean u from the {window} H/U_b before them. The flow still develops \
         then, and these numbers say nothing of its accuracy.",
        window = TRIED_TO / 5.0,
    );
    let mut table = Table::new(caption, columns);
    let mut study = Study::new("periodic-hill-reynolds", "Highest Reynolds number");
    let tried = |(variant, re): &(&str, f64)| {
        run(case, variant, &[format!("re={re}"), format!("end={TRIED_TO}")])
    };
    let found: Vec<_> = TRIED.par_iter().map(tried).collect();
    for ((variant, re), record) in TRIED.into_iter().zip(found) {
        table = record.iter().fold(table, |table, record| table.row(row(variant, re, record)));
        let held = if record.is_some_and(|record| holds(&record)) { re } else { 0.0 };
        let gate = Gate::new(
            format!("{NAME}.highest_re.{variant}"),
            "highest Re held",
            Bound::Above(re),
            Evidence::Regression,
            "what was measured to 20 H/U_b when this study was introduced must not fall, here to 12 for \
             time. Without shifting and density diffusion not even Re 10, the lowest tried, is held, a \
             control",
        );
        let gate = if variant == "plain" { gate.expected_to_fail() } else { gate };
        study = study.judge(gate, held);
    }
    study.block(table)
}

fn row(variant: &str, re: f64, record: &Record) -> Vec<Cell> {
    let ended = match &record.status {
        Status::Completed => "completed".to_string(),
        Status::Diverged { time, field, .. } => format!("diverged at {time:.1} H/U_b: {field}"),
        _ => "interrupted".into(),
    };
    vec![
        Cell::text(format!("`{variant}`")),
        Cell::exact(re),
        Cell::num(re / N as f64, 2),
        Cell::text(ended),
        shown(record, "outside", |v| Cell::count(v as u64)),
        shown(record, "force", |v| Cell::num(v, 3)),
        shown(record, "force_ripple", |v| Cell::percent(v, 1)),
        shown(record, "section_flux", |v| Cell::percent(v, 1)),
        shown(record, "drift", |v| Cell::sci(v, 1)),
    ]
}
