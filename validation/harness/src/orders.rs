//! The order at which an error falls under refinement: columns of a table and a panel of a figure for any
//! study, and a whole section for orders of one case alone.

use std::cmp::Ordering;

use touchstone_base::{functions::powf, gate::Gate};
use touchstone_report::{Axis, Cell, Colour, Figure, Plot, Series, sig};

use crate::{
    columns::TableColumns,
    convergence::{Convergence, ErrorLevel, convergence},
    looks,
    section::Section,
};

/// An order, or why there is none.
pub type FittedOrder = Result<Convergence, String>;

/// Something that is refined.
pub struct Refinement {
    /// Title of its panel.
    pub title: &'static str,
    /// The refined quantity and the error, with their units.
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
    pub levels: Vec<ErrorLevel>,
    /// The order that theory gives.
    pub formal: f64,
    /// Judges the order.
    pub gate: Gate,
}

/// Adds the figure, the table and the judged orders to a section; lines that `is_drawn` refuses are not
/// drawn.
pub fn add(
    section: Section,
    [figure, table]: [&str; 2],
    all: &[Refinement],
    is_drawn: fn(&Line) -> bool,
) -> Section {
    let panel = |of: &Refinement| {
        let drawn = of.lines.iter().filter(|line| is_drawn(line));
        let lines = drawn.map(|line| (line.name, line.levels.as_slice()));
        plot(of.title, of.axes, lines, of.slopes)
    };
    let panels = all.iter().map(panel);
    let found = |line: &Line| convergence(&line.levels, Some(line.formal));
    let figure = Figure::new(section.id.clone(), figure).columns(2).panel_size(330.0, 260.0);
    type Row<'a> = (&'a str, &'a Line, FittedOrder);
    let rows: Vec<Row> = all
        .iter()
        .flat_map(|of| of.lines.iter().map(|line| (of.title, line, found(line))))
        .collect();
    let table = TableColumns::<Row>::default()
        .text("refined", |(title, ..)| *title)
        .code("variant", |(_, line, _)| line.name)
        .order(|(.., found)| found)
        .table(table, &rows);
    let section = section.block(panels.fold(figure, Figure::panel)).block(table);
    rows.into_iter().fold(section, |section, (_, line, found)| {
        section.judge(line.gate.clone(), found.map_or(f64::NAN, |found| found.order))
    })
}

/// Errors over the refined quantity, by the name of each line, and orders as grey lines from the largest
/// error of the coarsest level.
pub fn plot<'a>(
    title: &str,
    [x, y]: [&str; 2],
    lines: impl Iterator<Item = (&'a str, &'a [ErrorLevel])> + Clone,
    slopes: &[f64],
) -> Plot {
    let series = |(k, (name, levels)): (usize, (&str, &[ErrorLevel]))| {
        let usable = levels.iter().filter(|level| level.value.is_finite());
        let points = usable.map(|level| (level.spacing, level.value)).collect();
        looks::line(name, points, k)
    };
    let plot = Plot::new(title, Axis::log(x), Axis::log(y));
    let plot = lines.clone().enumerate().map(series).fold(plot, Plot::layer);
    let levels = || lines.clone().flat_map(|(_, levels)| levels).filter(|l| l.value.is_finite());
    let size = |level: &&ErrorLevel| (level.spacing, level.value);
    let by_spacing =
        |a: &&ErrorLevel, b: &&ErrorLevel| size(a).partial_cmp(&size(b)).unwrap_or(Ordering::Equal);
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

/// Numbers with this number of digits, separated by commas.
fn listed(numbers: impl Iterator<Item = f64>, digits: usize) -> String {
    let text = |number: f64| if number.is_nan() { "–".into() } else { sig(number, digits) };
    numbers.map(text).collect::<Vec<_>>().join(", ")
}

impl<'a, T> TableColumns<'a, T> {
    /// More columns: the order of an item, how sure it is, and whether to believe it.
    #[must_use]
    pub fn order(self, found: impl Fn(&T) -> &FittedOrder + Copy + 'a) -> Self {
        let of = |show: fn(&Convergence) -> String| {
            move |item: &T| found(item).as_ref().map_or("–".into(), show)
        };
        let order = move |item: &T| match found(item) {
            Ok(of) => Cell { value: Some(of.order), ..Cell::text(of.in_words()) },
            Err(_) => Cell::text("–"),
        };
        let label = move |item: &T| match found(item) {
            Ok(Convergence { label, .. }) => label.name().into(),
            Err(error) => format!("no order: {error}"),
        };
        let local = of(|of| listed(of.local_orders.iter().copied(), 2));
        self.num(["order (95 %)", "-"], order)
            .text("local orders, coarse to fine", local)
            .text("label", label)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use touchstone_base::gate::{Bound, Evidence};
    use touchstone_report::{Block, Layer};

    use super::*;

    fn levels(value: fn(f64) -> f64) -> Vec<ErrorLevel> {
        [0.4, 0.2, 0.1].map(|spacing| ErrorLevel { spacing, value: value(spacing) }).into()
    }

    /// A grey line begins at the error of the coarsest level, and falls with its order to the finest spacing.
    #[test]
    fn a_grey_line_falls_from_the_coarsest_level_with_its_order() {
        let levels = levels(|h| 2.0 * h);
        let plot = plot("", ["dx", "error"], [("a", levels.as_slice())].into_iter(), &[2.0]);
        let Some(Layer::Series(line)) = plot.layers.last() else { panic!("no line") };
        let [(fine, end), (coarse, start)] = line.points[..] else { panic!("{:?}", line.points) };
        assert_eq!((fine, coarse, start), (0.1, 0.4, 0.8));
        assert_relative_eq!(end, 0.8 / 16.0, max_relative = 1e-14);
    }

    /// The label of each line compares its order with the order of its own theory.
    #[test]
    fn the_order_of_a_line_is_held_against_that_of_its_theory() {
        let gate = |name| {
            let bound = Bound::Within(1.9, 2.1);
            Gate::new(format!("case.{name}"), "order", bound, Evidence::Theory, "made up")
        };
        let line = |(name, formal)| Line {
            name,
            levels: levels(|h| 3.0 * h * h),
            formal,
            gate: gate(name),
        };
        let lines = [("second", 2.0), ("first", 1.0)].map(line).into();
        let all = [Refinement { title: "dx", axes: ["dx", "error"], slopes: &[], lines }];
        let section = add(Section::new("case-orders", "Orders"), ["", ""], &all, |_| true);
        let [_, Block::Table(table)] = &section.blocks[..] else { panic!("a figure and a table") };
        let labels: Vec<&str> = table.rows.iter().map(|row| &*row[row.len() - 1].text).collect();
        assert_eq!(labels, ["asymptotic", "orders agree"]);
    }
}
