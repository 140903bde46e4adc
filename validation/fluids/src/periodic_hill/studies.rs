//! What only the hills have to say: pictures, all runs, whether the start matters.

use super::{
    BEST, CASE, NAME,
    measure::{
        DRAG_BALANCE, DRAGS, FORCE, FORCE_ERROR, L2_U, REATTACHMENT, SECTION_FLUX, SEPARATION,
        UNSTEADY,
    },
    plan::{Row, name, shown, table},
    reference::{REYNOLDS, floor, reference},
};
use base::gate::{Bound, Evidence, Gate};
use harness::{case::Tier, columns::Columns, pictures, runs::Runs, study::Study};
use maths::metrics::norms::rms;
use report::{Axis, Cell, ColourMap, Figure, ParticleMap, Series};

/// All of them.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    vec![pictures(tier, runs), starts(all(runs), tier, runs)]
}

/// Every run.
fn all(runs: &Runs) -> Study {
    let caption = "All runs. The error of u is rms over the points of ten stations, the flux of sections the \
                   largest error of ten. The drag balance is the sum of the three drags over the force, less \
                   1; in `interface-wall` and `modern` it fails by the pressure on the hill, for the \
                   pressure of the field at the wall is not that of the sums that move particles. Unsteady \
                   is what is left of the decay, extrapolated. Runs from the reference start within 0.04 % \
                   of U_b.";
    let [hill, lid, pressure] = DRAGS;
    let drag = "rho U_b^2 H";
    let table = Columns::of_variants()
        .changed("settings", &CASE)
        .ended()
        .percent("error of u", "U_b", L2_U, 1.0)
        .number("force", "U_b^2/H", FORCE)
        .percent("error of it", "-", FORCE_ERROR, 1.0)
        .number("separation", "H", SEPARATION)
        .number("reattachment", "H", REATTACHMENT)
        .percent("flux of sections", "-", SECTION_FLUX, 1.0)
        .number("shear on the hill", drag, hill)
        .number("on the lid", drag, lid)
        .number("pressure", drag, pressure)
        .percent("drag balance", "-", DRAG_BALANCE, 1.0)
        .metric(["unsteady", "U_b"], UNSTEADY, |v| Cell::sci(v, 1))
        .table(caption, runs.simulations());
    Study::new("periodic-hill-runs", "All runs").block(table)
}

/// Runs from rest and from the reference, ten spacings a hill: only the full tier has both.
fn starts(study: Study, tier: Tier, runs: &Runs) -> Study {
    let because =
        "Both starts lead to the same steady flow, but for what disorder leaves in averages.";
    let table = table(tier);
    REYNOLDS.into_iter().fold(study, |study, re| {
        let rows = shown(&table, re).into_iter().filter(|row| row.settings.n == 10);
        let [rest, other] = rows.collect::<Vec<_>>()[..] else { return study };
        let u = |row: &Row| Some(runs.completed(&row.run.spec)?.column("stations", "u"));
        let both = u(rest).zip(u(other));
        let found = both.map_or(f64::NAN, |(a, b)| rms(a.iter().zip(b).map(|(a, b)| a - b)));
        let metric = "rms over stations of the difference of u [U_b]";
        let (id, bound) = (format!("{NAME}.{BEST}.{re}.starts"), Bound::Below(0.005));
        study.judge(Gate::new(id, metric, bound, Evidence::Invariant, because), found)
    })
}

/// Particles by their velocity.
fn pictures(tier: Tier, runs: &Runs) -> Study {
    let table = table(tier);
    let caption = "Particles of the finest run of variant `carried`, by their velocity u along the channel. \
                   A line encloses the fluid that circulates in finite elements (none at Re 10).";
    let shown = REYNOLDS.into_iter().filter_map(|re| {
        let (row, reference) = (*shown(&table, re).last()?, reference(re)?);
        Some((row, reference, runs.completed(&row.run.spec)?))
    });
    let shown: Vec<_> = shown.collect();
    let velocities = shown.iter().flat_map(|(.., record)| record.column("particles", "u"));
    let most = velocities.fold(0.0, |most: f64, u| most.max(u.abs()));
    let panels = shown.into_iter().map(|(row, reference, record)| {
        let title = format!("Re {}, {}", row.settings.re, name(row));
        let axes = (Axis::linear("x [H]").range(-0.1, 9.1), Axis::linear("y [H]").range(-0.1, 3.1));
        let points = pictures::points(record, "particles", "u");
        ParticleMap::new(title, axes, "u [U_b]", ColourMap::Diverging, points)
            .values(-most, most)
            .diameter(1.0 / row.settings.n as f64)
            .line(floor())
            .curve(Series::line("", reference.line.clone()).width(2.4))
    });
    let figure = panels.fold(Figure::new("periodic-hill-pictures", caption), Figure::panel);
    Study::new("periodic-hill-pictures", "Pictures").block(figure.panel_size(640.0, 230.0))
}
