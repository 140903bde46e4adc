//! Elastic solids.

pub mod elastic_bar;
pub mod elastic_wave;
pub mod oscillating_plate;
pub mod rings;
pub mod solid;
pub mod spinning_disk;

use harness::case::Case;

/// The cases of the family.
pub const CASES: &[&dyn Case] = &[
    &elastic_wave::ELASTIC_WAVE,
    &elastic_bar::ELASTIC_BAR,
    &spinning_disk::SPINNING_DISK,
    &oscillating_plate::OSCILLATING_PLATE,
    &rings::RUBBER_RINGS,
];
