//! Elastic solids.

pub mod elastic_bar;
pub mod elastic_waves;
pub mod oscillating_plate;
pub mod rings;
pub mod solid;
pub mod spinning_disk;

use harness::case::Case;

/// The cases of the family.
pub const CASES: &[&dyn Case] = &[
    &solid::SolidCase::<elastic_bar::ElasticBar>::CASE,
    &solid::SolidCase::<spinning_disk::SpinningDisk>::CASE,
    &solid::SolidCase::<oscillating_plate::OscillatingPlate>::CASE,
    rings::RUBBER_RINGS,
];
