//! Quantities through time, of which a snapshot may lack some.

use serde::{Deserialize, Serialize};
use touchstone_base::{absent::Absent, record::Profile};

/// Columns of equal length, one row a time. A column that one row lacks is absent as a whole.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Series<const N: usize> {
    /// As many as N.
    columns: Vec<Result<Vec<f64>, Absent>>,
}

impl<const N: usize> Default for Series<N> {
    fn default() -> Self {
        Self { columns: vec![Ok(Vec::new()); N] }
    }
}

impl<const N: usize> Series<N> {
    /// A series of these columns.
    pub fn of(columns: [Result<Vec<f64>, Absent>; N]) -> Self {
        Self { columns: columns.into() }
    }

    /// Adds a row.
    pub fn push(&mut self, row: [Result<f64, Absent>; N]) {
        for (column, value) in self.columns.iter_mut().zip(row) {
            match (&mut *column, value) {
                (Ok(values), Ok(value)) => values.push(value),
                (Ok(_), Err(absent)) => *column = Err(absent),
                (Err(_), _) => {}
            }
        }
    }

    /// Takes back the last row.
    pub fn pop(&mut self) {
        self.columns.iter_mut().flatten().for_each(|values| _ = values.pop());
    }

    /// The values of a column.
    ///
    /// # Errors
    /// Why the column is absent.
    pub fn column(&self, k: usize) -> Result<&[f64], Absent> {
        self.columns[k].as_deref().map_err(Absent::clone)
    }

    /// The last value of a column; NaN of no rows.
    ///
    /// # Errors
    /// As [`Series::column`].
    pub fn last(&self, k: usize) -> Result<f64, Absent> {
        Ok(self.column(k)?.last().copied().unwrap_or(f64::NAN))
    }

    /// The columns that are there, under these names and units.
    pub fn profile(&self, heads: &[(&str, &str); N]) -> Profile {
        let all = heads.iter().zip(&self.columns);
        all.fold(Profile::default(), |profile, ((name, unit), column)| match column {
            Ok(values) => profile.with(name, unit, values.clone()),
            Err(_) => profile,
        })
    }
}

impl<const N: usize> From<Vec<[f64; N]>> for Series<N> {
    fn from(rows: Vec<[f64; N]>) -> Self {
        let mut series = Self::default();
        rows.into_iter().for_each(|row| series.push(row.map(Ok)));
        series
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_that_one_row_lacks_is_absent_and_the_others_are_whole() {
        let none = || Absent::NotGiven("density".into());
        let mut series = Series::from(vec![[0.0, 5.0]]);
        series.push([Ok(1.0), Err(none())]);
        series.push([Ok(2.0), Ok(7.0)]);
        assert_eq!(series.column(0), Ok(&[0.0, 1.0, 2.0][..]));
        assert_eq!(series.column(1), Err(none()));
        let names: Vec<_> = series
            .profile(&[("t", "s"), ("p", "Pa")])
            .columns
            .into_iter()
            .map(|of| of.name)
            .collect();
        assert_eq!(names, ["t"]);
    }
}
