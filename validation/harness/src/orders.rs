//! The order at which an error falls as something is refined, for studies of one case alone: a figure with a
//! panel for each refinement, one table, and a gate a line.

use base::gate::Gate;
use report::{Axis, Cell, Figure, Layer, Plot, Series, sig};

use crate::{
    columns::Columns,
    convergence::{Convergence, Level, convergence},
    study::Study,
};

/// Something that is refined.
pub struct Refinement {
    /// Title of its panel.
    pub title: &'static str,
    /// What is refined and the error, with their units.
    pub axes: [&'static str; 2],
    /// Orders that are drawn as slopes.
    pub slopes: &'static [f64],
    /// Errors, a line each.
    pub lines: Vec<Line>,
}

/// Errors of a variant over a refinement.
pub struct Line {
    /// Name of the variant.
    pub name: &'static str,
    /// What else tells it from others, in a word.
    pub kind: &'static str,
    /// Errors, coarse to fine.
    pub levels: Vec<Level>,
    /// The order that theory expects.
    pub expected: &'static str,
    /// Judges the order.
    pub gate: Gate,
}

type Found = Result<Convergence, String>;

/// Adds the figure, the table and the judged orders to a study; lines that `is_drawn` refuses are not drawn.
pub fn study(
    study: Study,
    [figure, table]: [&str; 2],
    all: &[Refinement],
    is_drawn: fn(&Line) -> bool,
) -> Study {
    let panel = |of: &Refinement| {
        let plot = Plot::new(of.title, Axis::log(of.axes[0]), Axis::log(of.axes[1]));
        let lines = of.lines.iter().filter(|line| is_drawn(line)).enumerate();
        let plot = lines.fold(plot, |plot, (k, line)| {
            let points = line.levels.iter().map(|level| (level.spacing, level.value)).collect();
            plot.layer(Series::line_markers(line.name, points).cycle(k))
        });
        of.slopes.iter().fold(plot, |plot, order| plot.layer(Layer::Slope(*order)))
    };
    let panels = all.iter().map(panel);
    let figure = Figure::new(study.id.clone(), figure).columns(2).panel_size(330.0, 260.0);
    let rows: Vec<(&str, &Line, Found)> = all
        .iter()
        .flat_map(|of| of.lines.iter().map(|line| (of.title, line, convergence(&line.levels))))
        .collect();
    let shown = |show: fn(&Convergence) -> String| {
        move |(.., found): &(_, _, Found)| Cell::text(found.as_ref().map_or("–".into(), show))
    };
    let errors = |(_, line, _): &(_, &Line, _)| {
        let errors: Vec<String> = line.levels.iter().map(|level| sig(level.value, 3)).collect();
        errors.join(", ")
    };
    let table = Columns::default()
        .text("refined", |(title, ..): &(&str, &Line, Found)| *title)
        .code("variant", |(_, line, _)| line.name)
        .text("kind", |(_, line, _)| line.kind)
        .text("errors, coarse to fine", errors)
        .num(["order", "-"], shown(|c| sig(c.order, 3)))
        .num(["95 % interval", "-"], shown(|c| c.interval.map(|end| sig(end, 2)).join(" … ")))
        .num(["expected", "-"], |(_, line, _)| Cell::text(line.expected))
        .table(table, &rows);
    let study = study.block(panels.fold(figure, Figure::panel)).block(table);
    rows.into_iter().fold(study, |study, (_, line, found)| {
        study.judge(line.gate.clone(), found.map_or(f64::NAN, |found| found.order))
    })
}
