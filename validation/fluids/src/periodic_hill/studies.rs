//! What only the hills have to say: pictures, all runs, whether the start matters.

use super::{
    BEST, CASE, NAME,
    measure::{
        DRAG_BALANCE, DRAGS, FORCE, FORCE_ERROR, L2_U, L2_V, REATTACHMENT, SECTION_FLUX,
        SEPARATION, SHEAR_ERROR, UNSTEADY, rms,
    },
    plan::{For, Table, name, shown, table},
    reference::{REYNOLDS, floor, reference},
};
use base::{
    gate::{Bound, Evidence, Gate},
    record::Record,
};
use harness::{case::Tier, columns::Columns, pictures, runs::Runs, study::Study};
use report::{Axis, Cell, ColourMap, Figure, ParticleMap, Series};

/// All of them.
pub fn studies(tier: Tier, runs: &Runs) -> Vec<Study> {
    let table = table(tier);
    let mut studies = vec![pictures(&table, runs), all(runs)];
    if tier == Tier::Full {
        studies.push(starts(&table, runs));
    }
    studies
}

/// Every run.
fn all(runs: &Runs) -> Study {
    let caption = "All runs. Errors of u and v are rms over the points of ten stations. The error of shear \
                   is rms over the hill, relative to the largest shear there. Flux of sections is the \
                   largest error of ten. Drags are shear on the hill, shear on the lid and pressure on the \
                   hill; the balance is their sum over the force, less 1. In `interface-wall` and `modern` \
                   it fails by the pressure on the hill: the pressure of the field at the wall is not that \
                   of the sums that move particles. Unsteady is what is left of the decay, extrapolated, \
                   without the change that disorder explains. A dash stands for a run that diverged, for no \
                   bubble, or for no finite elements to compare with. Runs from the reference start within \
                   0.04 % of U_b of it: their error says that the flow stays there, and unsteady how far it \
                   would still go.";
    let [hill, lid, pressure] = DRAGS;
    let drag = "rho U_b^2 H";
    let table = Columns::of_variants()
        .changed("settings", &CASE)
        .ended()
        .percent("error of u", "U_b", L2_U, 1.0)
        .percent("error of v", "U_b", L2_V, 1.0)
        .number("force", "U_b^2/H", FORCE)
        .percent("error of it", "-", FORCE_ERROR, 1.0)
        .number("separation", "H", SEPARATION)
        .number("reattachment", "H", REATTACHMENT)
        .percent("error of shear", "-", SHEAR_ERROR, 1.0)
        .percent("flux of sections", "-", SECTION_FLUX, 1.0)
        .number("shear on the hill", drag, hill)
        .number("on the lid", drag, lid)
        .number("pressure", drag, pressure)
        .percent("drag balance", "-", DRAG_BALANCE, 1.0)
        .metric(["unsteady", "U_b"], UNSTEADY, |v| Cell::sci(v, 1))
        .table(caption, runs.simulations());
    Study::new("periodic-hill-runs", "All runs").block(table)
}

/// Particles by their velocity.
fn pictures(table: &Table, runs: &Runs) -> Study {
    let caption = "Particles of the finest run of variant `carried`, coloured by their velocity u along \
                   the channel over the bulk velocity U_b; H is the height of a hill. A thick line encloses \
                   the fluid that circulates in finite elements (none at Re 10).";
    let shown = REYNOLDS.into_iter().filter_map(|re| {
        let (row, reference) = (*shown(table, re).last()?, reference(re)?);
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

/// rms over stations of the difference of u of two runs \[U_b\].
fn difference(a: &Record, b: &Record) -> f64 {
    let [a, b] = [a, b].map(|record| record.column("stations", "u"));
    rms(a.iter().zip(b).map(|(a, b)| a - b))
}

/// From rest and from near the answer.
fn starts(table: &Table, runs: &Runs) -> Study {
    let because = "Both starts must lead to the same steady flow, except for what disorder leaves in \
                   averages over a fifth of the run, at least 3 H/U_b.";
    let about = "Finer runs start from the reference. That this does not make the result is judged at ten \
                 spacings a hill, where runs from rest end as well.";
    let study = Study::new("periodic-hill-starts", "From rest and from the reference").prose(about);
    table.of(For::Starts).fold(study, |study, row| {
        let re = row.settings.re;
        let rest = shown(table, re).into_iter().find(|rest| rest.settings.n == row.settings.n);
        let rest = rest.and_then(|rest| runs.completed(&rest.run.spec));
        let both = rest.zip(runs.completed(&row.run.spec));
        let found = both.map_or(f64::NAN, |(rest, other)| difference(rest, other));
        let id = format!("{NAME}.{BEST}.{re}.starts");
        let metric = "rms over stations of the difference of u [U_b]";
        study.judge(Gate::new(id, metric, Bound::Below(0.005), Evidence::Invariant, because), found)
    })
}
