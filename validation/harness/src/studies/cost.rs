//! Errors and their cost: the order in the spacing, and which settings reach an error with the least work, in
//! seconds of a run that was made alone, and in pair interactions, which do not depend on the machine or on
//! other programs.

use base::record::{Status, median};
use report::{Axis, Colour, Figure, Plot, Series, first_sentence};

use crate::{
    declare::{Accuracy, Ladder, Level, error_of},
    runs::Runs,
    studies::order::{GOALS, orders},
    study::Study,
};

/// One run of a cost diagram.
#[derive(Clone, Debug)]
pub struct Point {
    /// The variant of its ladder.
    pub ladder: String,
    /// Spacing.
    pub spacing: f64,
    /// The resolution in words.
    pub label: String,
    /// Its error; NaN if it has none.
    pub error: f64,
    /// Processor seconds of the stepping, sorted, taken alone \[s\].
    pub seconds: Vec<f64>,
    /// Pair interactions.
    pub pairs: f64,
    /// Ladder and resolution of a run that failed, which has no error.
    pub failure: Option<String>,
}

impl Point {
    /// Median of the timings \[s\]; NaN if the run was not timed.
    pub fn median(&self) -> f64 {
        median(&self.seconds).unwrap_or(f64::NAN)
    }

    /// Fastest and slowest \[s\].
    pub fn spread(&self) -> (f64, f64) {
        let end = |value: Option<&f64>| value.copied().unwrap_or(f64::NAN);
        (end(self.seconds.first()), end(self.seconds.last()))
    }
}

/// The points of a ladder.
pub fn points(accuracy: &Accuracy, ladder: &Ladder, runs: &Runs) -> Vec<Point> {
    let point = |level: &Level| {
        let record = runs.record(&level.run.spec)?;
        let error = error_of(&accuracy.error, record);
        let name = ladder.variant.to_string();
        let has_failed = record.status != Status::Completed;
        let failure = has_failed.then(|| format!("{name}, {}", level.label));
        let mut seconds = record.cost.alone_s.clone();
        seconds.sort_by(f64::total_cmp);
        Some(Point {
            ladder: name,
            spacing: level.spacing,
            label: level.label.clone(),
            error: error.unwrap_or(f64::NAN),
            seconds,
            pairs: record.cost.pair_interactions as f64,
            failure,
        })
    };
    ladder.levels.iter().filter_map(point).collect()
}

/// What a run costs.
type Cost = fn(&Point) -> f64;

/// Points that no other point beats in both error and cost, cheapest first.
fn pareto(points: &[Point], cost: Cost) -> Vec<&Point> {
    let mut sorted: Vec<&Point> = points.iter().filter(|p| p.error.is_finite()).collect();
    sorted.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    let mut front: Vec<&Point> = Vec::new();
    for point in sorted {
        if front.last().is_none_or(|best| point.error < best.error) {
            front.push(point);
        }
    }
    front
}

/// The least median of a point of a ladder with at most this error, of those whose finer levels have at most
/// this error too: a single level may be good because parts of its error cancel. NaN if there is none.
fn cheapest(ladder: &[Point], error: f64) -> f64 {
    let holds = |point: &&Point| {
        let finer = ladder.iter().filter(|p| p.spacing <= point.spacing);
        finer.into_iter().all(|p| p.error <= error)
    };
    ladder.iter().filter(holds).map(Point::median).fold(f64::NAN, f64::min)
}

pub fn study(accuracy: &Accuracy, runs: &Runs) -> Study {
    let id = format!("{}-work-precision", accuracy.id);
    let of = |ladder| points(accuracy, ladder, runs);
    let ladders: Vec<Vec<Point>> = accuracy.ladders.iter().map(of).collect();
    let costs: Vec<_> =
        ladders.iter().map(|ladder| GOALS.map(|goal| cheapest(ladder, goal))).collect();
    let orders = orders(accuracy, &costs, runs);
    let study = Study::new(&id, "Error against spacing and run time");
    let study =
        orders.judged.into_iter().fold(study, |study, (gate, order)| study.judge(gate, order));
    let figure = figure(&id, accuracy, &ladders.concat(), (orders.panel, orders.caption));
    study.block(figure).block(orders.table)
}

/// Beside the panel of orders and what its caption explains.
fn figure(
    id: &str,
    accuracy: &Accuracy,
    points: &[Point],
    (orders, explained): (Plot, String),
) -> Figure {
    let failed: Vec<&str> = points.iter().filter_map(|p| p.failure.as_deref()).collect();
    let failed = match failed.is_empty() {
        true => String::new(),
        false => format!(" Runs that failed: {}.", failed.join("; ")),
    };
    let caption = format!(
        "{} {} over spacing (left), run time on one core (middle) and work (right).\
         {explained}{failed}",
        first_sentence(&accuracy.about).0,
        name_of_error(&accuracy.label),
    );
    let clock = panel("Error against run time", "run time on one core [s]", points, Point::median);
    let pairs = |p: &Point| p.pairs;
    let counted = panel("Error against work", "pair interactions [-]", points, pairs);
    let panels = [orders, clock, counted];
    let figure = Figure::new(id, caption).columns(panels.len()).panel_size(320.0, 290.0);
    panels.into_iter().fold(figure, Figure::panel)
}

/// The label of an axis without the mark of a number without unit, as the beginning of a sentence.
fn name_of_error(label: &str) -> String {
    let name = label.trim_end_matches(" [-]");
    let mut letters = name.chars();
    // An abbreviation or a symbol stays as it is.
    let is_word = name.split(' ').next().is_some_and(|word| word.len() > 3);
    match letters.next().filter(|_| is_word) {
        Some(first) => first.to_uppercase().chain(letters).collect(),
        None => format!("The {name}"),
    }
}

