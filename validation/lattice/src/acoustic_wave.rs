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
        about: "A standing sound wave of infinitesimal amplitude in a periodic box follows p'' + nu lambda \
            p' + (c0 |g|)^2 p = 0. On a lattice, the symbols g(k) and lambda(k) of the sums of the method \
            are known exactly. A correct program has the frequency and decay that follow from them, \
            whatever the kernel.",
        polarisation: Polarisation::Sound,
        set: |_| (),
        gates: &[
            (
                wave::FREQUENCY_ERROR,
                "The gradient symbol is exact on a lattice. At an amplitude of 1e-6, nonlinearity and \
                             round-off were measured as 1e-11 or less.",
            ),
            (
                wave::DECAY_ERROR,
                "The Laplacian symbol is exact on a lattice. The decay rate gamma is a difference of \
                         amplitudes, so round-off counts by 1/(gamma dt), which was measured as 6e-9 at \
                         most.",
            ),
            (
                wave::TRAJECTORY_ERROR,
                "Every amplitude of every step follows from the symbols and the closed form of one step. \
                              The largest difference measured was 3e-10.",
            ),
        ],
        compressed: Some((
            wave::FREQUENCY_ERROR,
            "The sound speed of the Tait equation rises as (rho/rho0)^3, which no wave at rho0 shows. The \
         exponent shows in the curvature of p(rho) alone.",
        )),
        disordered: Some((
            wave::MOMENTUM_ERROR,
            "Forces of pairs are equal and opposite wherever particles are. On a lattice, symmetry would \
         hide a pressure force that is not, which a disorder of 0.1 dx shows.",
        )),
    };
}
