//! Finite elements of a point of a body: its path, and quantities by name.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use touchstone_base::{
    record::{MetricKey, Record},
    reference::{Reference, Uncertain},
};
use touchstone_maths::metrics::path::{Path, PathPoint};

/// Columns of a table with the texts that rows have in them.
type Texts<'a> = &'a [(&'a str, &'a str)];

/// Quantities by name.
pub type Quantities = BTreeMap<String, Uncertain>;

/// The quantities in the rows of the summary of a package with these texts.
pub fn quantities(package: &str, of: Texts) -> Option<Quantities> {
    let summary = Reference::load(package).ok()?.table("summary").ok()?;
    let (names, rows) = (summary.texts("quantity").ok()?, summary.rows_of(of).ok()?);
    let numbers = summary.uncertain(of).ok()?;
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
        self.quantities.get(name).map(|number| number.value)
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
