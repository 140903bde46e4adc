//! The observed order of accuracy with its confidence interval: a panel, a table and gates, which the study
//! of errors and their cost shows.

use base::gate::Gate;
use report::{Axis, Cell, Layer, Legend, Plot, Series, Table, exact, percent, sig};

use crate::{
    columns::Columns,
    convergence::{Convergence, ConvergenceError, Label, Level as Point, convergence},
    declare::{Accuracy, Ladder, Level, error_of},
    runs::Runs,
};

/// The errors of the levels of a ladder.
fn points(accuracy: &Accuracy, ladder: &Ladder, runs: &Runs) -> Vec<Point> {
    let error = |level: &Level| error_of(&accuracy.error, runs.record(&level.run.spec)?);
    let point =
        |level: &Level| Point { spacing: level.spacing, value: error(level).unwrap_or(f64::NAN) };
    ladder.levels.iter().map(point).collect()
}

/// What is found of the orders of all ladders.
pub struct Orders {
    /// Error against spacing.
    pub panel: Plot,
    /// What the caption of the panel has to explain, beginning with a space.
    pub caption: String,
    /// Orders, intervals, and what errors cost.
    pub table: Table,
    /// Gates of ladders with their orders.
    pub judged: Vec<(Gate, f64)>,
}

/// The errors of which the table tells the least run time that reaches them.
pub const GOALS: [f64; 2] = [1e-2, 1e-3];

/// `costs` are the seconds that each ladder takes to reach the [`GOALS`], NaN if it does not.
pub fn orders(accuracy: &Accuracy, costs: &[[f64; 2]], runs: &Runs) -> Orders {
    let slope = accuracy.slope.map(|order| format!(" The triangle shows order {}.", exact(order)));
    let axes = (Axis::log(accuracy.spacing), Axis::log(accuracy.label.as_str()));
    let mut panel = Plot::new("Error against spacing", axes.0, axes.1).legend(Legend::Hidden);
    let (mut rows, mut judged) = (Vec::new(), Vec::new());
    for (k, ladder) in accuracy.ladders.iter().enumerate() {
        let points = points(accuracy, ladder, runs);
        let usable = points.iter().filter(|p| p.value.is_finite());
        let line = usable.map(|p| (p.spacing, p.value)).collect();
        let name = ladder.variant.to_string();
        panel = panel.layer(Series::line_markers(&name, line).cycle(k));
        let found = convergence(&points);
        if let Some(order) = ladder.order.clone() {
            judged.push((order, found.as_ref().map_or(f64::NAN, |c| c.order)));
        }
        let finest = points.last().map_or(f64::NAN, |p| p.value);
        rows.push(Row { name, found, finest, costs: costs[k] });
    }
    let panel = accuracy.slope.into_iter().map(Layer::Slope).fold(panel, Plot::layer);
    let about = format!("Observed orders of accuracy. {} {TIMES}", accuracy.about);
    let table = table(about, &rows);
    Orders { panel, caption: slope.unwrap_or_default(), table, judged }
}

const TIMES: &str = "Times are the least median run time on one core of a level whose error, and that of \
    every finer level, is at most so much: at a single level errors of time and spacing can cancel.";

struct Row {
    /// The variant of the ladder.
    name: String,
    /// Its order, or why it has none.
    found: Result<Convergence, ConvergenceError>,
    /// Its finest error.
    finest: f64,
    costs: [f64; 2],
}

