//! What only the vortices have to say: pictures, all runs, what the sound speed and super-time-stepping cost
//! and buy.

use super::{
    BEST, CASE, NAME, STIFF,
    plan::{For, Row, Table, VISCOUS, is_pictured, table, usual},
    run::{ENERGY, L2, L2_WORST, MOMENTUM_ADDED, NEAREST, NU_EFF, PRESSURE_L2},
};
use base::{
    functions::log10,
    gate::{Bound, Evidence, Gate},
    record::Record,
};
use harness::{
    case::{Case, Tier},
    columns::Columns,
    pictures,
    runs::Runs,
    study::Study,
};
use report::{Axis, Cell, ColourMap, Figure, ParticleMap};
use std::f64::consts::TAU;

/// All of them.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    let table = table(tier);
    let all = viscous(sound(all(runs), &table, runs), &table, runs);
    vec![pictures(&table, runs), all]
}

/// Every run.
fn all(runs: &Runs) -> Study {
    let caption = "All runs at their end, by default t = 2 L/U: what sound speed and super-time-stepping \
                   cost and buy. The largest error is that over time. The viscosity found follows from the \
                   fall of the kinetic energy. Momentum added is the change of the total momentum over the \
                   total mass, exactly 0 in theory. Each stage of `stiff` counts as one pair sweep.";
    let step = |record: &Record| record.cost.largest_dt_s;
    let table = Columns::of_variants()
        .changed("settings", &CASE)
        .ended()
        .percent("error of the velocity", "-", L2, 1.0)
        .percent("largest error", "-", L2_WORST, 1.0)
        .percent("energy less exact", "-", ENERGY, 1.0)
        .metric(["viscosity found", "nu"], NU_EFF, |v| Cell::num(v, 4))
        .percent("error of the pressure", "-", PRESSURE_L2, 1.0)
        .metric(["momentum added", "U"], MOMENTUM_ADDED, |v| Cell::sci(v, 2))
        .number("nearest pair", "dx", NEAREST)
        .of(["longest step", "L/U"], step, |v| Cell::sci(v, 2))
        .num(["pair interactions", "1"], |record| Cell::sci(pairs(record), 3))
        .table(caption, runs.simulations());
    Study::new("taylor-green-runs", "All runs").block(table)
}

fn pairs(record: &Record) -> f64 {
    record.cost.pair_interactions as f64
}

/// Finds a number of the completed run of a row; NaN, which no gate passes, without one.
fn found(runs: &Runs, row: Option<&Row>, number: impl Fn(&Record) -> Option<f64>) -> f64 {
    let record = row.and_then(|row| runs.completed(&row.run.spec));
    record.and_then(number).unwrap_or(f64::NAN)
}

/// Does faster sound pay?
fn sound(study: Study, table: &Table, runs: &Runs) -> Study {
    let because = "Faster sound must not be needed: what irregular particles add to the pressure grows as \
                   c0^2, so that the error has been seen to rise.";
    table.of(For::Sound).filter(|row| row.settings.c0 == 40.0).fold(study, |study, fast| {
        let (variant, n) = (fast.variant, fast.settings.n);
        let error = |row| found(runs, row, |record| record.value(L2));
        let (id, metric) =
            (format!("{NAME}.{variant}.{n}.sound_speed"), "error at c0 = 40 U over error at 10 U");
        let gate = Gate::new(id, metric, Bound::Above(1.0), Evidence::Regression, because);
        study.judge(gate, error(Some(fast)) / error(usual(table, variant, n)))
    })
}

/// Does super-time-stepping have the error of short explicit steps, for less work?
fn viscous(study: Study, table: &Table, runs: &Runs) -> Study {
    let same = "Explicit steps of a velocity that decays at the rate g = 2 nu k^2 have the error g^2 t dt/2 \
                at the end, super-time-stepping one of second order, for which the bound adds 0.05 %.";
    let fifth =
        "The goal of the channels at Re 0.5: a fifth of the work of steps of about the same error.";
    let gain =
        "It costs less than the longest explicit steps, whose error of time it does not have.";
    let of = |variant| table.of(For::Viscous).filter(move |row| row.variant == variant);
    of(STIFF).fold(study, |study, stiff| {
        let (n, end) = (stiff.settings.n, stiff.settings.end);
        let [long, short] = VISCOUS.map(|viscous| {
            of(BEST).find(|row| row.settings.n == n && row.settings.viscous == viscous)
        });
        let error = |row| found(runs, row, |record| record.value(L2_WORST));
        let work = |row| found(runs, row, |record| Some(pairs(record)));
        let rules = short.and_then(|row| CASE.rules(&row.run.spec).ok());
        let dt = rules.map_or(0.0, |rules| rules.dt());
        let most = 0.5 * (2.0 * TAU * TAU).powi(2) * end * dt + 5e-4;
        let gate = |what, metric, bound, because| {
            let id = format!("{NAME}.{STIFF}.{n}.re1.{what}");
            Gate::new(id, metric, bound, Evidence::Theory, because)
        };
        let metric = "error less that of short explicit steps";
        let same = gate("same_error", metric, Bound::Within(-most, most), same);
        let metric = "pair interactions/those of short explicit steps";
        let fifth = gate("pairs", metric, Bound::Below(0.2), fifth);
        let metric = "pair interactions/those of the longest explicit steps";
        let gain = gate("gain", metric, Bound::Below(1.0), gain);
        let stiff = Some(stiff);
        study
            .judge(same, error(stiff) - error(short))
            .judge(fifth, work(stiff) / work(short))
            .judge(gain, work(stiff) / work(long))
    })
}

/// Particles at the end, by their error.
fn pictures(table: &Table, runs: &Runs) -> Study {
    let caption = "Particles in half of the periodic box of Taylor-Green vortices at t = 2 L/U, Re 100, \
                   from the disturbed lattice, for variant `plain`, without stabilisers, and the best one, \
                   by the logarithm of the error of the velocity, where −2 is 1 %.";
    let mut figure = Figure::new("taylor-green-pictures", caption).columns(2);
    for row in table.rows.iter().filter(|row| is_pictured(row)) {
        let Some(record) = runs.completed(&row.run.spec) else { continue };
        let n = row.settings.n;
        let axis = |name: &str, end| Axis::linear(format!("{name} [L]")).range(0.0, end);
        let points = pictures::points(record, "particles", "error").into_iter();
        let lower = points.filter(|(_, y, _)| *y < 0.5);
        let points = lower.map(|(x, y, error)| (x, y, log10(error.max(1e-12)))).collect();
        let (title, label) = (format!("{}, {n} x {n}", row.variant), "log₁₀(error/exact speed)");
        let axes = (axis("x", 1.0), axis("y", 0.5));
        let map = ParticleMap::new(title, axes, label, ColourMap::Sequential, points);
        figure = figure.panel(map.values(-4.0, 0.0).diameter(1.0 / n as f64));
    }
    Study::new("taylor-green-pictures", "Pictures").block(figure.panel_size(300.0, 170.0))
}
