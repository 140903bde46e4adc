//! The front of the column of Martin & Moyce over resolutions: the distance of two runs, and the observed
//! order over parts of the time.

use super::{
    DamSettings, metrics,
    reference::{self, Curve, PEERS, value},
    specs,
};
use crate::water;
use base::functions::{exp2, log2};
use base::{
    gate::{Bound, Evidence, Gate},
    record::Record,
};
use harness::{
    case::Tier,
    columns::Columns,
    runs::{Judged, Runs},
    study::Study,
};
use report::{Cell, sig};

/// T between which fronts are compared: before, they have hardly moved; later, there is no experiment.
pub const LATER: [f64; 2] = [1.0, 3.3];

/// Z over T.
pub fn front(record: &Record) -> Curve {
    let DamSettings { width: a, gravity: g, .. } = record.settings_as();
    water::curve(record, "series", ["t", "front"], [(0.5 * a / g).sqrt(), a])
}

/// rms distance of two curves over a window of time.
pub fn rms(one: &Curve, other: &Curve, [from, to]: [f64; 2]) -> f64 {
    const POINTS: usize = 100;
    let at = |k: usize| from + (to - from) * (k as f64 + 0.5) / POINTS as f64;
    let points: Curve = (0..POINTS).map(at).map(|t| (t, value(other, t))).collect();
    reference::rms(one, &points, 0.0)
}

/// The observed order of three curves, each at half the spacing of the one before: log2 of the rms of
/// successive differences, over the whole window, and the least and most over its thirds.
fn order([coarse, middle, fine]: [&Curve; 3]) -> [f64; 3] {
    let over = |window| log2(rms(coarse, middle, window) / rms(middle, fine, window));
    let [from, to] = LATER;
    let third = (to - from) / 3.0;
    let thirds = [0.0, 1.0, 2.0].map(|k| over([from + k * third, from + (k + 1.0) * third]));
    let fold = |f: fn(f64, f64) -> f64| thirds.into_iter().fold(f64::NAN, f);
    [over(LATER), fold(f64::min), fold(f64::max)]
}

/// The observed order of one place of the front from three runs, each at half the spacing of the one before,
/// the finest with so many spacings; and its interval, a place being known to a quarter of a spacing.
fn order_of_place([coarse, middle, fine]: [f64; 3], finest: usize) -> [f64; 3] {
    let by = 0.25 / finest as f64;
    let (first, second) = ((middle - coarse).abs(), (fine - middle).abs());
    let low = log2((first - 4.0 * by).max(0.0) / (second + 2.0 * by));
    let high = log2((first + 4.0 * by) / (second - 2.0 * by).max(0.0));
    [log2(first / second), low, high]
}

/// What the three finest runs of a variant say.
struct Row {
    variant: &'static str,
    n: [usize; 3],
    /// Z at T = 2 and 3.
    z: [[f64; 3]; 2],
    /// Of the whole front, with the least and the most over thirds of the time.
    order: [f64; 3],
}

/// The observed order of the front, variant by variant, from the three finest judged runs of each.
pub fn orders(tier: Tier, runs: &Runs) -> Study {
    let caption = format!(
        "Observed order of the front: log2 of the ratio of successive rms differences of Z(T), 1 ≤ T ≤ \
         3.3, with its range over thirds of that time; and of Z at T = 2 alone, with the interval that a \
         quarter of a spacing in each place makes. Limits are Richardson's extrapolation. By volume of fluid \
         Z is 2.655 ± 0.017 at T = 2 and 4.081 ± 0.024 at T = 3; three other codes have {} to {} and {} to \
         {}.",
        PEERS[0].1, PEERS[0].2, PEERS[1].1, PEERS[1].2
    );
    let place = |record: &Record, t: u32| record.value(metrics::Z.at(t)).unwrap_or(f64::NAN);
    let mut rows = Vec::new();
    let mut study = Study::new("dam-break-front-order", "Order of the front");
    for variant in ["seed", "modern"] {
        let Some(&n) = specs::martin_moyce(variant, tier).last_chunk::<3>() else { continue };
        let records = n.map(|n| runs.record(&specs::free(tier, variant, n)));
        let found = match records {
            [Some(a), Some(b), Some(c)] => {
                let order = order([&front(a), &front(b), &front(c)]);
                let z = [2, 3].map(|t| [a, b, c].map(|record| place(record, t)));
                rows.push(Row { variant, n, z, order });
                Some(order[0])
            }
            _ => None,
        };
        if variant == "modern" {
            let because = "Artificial viscosity, the place of a surface and what a wall sees of it are of \
                           first order in dx. The front is known to a quarter of a spacing, 0.013 and 0.006 \
                           a, of differences of 0.048 and 0.026 a, so the order is uncertain by 0.5.";
            let bound = Bound::Within(0.5, 1.5);
            let id = "dam_break.martin-moyce.modern.front.order";
            let gate = Gate::new(id, "order of the front", bound, Evidence::Theory, because);
            study.judged.push(Judged::new(gate, found));
        }
    }
    let limit = |[_, b, c]: [f64; 3], p: f64| c + (c - b) / (exp2(p) - 1.0);
    let places = |z: [f64; 3]| z.map(|z| sig(z, 4)).join(", ");
    let at_2 = |row: &Row| order_of_place(row.z[0], row.n[2]);
    let table = Columns::<Row>::default()
        .code("variant", |row| row.variant)
        .text("a/dx", |row| row.n.map(|n| n.to_string()).join(", "))
        .text("Z at T = 2", move |row| places(row.z[0]))
        .of(["its order", "-"], move |row| at_2(row)[0], |order| Cell::num(order, 2))
        .text("from, to", move |row| {
            let [_, low, high] = at_2(row);
            format!("{}, {}", sig(low, 2), sig(high, 2))
        })
        .of(["limit", "a"], move |row| limit(row.z[0], at_2(row)[0]), |z| Cell::num(z, 4))
        .text("Z at T = 3", move |row| places(row.z[1]))
        .num(["order of the front", "-"], |row| Cell::num(row.order[0], 2))
        .text("over thirds of the time", |row| {
            format!("{} to {}", sig(row.order[1], 2), sig(row.order[2], 2))
        })
        .num(["limit at T = 3", "a"], move |row| Cell::num(limit(row.z[1], row.order[0]), 4))
        .table(caption, rows);
    study.block(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::functions::powf;

    #[test]
    fn the_order_of_a_place_has_the_interval_that_its_resolution_leaves() {
        let with = |dx: f64| 2.66 - 20.0 * dx * dx;
        let [p, low, high] = order_of_place([20, 40, 80].map(|n| with(1.0 / f64::from(n))), 80);
        assert!((p - 2.0).abs() < 1e-9, "{p}");
        let expected = [(0.0375 - 0.0125) / (0.009375 + 0.00625), 0.05 / (0.009375 - 0.00625)];
        assert!((low - log2(expected[0])).abs() < 1e-9 && (high - log2(expected[1])).abs() < 1e-9);
    }

    #[test]
    fn an_order_is_found_from_three_curves() {
        let with = |dx: f64| -> Curve {
            (0..80).map(|k| 0.05 * f64::from(k)).map(|t| (t, t * t + powf(dx, 1.5) * t)).collect()
        };
        let curves = [0.4, 0.2, 0.1].map(with);
        let [p, least, most] = order([&curves[0], &curves[1], &curves[2]]);
        assert!((p - 1.5).abs() < 1e-9 && least <= p && p <= most && most - least < 1e-9, "{p}");
    }
}
