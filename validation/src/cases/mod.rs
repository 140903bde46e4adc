//! The benchmarks, one file each, and their list.

pub mod acoustic_wave;
pub mod channel;
pub mod composed;
mod couette;
pub mod dam_break;
mod elastic_bar;
mod elliptic_drop;
pub mod fluid;
pub mod hydrostatic;
mod oscillating_plate;
pub mod periodic_hill;
mod poiseuille;
pub mod rings;
pub mod shear_wave;
pub mod solid;
mod spinning_disk;
mod taylor_couette;
pub mod taylor_green;
pub mod water;
pub mod wave;

use self::solid::SolidCase;
use crate::{
    case::{Case, RunError},
    settings::nearest,
};

/// Every case.
pub const CASES: &[&dyn Case] = &[
    &couette::COUETTE,
    &poiseuille::POISEUILLE,
    &acoustic_wave::ACOUSTIC_WAVE,
    &shear_wave::SHEAR_WAVE,
    &SolidCase::<elastic_bar::ElasticBar>::CASE,
    &SolidCase::<spinning_disk::SpinningDisk>::CASE,
    &SolidCase::<oscillating_plate::OscillatingPlate>::CASE,
    rings::RUBBER_RINGS,
    taylor_green::TAYLOR_GREEN,
    periodic_hill::PERIODIC_HILL,
    dam_break::DAM_BREAK,
    elliptic_drop::ELLIPTIC_DROP,
    hydrostatic::HYDROSTATIC,
    &taylor_couette::Gap,
];

/// The case of that name.
pub fn find(name: &str) -> Result<&'static dyn Case, RunError> {
    find_in(CASES, name)
}

/// The case of that name among these.
pub fn find_in(cases: &[&'static dyn Case], name: &str) -> Result<&'static dyn Case, RunError> {
    cases.iter().copied().find(|case| case.name() == name).ok_or_else(|| {
        let known: Vec<_> = cases.iter().map(|case| case.name()).collect();
        RunError::Case { name: name.into(), nearest: nearest(&known, name), known }
    })
}
