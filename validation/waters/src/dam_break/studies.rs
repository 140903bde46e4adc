//! Pictures of the tank.

use report::{Axis, ColourMap, Figure, ParticleMap, sig};

use super::{run::PICTURES, *};

/// Them, if their run is there.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    let table = plan::table(tier);
    let kept = table.rows.iter().find(|row| row.run.spec.keep.particles);
    let record = kept.and_then(|row| runs.record(&row.run.spec));
    let study = Study::new("dam-break-pictures", "Pictures of the tank");
    record.map(|record| study.block(pictures(record))).into_iter().collect()
}

/// Six times of a run in the tank, on the same axes.
fn pictures(record: &Record) -> Figure {
    let s = record.settings_as::<DamSettings>();
    let caption = format!(
        "The water at six times, {}, H/dx = {}, coloured by pressure, cut at 0 and 1 ρ g H.",
        record.variant, s.n
    );
    let mut figure = Figure::new("dam-break-lobovsky-pictures", caption).columns(2);
    for share in PICTURES {
        let points = pictures::points(record, &format!("particles@{share}"), "p");
        let [x, y] = [("x [H]", s.tank / s.height), ("y [H]", s.rim)]
            .map(|(label, most)| Axis::linear(label).range(0.0, most));
        let title = format!("time {} √(H/g)", sig(s.end * share, 3));
        let map = ParticleMap::new(&title, (x, y), "p [ρ g H]", ColourMap::Sequential, points);
        figure = figure.panel(map.diameter(1.0 / s.n as f64).values(0.0, 1.0));
    }
    figure.panel_size(430.0, 430.0 * s.rim * s.height / s.tank)
}