/// The first number of a resolution in words.
fn short(label: &str) -> String {
    let is_number = |word: &&str| word.starts_with(|c: char| c.is_ascii_digit());
    label.split_whitespace().find(is_number).unwrap_or(label).into()
}

fn panel(title: &str, cost_label: &str, points: &[Point], cost: Cost) -> Plot {
    // The error is named at the panel on the left.
    let mut plot = Plot::new(title, Axis::log(cost_label), Axis::log(""));
    let front = pareto(points, cost).iter().map(|p| (cost(p), p.error)).collect();
    plot = plot.layer(Series::line("Pareto front", front).colour(PALE).width(7.0));
    for (k, ladder) in points.chunk_by(|a, b| a.ladder == b.ladder).enumerate() {
        let own: Vec<&Point> = ladder.iter().filter(|p| p.error.is_finite()).collect();
        let line = own.iter().map(|p| (cost(p), p.error)).collect();
        let mut series = Series::line_markers(&ladder[0].ladder, line).cycle(k);
        if title.contains("time") {
            series = series.labels(own.iter().map(|p| short(&p.label)));
            series = series.x_bars(own.iter().map(|p| p.spread()).collect());
        }
        plot = plot.layer(series);
    }
    plot
}

/// Behind everything else.
const PALE: Colour = Colour(222, 222, 222);

#[cfg(test)]
mod tests {
    use super::*;

    fn point(ladder: &str, error: f64, seconds: &[f64]) -> Point {
        Point {
            ladder: ladder.into(),
            spacing: 0.1,
            label: "10 rows".into(),
            error,
            seconds: seconds.to_vec(),
            pairs: 1.0,
            failure: None,
        }
    }

    #[test]
    fn the_front_keeps_what_nothing_beats_and_ignores_failures() {
        let points = [
            point("slow and good", 1e-4, &[1.0, 2.0, 3.0]),
            point("fast and bad", 1e-2, &[0.1]),
            point("slow and bad", 2e-2, &[1.5]),
            point("failed", f64::NAN, &[0.01]),
        ];
        let names: Vec<_> =
            pareto(&points, Point::median).iter().map(|p| p.ladder.as_str()).collect();
        assert_eq!(names, ["fast and bad", "slow and good"]);
        assert_eq!(points[0].median(), 2.0);
        assert_eq!(points[0].spread(), (1.0, 3.0));
    }

    fn names<'a>(points: impl IntoIterator<Item = &'a Point>) -> Vec<&'a str> {
        points.into_iter().map(|p| p.ladder.as_str()).collect()
    }

    /// What is a tenth worse at a higher cost is beaten, what is a hundredth better is not.
    #[test]
    fn the_front_drops_what_is_a_little_worse_and_keeps_what_is_a_little_better() {
        let points = [
            point("a hundredth better", 0.99e-2, &[4.0]),
            point("a tenth worse", 1.1e-2, &[2.0]),
            point("cheapest", 1e-2, &[1.0]),
            point("a thousandth worse", 1.001e-2, &[3.0]),
            point("equal and dearer", 1e-2, &[1.5]),
            point("worse than the best alone", 0.9901e-2, &[5.0]),
        ];
        assert_eq!(names(pareto(&points, Point::median)), ["cheapest", "a hundredth better"]);
        // By work, of which they all have as much as the number of their place, the first comes first.
        let work = |k: usize| Point { pairs: k as f64, ..points[k].clone() };
        let work: Vec<Point> = (0..points.len()).map(work).collect();
        assert_eq!(names(pareto(&work, |p| p.pairs)), ["a hundredth better"]);
    }

    /// The median, not the mean or the fastest, is what a level costs.
    #[test]
    fn the_cost_is_a_median_and_every_finer_level_counts() {
        let disturbed = [point("disturbed once", 1e-3, &[2.0, 2.1, 30.0])];
        assert_eq!((cheapest(&disturbed, 1e-3), disturbed[0].spread()), (2.1, (2.0, 30.0)));
        assert!(cheapest(&disturbed, 1e-5).is_nan());
        // A failure has no error, so what is coarser than it does not count either.
        let failed = Point { spacing: 0.05, ..point("failed later", f64::NAN, &[9.0]) };
        assert!(cheapest(&[point("failed later", 1e-3, &[1.0]), failed], 1e-2).is_nan());
    }

    #[test]
    fn captions_begin_with_a_whole_sentence() {
        assert_eq!(name_of_error("relative error of u [-]"), "Relative error of u");
        assert_eq!(name_of_error("rms error of u [U_b]"), "The rms error of u [U_b]");
    }

    #[test]
    fn a_resolution_in_short_is_its_first_number() {
        assert_eq!(
            ["20 rows", "H/dx = 10", "50 x 50", "fine"].map(short),
            ["20", "10", "50", "fine"]
        );
    }

    #[test]
    fn an_error_that_a_finer_level_does_not_reach_is_not_the_cheapest() {
        let of = |spacing: f64, error: f64, seconds: f64| Point {
            spacing,
            ..point("cancels", error, &[seconds])
        };
        let points = [of(0.1, 1e-3, 0.1), of(0.05, 2e-3, 1.0), of(0.025, 5e-4, 9.0)];
        assert_eq!(cheapest(&points, 1e-3), 9.0);
        assert_eq!(cheapest(&points, 3e-3), 0.1);
    }
}
