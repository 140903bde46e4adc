//! Profiles and histories that a record of the case has.

use touchstone_harness::prelude::ColumnKey;

const fn station(name: &'static str, unit: &'static str) -> ColumnKey {
    ColumnKey::new("stations", name, unit)
}

const fn wall(name: &'static str, unit: &'static str) -> ColumnKey {
    ColumnKey::new("wall", name, unit)
}

const fn series(name: &'static str, unit: &'static str) -> ColumnKey {
    ColumnKey::new("series", name, unit)
}

/// x of the points of all stations.
pub const X: ColumnKey = station("x", "H");
/// Their heights.
pub const Y: ColumnKey = station("y", "H");
/// Velocity along x at these points.
pub const U: ColumnKey = station("u", "U_b");
/// Velocity along y at these points.
pub const V: ColumnKey = station("v", "U_b");
/// Places along the walls.
pub const ALONG: ColumnKey = wall("x", "H");
/// Shear stress on the hill.
pub const HILL_SHEAR: ColumnKey = wall("hill shear", "rho U_b^2");
/// Shear stress on the lid.
pub const LID_SHEAR: ColumnKey = wall("lid shear", "rho U_b^2");
/// Pressure on the hill.
pub const PRESSURE: ColumnKey = wall("pressure", "rho U_b^2");
/// Times of the samples.
pub const TIME: ColumnKey = series("t", "H/U_b");
/// Body force.
pub const FORCE: ColumnKey = series("force", "U_b^2/H");
/// Flux.
pub const FLUX: ColumnKey = series("flux", "U_b H");
/// Kinetic energy.
pub const KINETIC_ENERGY: ColumnKey = series("kinetic energy", "rho U_b^2 H^2");
