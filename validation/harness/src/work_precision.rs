//! Error against cost: which settings reach an error with the least work, on three clocks (seconds,
//! pair interactions, steps), of which two cannot be disturbed by what else the machine does.

use base::record::{Cost, Record, Status};
use report::{Axis, Cell, Colour, Column, Dash, Figure, Layer, Legend, Plot, Series, Shape, Table};

/// One run: a variant at a resolution.
#[derive(Clone, Debug)]
pub struct Point {
    /// Name of the variant.
    pub variant: &'static str,
    /// Rows.
    pub rows: usize,
    /// What the rows are called, `10 rows` if the case says no other.
    pub resolution: String,
    /// Unit of the time at which it diverged.
    pub time: &'static str,
    /// What else is special about it, to follow the rows; mostly nothing.
    pub note: String,
    /// Its error \[-\]; NaN if the run failed.
    pub error: f64,
    /// Processor seconds of the stepping loop, one a repetition.
    pub seconds: Vec<f64>,
    /// What it took, counted.
    pub cost: Cost,
    /// How it ended.
    pub status: Status,
}

impl Point {
    /// A run that was timed once. One that did not reach its end has no error, whatever it measured before.
    pub fn of(variant: &'static str, rows: usize, error: f64, record: &Record) -> Self {
        let error = if record.status == Status::Completed { error } else { f64::NAN };
        let (seconds, cost) = (vec![record.cost.cpu_s], record.cost.clone());
        let status = record.status.clone();
        let (resolution, note) = (format!("{rows} rows"), String::new());
        Self { variant, rows, resolution, time: "s", note, error, seconds, cost, status }
    }

    /// Median of the repeated timings \[s\].
    pub fn median_seconds(&self) -> f64 {
        let mut sorted = self.seconds.clone();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        if n == 0 { f64::NAN } else { 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]) }
    }

    /// Fastest and slowest \[s\].
    pub fn spread(&self) -> (f64, f64) {
        let fold = |f: fn(f64, f64) -> f64| self.seconds.iter().copied().fold(f64::NAN, f);
        (fold(f64::min), fold(f64::max))
    }

    fn failure(&self) -> Option<String> {
        match &self.status {
            Status::Completed => None,
            Status::Diverged { time, .. } => {
                let Self { variant, resolution, time: unit, .. } = self;
                Some(format!("{variant}, {resolution}: diverged at t = {time:.3} {unit}"))
            }
            Status::Refused { reason } => Some(reason.clone()),
            Status::Interrupted { .. } => Some("interrupted".into()),
        }
    }
}

/// Points that no other point beats in both error and seconds, cheapest first.
pub fn pareto(points: &[Point]) -> Vec<&Point> {
    let mut sorted: Vec<&Point> = points.iter().filter(|p| p.error.is_finite()).collect();
    sorted.sort_by(|a, b| a.median_seconds().total_cmp(&b.median_seconds()));
    let mut front: Vec<&Point> = Vec::new();
    for point in sorted {
        if front.last().is_none_or(|best| point.error < best.error) {
            front.push(point);
        }
    }
    front
}

/// The cheapest point with at most this error, of those whose finer levels have at most this error too:
/// a single level may be good because parts of its error cancel.
pub fn cheapest(points: &[Point], error: f64) -> Option<&Point> {
    let holds = |point: &&Point| {
        let ladder = points.iter().filter(|p| p.variant == point.variant && p.note == point.note);
        ladder.filter(|p| p.rows >= point.rows).all(|p| p.error <= error)
    };
    let good = points.iter().filter(holds);
    good.min_by(|a, b| a.median_seconds().total_cmp(&b.median_seconds()))
}

/// A result of somebody else: name, seconds, error.
pub type Peer = (String, f64, f64);

/// Error against seconds and against pair interactions.
pub fn figure(id: &str, caption: &str, error: &str, points: &[Point], peers: &[Peer]) -> Figure {
    let seconds = |p: &Point| p.median_seconds();
    let pairs = |p: &Point| p.cost.pair_interactions as f64;
    let mut clock =
        panel("Error against run time", "stepping loop, one core [s]", error, points, seconds);
    clock.layers.splice(0..0, peer_layers(peers));
    let front = pareto(points).iter().map(|p| (p.median_seconds(), p.error)).collect();
    let line = Series::line("Pareto front", front).colour(Colour::GREY).dash(Dash::DashDot);
    clock = clock.layer(line).legend(Legend::Outside);
    let counted = panel("Error against work", "pair interactions [1]", error, points, pairs);
    Figure::new(id, caption).panel(clock).panel(counted.legend(Legend::Hidden)).columns(2)
}

