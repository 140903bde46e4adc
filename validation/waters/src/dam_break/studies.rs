//! Pictures of the tank, and what each ingredient buys.

use report::{Axis, Cell, ColourMap, Dots, Figure, Plot, Table, sig};

use super::{run::PICTURES, *};

/// All of them.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    let table = plan::table(tier);
    let kept = table.rows.iter().find(|row| row.run.spec.keep.particles);
    let record = kept.and_then(|row| runs.record(&row.run.spec));
    let study = Study::new("dam-break-pictures", "Pictures of the tank");
    let shown = record.map(|record| study.block(pictures(record)));
    let study = Study::new("dam-break-ablation", "What each ingredient buys");
    let bought = match tier {
        Tier::Quick => study.prose("It takes 17 runs, which are made in the full tier only."),
        _ => study.block(ablation(runs)),
    };
    shown.into_iter().chain([bought]).collect()
}

fn ablation(runs: &Runs) -> Table {
    let caption = "The tank of Lobovsky et al. at H/dx = 20, with one thing changed at a time. Runs end at t \
                   √(g/H) = 5. Errors are of front and levels after the best shift (rms), and of the \
                   impulses on P1 to P3 during one √(H/g) (mean). Noise is the rms distance of P2 from its \
                   running mean; runs are chaotic, so that an ingredient damps (the paper's claims M1 of \
                   artificial viscosity and M3 of XSPH) only if the noise falls from each of its values to \
                   the next. Walls work (M4) where the run ends without lost particles and they give at most \
                   5 % of the energy.";
    let changed = |record: &Record| {
        let mut set = changed(&DAM_BREAK, &record.spec());
        set.retain(|set| ["alpha", "xsph", "xi", "diffusion"].iter().any(|of| set.starts_with(of)));
        set.join(", ")
    };
    let impulse = |record: &Record| {
        let error = |k: usize| record.value(IMPULSE[k].at(1)).map_or(f64::NAN, f64::abs);
        (0..3).map(error).sum::<f64>() / 3.0
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
        .number("lost particles", "1", OUTSIDE_END)
        .table(caption, runs.records(plan::table(Tier::Full).specs(Group::Ablation)))
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
        let dots = Dots::new("p [ρ g H]", ColourMap::Sequential, 1.0 / s.n as f64, points);
        figure = figure.panel(Plot::new(title, x, y).layer(dots.values(0.0, 1.0)));
    }
    figure.panel_size(430.0, 430.0 * s.rim * s.height / s.tank)
}
