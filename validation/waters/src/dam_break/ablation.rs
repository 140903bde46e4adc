//! What each ingredient buys: the seed and the modern variant with one thing changed, in the tank of
//! Lobovsky et al. at a coarse spacing, and what that says of the paper's claims.

use super::{
    DAM_BREAK,
    metrics::{DENSITY_LEAST, DENSITY_MOST, FRONT, IMPULSE, LEVELS, NOISE, OUTSIDE_END},
    plan::{self, ALPHA, Group, Set, XSPH, change},
};
use crate::water::ledger::{WORK_STRESS, WORK_VISCOSITY, WORK_WALLS};
use base::{
    record::{MetricKey, Record, Status},
    spec::RunSpec,
};
use harness::{
    case::{Tier, changed},
    columns::Columns,
    runs::Runs,
    study::Study,
};
use report::{Cell, Table, percent, sig};

/// The study.
pub fn study(tier: Tier, runs: &Runs) -> Study {
    let study = Study::new("dam-break-ablation", "What each ingredient buys");
    match tier {
        Tier::Quick => study.prose(
            "What each ingredient buys, and with it the answers to the paper's claims M1 to M4, takes 18 \
             runs: they are made in the full tier only.",
        ),
        _ => study.block(table(runs)).prose(claims(runs)),
    }
}

/// Mean of |relative error| of the impulses at P1 to P3; NaN if one was not measured.
fn impulse(record: &Record) -> f64 {
    let error = |of: MetricKey| record.value(of.at(1)).map_or(f64::NAN, f64::abs);
    IMPULSE.into_iter().take(3).map(error).sum::<f64>() / 3.0
}

fn table(runs: &Runs) -> Table {
    let caption = "The tank of Lobovsky et al. at H/dx = 20, with one thing changed at a time. Runs end at t \
                   √(g/H) = 5. Errors are of front and levels after the best shift (rms), and of the \
                   impulses on P1 to P3 during one √(H/g) (mean). Noise is the rms distance of P2 from its \
                   running mean.";
    let changed = |record: &Record| {
        let mut set = changed(&DAM_BREAK, &record.spec());
        set.retain(|set| ["alpha", "xsph", "xi", "diffusion"].iter().any(|of| set.starts_with(of)));
        set.join(", ")
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
        .table(caption, runs.records(plan::table(Tier::Full).specs(Group::Ablation)))
}

/// The run of a row.
fn spec(variant: &str, value: f64, set: Set) -> RunSpec {
    DAM_BREAK.spec(variant, |s| change(s, value, set)).allow_unstable().measure_all()
}

/// Whether the noise falls from each value of a setting of the seed to the next: what a claim that the
/// ingredient damps needs, for two runs alone may differ by chance. A run that diverged is the noisiest.
fn damps(runs: &Runs, values: &[f64], set: Set) -> &'static str {
    let noise = |value: &f64| match runs.record(&spec("seed", *value, set)) {
        Some(r) if r.status == Status::Completed => r.value(NOISE).unwrap_or(f64::NAN),
        Some(_) => f64::INFINITY,
        None => f64::NAN,
    };
    let noise: Vec<f64> = values.iter().map(noise).collect();
    let is_less = noise.windows(2).all(|w| w[1] < w[0] || w == [f64::INFINITY; 2]);
    match is_less && noise.last() < noise.first() {
        true => "**holds**: the noise of P2 falls from each value to the next",
        false => {
            "**is not shown here**: the noise of P2 does not fall from each value to the next, so a \
             difference of two runs is no evidence"
        }
    }
}

/// The claim that a wall works: one does if the run ends, no particle is lost, and the wall does no work
/// beyond the 5 % that the gates allow.
fn works(runs: &Runs, variant: &str) -> &'static str {
    let is_good = |r: &&Record| {
        r.status == Status::Completed
            && r.value(OUTSIDE_END) == Some(0.0)
            && r.value(WORK_WALLS).is_some_and(|work| work.abs() <= 0.05)
    };
    let record = runs.record(&spec(variant, 0.0, |_, _| ()));
    if record.filter(is_good).is_some() { "yes" } else { "no" }
}

/// The claims M1 to M4 of the paper, answered from the rows.
fn claims(runs: &Runs) -> String {
    let stress = |value: f64, metric: MetricKey| {
        let record = runs.completed(&spec("seed", value, |s, value| s.xi = value));
        record.and_then(|record| record.value(metric)).unwrap_or(f64::NAN)
    };
    let m1 = damps(runs, &[0.0, 0.01, 0.05, 0.1, 0.2], ALPHA);
    let m3 = damps(runs, &[0.0, 0.25, 0.5, 0.9], XSPH);
    let m4 = ["seed", "ghosts", "ghosts-slip", "ghosts-split"].map(|variant| works(runs, variant));
    format!(
        "**M1** (artificial viscosity damps unphysical oscillation) {m1}. **M2** (artificial stress in the \
         fluid): it adds {} to the energy, and the noise is {} with it and {} without. **M3** (XSPH prevents \
         unphysical motion) {m3}. **M4** (both walls work): interface and wall particles **{}**, ghosts \
         **{}**, ghosts that keep the velocity along the wall **{}**, those except for viscosity **{}**: a \
         wall works if the run ends, no particle is lost, and the wall adds at most 5 % to the energy.",
        percent(stress(0.3, WORK_STRESS), 2),
        sig(stress(0.3, NOISE), 2),
        sig(stress(0.0, NOISE), 2),
        m4[0],
        m4[1],
        m4[2],
        m4[3],
    )
}
