//! The benchmarks, one file each, and their list.

pub use harness::case::find_in;
use harness::case::{Case, RunError};

use fluids::{couette, periodic_hill, poiseuille, taylor_couette, taylor_green};
use lattice::{acoustic_wave, extremes, shear_wave, stability};
use solids::{elastic_bar, elastic_wave, oscillating_plate, rings, spinning_disk};
use waters::{dam_break, elliptic_drop, hydrostatic};

/// Every case, in the order of the report: the five of the paper, then those that support them.
pub const CASES: &[&dyn Case] = &[
    &couette::COUETTE,
    &poiseuille::POISEUILLE,
    periodic_hill::PERIODIC_HILL,
    &dam_break::DAM_BREAK,
    &rings::RUBBER_RINGS,
    taylor_green::TAYLOR_GREEN,
    taylor_couette::TAYLOR_COUETTE,
    &elliptic_drop::ELLIPTIC_DROP,
    &hydrostatic::HYDROSTATIC,
    &elastic_bar::ELASTIC_BAR,
    &spinning_disk::SPINNING_DISK,
    &oscillating_plate::OSCILLATING_PLATE,
    &acoustic_wave::ACOUSTIC_WAVE,
    &shear_wave::SHEAR_WAVE,
    &elastic_wave::ELASTIC_WAVE,
    &stability::RESTING_BOX,
    &extremes::EXTREMES,
];

/// The case of that name.
pub fn find(name: &str) -> Result<&'static dyn Case, RunError> {
    find_in(CASES, name)
}

/// The family that a case belongs to, by the name of its crate.
pub fn family(case: &str) -> Option<&'static str> {
    let families = [
        ("fluids", fluids::CASES),
        ("waters", waters::CASES),
        ("solids", solids::CASES),
        ("lattice", lattice::CASES),
    ];
    let has = |cases: &[&dyn Case]| cases.iter().any(|known| known.name() == case);
    families.into_iter().find(|(_, cases)| has(cases)).map(|(name, _)| name)
}