fn table(about: String, rows: &[Row]) -> Table {
    let of = |show: fn(&Convergence) -> String| {
        move |row: &Row| row.found.as_ref().map_or("–".into(), show)
    };
    let order = of(|found| format!("{} ± {}", sig(found.order, 3), sig(found.standard_error, 2)));
    let interval = of(|found| {
        let [low, high] = found.interval.map(|end| sig(end, 2));
        format!("{low} … {high}")
    });
    let local = of(|found| {
        let orders: Vec<String> = found.local_orders.iter().map(|p| sig(*p, 2)).collect();
        orders.join(", ")
    });
    let label = |row: &Row| match &row.found {
        Ok(Convergence { label: Label::Asymptotic, .. }) => "asymptotic".into(),
        Ok(Convergence { label: Label::FloorReached, .. }) => "floor reached".into(),
        Ok(Convergence { label: Label::NotAsymptotic, .. }) => "not asymptotic".into(),
        Err(error) => format!("no order: {error}"),
    };
    let columns = Columns::default()
        .code("variant", |row: &Row| row.name.clone())
        .num(["order ± standard error", "-"], move |row| Cell::text(order(row)))
        .text("95 % interval", interval)
        .text("local orders, coarse to fine", local)
        .text("label", label)
        .of(["finest error", "-"], |row| row.finest, |error| Cell::percent(error, 2));
    let columns = GOALS.iter().enumerate().fold(columns, |columns, (k, goal)| {
        let head = format!("time to {}", percent(*goal, 1));
        columns.of([&head, "s"], move |row| row.costs[k], Cell::seconds)
    });
    columns.table(about, rows)
}

#[cfg(test)]
mod tests {
    use base::gate::{Bound, Evidence, Verdict};

    use super::*;
    use crate::{
        runs::Runs,
        studies::tests::{ERROR, column, comparison, runs, spec},
    };

    /// Ladders of `seed` and `best` at n = 10, 20, 40, 80; the order of the second is judged.
    fn accuracy() -> Accuracy {
        let bound = Bound::Within(2.9, 3.1);
        let gate = Gate::new("case.order", "order", bound, Evidence::Theory, "made up");
        let ladder = |(variant, order)| {
            let levels = comparison(variant, &[10, 20, 40, 80]).levels;
            Ladder { variant, levels, order }
        };
        let ladders = [("seed", None), ("best", Some(gate))].map(ladder).into();
        Accuracy { ladders, ..Accuracy::new("case", ERROR, "Error [-]") }
    }

    /// Runs with these errors, a function of variant and n.
    fn made(of: impl Fn(&str, f64) -> f64) -> Runs {
        let levels = [10, 20, 40, 80];
        let each = ["seed", "best"].into_iter().flat_map(|v| levels.map(|n| (v, n)));
        runs(each.map(|(variant, n)| (spec(variant, n), of(variant, n as f64))))
    }

    #[test]
    fn each_ladder_has_the_order_of_its_own_errors() {
        let runs = made(|variant, n| match variant {
            "seed" => -4.0 / (n * n), // a metric with a sign
            _ => 8.0 / n.powi(3),
        });
        let orders = orders(&accuracy(), &[[0.5, f64::NAN]; 2], &runs);
        assert_eq!(column(&orders.table, "variant"), ["`seed`", "`best`"]);
        let local = column(&orders.table, "local orders, coarse to fine");
        assert_eq!(local, ["2.0, 2.0, 2.0", "3.0, 3.0, 3.0"]);
        assert_eq!(column(&orders.table, "label"), ["asymptotic", "asymptotic"]);
        let finest = column(&orders.table, "finest error");
        assert_eq!(finest, ["0.062 %", "0.0016 %"], "4/80² and 8/80³");
        let times =
            GOALS.map(|goal| column(&orders.table, &format!("time to {}", percent(goal, 1))));
        assert_eq!(times, [["500 ms"; 2], ["–"; 2]]);
        let [(gate, order)] = orders.judged.as_slice() else { panic!("one order is judged") };
        assert_eq!(
            (gate.id.as_str(), gate.judge(Some(*order)).verdict),
            ("case.order", Verdict::Pass)
        );
        assert!((order - 3.0).abs() < 1e-12, "order {order} of errors 8/n³");
        assert_eq!(orders.caption, " The triangle shows order 2.");
    }

    #[test]
    fn a_level_that_failed_leaves_no_order_and_its_gate_fails() {
        let runs = made(|_, n| if n == 20.0 { f64::NAN } else { 1.0 / n });
        let orders = orders(&accuracy(), &[[0.5, f64::NAN]; 2], &runs);
        assert!(orders.judged[0].1.is_nan(), "order {}", orders.judged[0].1);
        assert!(
            column(&orders.table, "label")[0].starts_with("no order: a level with spacing 0.05")
        );
    }
}
