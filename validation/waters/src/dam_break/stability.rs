//! How far the collapse can be pushed: the time step against theory, the sound speed, and settings far
//! outside of the usual, each with what must come of it.

use nalgebra::Vector2;
use rayon::prelude::*;
use solver::Role;

use super::{Dam, LOBOVSKY, Modern, NAME, run_scene, settings, studies::number};
use base::{
    gate::{Bound, Evidence, Gate},
    record::{Record, Status},
};
use harness::{
    bisect::largest_stable,
    case::{Case, RunError},
    runner::Context,
    suite::Study,
};
use report::{Cell, Column, Table, sig};

fn texts(set: &[&str]) -> Vec<String> {
    set.iter().map(|text| text.to_string()).collect()
}

fn run(case: &'static dyn Case, variant: &str, set: &[String]) -> Result<Record, RunError> {
    let context = Context { allow_unstable: true, ..Context::default() };
    case.run(variant, set, &context)
}

/// The theoretical limit of the time step of these settings \[s\], and the step of the case over it.
fn limit(case: &'static dyn Case, variant: &str, set: &[String]) -> [f64; 2] {
    let mut short = set.to_vec();
    short.push("end=0.01".into());
    let of = |r: Record| [r.chose("dt [s]") / r.chose("dt/limit"), r.chose("dt/limit")];
    run(case, variant, &short).map_or([f64::NAN; 2], of)
}

/// A run that ended, with the energy that it began with.
fn is_stable(record: &Record) -> bool {
    record.status == Status::Completed
        && record.measured("energy_gap") < 0.02
        && record.measured("mach") < 0.5
}

/// Of the bisection, relative to the theoretical limit.
const RESOLUTION: f64 = 0.02;

/// The largest stable step over the theoretical one, by bisection.
pub fn limits(case: &'static dyn Case) -> Study {
    let columns = vec![
        Column::text("variant"),
        Column::text("scene"),
        Column::num("theory", "s"),
        Column::num("measured/theory", "-"),
        Column::num("default/theory", "-"),
    ];
    let caption = "The largest time step with which the collapse ends with its energy accounted for within \
                   2 %, by bisection, over the limit of a resting lattice. Water that moves, is compressed \
                   and loses its lattice is expected at 0.7 to 1.0 of it.";
    let mut table = Table::new(caption, columns);
    let mut tank = texts(&LOBOVSKY);
    tank.extend(texts(&["n=15", "end=4"]));
    let free = texts(&["n=15"]);
    let cases: Vec<(&str, &str, &Vec<String>)> = ["modern", "modern-bare", "seed-leapfrog", "seed"]
        .into_iter()
        .flat_map(|variant| [(variant, "Martin & Moyce", &free), (variant, "Lobovsky", &tank)])
        .collect();
    let measured: Vec<[f64; 3]> = cases
        .par_iter()
        .map(|(variant, _, set)| {
            let [theory, default] = limit(case, variant, set);
            let stable = |share: f64| {
                let mut set = (*set).clone();
                set.push(format!("dt={}", share * theory));
                run(case, variant, &set).is_ok_and(|record| is_stable(&record))
            };
            let found = largest_stable(1.0, RESOLUTION, stable).map_or(f64::NAN, |b| b.stable);
            [theory, found, default]
        })
        .collect();
    let mut study = Study::new("dam-break-time-step", "Largest stable time step");
    for ((variant, scene, _), [theory, share, default]) in cases.into_iter().zip(measured) {
        table = table.row(vec![
            Cell::text(format!("`{variant}`")),
            Cell::text(scene),
            Cell::sci(theory, 3),
            Cell::num(share, 2),
            Cell::num(default, 2),
        ]);
        let because = "R1 to R5: a resting lattice; the moving, disordered water is expected between 0.7 and \
                       1.0 of its limit, and the step of the case must be below what is measured. At 1.2 of \
                       it leapfrog lets the stiffest mode grow 3.5-fold a step: a run that ends there would \
                       tell of a limit that is not that of this water";
        let id = format!("{NAME}.limit.{variant}.{}", scene.split(' ').next().unwrap_or_default());
        let bound = Bound::Within(default, 1.2);
        study =
            study.judge(Gate::new(id, "measured/theory", bound, Evidence::Theory, because), share);
    }
    study.block(table)
}

/// The sound speed: Mach number, excursion of the density, front.
pub fn sound(case: &'static dyn Case) -> Study {
    const SPEEDS: [f64; 5] = [5.0, 10.0, 20.0, 50.0, 100.0];
    let columns = vec![
        Column::num("c0", "√(g H)"),
        Column::text("ended"),
        Column::num("Mach number", "-"),
        Column::num("density from", "-"),
        Column::num("to", "-"),
        Column::num("Z at T = 3", "a"),
        Column::num("rms of front after shift", "a"),
        Column::num("viscosity took", "M g H/2"),
        Column::num("steps", "1"),
    ];
    let caption = "The column of Martin & Moyce at a/dx = 20, variant `modern`, over the sound speed. \
                   Artificial viscosity is proportional to it.";
    let mut table = Table::new(caption, columns);
    let records: Vec<Option<Record>> = SPEEDS
        .par_iter()
        .map(|c0| run(case, "modern", &[format!("c0={c0}"), "n=20".into()]).ok())
        .collect();
    for (c0, record) in SPEEDS.iter().zip(records) {
        let Some(record) = record else { continue };
        let number = |name: &str| number(&record, name);
        table = table.row(vec![
            Cell::num(*c0, 3),
            Cell::text(ended(&record)),
            number("mach"),
            Cell::percent(record.measured("density_least"), 2),
            Cell::percent(record.measured("density_most"), 2),
            number("z@3"),
            number("front_rms_shifted"),
            Cell::percent(-record.measured("work_viscosity"), 2),
            Cell::count(record.cost.steps),
        ]);
    }
    Study::new("dam-break-sound", "Sound speed").block(table)
}

