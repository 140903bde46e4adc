//! How much every gate leaves of what it allows: one dot a gate.

use harness::{runs::Judged, suite::Suite};
use report::{Axis, Colour, Figure, Layer, Legend, Plot, Series, Shape, Status};

/// Where gates stand of which nothing is left, or of which there is no share.
const OUTSIDE: f64 = -0.08;

/// Gates whose margins differ by less than this stand above each other.
const SAME: f64 = 0.012;

/// The margins of all gates, one row a case.
pub fn figure(suite: &Suite) -> Figure {
    let names: Vec<String> = suite.cases.iter().rev().map(|case| case.case.name().into()).collect();
    let count = names.len();
    let axes = (
        Axis::linear("share of the allowance that is left [-]")
            .range(-0.13, 1.03)
            .ticks([0.0, 0.25, 0.5, 0.75, 1.0]),
        Axis::of_names("", names),
    );
    let mut dots: Vec<(Status, (f64, f64))> = Vec::new();
    for (row, case) in suite.cases.iter().rev().enumerate() {
        let judged = case.judged().map(|(_, judged)| judged);
        dots.extend(stacked(row as f64, judged.map(margin)));
    }
    let mut plot = Plot::new("", axes.0, axes.1).layer(Layer::vertical(0.0, ""));
    for (status, colour, shape) in LOOKS {
        let of_status = dots.iter().filter(|dot| dot.0 == status);
        let points: Vec<(f64, f64)> = of_status.map(|dot| dot.1).collect();
        let name = format!("{}: {}", status.name(), points.len());
        let series = Series::markers(name, points).colour(colour).shape(shape).size(4.0);
        plot = plot.layer(series);
    }
    let caption = "The margin of every gate, one dot a gate and one row a case: 0 is at the bound, and 1 as \
                   far inside as can be. A limitation is measured by its own, wider bound. Left of 0 stand \
                   gates outside their bound, and those that allow a single number only.";
    let height = 24.0 * count.max(1) as f64;
    Figure::new("margins", caption).panel(plot.legend(Legend::Outside)).panel_size(620.0, height)
}

/// Status, colour and shape, the worst drawn last.
const LOOKS: [(Status, Colour, Shape); 4] = [
    (Status::Pass, Colour::BLUE, Shape::Circle),
    (Status::ExpectedFailure, Colour::PURPLE, Shape::Square),
    (Status::Limitation, Colour::ORANGE, Shape::Diamond),
    (Status::Fail, Colour::VERMILLION, Shape::Cross),
];

/// What is drawn of a gate that is judged.
fn margin(judged: &Judged) -> (Status, f64) {
    let margin = judged.judgement.margin.filter(|margin| margin.is_finite());
    (judged.status(), margin.unwrap_or(OUTSIDE))
}

/// Dots of a row: those of nearly one margin above and below each other, within the row.
fn stacked(
    row: f64,
    margins: impl Iterator<Item = (Status, f64)>,
) -> impl Iterator<Item = (Status, (f64, f64))> {
    let mut margins: Vec<(Status, f64)> = margins.collect();
    margins.sort_by(|a, b| a.1.total_cmp(&b.1));
    let step = |(_, margin): &(Status, f64)| (margin / SAME).round() as i64;
    let place = |stack: &[(Status, f64)]| -> Vec<(Status, (f64, f64))> {
        let apart = (0.8 / stack.len() as f64).min(0.2);
        let height = |k: usize| (k as f64 - 0.5 * (stack.len() - 1) as f64) * apart;
        let dot =
            |(k, (status, margin)): (usize, &(Status, f64))| (*status, (*margin, row + height(k)));
        stack.iter().enumerate().map(dot).collect()
    };
    let placed: Vec<_> = margins.chunk_by(|a, b| step(a) == step(b)).flat_map(place).collect();
    placed.into_iter()
}
