//! Histories that a record of the case has.

use touchstone_harness::prelude::ColumnKey;

const fn series(name: &'static str, unit: &'static str) -> ColumnKey {
    ColumnKey::new("series", name, unit)
}

const fn pressure(name: &'static str) -> ColumnKey {
    ColumnKey::new("pressure", name, "rho g H")
}

/// Times of the samples.
pub const TIME: ColumnKey = series("t", "s");
/// Place of the front, from the back wall.
pub const FRONT: ColumnKey = series("front", "m");
/// Residual height.
pub const HEIGHT: ColumnKey = series("height", "m");
/// Levels at the four probes.
pub const LEVELS: [ColumnKey; 4] =
    [series("H1", "m"), series("H2", "m"), series("H3", "m"), series("H4", "m")];
/// Potential energy.
pub const POTENTIAL: ColumnKey = series("potential", "M g H/2");
/// Middle times of the means of the pressures.
pub const PRESSURE_TIME: ColumnKey = ColumnKey::new("pressure", "t", "(H/g)^(1/2)");
/// Pressures on the four sensors.
pub const PRESSURES: [ColumnKey; 4] =
    [pressure("P1"), pressure("P2"), pressure("P3"), pressure("P4")];
