//! What each ingredient buys: the seed and the modern variant with one thing changed, in the tank of
//! Lobovsky et al. at a coarse spacing, and what that says of the paper's claims.

use rayon::prelude::*;

use super::{
    plan::in_tank,
    studies::{self, number, share},
};
use base::record::{Record, Status};
use harness::{
    case::{Case, RunError},
    runner::Context,
    suite::Study,
};
use report::{Cell, Column, Table, percent, sig};

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

/// Neighbours visited by a particle in a step.
fn pairs(record: &Record) -> f64 {
    let cost = &record.cost;
    cost.pair_interactions as f64 / (cost.steps as f64 * cost.particles as f64)
}

/// The least and the most that a particle and step take \[µs\] in rows that differ by a number alone.
fn span(results: &[(Row, Record)]) -> [f64; 2] {
    let is_same = |((variant, more), _): &&(Row, Record)| {
        let is_number = |text: &&str| text.starts_with("alpha=") || text.starts_with("xsph=");
        *variant == "seed" && more.iter().all(is_number)
    };
    let fold = |f: fn(f64, f64) -> f64| {
        results.iter().filter(is_same).map(|(_, record)| step(record)).fold(f64::NAN, f)
    };
    [fold(f64::min), fold(f64::max)]
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
        Column::num("pairs a particle and step", "1"),
        Column::num("a particle and step", "µs"),
    ];
    let [least, most] = span(results);
    let caption = format!(
        "One thing changed at a time, in the tank of Lobovsky et al. at H/dx = {N}, {END}. Errors of front \
         and levels: rms after the best shift; of the impulse: mean over P1 to P3, for one √(H/g) from the \
         arrival. Noise: rms distance of P2 from its running mean after that. Pairs: neighbours visited, \
         exact. Times are of runs side by side: rows of one code, `seed` with another α or ε, span {} to \
         {} µs, ± {}, so less between two rows is no difference.",
        sig(least, 2),
        sig(most, 2),
        percent((most - least) / (most + least), 1),
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
            Cell::num(pairs(record), 3),
            Cell::num(step(record), 3),
        ]);
    }
    table
}

/// Rows of the seed over α and over ε, ascending: the value, and what is set.
type Ladder = [(&'static str, &'static [&'static str])];
const ALPHAS: &Ladder = &[
    ("0", &["alpha=0"]),
    ("0.01", &["alpha=0.01"]),
    ("0.05", &["alpha=0.05"]),
    ("0.1", &[]),
    ("0.2", &["alpha=0.2"]),
];
const EPSILONS: &Ladder =
    &[("0", &["xsph=0"]), ("0.25", &["xsph=0.25"]), ("0.5", &[]), ("0.9", &["xsph=0.9"])];

/// The row with a variant and what is set.
fn row<'a>(results: &'a [(Row, Record)], variant: &str, more: &[&str]) -> Option<&'a Record> {
    results.iter().find(|((v, m), _)| *v == variant && *m == more).map(|(_, record)| record)
}

/// A metric of a row in words.
fn quoted(record: Option<&Record>, name: &str, text: fn(f64, usize) -> String) -> String {
    match record.map(|r| (&r.status, r.measured(name))) {
        Some((Status::Completed, value)) if value.is_finite() => text(value, 2),
        Some((Status::Completed, _)) => "not measured".into(),
        Some(_) => "diverged".into(),
        None => "not run".into(),
    }
}

/// A metric of each row of a ladder in words.
fn list(
    results: &[(Row, Record)],
    ladder: &Ladder,
    name: &str,
    text: fn(f64, usize) -> String,
) -> String {
    let one = |(value, more): &(&str, &[&str])| {
        format!("{} at {value}", quoted(row(results, "seed", more), name, text))
    };
    ladder.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Whether the noise falls from each row of a ladder to the next: what a claim that the ingredient damps
/// needs, for two rows alone may differ by chance. A run that diverged is the noisiest.
fn falls(results: &[(Row, Record)], ladder: &Ladder) -> bool {
    let noise = |(_, more): &(&str, &[&str])| match row(results, "seed", more) {
        Some(r) if r.status == Status::Completed => r.measured("pressure_noise"),
        Some(_) => f64::INFINITY,
        None => f64::NAN,
    };
    let noise: Vec<f64> = ladder.iter().map(noise).collect();
    let is_less = noise.windows(2).all(|w| w[1] < w[0] || w == [f64::INFINITY; 2]);
    is_less && noise.last() < noise.first()
}

/// The claims M1 to M4 of the paper, answered from the rows.
fn claims(results: &[(Row, Record)]) -> String {
    let shown = |holds: bool| if holds { "holds" } else { "not shown here" };
    let damps = |ladder: &Ladder, name: &str| match falls(results, ladder) {
        true => String::new(),
        false => format!(
            ": over {name} the noise does not fall from each row to the next, so that two rows differ is \
             no evidence"
        ),
    };
    let seed = row(results, "seed", &[]);
    let m1 = format!(
        "M1, artificial viscosity damps unphysical oscillation: **{}**{}; noise of P2 in ρ g H over α is \
         {}, and viscosity adds {} to the energy.",
        shown(falls(results, ALPHAS)),
        damps(ALPHAS, "α"),
        list(results, ALPHAS, "pressure_noise", sig),
        list(results, ALPHAS, "work_viscosity", percent),
    );
    let m2 = format!(
        "M2, artificial stress in the fluid: it adds {} to the energy, and noise is {} with it and {} \
         without.",
        quoted(seed, "work_stress", percent),
        quoted(seed, "pressure_noise", sig),
        quoted(row(results, "seed-no-stress", &[]), "pressure_noise", sig),
    );
    let m3 = format!(
        "M3, XSPH prevents unphysical motion: **{}**{}; noise over ε is {}, and the least excursion of the \
         density {}.",
        shown(falls(results, EPSILONS)),
        damps(EPSILONS, "ε"),
        list(results, EPSILONS, "pressure_noise", sig),
        list(results, EPSILONS, "density_least", percent),
    );
    [m1, m2, m3, walls(results)].join(" ")
}

/// The claim that both walls work: one does if the run ends, no particle is lost, and it does no work
/// beyond the 5 % that the gates allow.
fn walls(results: &[(Row, Record)]) -> String {
    let of = |variant: &str| row(results, variant, &[]);
    let works = |variant: &str| {
        let good = |r: &Record| {
            r.status == Status::Completed
                && r.measured("outside_end") == 0.0
                && r.measured("work_walls").abs() <= 0.05
        };
        if of(variant).is_some_and(good) { "yes" } else { "no" }
    };
    let told = |variant: &str| match of(variant) {
        Some(r) => {
            let end = if r.status == Status::Completed { "" } else { " and the run diverges" };
            let lost = r.measured("outside_end");
            let work = percent(r.measured("work_walls"), 2);
            format!("the walls add {work} to the energy, {lost} particles are lost{end}")
        }
        None => "not run".into(),
    };
    format!(
        "M4, both walls work: **interface walls {}, sticking ghosts {}, slipping ghosts {}**; with interface \
         and wall particles {}; with ghosts {}; with ghosts that keep the velocity along the wall {}.",
        works("seed"),
        works("ghosts"),
        works("ghosts-slip"),
        told("seed"),
        told("ghosts"),
        told("ghosts-slip"),
    )
}
