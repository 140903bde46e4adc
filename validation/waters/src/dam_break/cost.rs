//! What accuracy costs: the front of the column of Martin & Moyce at several resolutions, its observed
//! order, and the distance from the finest run against run time.

use super::{
    plan::PEERS,
    reference::{Curve, value},
    studies::{curve, is_free},
};
use base::{
    gate::{Bound, Evidence, Gate},
    record::Record,
};
use harness::{
    case::Tier,
    suite::{JudgedRun, Study},
    work_precision::{self, Point},
};
use report::{Cell, Column, Table, sig};

/// Error of the front against what it costs.
pub fn study(tier: Tier, runs: &[JudgedRun]) -> Study {
    let finest = runs.iter().map(|run| &run.record).rfind(|r| is_free(r) && r.variant == "modern");
    let best = finest.map(front).unwrap_or_default();
    let is_shown = |run: &&JudgedRun| {
        is_free(&run.record) && finest.is_none_or(|f| !std::ptr::eq(f, &run.record))
    };
    let point = |run: &JudgedRun| {
        let record = &run.record;
        let error = rms(&front(record), &best, LATER);
        Point::of(run.planned.variant, record.setting("n") as usize, error, record)
    };
    let points: Vec<Point> = runs.iter().filter(is_shown).map(point).collect();
    let finest_n = finest.map_or(f64::NAN, |r| r.setting("n"));
    let caption = format!(
        "rms distance of the front Z(T), 1 ≤ T ≤ 3.3, from that of `modern` at a/dx = {finest_n}, over the \
         cost of the run. A variant approaches it with its points from left to right; rows are spacings \
         along a. The finest run is itself short of the limit by what the order below leaves, so a point \
         nearer to it than that says no more. Timed once, side by side with other runs; pair interactions \
         are exact."
    );
    let id = "dam-break-work-precision";
    let label = "rms distance of Z from the finest run [a]";
    let mut study = Study::new(id, "Error against run time")
        .block(work_precision::figure(id, &caption, label, &points, &[]))
        .block(rate_table(runs));
    if tier == Tier::Full {
        study = orders(study, runs);
    }
    study
}

/// T between which fronts are compared: before, they have hardly moved; later, there is no experiment.
const LATER: [f64; 2] = [1.0, 3.3];

/// Z over T.
fn front(record: &Record) -> Curve {
    let (a, g) = (record.setting("width"), record.setting("gravity"));
    curve(record, "series", "front", [(0.5 * a / g).sqrt(), a], 0.0)
}

/// rms distance of two curves over a window of time.
fn rms(one: &Curve, other: &Curve, [from, to]: [f64; 2]) -> f64 {
    const POINTS: usize = 100;
    let at = |k: usize| from + (to - from) * (k as f64 + 0.5) / POINTS as f64;
    let square = |k: usize| (value(one, at(k)) - value(other, at(k))).powi(2);
    ((0..POINTS).map(square).sum::<f64>() / POINTS as f64).sqrt()
}

/// The observed order of three curves, each at half the spacing of the one before: log2 of the rms of
/// successive differences, over the whole window, and the least and most over its thirds.
fn order([coarse, middle, fine]: [&Curve; 3]) -> [f64; 3] {
    let over = |window| (rms(coarse, middle, window) / rms(middle, fine, window)).log2();
    let [from, to] = LATER;
    let third = (to - from) / 3.0;
    let thirds = [0.0, 1.0, 2.0].map(|k| over([from + k * third, from + (k + 1.0) * third]));
    let fold = |f: fn(f64, f64) -> f64| thirds.into_iter().fold(f64::NAN, f);
    [over(LATER), fold(f64::min), fold(f64::max)]
}

/// The observed order of the front, variant by variant, from the three finest runs of each.
fn orders(mut study: Study, runs: &[JudgedRun]) -> Study {
    let columns = vec![
        Column::text("variant"),
        Column::text("a/dx"),
        Column::text("Z at T = 3"),
        Column::num("order", "-"),
        Column::text("over thirds of the time"),
        Column::num("Z at T = 3 in the limit", "a"),
    ];
    let caption = format!(
        "Observed order of the front: log2 of the ratio of the rms of successive differences of Z(T), 1 ≤ T \
         ≤ 3.3, and as its error the range over thirds of that time. The limit is Richardson's with that \
         order. Three other codes have {} to {} at T = 3.",
        PEERS[1].1, PEERS[1].2
    );
    let mut table = Table::new(caption, columns);
    for variant in ["seed", "modern"] {
        let records = runs.iter().map(|run| &run.record);
        let ladder: Vec<&Record> = records.filter(|r| is_free(r) && r.variant == variant).collect();
        let Some(&[a, b, c]) = ladder.last_chunk::<3>() else { continue };
        let [p, least, most] = order([&front(a), &front(b), &front(c)]);
        let each = |of: &dyn Fn(&Record) -> String| [a, b, c].map(of).join(", ");
        let z = |record: &Record| record.measured("z@3");
        let limit = z(c) + (z(c) - z(b)) / (p.exp2() - 1.0);
        table = table.row(vec![
            Cell::text(format!("`{variant}`")),
            Cell::text(each(&|r| sig(r.setting("n"), 3))),
            Cell::text(each(&|r| sig(z(r), 4))),
            Cell::num(p, 2),
            Cell::text(format!("{} to {}", sig(least, 2), sig(most, 2))),
            Cell::num(limit, 3),
        ]);
        if variant == "modern" {
            let because = "artificial viscosity, the place of a surface and what a wall sees of it are of \
                           first order in dx: differences at least fall as the root of it, and faster than \
                           the second order of the interior they cannot";
            let bound = Bound::Within(0.5, 2.5);
            let id = "dam_break.martin-moyce.modern.front.order";
            let gate = Gate::new(id, "order of the front", bound, Evidence::Theory, because);
            study = study.judge(gate, p);
        }
    }
    study.block(table)
}

/// What a particle costs a step.
fn rate_table(runs: &[JudgedRun]) -> Table {
    let columns = vec![
        Column::text("variant"),
        Column::text("case"),
        Column::num("n", "1"),
        Column::num("particles of water", "1"),
        Column::num("steps", "1"),
        Column::num("a particle and step", "µs"),
        Column::num("solver memory a particle", "B"),
    ];
    let caption = "What a particle of water costs a step, walls and neighbour search included, timed side by \
                   side with other runs.";
    let mut table = Table::new(caption, columns);
    for record in runs.iter().map(|run| &run.record) {
        let cost = &record.cost;
        let steps = cost.steps as f64 * cost.particles as f64;
        table = table.row(vec![
            Cell::text(format!("`{}`", record.variant)),
            Cell::text(if is_free(record) { "Martin & Moyce" } else { "Lobovsky" }),
            Cell::num(record.setting("n"), 3),
            Cell::count(cost.particles as u64),
            Cell::count(cost.steps),
            Cell::num(1e6 * cost.cpu_s / steps, 3),
            Cell::num(cost.solver_bytes as f64 / cost.particles as f64, 3),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_is_found_from_three_curves() {
        let with = |dx: f64| -> Curve {
            (0..80).map(|k| 0.05 * f64::from(k)).map(|t| (t, t * t + dx.powf(1.5) * t)).collect()
        };
        let curves = [0.4, 0.2, 0.1].map(with);
        let [p, least, most] = order([&curves[0], &curves[1], &curves[2]]);
        assert!((p - 1.5).abs() < 1e-9 && least <= p && p <= most && most - least < 1e-9, "{p}");
    }
}