fn panel(
    title: &str,
    cost_label: &str,
    error_label: &str,
    points: &[Point],
    cost: impl Fn(&Point) -> f64,
) -> Plot {
    let mut plot = Plot::new(title, Axis::log(cost_label), Axis::log(error_label));
    let mut variants: Vec<&str> = points.iter().map(|p| p.variant).collect();
    variants.dedup();
    for (k, variant) in variants.into_iter().enumerate() {
        let own: Vec<&Point> =
            points.iter().filter(|p| p.variant == variant && p.error.is_finite()).collect();
        let line = own.iter().map(|p| (cost(p), p.error)).collect();
        let mut series = Series::line_markers(variant, line).cycle(k);
        if title.contains("time") {
            series = series.x_bars(own.iter().map(|p| p.spread()).collect());
        }
        plot = plot.layer(series);
    }
    let failed: Vec<(f64, String)> =
        points.iter().filter_map(|p| Some((cost(p), p.failure()?))).collect();
    if failed.is_empty() { plot } else { plot.layer(Layer::Failed(failed)) }
}

fn peer_layers(peers: &[Peer]) -> Vec<Layer> {
    if peers.is_empty() {
        return Vec::new();
    }
    let points = peers.iter().map(|(_, seconds, error)| (*seconds, *error)).collect();
    let name = "other codes, another machine";
    vec![Series::markers(name, points).colour(Colour::GREY).shape(Shape::Plus).into()]
}

/// The table "cheapest setting that reaches 1 %, 0.3 %, 0.1 %, 0.03 %".
pub fn cheapest_table(caption: &str, points: &[Point]) -> Table {
    let columns = vec![
        Column::num("error wanted", "-"),
        Column::text("cheapest setting"),
        Column::num("error", "-"),
        Column::num("median", "s"),
        Column::text("fastest – slowest (runs)"),
        Column::num("steps", "1"),
        Column::num("pair interactions", "1"),
    ];
    let mut table = Table::new(caption, columns);
    for goal in [1e-2, 3e-3, 1e-3, 3e-4] {
        let wanted = Cell::percent(goal, 1);
        let Some(p) = cheapest(points, goal) else {
            let none = "none of the settings run";
            let rest = (0..5).map(|_| Cell::text("–"));
            table = table.row([wanted, Cell::text(none)].into_iter().chain(rest).collect());
            continue;
        };
        let (fast, slow) = p.spread();
        use report::seconds;
        table = table.row(vec![
            wanted,
            Cell::text(format!("`{}`, {}", p.variant, p.resolution)),
            Cell::percent(p.error, 2),
            Cell::seconds(p.median_seconds()),
            Cell::text(format!("{} – {} ({})", seconds(fast), seconds(slow), p.seconds.len())),
            Cell::count(p.cost.steps),
            Cell::sci(p.cost.pair_interactions as f64, 2),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(variant: &'static str, error: f64, seconds: &[f64]) -> Point {
        let (cost, status) = (Cost::default(), Status::Completed);
        Point {
            variant,
            rows: 10,
            resolution: "10 rows".into(),
            time: "s",
            note: String::new(),
            error,
            seconds: seconds.to_vec(),
            cost,
            status,
        }
    }

    #[test]
    fn the_front_keeps_what_nothing_beats_and_ignores_failures() {
        let points = [
            point("slow and good", 1e-4, &[3.0, 1.0, 2.0]),
            point("fast and bad", 1e-2, &[0.1]),
            point("slow and bad", 2e-2, &[1.5]),
            point("failed", f64::NAN, &[0.01]),
        ];
        let names: Vec<_> = pareto(&points).iter().map(|p| p.variant).collect();
        assert_eq!(names, ["fast and bad", "slow and good"]);
        assert_eq!(points[0].median_seconds(), 2.0);
        assert_eq!(points[0].spread(), (1.0, 3.0));
        assert_eq!(cheapest(&points, 1e-2).map(|p| p.variant), Some("fast and bad"));
        assert!(cheapest(&points, 1e-5).is_none());
    }

    #[test]
    fn an_error_that_a_finer_level_does_not_reach_is_not_the_cheapest() {
        let of = |rows: usize, error: f64, seconds: f64| Point {
            rows,
            ..point("cancels", error, &[seconds])
        };
        let points = [of(10, 1e-3, 0.1), of(20, 2e-3, 1.0), of(40, 5e-4, 9.0)];
        assert_eq!(cheapest(&points, 1e-3).map(|p| p.rows), Some(40));
        assert_eq!(cheapest(&points, 3e-3).map(|p| p.rows), Some(10));
    }
}
