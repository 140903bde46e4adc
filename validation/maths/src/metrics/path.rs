//! The path of a place through time: distances from another path, extremes, harmonics.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::{
    functions::{cos, sin},
    record::{ColumnKey, Record},
};

/// Points between the two times, at which the path is taken for averages and harmonics.
const POINTS: usize = 8000;

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

    /// Puts its times \[s\] and displacements \[m\] as these columns.
    pub fn put(&self, [t, x, y]: [ColumnKey; 3], record: &mut Record) {
        record.put_column(t, &self.0, |at| at.time);
        record.put_column(x, &self.0, |at| at.displacement.x);
        record.put_column(y, &self.0, |at| at.displacement.y);
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

    /// The greatest and the least displacement along an axis \[m\], each by a parabola through three points;
    /// `None` of one that is at an end of the path.
    pub fn extremes(&self, axis: usize) -> [Option<f64>; 2] {
        let path = &self.0;
        let value = |k: usize| path[k].displacement[axis];
        let places = || 0..path.len();
        let greatest = places().max_by(|a, b| value(*a).total_cmp(&value(*b)));
        let least = places().min_by(|a, b| value(*a).total_cmp(&value(*b)));
        [greatest, least].map(|place| {
            let k = place.filter(|&k| k > 0 && k + 1 < path.len())?;
            let [a, b, c] = [value(k - 1), value(k), value(k + 1)];
            let bend = a - 2.0 * b + c;
            Some(if bend == 0.0 { b } else { b - (a - c) * (a - c) / (8.0 * bend) })
        })
    }

    /// Mean and amplitude along an axis \[m\]. Where an extreme is at an end of the path, it is the value
    /// there.
    pub fn mean_and_amplitude(&self, axis: usize) -> [f64; 2] {
        let all = || self.0.iter().map(|at| at.displacement[axis]);
        let ends = [all().fold(f64::NEG_INFINITY, f64::max), all().fold(f64::INFINITY, f64::min)];
        let [greatest, least] = self.extremes(axis);
        let (high, low) = (greatest.unwrap_or(ends[0]), least.unwrap_or(ends[1]));
        [0.5 * (high + low), 0.5 * (high - low)]
    }

    /// Mean between two times \[s\], and amplitude of the sinusoid of this frequency \[Hz\].
    pub fn harmonic(
        &self,
        [first, last]: [f64; 2],
        frequency: f64,
    ) -> (Vector2<f64>, Vector2<f64>) {
        let mut sums = [Vector2::zeros(); 3];
        for k in 0..POINTS {
            let time = first + (last - first) * (k as f64 / POINTS as f64);
            let (place, angle) = (self.at(time).unwrap_or_default(), TAU * frequency * time);
            let [sum, even, odd] = &mut sums;
            *sum += place;
            *even += place * cos(angle);
            *odd += place * sin(angle);
        }
        let [average, even, odd] = sums.map(|sum| sum / POINTS as f64);
        (average, even.zip_map(&odd, |a, b| 2.0 * (a * a + b * b).sqrt()))
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
