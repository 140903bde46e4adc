//! Histories that a record of the case has, of the ring on the right.

use touchstone_harness::prelude::ColumnKey;

/// A column of the series of a run.
pub const fn series(name: &'static str, unit: &'static str) -> ColumnKey {
    ColumnKey::new("series", name, unit)
}

/// Times of the samples.
pub const TIME: ColumnKey = series("t", "L/c0");
/// Place of the centre of mass along the line of flight.
pub const PLACE: ColumnKey = series("x_c", "L");
/// Velocity of the centre of mass along the line of flight.
pub const VELOCITY: ColumnKey = series("v_c", "c0");
/// Extent along the line of flight.
pub const WIDTH: ColumnKey = series("width", "L");
/// Extent across the line of flight.
pub const HEIGHT: ColumnKey = series("height", "L");
