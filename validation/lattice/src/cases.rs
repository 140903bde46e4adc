//! The cases of other families that extreme settings are tried on.

use fluids::couette::COUETTE;
use harness::case::{Case, RunError, find_in};
use solids::{
    elastic_bar::ElasticBar, oscillating_plate::OscillatingPlate, rings::RUBBER_RINGS,
    solid::SolidCase, spinning_disk::SpinningDisk,
};

const CASES: &[&dyn Case] = &[
    &COUETTE,
    RUBBER_RINGS,
    &SolidCase::<ElasticBar>::CASE,
    &SolidCase::<SpinningDisk>::CASE,
    &SolidCase::<OscillatingPlate>::CASE,
];

pub fn find(name: &str) -> Result<&'static dyn Case, RunError> {
    find_in(CASES, name)
}
