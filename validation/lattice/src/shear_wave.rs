//! A decaying shear wave on a lattice against the Laplacian symbol.

use harness::composed::Composed;

use super::wave::{self, Kind, Polarisation, WaveCase, WaveSettings};

/// A decaying shear wave.
pub struct Shear;

/// A decaying shear wave as a case.
pub static SHEAR_WAVE: Composed<WaveSettings> = wave::case::<Shear>();

impl Kind for Shear {
    const CASE: &'static WaveCase = &WaveCase {
        name: "shear_wave",
        problem: "A small shear wave decays in a periodic box",
        about: "A shear wave of infinitesimal amplitude in a periodic box decays as exp(-nu lambda t). On \
            a lattice, the symbol lambda(k) of the viscous sum is known exactly. Sound and pressure stay \
            exactly zero to first order.",
        polarisation: Polarisation::Shear,
        // Strong viscosity: rows slide less before the wave is gone, and fewer steps see it go.
        set: |settings| settings.nu = 0.01,
        gates: &[
            (
                wave::SHEAR_DECAY_ERROR,
                "The Laplacian symbol is exact on a lattice. Rows slide by amplitude c0/gamma, which \
                         counts with the square of the amplitude and was measured as 3e-9.",
            ),
            (
                wave::TRAJECTORY_ERROR,
                "Every amplitude of every step follows from the symbol and the closed form of one step, \
                              and sound is not excited.",
            ),
        ],
        compressed: None,
        disordered: None,
    };
}