fn ended(record: &Record) -> String {
    match &record.status {
        Status::Completed => "completed".into(),
        Status::Diverged { step, field, .. } => format!("diverged at step {step}: {field}"),
        Status::Refused { reason } => reason.clone(),
        Status::Interrupted { .. } => "interrupted".into(),
    }
}

/// Settings far outside of the usual, and what must come of them.
pub fn extremes(case: &'static dyn Case) -> Study {
    let columns = vec![
        Column::text("extreme"),
        Column::text("settings"),
        Column::text("must"),
        Column::text("ended"),
        Column::num("lost particles", "1"),
        Column::num("energy not accounted for", "-"),
    ];
    let caption = "The collapse, variant `modern`, with settings far outside of the usual.";
    let mut table = Table::new(caption, columns);
    let mut study = Study::new("dam-break-extremes", "Extremes");
    let stable = "it is water in a tank: it stays there, and its energy is accounted for";
    let rows: [(&str, &[&str], bool); 6] = [
        ("g x 1000", &["gravity=9810", "n=10"], true),
        ("a column one particle wide", &["width=0.01", "height=0.2", "n=1", "tank=0.5"], true),
        (
            "a tank filled to the brim",
            &["width=0.2", "height=0.1", "tank=0.2", "rim=1", "n=10"],
            true,
        ),
        ("impact on a dry corner near by", &["width=0.1", "height=0.2", "tank=0.13", "n=10"], true),
        (TOUCHING, &["n=10"], true),
        ("dt at twice the limit", &["n=10"], false),
    ];
    for (name, set, holds) in rows {
        let mut set = texts(set);
        if !holds {
            let [limit, _] = limit(case, "modern", &set);
            set.push(format!("dt={}", 2.0 * limit));
        }
        let ran = if name == TOUCHING { touching(&set) } else { run(case, "modern", &set) };
        let record = match ran {
            Ok(record) => record,
            Err(error) => {
                study = study.prose(format!("{name}: {error}"));
                continue;
            }
        };
        let (lost, gap) = (record.measured("outside_end"), record.measured("energy_gap"));
        let must = if holds { "keep water and energy" } else { "end as diverged" };
        table = table.row(vec![
            Cell::text(name),
            Cell::text(set.join(", ")),
            Cell::text(must),
            Cell::text(ended(&record)),
            Cell::num(lost, 2),
            Cell::sci(gap, 2),
        ]);
        let is_good = match (holds, &record.status) {
            (true, Status::Completed) => lost == 0.0 && gap < 0.01,
            (false, Status::Diverged { .. }) => true,
            _ => false,
        };
        let typed =
            "twice the limit grows without bound, which is a typed failure with step and particle";
        let because = if holds { stable } else { typed };
        let id = format!("{NAME}.extreme.{}", name.replace(' ', "-"));
        let gate =
            Gate::new(id, "as it must (1)", Bound::Equals(1.0), Evidence::Invariant, because);
        let gate = if name == TOUCHING { gate.with_limitation(CROWDED) } else { gate };
        study = study.judge(gate, f64::from(u8::from(is_good)));
    }
    study.block(table).prose(scaling(case))
}

const TOUCHING: &str = "water that starts on the surface of the walls";

const CROWDED: &str = "(3) knows how the density changes, not what it is: water half a spacing too near \
                       to a wall has the pressure it was given, and a few particles slip between those \
                       of the wall";

/// The column moved by half a spacing down and to the left, so that its particles stand on the walls.
fn touching(set: &[String]) -> Result<Record, RunError> {
    let dam = Dam::new::<Modern>(&settings("modern", set)?, false)?;
    let mut scene = dam.scene::<Modern>();
    for p in scene.particles.iter_mut().filter(|p| p.role == Role::Fluid) {
        p.position -= Vector2::repeat(0.5 * dam.medium.dx);
    }
    run_scene(&dam, "modern", "touched", scene, &Context::default())
}

/// Gravity is a unit: the same collapse in units of (H/g)^(1/2).
fn scaling(case: &'static dyn Case) -> String {
    let z = |g: &str| {
        let record = run(case, "modern", &[format!("gravity={g}"), "n=10".into()]);
        record.map_or(f64::NAN, |r| r.measured("z@3"))
    };
    let (one, thousand) = (z("9.81"), z("9810"));
    format!(
        "Z at T = 3 is {} with g and {} with 1000 g: a relative difference of {}, which round-off makes.",
        sig(one, 6),
        sig(thousand, 6),
        sig((thousand / one - 1.0).abs(), 2)
    )
}
