//! What each ingredient buys: the seed and the modern variant with one thing changed, in the tank of
//! Lobovsky et al. at a coarse spacing, and what that says of the paper's claims.

use super::{
    DAM_BREAK, DamSettings, lobovsky,
    metrics::{DENSITY_LEAST, DENSITY_MOST, FRONT, IMPULSE, LEVELS, NOISE, OUTSIDE_END},
};
use crate::water::ledger::{WORK_STRESS, WORK_VISCOSITY, WORK_WALLS};
use base::{
    record::{MetricKey, Record, Status},
    spec::RunSpec,
};
use harness::{columns::Columns, runs::Runs, study::Study};
use report::{Cell, Table, percent, sig};

/// The one setting that a row changes, if it does: name, value, how it is set.
type Change = Option<(&'static str, f64, fn(&mut DamSettings, f64))>;

const NOTHING: Change = None;

const fn alpha(value: f64) -> Change {
    Some(("alpha", value, |s, value| s.alpha = value))
}

const fn xsph(value: f64) -> Change {
    Some(("xsph", value, |s, value| s.xsph = value))
}

const fn h_over_dx(value: f64) -> Change {
    Some(("h_over_dx", value, |s, value| s.h_over_dx = value))
}

/// The seed and what of it is changed, the same of its other wall, and of the modern variant.
const ROWS: [(&str, Change); 29] = [
    ("seed", NOTHING),
    ("seed", alpha(0.0)),
    ("seed", alpha(0.01)),
    ("seed", alpha(0.05)),
    ("seed", alpha(0.2)),
    ("seed", xsph(0.0)),
    ("seed", xsph(0.25)),
    ("seed", xsph(0.9)),
    ("seed", h_over_dx(1.2)),
    ("seed-no-stress", NOTHING),
    ("seed-diffusion", NOTHING),
    ("seed-extrapolating", NOTHING),
    ("seed-wendland", NOTHING),
    ("seed-leapfrog", NOTHING),
    ("ghosts", NOTHING),
    ("ghosts", xsph(0.0)),
    ("ghosts-slip", NOTHING),
    ("ghosts-slip", xsph(0.0)),
    ("ghosts-split", NOTHING),
    ("modern", NOTHING),
    ("modern", alpha(0.0)),
    ("modern", alpha(0.1)),
    ("modern", h_over_dx(2.0)),
    ("modern-sticking", NOTHING),
    ("modern-bare", NOTHING),
    ("modern-plain-diffusion", NOTHING),
    ("modern-interface", NOTHING),
    ("modern-ghosts", NOTHING),
    ("modern-ghosts-slip", NOTHING),
];

/// Spacings along the height, and the end: after the impact, before the wave breaks.
const N: usize = 20;
const END: f64 = 5.0;

const ID: &str = "dam-break-ablation";
const TITLE: &str = "What each ingredient buys";

/// Where the rows are not run.
pub fn elsewhere() -> Study {
    let text = "What each ingredient buys, and with it the answers to the paper's claims M1 to M4, takes 29 \
                runs: they are made in the full tier only.";
    Study::new(ID, TITLE).prose(text)
}

/// The run of a row. Without viscosity the predictor-corrector has no stable step at all: it runs as it is.
fn spec(variant: &str, change: Change) -> RunSpec {
    let set = |s: &mut DamSettings| {
        lobovsky(s);
        (s.n, s.end) = (N, END);
        if let Some((_, value, set)) = change {
            set(s, value);
        }
    };
    DAM_BREAK.spec(variant, set).allow_unstable().measure_all()
}

/// The runs of all rows.
pub fn specs() -> impl Iterator<Item = RunSpec> {
    ROWS.into_iter().map(|(variant, change)| spec(variant, change))
}

/// The study.
pub fn study(runs: &Runs) -> Study {
    Study::new(ID, TITLE).block(table(runs)).prose(claims(runs))
}

/// Mean of |relative error| of the impulses at P1 to P3; NaN if one was not measured.
fn impulse(record: &Record) -> f64 {
    let error = |of: MetricKey| record.value(of.at(1)).map_or(f64::NAN, f64::abs);
    IMPULSE.into_iter().take(3).map(error).sum::<f64>() / 3.0
}

/// Neighbours of a particle in the sweeps of a step.
fn pairs(record: &Record) -> f64 {
    let cost = &record.cost;
    cost.pair_interactions as f64 / (cost.steps as f64 * cost.particles as f64)
}

fn table(runs: &Runs) -> Table {
    let caption = format!(
        "The tank of Lobovsky et al. at H/dx = {N}, with one thing changed at a time. Runs end at t √(g/H) \
         = {END}. Errors are of front and levels after the best shift (rms), and of the impulses on P1 to \
         P3 during one √(H/g) (mean). Noise is the rms distance of P2 from its running mean.",
    );
    let changed = |record: &Record| {
        let is_it = |row: &&(&str, Change)| spec(row.0, row.1).key() == record.key();
        let change = ROWS.iter().find(is_it).and_then(|(_, change)| *change);
        change.map_or(String::new(), |(name, value, _)| format!("{name}={value}"))
    };
    Columns::of_variants()
        .text("changed", changed)
        .ended()
        .number("error of front", "H", FRONT.rms_shifted)
        .number("error of levels", "H", LEVELS.rms_shifted)
        .of(["error of impulse", "-"], impulse, |error| Cell::percent(error, 2))
        .percent("viscosity took", "M g H/2", WORK_VISCOSITY, -1.0)
        .percent("stress gave", "M g H/2", WORK_STRESS, 1.0)
        .percent("walls gave", "M g H/2", WORK_WALLS, 1.0)
        .number("noise of P2", "ρ g H", NOISE)
        .percent("density from", "-", DENSITY_LEAST, 1.0)
        .percent("to", "-", DENSITY_MOST, 1.0)
        .number("lost particles", "1", OUTSIDE_END)
        .of(["pairs a particle and step", "1"], pairs, |pairs| Cell::num(pairs, 3))
        .table(caption, runs.records(specs()))
}

/// Changes of the seed over α and over ε, ascending, each with its value.
type Ladder = [(f64, Change)];
const ALPHAS: &Ladder = &[
    (0.0, alpha(0.0)),
    (0.01, alpha(0.01)),
    (0.05, alpha(0.05)),
    (0.1, NOTHING),
    (0.2, alpha(0.2)),
];
const EPSILONS: &Ladder = &[(0.0, xsph(0.0)), (0.25, xsph(0.25)), (0.5, NOTHING), (0.9, xsph(0.9))];

/// A metric of a row in words.
fn quoted(
    runs: &Runs,
    (variant, change): (&str, Change),
    metric: MetricKey,
    text: fn(f64, usize) -> String,
) -> String {
    match runs.record(&spec(variant, change)).map(|r| (&r.status, r.value(metric))) {
        Some((Status::Completed, Some(value))) if value.is_finite() => text(value, 2),
        Some((Status::Completed, _)) => "not measured".into(),
        Some((Status::Refused { .. }, _)) | None => "not run".into(),
        Some(_) => "diverged".into(),
    }
}

/// A metric of each row of a ladder in words.
fn list(runs: &Runs, ladder: &Ladder, metric: MetricKey, text: fn(f64, usize) -> String) -> String {
    let one = |(value, change): &(f64, Change)| {
        format!("{} at {value}", quoted(runs, ("seed", *change), metric, text))
    };
    ladder.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Whether the noise falls from each row of a ladder to the next: what a claim that the ingredient damps
/// needs, for two rows alone may differ by chance. A run that diverged is the noisiest.
fn falls(runs: &Runs, ladder: &Ladder) -> bool {
    let noise = |(_, change): &(f64, Change)| match runs.record(&spec("seed", *change)) {
        Some(r) if r.status == Status::Completed => r.value(NOISE).unwrap_or(f64::NAN),
        Some(_) => f64::INFINITY,
        None => f64::NAN,
    };
    let noise: Vec<f64> = ladder.iter().map(noise).collect();
    let is_less = noise.windows(2).all(|w| w[1] < w[0] || w == [f64::INFINITY; 2]);
    is_less && noise.last() < noise.first()
}

/// The claims M1 to M4 of the paper, answered from the rows.
fn claims(runs: &Runs) -> String {
    let shown = |holds: bool| if holds { "holds" } else { "is not shown here" };
    let damps = |ladder: &Ladder, name: &str| match falls(runs, ladder) {
        true => String::new(),
        false => format!(
            ": over {name} the noise does not fall from each row to the next, so a difference of two rows \
             is no evidence"
        ),
    };
    let seed = ("seed", NOTHING);
    let m1 = format!(
        "**M1** (artificial viscosity damps unphysical oscillation) **{}**{}. The noise of P2 in ρ g H \
         over α is {}; viscosity adds {} to the energy.",
        shown(falls(runs, ALPHAS)),
        damps(ALPHAS, "α"),
        list(runs, ALPHAS, NOISE, sig),
        list(runs, ALPHAS, WORK_VISCOSITY, percent),
    );
    let m2 = format!(
        "**M2** (artificial stress in the fluid): it adds {} to the energy, and the noise is {} with it \
         and {} without.",
        quoted(runs, seed, WORK_STRESS, percent),
        quoted(runs, seed, NOISE, sig),
        quoted(runs, ("seed-no-stress", NOTHING), NOISE, sig),
    );
    let m3 = format!(
        "**M3** (XSPH prevents unphysical motion) **{}**{}. The noise over ε is {}, and the least \
         excursion of the density {}.",
        shown(falls(runs, EPSILONS)),
        damps(EPSILONS, "ε"),
        list(runs, EPSILONS, NOISE, sig),
        list(runs, EPSILONS, DENSITY_LEAST, percent),
    );
    [m1, m2, m3, walls(runs)].join(" ")
}

/// The claim that both walls work: one does if the run ends, no particle is lost, and it does no work
/// beyond the 5 % that the gates allow.
fn walls(runs: &Runs) -> String {
    let of = |variant: &str| runs.record(&spec(variant, NOTHING));
    let works = |variant: &str| {
        let good = |r: &Record| {
            r.status == Status::Completed
                && r.value(OUTSIDE_END) == Some(0.0)
                && r.value(WORK_WALLS).is_some_and(|work| work.abs() <= 0.05)
        };
        if of(variant).is_some_and(good) { "yes" } else { "no" }
    };
    let in_words =
        |variant: &str| match of(variant).map(|r| (r, r.value(WORK_WALLS), r.value(OUTSIDE_END))) {
            Some((r, Some(work), Some(lost))) => {
                let end = if r.status == Status::Completed { "" } else { " and the run diverges" };
                let work = percent(work, 2);
                format!("the walls add {work} to the energy, {lost} particles are lost{end}")
            }
            _ => "not run".into(),
        };
    format!(
        "**M4** (both walls work): **interface walls {}, sticking ghosts {}, slipping ghosts {}, ghosts \
         that stick for viscosity alone {}**. With interface and wall particles {}; with ghosts {}; with \
         ghosts that keep the velocity along the wall {}; with those except for viscosity {}.",
        works("seed"),
        works("ghosts"),
        works("ghosts-slip"),
        works("ghosts-split"),
        in_words("seed"),
        in_words("ghosts"),
        in_words("ghosts-slip"),
        in_words("ghosts-split"),
    )
}
