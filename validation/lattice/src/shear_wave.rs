//! A decaying shear wave on a lattice against the Laplacian symbol.

use super::wave::{Polarisation, WaveCase};

/// A decaying shear wave.
pub const SHEAR_WAVE: WaveCase = WaveCase {
    name: "shear_wave",
    about: "A shear wave of infinitesimal amplitude in a periodic box decays as exp(-nu lambda t), \
            lambda(k) the symbol of the viscous sum, known exactly on a lattice. Sound and pressure \
            stay exactly zero to first order.",
    polarisation: Polarisation::Shear,
    // Strong viscosity: rows slide less before the wave is gone, and fewer steps see it go.
    set: &["nu=0.01"],
    gates: &[
        (
            "decay_error",
            "the Laplacian symbol is exact on a lattice; rows slide by amplitude \
                         c0/gamma, which counts with the square of the amplitude: 3e-9 measured",
        ),
        (
            "trajectory_error",
            "every amplitude of every step follows from the symbol and the closed \
                              form of one step, and sound is not excited",
        ),
    ],
    compressed: None,
    disordered: None,
};
