//! Pictures of particles, from what a record keeps of them.

use base::record::Record;

/// Places of the particles of a profile, each with its value of a column; none if there is no such profile.
pub fn points(record: &Record, profile: &str, value: &str) -> Vec<(f64, f64, f64)> {
    let [x, y, values] = ["x", "y", value].map(|name| record.column(profile, name));
    x.iter().zip(y).zip(values).map(|((x, y), value)| (*x, *y, *value)).collect()
}
