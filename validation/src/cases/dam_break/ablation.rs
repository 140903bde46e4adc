//! What each ingredient buys: the seed and the modern variant with one thing changed, in the tank of
//! Lobovsky et al. at a coarse spacing, and what that says of the paper's claims.

use rayon::prelude::*;

use super::{
    plan::in_tank,
    studies::{self, number, share},
};
use crate::{
    case::{Case, RunError},
    record::{Record, Status},
    report::{Cell, Column, Table, percent, sig},
    runner::Context,
    suite::Study,
};

/// A row of the table: variant, settings.
type Row = (&'static str, &'static [&'static str]);

/// The seed and what of it is changed, the same of its other wall, and of the modern variant.
const ROWS: [Row; 27] = [
    ("seed", &[]),
    ("seed", &["alpha=0"]),
    ("seed", &["alpha=0.01"]),
    ("seed", &["alpha=0.05"]),
    ("seed", &["alpha=0.2"]),
    ("seed", &["xsph=0"]),
    ("seed", &["xsph=0.25"]),
    ("seed", &["xsph=0.9"]),
    ("seed", &["h_over_dx=1.2"]),
    ("seed-no-stress", &[]),
    ("seed-diffusion", &[]),
    ("seed-extrapolating", &[]),
    ("seed-wendland", &[]),
    ("seed-leapfrog", &[]),
    ("ghosts", &[]),
    ("ghosts", &["xsph=0"]),
    ("ghosts-slip", &[]),
    ("ghosts-slip", &["xsph=0"]),
    ("modern", &[]),
    ("modern", &["alpha=0"]),
    ("modern", &["alpha=0.1"]),
    ("modern", &["h_over_dx=2"]),
    ("modern-bare", &[]),
    ("modern-plain-diffusion", &[]),
    ("modern-interface", &[]),
    ("modern-ghosts", &[]),
    ("modern-ghosts-slip", &[]),
];

/// Spacings along the height, and the end: after the impact, before the wave breaks.
const N: usize = 20;
const END: &str = "end=5";

const ID: &str = "dam-break-ablation";
const TITLE: &str = "What each ingredient buys";

/// Where the rows are not run.
pub fn elsewhere() -> Study {
    let text = "What each ingredient buys, and with it the answers to the paper's claims M1 to M4, takes 27 \
                runs: they are made in the full tier only.";
    Study::new(ID, TITLE).prose(text)
}

/// The study.
pub fn study(case: &'static dyn Case) -> Study {
    let run = |(variant, more): &Row| -> Result<Record, RunError> {
        let mut set = in_tank(N);
        set.push(END.into());
        set.extend(more.iter().map(|text| text.to_string()));
        // Without viscosity the predictor-corrector has no stable step at all: it runs as it is.
        let context = Context { allow_unstable: true, ..Context::default() };
        case.run(variant, &set, &context)
    };
    let records: Vec<Result<Record, RunError>> = ROWS.par_iter().map(run).collect();
    let (mut study, mut results) = (Study::new(ID, TITLE), Vec::new());
    for (row, record) in ROWS.into_iter().zip(records) {
        match record {
            Ok(record) => results.push((row, record)),
            Err(error) => study = study.prose(format!("`{}` {:?}: {error}", row.0, row.1)),
        }
    }
    study.block(table(&results)).prose(claims(&results))
}

/// Mean of |relative error| of the impulses at P1 to P3.
fn impulse(record: &Record) -> f64 {
    (1..=3).map(|k| record.measured(&format!("impulse_P{k}@1")).abs()).sum::<f64>() / 3.0
}

/// Microseconds of a particle and step.
fn step(record: &Record) -> f64 {
    let cost = &record.cost;
    1e6 * cost.cpu_s / (cost.steps as f64 * cost.particles as f64)
}

fn table(results: &[(Row, Record)]) -> Table {
    let columns = vec![
        Column::text("variant"),
        Column::text("changed"),
        Column::text("ended"),
        Column::num("error of front", "H"),
        Column::num("error of levels", "H"),
        Column::num("error of impulse", "-"),
        Column::num("viscosity took", "M g H/2"),
        Column::num("stress gave", "M g H/2"),
        Column::num("walls gave", "M g H/2"),
        Column::num("noise of P2", "ρ g H"),
        Column::num("density from", "-"),
        Column::num("to", "-"),
        Column::num("lost particles", "1"),
        Column::num("a particle and step", "µs"),
    ];
    let caption = format!(
        "One thing changed at a time, in the tank of Lobovsky et al. at H/dx = {N}, {END}. Errors of front \
         and levels: rms after the best shift; of the impulse: mean over P1 to P3, for one √(H/g) from the \
         arrival. Noise: rms distance of P2 from its running mean after that."
    );
    let mut table = Table::new(caption, columns);
    for ((variant, more), record) in results {
        let ended = match &record.status {
            Status::Diverged { time, .. } => format!("diverged at {} s", sig(*time, 2)),
            _ => "completed".into(),
        };
        let number = |name: &str| number(record, name);
        let share = |name: &str, sign: f64| share(sign * record.measured(name));
        table = table.row(vec![
            Cell::text(format!("`{variant}`")),
            Cell::text(more.join(", ")),
            Cell::text(ended),
            number("front_rms_shifted"),
            number("levels_rms_shifted"),
            studies::share(impulse(record)),
            share("work_viscosity", -1.0),
            share("work_stress", 1.0),
            share("work_walls", 1.0),
            number("pressure_noise"),
            share("density_least", 1.0),
            share("density_most", 1.0),
            Cell::num(record.measured("outside_end"), 3),
            Cell::num(step(record), 3),
        ]);
    }
    table
}

/// The claims M1 to M4 of the paper, answered from the rows.
fn claims(results: &[(Row, Record)]) -> String {
    let of = |variant: &str, more: &[&str]| {
        results.iter().find(|((v, m), _)| *v == variant && *m == more).map(|(_, r)| r)
    };
    let text = |variant: &str, more: &[&str], name: &str, factor: f64| match of(variant, more) {
        Some(r) if r.status == Status::Completed => percent(factor * r.measured(name), 2),
        Some(_) => "unknown, for the run diverged".into(),
        None => "not run".into(),
    };
    let noise = |variant: &str, more: &[&str]| match of(variant, more) {
        Some(r) if r.status == Status::Completed => sig(r.measured("pressure_noise"), 2),
        Some(_) => "unknown, for the run diverged".into(),
        None => "not run".into(),
    };
    let took = |more: &[&str]| text("seed", more, "work_viscosity", -1.0);
    let walls = |variant: &str| match of(variant, &[]) {
        Some(r) => {
            let end = if r.status == Status::Completed { "" } else { " and the run diverges" };
            let lost = r.measured("outside_end");
            let work = percent(r.measured("work_walls"), 2);
            format!("the walls add {work} to the energy, {lost} particles are lost{end}")
        }
        None => "not run".into(),
    };
    format!(
        "M1, artificial viscosity damps unphysical oscillation: noise of P2 in ρ g H is {} at α = 0.1 and \
         {} at 0.05; viscosity takes {} and {} of the energy. M2, artificial stress in the fluid: it adds \
         {} to the energy, and noise is {} with it and {} without. M3, XSPH prevents unphysical motion: \
         noise is {} at ε = 0.5 and {} at 0, and the least excursion of the density is {} and {}. M4, both \
         walls work: with interface and wall particles {}; with ghosts {}; with ghosts that keep the \
         velocity along the wall {}.",
        noise("seed", &[]),
        noise("seed", &["alpha=0.05"]),
        took(&[]),
        took(&["alpha=0.05"]),
        text("seed", &[], "work_stress", 1.0),
        noise("seed", &[]),
        noise("seed-no-stress", &[]),
        noise("seed", &[]),
        noise("seed", &["xsph=0"]),
        text("seed", &[], "density_least", 1.0),
        text("seed", &["xsph=0"], "density_least", 1.0),
        walls("seed"),
        walls("ghosts"),
        walls("ghosts-slip"),
    )
}
