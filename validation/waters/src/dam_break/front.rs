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

/// The observed order of the front, variant by variant, from the three finest judged runs of each.
pub fn orders(tier: Tier, runs: &Runs) -> Study {
    let caption = format!(
        "Observed order of the front: log2 of the ratio of successive rms differences of Z(T), 1 ≤ T ≤ \
         3.3, with its range over thirds of that time. The limit is Richardson's extrapolation. Three \
         other codes have {} to {} at T = 3.",
        PEERS[1].1, PEERS[1].2
    );
    let z = |record: &Record| record.value(metrics::Z.at(3)).unwrap_or(f64::NAN);
    let mut rows = Vec::new();
    let mut study = Study::new("dam-break-front-order", "Order of the front");
    for variant in ["seed", "modern"] {
        let Some(&n) = specs::martin_moyce(variant, tier).last_chunk::<3>() else { continue };
        let records = n.map(|n| runs.record(&specs::free(tier, variant, n)));
        let found = match records {
            [Some(a), Some(b), Some(c)] => {
                let orders = order([&front(a), &front(b), &front(c)]);
                rows.push((variant, n, [a, b, c].map(z), orders));
                Some(orders[0])
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
    let table = Columns::<(&str, [usize; 3], [f64; 3], [f64; 3])>::default()
        .code("variant", |(variant, ..)| *variant)
        .text("a/dx", |(_, n, ..)| n.map(|n| n.to_string()).join(", "))
        .text("Z at T = 3", |(.., z, _)| z.map(|z| sig(z, 4)).join(", "))
        .num(["order", "-"], |(.., [p, ..])| Cell::num(*p, 2))
        .text("over thirds of the time", |(.., [_, least, most])| {
            format!("{} to {}", sig(*least, 2), sig(*most, 2))
        })
        .num(["Z at T = 3 in the limit", "a"], |(.., z, [p, ..])| Cell::num(limit(*z, *p), 3))
        .table(caption, rows);
    study.block(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::functions::powf;

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
