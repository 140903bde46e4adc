//! The order at which an error falls as something is refined: columns of a table and a panel of a figure for
//! any study, and a whole study for those of one case alone.

use std::cmp::Ordering;

use base::{functions::powf, gate::Gate};
use report::{Axis, Cell, Colour, Figure, Plot, Series, sig};

use crate::{
    columns::Columns,
    convergence::{Convergence, Level, convergence},
    study::Study,
};

/// An order, or why there is none.
pub type Found = Result<Convergence, String>;

/// Something that is refined.
pub struct Refinement {
    /// Title of its panel.
    pub title: &'static str,
    /// What is refined and the error, with their units.
    pub axes: [&'static str; 2],
    /// Orders that are drawn as grey lines.
    pub slopes: &'static [f64],
    /// Errors, a line each.
    pub lines: Vec<Line>,
}

/// Errors of a variant over a refinement.
pub struct Line {
    /// Name of the variant.
    pub name: &'static str,
    /// Errors, coarse to fine.
    pub levels: Vec<Level>,
    /// The order that theory gives.
    pub formal: f64,
    /// Judges the order.
    pub gate: Gate,
}

/// Adds the figure, the table and the judged orders to a study; lines that `is_drawn` refuses are not drawn.
pub fn study(
    study: Study,
    [figure, table]: [&str; 2],
    all: &[Refinement],
    is_drawn: fn(&Line) -> bool,
) -> Study {
    let panel = |of: &Refinement| {
        let drawn = of.lines.iter().filter(|line| is_drawn(line));
        let lines = drawn.map(|line| (line.name, line.levels.as_slice()));
        plot(of.title, of.axes, lines, of.slopes)
    };
    let panels = all.iter().map(panel);
    let found = |line: &Line| convergence(&line.levels, Some(line.formal));
    let figure = Figure::new(study.id.clone(), figure).columns(2).panel_size(330.0, 260.0);
    type Row<'a> = (&'a str, &'a Line, Found);
    let rows: Vec<Row> = all
        .iter()
        .flat_map(|of| of.lines.iter().map(|line| (of.title, line, found(line))))
        .collect();
    let errors = |(_, line, _): &Row| listed(line.levels.iter().map(|level| level.value), 3);
    let table = Columns::<Row>::default()
        .text("refined", |(title, ..)| *title)
        .code("variant", |(_, line, _)| line.name)
        .text("errors, coarse to fine", errors)
        .order(|(.., found)| found)
        .table(table, &rows);
    let study = study.block(panels.fold(figure, Figure::panel)).block(table);
    rows.into_iter().fold(study, |study, (_, line, found)| {
        study.judge(line.gate.clone(), found.map_or(f64::NAN, |found| found.order))
    })
}

/// Errors over what is refined, by the name of each line, and orders as grey lines from the largest error of
/// the coarsest level.
pub fn plot<'a>(
    title: &str,
    [x, y]: [&str; 2],
    lines: impl Iterator<Item = (&'a str, &'a [Level])> + Clone,
    slopes: &[f64],
) -> Plot {
    let series = |(k, (name, levels)): (usize, (&str, &[Level]))| {
        let usable = levels.iter().filter(|level| level.value.is_finite());
        let points = usable.map(|level| (level.spacing, level.value)).collect();
        Series::line(name, points).cycle(k)
    };
    let plot = Plot::new(title, Axis::log(x), Axis::log(y));
    let plot = lines.clone().enumerate().map(series).fold(plot, Plot::layer);
    let levels = || lines.clone().flat_map(|(_, levels)| levels).filter(|l| l.value.is_finite());
    let size = |level: &&Level| (level.spacing, level.value);
    let by_spacing =
        |a: &&Level, b: &&Level| size(a).partial_cmp(&size(b)).unwrap_or(Ordering::Equal);
    let (Some(coarsest), Some(finest)) = (levels().max_by(by_spacing), levels().min_by(by_spacing))
    else {
        return plot;
    };
    slopes.iter().fold(plot, |plot, order| {
        let end = coarsest.value * powf(finest.spacing / coarsest.spacing, *order);
        let ends = vec![(finest.spacing, end), size(&coarsest)];
        let line = Series::line("", ends).colour(Colour::GREY).width(1.0);
        plot.layer(line.labels([format!("order {order}")]))
    })
}

/// Numbers with so many digits, one after the other.
fn listed(numbers: impl Iterator<Item = f64>, digits: usize) -> String {
    numbers.map(|number| sig(number, digits)).collect::<Vec<_>>().join(", ")
}

impl<'a, T> Columns<'a, T> {
    /// More columns: the order of an item, how sure it is, and whether to believe it.
    #[must_use]
    pub fn order(self, found: impl Fn(&T) -> &Found + Copy + 'a) -> Self {
        let of = |show: fn(&Convergence) -> String| {
            move |item: &T| found(item).as_ref().map_or("–".into(), show)
        };
        let order = of(|of| format!("{} ± {}", sig(of.order, 3), sig(of.standard_error, 2)));
        let label = move |item: &T| match found(item) {
            Ok(Convergence { label, .. }) => label.name().into(),
            Err(error) => format!("no order: {error}"),
        };
        self.num(["order ± standard error", "-"], move |item| Cell::text(order(item)))
            .text("95 % interval", of(|of| of.interval.map(|end| sig(end, 2)).join(" … ")))
            .text(
                "local orders, coarse to fine",
                of(|of| listed(of.local_orders.iter().copied(), 2)),
            )
            .text("label", label)
    }
}
