//! What finite elements say of a body: quantities by name, and the path of a place.

use base::reference::{ReferenceError, Table};
use nalgebra::Vector2;

/// The rows of a table whose columns have these texts.
pub fn rows(table: &Table, of: &[(&str, &str)]) -> Result<Vec<usize>, ReferenceError> {
    let mut rows: Vec<usize> = (0..table.len()).collect();
    for (column, text) in of {
        let texts = table.texts(column)?;
        rows.retain(|row| texts[*row] == *text);
    }
    Ok(rows)
}

/// Quantities of a summary by name, each with its uncertainty.
#[derive(Clone, Debug)]
pub struct Quantities(Vec<(String, [f64; 2])>);

impl Quantities {
    /// Those of the rows whose columns have these texts.
    pub fn of(summary: &Table, of: &[(&str, &str)]) -> Result<Self, ReferenceError> {
        let (names, values) = (summary.texts("quantity")?, summary.numbers("value")?);
        let spread = summary.numbers("uncertainty")?;
        let quantity = |row: usize| (names[row].to_string(), [values[row], spread[row]]);
        Ok(Self(rows(summary, of)?.into_iter().map(quantity).collect()))
    }

    /// A value and its uncertainty.
    pub fn get(&self, name: &str) -> Option<[f64; 2]> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, value)| *value)
    }
}

/// The path of a place: times \[s\], ascending, and its displacements \[m\].
#[derive(Clone, Debug, Default)]
pub struct Path(pub Vec<[f64; 3]>);

impl Path {
    /// That of a series, by the columns of its displacements along x and y, of the rows whose columns have
    /// these texts.
    pub fn of(
        series: &Table,
        [x, y]: [&str; 2],
        of: &[(&str, &str)],
    ) -> Result<Self, ReferenceError> {
        let [t, x, y] = [series.numbers("t")?, series.numbers(x)?, series.numbers(y)?];
        Ok(Self(rows(series, of)?.into_iter().map(|row| [t[row], x[row], y[row]]).collect()))
    }

    /// Where the place is at a time \[s\], between two rows; `None` before the first and after the last.
    pub fn at(&self, time: f64) -> Option<Vector2<f64>> {
        let after = self.0.partition_point(|row| row[0] < time);
        let b = self.0.get(after)?;
        let a = if b[0] == time { b } else { self.0.get(after.checked_sub(1)?)? };
        let share = if b[0] > a[0] { (time - a[0]) / (b[0] - a[0]) } else { 0.0 };
        let [x, y] = [1, 2].map(|k| a[k] + (b[k] - a[k]) * share);
        Some(Vector2::new(x, y))
    }

    /// Root of the mean square of the distance from another path, at its times that this one covers \[m\];
    /// NaN if it covers none.
    pub fn distance(&self, other: &Self) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for [t, x, y] in &other.0 {
            if let Some(place) = self.at(*t) {
                sum += (place - Vector2::new(*x, *y)).norm_squared();
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

    #[test]
    fn a_path_is_straight_between_its_rows_and_nowhere_beyond_them() {
        let path = Path(vec![[0.0, 0.0, 1.0], [1.0, 2.0, 1.0], [3.0, 2.0, 5.0]]);
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
        let path = Path(vec![[0.0, 0.0, 0.0], [2.0, 2.0, 0.0]]);
        let other = Path(vec![[0.0, 0.0, 3.0], [1.0, 5.0, 3.0], [3.0, 100.0, 100.0]]);
        // 3 and 5 apart; the last time is beyond the first path.
        assert_relative_eq!(path.distance(&other), (17.0_f64).sqrt(), max_relative = 1e-14);
        assert!(Path::default().distance(&other).is_nan());
    }
}
