//! A standing sound wave on a lattice against the gradient symbol.

use harness::composed::Composed;

use super::wave::{self, Kind, Polarisation, WaveCase, WaveSettings};

/// A standing sound wave.
pub struct Acoustic;

/// A standing sound wave as a case.
pub static ACOUSTIC_WAVE: Composed<WaveSettings> = wave::case::<Acoustic>();

impl Kind for Acoustic {
    const CASE: &'static WaveCase = &WaveCase {
        name: "acoustic_wave",
        problem: "A small standing sound wave in a periodic box",
        about: "A standing sound wave of infinitesimal amplitude in a periodic box, p'' + nu lambda p' \
            + (c0 |g|)^2 p = 0. On a lattice the sums of the method are the symbols g(k) and \
            lambda(k), known exactly: whatever the kernel, a correct program has their frequency \
            and decay.",
        polarisation: Polarisation::Sound,
        set: |_| (),
        gates: &[
            (
                wave::FREQUENCY_ERROR,
                "the gradient symbol is exact on a lattice; at amplitude 1e-6 \
                             nonlinearity and round-off measure 1e-11 or less",
            ),
            (
                wave::DECAY_ERROR,
                "the Laplacian symbol is exact on a lattice; gamma is a difference of \
                         amplitudes, so round-off counts by 1/(gamma dt): 6e-9 measured at most",
            ),
            (
                wave::TRAJECTORY_ERROR,
                "every amplitude of every step follows from the symbols and the \
                              closed form of one step; 3e-10 measured at most",
            ),
        ],
        compressed: Some((
            wave::FREQUENCY_ERROR,
            "the sound speed of the Tait equation rises as (rho/rho0)^3, which no wave at rho0 shows: the \
         exponent is seen by the curvature of p(rho) alone",
        )),
        disordered: Some((
            wave::MOMENTUM_ERROR,
            "forces of pairs are equal and opposite wherever particles are; on a lattice symmetry would hide \
         a pressure that is not, 0.1 dx of disorder shows it",
        )),
    };
}
