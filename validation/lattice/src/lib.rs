//! Particles on a lattice: waves, stability limits of the time step, extreme settings.

pub mod acoustic_wave;
pub mod extremes;
pub mod shear_wave;
pub mod stability;
pub mod wave;

use harness::case::Case;

/// The cases of the family.
pub const CASES: &[&dyn Case] = &[
    &acoustic_wave::ACOUSTIC_WAVE,
    &shear_wave::SHEAR_WAVE,
    &stability::RESTING_BOX,
    &extremes::EXTREMES,
];

#[cfg(test)]
mod tests {
    use harness::{
        case::{Case, Tier},
        make::Making,
        runs::Judged,
        suite,
    };

    /// The judgements of the quick tier of some cases.
    pub fn judged(cases: &[&'static dyn Case]) -> Vec<Judged> {
        let sources = |_: &str| String::new();
        let making = Making::new(Tier::Quick, &sources);
        suite::run(cases, &making).judged().cloned().collect()
    }
}
