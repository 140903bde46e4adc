//! What only the vortices have to say: a table of all runs, and pictures.

use super::{
    CASE,
    declaration::start_of,
    plan::{self, PICTURED, spec},
    run::{ENERGY, L2, MOMENTUM_ADDED, NEAREST, NU_EFF, PRESSURE_L2},
    sound, viscous,
};
use base::functions::log10;
use harness::{case::Tier, columns::Columns, pictures, runs::Runs, study::Study};
use report::{Axis, Cell, ColourMap, Figure, ParticleMap, Table};

/// All of them.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    let table = Study::new("taylor-green-runs", "All runs").block(table(runs));
    vec![pictures(tier, runs), sound::study(tier, runs), viscous::study(tier, runs), table]
}

/// Every run.
fn table(runs: &Runs) -> Table {
    let caption = "All runs at their end, by default t = 2 L/U. The viscosity found follows from the fall \
                   of the kinetic energy. Momentum added is the change of the total momentum from start to \
                   end over the total mass, exactly 0 in theory; that of a disturbed start does not count.";
    Columns::of_variants()
        .changed("settings", &CASE)
        .ended()
        .percent("error of the velocity", "-", L2, 1.0)
        .percent("energy less exact", "-", ENERGY, 1.0)
        .metric(["viscosity found", "nu"], NU_EFF, |v| Cell::num(v, 4))
        .percent("error of the pressure", "-", PRESSURE_L2, 1.0)
        .metric(["momentum added", "U"], MOMENTUM_ADDED, |v| Cell::sci(v, 2))
        .number("nearest pair", "dx", NEAREST)
        .table(caption, runs.simulations())
}

/// Particles at the end, by speed and by error.
fn pictures(tier: Tier, runs: &Runs) -> Study {
    let caption = "Particles in half of the periodic box of Taylor-Green vortices at t = 2 L/U, Re 100, \
                   for variant `plain`, without stabilisers, and the best one, `consistent`. Left: speed; \
                   right: logarithm of the error of the velocity, where −2 is 1 %.";
    let mut figure = Figure::new("taylor-green-pictures", caption).columns(2);
    let of_tier = plan::judged(tier);
    for (variant, n, start) in PICTURED.into_iter().filter(|run| of_tier.contains(run)) {
        let Some(record) = runs.completed(&spec(variant, n, start)) else { continue };
        let of = |name: &str, label: &str, value: fn(f64) -> f64, [low, high]: [f64; 2]| {
            let title = format!("{variant}, {n} x {n}, {}", start_of(start));
            let axis = |name: &str, end| Axis::linear(format!("{name} [L]")).range(0.0, end);
            let points = pictures::points(record, "particles", name).into_iter();
            let lower = points.filter(|(_, y, _)| *y < 0.5);
            let points = lower.map(|(x, y, v)| (x, y, value(v))).collect();
            let axes = (axis("x", 1.0), axis("y", 0.5));
            let map = ParticleMap::new(title, axes, label, ColourMap::Sequential, points);
            map.values(low, high).diameter(1.0 / n as f64)
        };
        let logarithm = |v: f64| log10(v.max(1e-12));
        figure = figure
            .panel(of("speed", "speed/largest exact speed [-]", |v| v, [0.0, 1.1]))
            .panel(of("error", "log₁₀(error/largest exact speed)", logarithm, [-4.0, 0.0]));
    }
    Study::new("taylor-green-pictures", "Pictures").block(figure.panel_size(300.0, 170.0))
}
