//! Finite elements of a point of a body: its path, and quantities by name.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::{
    record::{MetricKey, Profile, Record},
    reference::Reference,
};

/// Columns of a table with the texts that rows have in them.
type Texts<'a> = &'a [(&'a str, &'a str)];

/// Quantities by name, each with its uncertainty.
pub type Quantities = BTreeMap<String, [f64; 2]>;

/// The quantities in the rows of the summary of a package with these texts.
pub fn quantities(package: &str, of: Texts) -> Option<Quantities> {
    let summary = Reference::load(package).ok()?.table("summary").ok()?;
    let (names, rows) = (summary.texts("quantity").ok()?, summary.rows_of(of).ok()?);
    let numbers = summary.select(of, ["value", "uncertainty"]).ok()?;
    Some(rows.into_iter().map(|row| names[row].to_string()).zip(numbers).collect())
}

/// Finite elements of one place.
pub struct Elements {
    quantities: Quantities,
    /// Where the place is.
    pub path: Path,
}

impl Elements {
    /// The quantities of the summary and the path of the series in the rows of a package with these texts;
    /// the path has the columns x and y.
    pub fn of(package: &str, [summary, series]: [Texts; 2], [x, y]: [&str; 2]) -> Option<Self> {
        let table = Reference::load(package).ok()?.table("series").ok()?;
        let rows = table.select(series, ["t", x, y]).ok()?.into_iter();
        let path = rows.map(|[time, x, y]| PathPoint::new(time, Vector2::new(x, y))).collect();
        Some(Self { quantities: quantities(package, summary)?, path: Path(path) })
    }

    /// A quantity.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.quantities.get(name).map(|[value, _]| *value)
    }
}

/// Puts quantities over the finite elements' values, minus 1, and the distance of the path of a whole run
/// from theirs over one of their quantities; or the reason for their absence.
pub fn compare(
    exact: Option<&Elements>,
    quantities: &[(MetricKey, MetricKey)],
    (rms, scale): (MetricKey, &str),
    (path, lacks): (&Path, &str),
    record: &mut Record,
) {
    for (quantity, error) in quantities {
        let exact = exact.and_then(|exact| exact.number(&String::from(*quantity)));
        let ratio = record.value(*quantity).zip(exact).map(|(found, exact)| found / exact - 1.0);
        record.put_or(*error, ratio, lacks);
    }
    let is_whole =
        |exact: &&Elements| exact.path.end() > 0.0 && path.end() >= 0.99 * exact.path.end();
    let distance = exact.filter(is_whole).and_then(|exact| {
        let scale = exact.number(scale)?;
        Some(path.distance(&exact.path) / scale)
    });
    record.put_or(rms, distance, lacks);
}

/// A point of a path.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct PathPoint {
    /// \[s\].
    pub time: f64,
    /// \[m\].
    pub displacement: Vector2<f64>,
}

impl PathPoint {
    /// A displacement \[m\] at a time \[s\].
    pub fn new(time: f64, displacement: Vector2<f64>) -> Self {
        Self { time, displacement }
    }
}

/// The path of a place; times ascend.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Path(pub Vec<PathPoint>);

impl Path {
    /// The path of a place that has not moved yet.
    pub fn start() -> Self {
        Self(vec![PathPoint::default()])
    }

    /// Adds a point, at a later time \[s\].
    pub fn push(&mut self, time: f64, displacement: Vector2<f64>) {
        self.0.push(PathPoint::new(time, displacement));
    }

    /// Its last time \[s\].
    pub fn end(&self) -> f64 {
        self.0.last().map_or(0.0, |at| at.time)
    }

    /// Times \[s\] and displacements upwards \[m\].
    pub fn heights(&self) -> impl Iterator<Item = (f64, f64)> + Clone {
        self.0.iter().map(|at| (at.time, at.displacement.y))
    }

    /// A profile with these names of both displacements.
    pub fn profile(&self, [x, y]: [&str; 2]) -> Profile {
        Profile::of(
            &self.0,
            &[
                ("t", "s", &|at| at.time),
                (x, "m", &|at| at.displacement.x),
                (y, "m", &|at| at.displacement.y),
            ],
        )
    }

    /// Where the place is at a time \[s\], between two points; `None` before the first and after the last.
    pub fn at(&self, time: f64) -> Option<Vector2<f64>> {
        let after = self.0.partition_point(|at| at.time < time);
        let b = self.0.get(after)?;
        let a = if b.time == time { b } else { self.0.get(after.checked_sub(1)?)? };
        let share = if b.time > a.time { (time - a.time) / (b.time - a.time) } else { 0.0 };
        Some(a.displacement + (b.displacement - a.displacement) * share)
    }

    /// Root of the mean square of the distance from another path, at its times that this one covers \[m\];
    /// NaN if it covers none.
    pub fn distance(&self, other: &Self) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for PathPoint { time, displacement } in &other.0 {
            if let Some(place) = self.at(*time) {
                sum += (place - displacement).norm_squared();
                count += 1.0;
            }
        }
        (sum / count).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn path<const N: usize>(rows: [[f64; 3]; N]) -> Path {
        Path(rows.map(|[t, x, y]| PathPoint::new(t, Vector2::new(x, y))).into())
    }

    #[test]
    fn a_path_is_straight_between_its_rows_and_nowhere_beyond_them() {
        let path = path([[0.0, 0.0, 1.0], [1.0, 2.0, 1.0], [3.0, 2.0, 5.0]]);
        assert_eq!(path.at(0.0), Some(Vector2::new(0.0, 1.0)));
        assert_eq!(path.at(0.25), Some(Vector2::new(0.5, 1.0)));
        assert_eq!(path.at(2.0), Some(Vector2::new(2.0, 3.0)));
        assert_eq!(
            [path.at(3.0), path.at(3.1), path.at(-0.1)],
            [Some(Vector2::new(2.0, 5.0)), None, None]
        );
    }

    #[test]
    fn the_distance_of_two_paths_is_that_at_the_times_of_both() {
        let other = path([[0.0, 0.0, 3.0], [1.0, 5.0, 3.0], [3.0, 100.0, 100.0]]);
        let path = path([[0.0, 0.0, 0.0], [2.0, 2.0, 0.0]]);
        // 3 and 5 apart; the last time is beyond the first path.
        assert_relative_eq!(path.distance(&other), (17.0_f64).sqrt(), max_relative = 1e-14);
        assert!(Path::default().distance(&other).is_nan());
    }
}
