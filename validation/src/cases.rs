//! The benchmarks, one file each, and their list.

pub use fluids::{channel, fluid, periodic_hill, taylor_green};
pub use harness::composed;
pub use lattice::{acoustic_wave, shear_wave, wave};
pub use solids::{rings, solid};
pub use waters::{dam_break, hydrostatic, water};

use fluids::{couette, poiseuille, taylor_couette};
use solids::{elastic_bar, oscillating_plate, spinning_disk};
use waters::elliptic_drop;

use self::solid::SolidCase;
pub use harness::case::find_in;
use harness::case::{Case, RunError};

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
