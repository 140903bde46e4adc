//! Particles on a lattice: waves, stability limits of the time step, extreme settings.

pub mod acoustic_wave;
mod cases;
pub mod extremes;
pub mod shear_wave;
pub mod stability;
pub mod wave;

use harness::case::Case;

/// The cases of the family.
pub const CASES: &[&dyn Case] = &[&acoustic_wave::ACOUSTIC_WAVE, &shear_wave::SHEAR_WAVE];
