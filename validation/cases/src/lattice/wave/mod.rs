//! One Fourier mode on a periodic lattice: the cases of the sound wave and of the shear wave.
//!
//! Particles are labelled by where they start, and amplitudes are projections over the labels: that
//! is the linear problem that [`touchstone_maths::theory::lattice`] solves exactly. Without background
//! pressure a displacement meets a pressure of the same order, so moving particles are second order in the
//! amplitude; products of one wave number with itself have wave numbers 0 and 2k, so the mode k itself is
//! disturbed only to third order, relative to itself by amplitude² (unless 3k is a whole number of turns from
//! one particle to the next, where 2k looks like -k).
//!
//! The error in time is not subtracted but divided out: the amplitudes of one step follow from the last by a
//! matrix known in closed form for each integrator, and the inverse of this form turns the measured matrix
//! into ω and γ of continuous time. See `fit`.

mod run;

use touchstone_base::record::MetricKey;
use touchstone_harness::prelude::*;
use touchstone_harness::{
    case::Statement,
    table::{Row, Table},
};

touchstone_base::settings! {
    /// Settings of one mode in a periodic square box.
    pub struct WaveSettings {
        /// particles along each side
        n: usize ["-"] in 4..=400 = 16,
        /// wave number along x: whole waves in the box
        kx: usize ["-"] in 1..=200 = 1,
        /// wave number along y
        ky: usize ["-"] in 0..=200 = 0,
        /// side of the box
        length: f64 ["m"] in 1e-9..=1e6 = 1.0,
        /// density
        rho: f64 ["kg/m^3"] in 1e-6..=1e6 = 1000.0,
        /// sound speed
        c0: f64 ["m/s"] in 1e-9..=1e9 = 1.0,
        /// density of the lattice over the reference density, minus one; the sound speed rises with its cube,
        /// and a background pressure cancels the pressure
        compression: f64 ["-"] in 0.0..=0.2 = 0.0,
        /// kinematic viscosity
        nu: f64 ["m^2/s"] in 0.0..=1e6 = 1e-3,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.5..=5.0 = 1.2,
        /// guard against 0/0 in the viscous term
        eta2_over_h2: f64 ["-"] in 1e-12..=0.1 = 0.01,
        /// density diffusion δ
        diffusion: f64 ["-"] in 0.0..=10.0 = 0.0,
        /// standard deviation of the initial displacements, which break the symmetry of the sums; theory
        /// assumes the lattice
        jitter: f64 ["dx"] in 0.0..=0.2 = 0.0,
        /// initial velocity amplitude
        amplitude: f64 ["c0"] in 1e-12..=0.1 = 1e-6,
        /// time step; auto: the smaller of courant h/c0 and viscous h²/ν
        dt: Option<f64> ["s"] in 1e-15..=1e6 = None,
        /// Courant number of the time step
        courant: f64 ["-"] in 1e-6..=10.0 = 0.2,
        /// viscous number of the time step
        viscous: f64 ["-"] in 1e-6..=10.0 = 0.05,
        /// end of the run: periods of the sound wave, decay times 1/γ of the shear wave
        span: f64 ["periods"] in 1e-3..=1e4 = 2.0,
    }
}

/// Kind of wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Polarisation {
    /// Velocity along the gradient symbol.
    Sound,
    /// Velocity across it.
    Shear,
}

/// A standing sound wave.
pub static ACOUSTIC_WAVE: Composed<WaveSettings> = Composed {
    name: "acoustic_wave",
    problem: "A small standing sound wave in a periodic box",
    recommended: RECOMMENDED,
    about: "A standing sound wave of infinitesimal amplitude in a periodic box follows p'' + nu lambda \
            p' + (c0 |g|)^2 p = 0. On a lattice, the symbols g(k) and lambda(k) of the sums of the method \
            are known exactly. A correct program has the frequency and decay that follow from them, \
            whatever the kernel.",
    variants: || variants(Polarisation::Sound),
    facts,
    studies: |tier| studies(&ACOUSTIC_WAVE, Polarisation::Sound, tier),
};

/// A decaying shear wave.
pub static SHEAR_WAVE: Composed<WaveSettings> = Composed {
    name: "shear_wave",
    problem: "A small shear wave decays in a periodic box",
    recommended: RECOMMENDED,
    about: "A shear wave of infinitesimal amplitude in a periodic box decays as exp(-nu lambda t). On \
            a lattice, the symbol lambda(k) of the viscous sum is known exactly. Sound and pressure stay \
            exactly zero to first order.",
    variants: || variants(Polarisation::Shear),
    facts,
    studies: |tier| studies(&SHEAR_WAVE, Polarisation::Shear, tier),
};

const RECOMMENDED: Recommended = Recommended {
    variant: "cubic-leapfrog",
    because: "all kernels follow lattice theory to round-off, and this one needs the fewest pairs",
    papers: None,
};

touchstone_base::metrics! {
    all ALL;
    // Error of the frequency of a sound wave.
    FREQUENCY_ERROR = "frequency_error" ["-"]
        "|omega - c0 |g(k)||/(c0 |g(k)|), time error divided out";
    // Error of the decay.
    DECAY_ERROR = "decay_error" ["-"]
        "|gamma - nu lambda(k)|/(nu lambda(k)), of omega if nu = 0, time error divided out";
    // Distance of the amplitudes from exact steps.
    TRAJECTORY_ERROR = "trajectory_error" ["-"]
        "max|amplitudes - exact steps|/amplitude over p, v along, v across and all steps";
    // Change of momentum.
    MOMENTUM_ERROR = "momentum_error" ["-"]
        "|change of sum m v after the first step|/(sum m times the velocity amplitude)";
}

/// Measurements after every step, and facts for other codes.
fn facts() -> Facts {
    let statement = Statement::new("There is no wall: x and y are periodic.", &[ALL, run::FACTORS]);
    Facts { statement, stepwise: STEPWISE, ..Facts::default() }
}

/// All are fits to every step, or differences between steps.
const STEPWISE: &[MetricKey] = &[
    FREQUENCY_ERROR,
    DECAY_ERROR,
    TRAJECTORY_ERROR,
    MOMENTUM_ERROR,
    run::SOUND_FACTOR,
    run::VISCOUS_FACTOR,
];

fn variants(of: Polarisation) -> Compositions<WaveSettings> {
    let of_kernel =
        "plain equations with this kernel and the leapfrog: do the sums have its symbols?";
    let of_step = "as cubic-leapfrog, with the predictor-corrector: does it amplify sound exactly as theory \
                   says?";
    let of_diffusion =
        "as cubic-leapfrog, with density diffusion: does it decay as its symbol says?";
    Variants::of(move |m, s| run::Wave::new(of, s, m))
        .with(CUBIC, of_kernel, touchstone_schemes::lattice::cubic(), |_| ())
        .with(MIDPOINT, of_step, touchstone_schemes::lattice::midpoint(), |_| ())
        .with(QUINTIC, of_kernel, touchstone_schemes::lattice::quintic(), |_| ())
        .with(WENDLAND, of_kernel, touchstone_schemes::lattice::wendland(), |_| ())
        .with(DIFFUSIVE, of_diffusion, touchstone_schemes::lattice::diffusive(), |s| {
            s.diffusion = 0.1
        })
        .all
}

const CUBIC: &str = "cubic-leapfrog";
const MIDPOINT: &str = "cubic-pc";
const QUINTIC: &str = "quintic-leapfrog";
const WENDLAND: &str = "wendland-leapfrog";
const DIFFUSIVE: &str = "cubic-leapfrog-diffusion";

/// Gates allow this relative error. Measured at amplitudes 1e-3 to 1e-8: the error of γ is
/// 1.3e3 amplitude² for sound and 6e4 amplitude² for shear at ν = 1e-3 (rows slide by amplitude
/// c₀/γ), plus, for sound, round-off of about 3e-15/amplitude. At 1e-6 both leave two decades.
const TOLERANCE: f64 = 1e-6;

/// Total momentum may change by this much of Σ m |v|: round-off of a thousand sums.
const MOMENTUM: f64 = 1e-10;

/// The judged metrics of runs, and why each is exact.
type Judged = &'static [(MetricKey, &'static str)];

/// A sound wave on the lattice as it is.
const SOUND: Judged = &[
    (
        FREQUENCY_ERROR,
        "The gradient symbol is exact on a lattice. At an amplitude of 1e-6, nonlinearity and round-off \
         were measured as 1e-11 or less.",
    ),
    (
        DECAY_ERROR,
        "The Laplacian symbol is exact on a lattice. The decay rate gamma is a difference of amplitudes, \
         so round-off counts by 1/(gamma dt), which was measured as 6e-9 at most.",
    ),
    EXACT_STEPS,
];
/// A shear wave on the lattice as it is.
const SHEAR: Judged = &[
    (
        DECAY_ERROR,
        "The Laplacian symbol is exact on a lattice. Rows slide by amplitude c0/gamma, which counts with \
         the square of the amplitude and was measured as 3e-9.",
    ),
    (
        TRAJECTORY_ERROR,
        "Every amplitude of every step follows from the symbol and the closed form of one step, and \
         sound is not excited.",
    ),
];
/// `fit` has no inverse for density diffusion: the trajectory is judged.
const DIFFUSED: Judged = &[EXACT_STEPS];
/// The sound speed rises with compression, which no wave at rho0 shows.
const COMPRESSED: Judged = &[(
    FREQUENCY_ERROR,
    "The sound speed of the Tait equation rises as (rho/rho0)^3, which no wave at rho0 shows. \
     The exponent shows in the curvature of p(rho) alone.",
)];
/// Forces on a disordered lattice, whose symmetry hides nothing.
const DISORDERED: Judged = &[(
    MOMENTUM_ERROR,
    "Forces of pairs are equal and opposite wherever particles are. On a lattice, symmetry would \
     hide a pressure force that is not, which a disorder of 0.1 dx shows.",
)];
/// A short wave that nothing damps.
const UNDAMPED: Judged = &[(
    TRAJECTORY_ERROR,
    "Without damping the predictor-corrector amplifies sound by the factor 1 + (omega dt)^4/4 of \
     the energy a step, at every time step: a weak instability, and exactly this one.",
)];
/// The amplitudes of sound are exact.
const EXACT_STEPS: (MetricKey, &str) = (
    TRAJECTORY_ERROR,
    "Every amplitude of every step follows from the symbols and the closed form of one step. The largest \
     difference measured was 3e-10.",
);

/// h/dx of each variant, and more of the full tier.
const RATIOS: [(&str, &[f64], &[f64]); 4] = [
    (CUBIC, &[1.2, 1.3], &[1.0, 1.5, 2.0]),
    (MIDPOINT, &[1.2, 1.3], &[1.0, 1.5, 2.0]),
    (QUINTIC, &[1.0, 1.3], &[0.9, 1.5]),
    (WENDLAND, &[1.5, 2.0], &[1.2, 2.5]),
];

/// The runs of a tier; the full one adds waves that are oblique to the lattice.
fn studies(case: &'static Composed<WaveSettings>, of: Polarisation, tier: Tier) -> Studies {
    let mut table = Table::new(case, tier);
    let on_lattice = if of == Polarisation::Sound { SOUND } else { SHEAR };
    let wave = |s: &mut WaveSettings, (n, ratio, [kx, ky]): (usize, f64, [usize; 2])| {
        (s.n, s.h_over_dx, s.kx, s.ky) = (n, ratio, kx, ky);
        // Strong viscosity: rows slide less before the shear wave has decayed, within fewer steps.
        s.nu = if of == Polarisation::Shear { 0.01 } else { s.nu };
    };
    for (variant, usual, more) in RATIOS {
        let along = |s: &mut _, ratio| wave(s, (16, ratio, [1, 0]));
        table.over(on_lattice, &[variant], [usual; 2], along);
        let oblique = |s: &mut _, ratio| wave(s, (16, ratio, [3, 2]));
        table.over(on_lattice, &[variant], [&[], &[usual, more].concat()], oblique);
    }
    // Smoothing lengths from too short to too long, in a box that holds the widest support.
    let far = |s: &mut _, ratio| wave(s, (20, ratio, [1, 0]));
    table.over(on_lattice, &[CUBIC, QUINTIC, WENDLAND], [&[0.9, 3.0]; 2], far);
    if of == Polarisation::Sound {
        let diffusive = |s: &mut _, k| wave(s, (16, 1.2, k));
        let waves = [[1, 0], [3, 2]];
        table.over(DIFFUSED, &[DIFFUSIVE], [&waves[..1], &waves], diffusive);
        table.one(COMPRESSED, CUBIC, |s| s.compression = 0.05);
        table.one(DISORDERED, CUBIC, |s| s.jitter = 0.1);
        table.over(UNDAMPED, &[MIDPOINT], [&[0.2, 0.7]; 2], |s, courant| {
            wave(s, (16, 1.3, [5, 0]));
            (s.nu, s.courant) = (0.0, courant);
        });
    }
    table.judge(|row| gates(case, row));
    Studies::judging(table.plan())
}

/// Gates of a run, with reasons.
fn gates(
    case: &Composed<WaveSettings>,
    Row { group: judged, variant, settings: s, .. }: &Row<WaveSettings, Judged>,
) -> Vec<Gate> {
    let what = match s {
        _ if s.compression > 0.0 => format!("compressed{}", s.compression),
        _ if s.jitter > 0.0 => format!("jitter{}", s.jitter),
        _ if s.nu == 0.0 => format!("undamped{}", s.courant),
        _ => format!("k{}{}", s.kx, s.ky),
    };
    let (most, evidence) = match s.jitter > 0.0 {
        true => (MOMENTUM, Evidence::Invariant),
        false => (TOLERANCE, Evidence::Theory),
    };
    let gates = case.gates(format!("{variant}.h{}.{what}", s.h_over_dx));
    let gate = |(metric, because): &(MetricKey, &str)| {
        gates.gate(*metric, Bound::Below(most), evidence, because)
    };
    judged.iter().map(gate).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::tests::judged;
    use touchstone_base::functions::ln;
    use touchstone_harness::case::{Case, RunError};
    use touchstone_harness::context::Context;

    /// Every kernel, integrator and smoothing length of the quick tier has the lattice's symbols.
    #[test]
    fn waves_have_the_symbols_of_the_lattice() {
        let judged = judged(&[&ACOUSTIC_WAVE, &SHEAR_WAVE]);
        assert_eq!(judged.len(), (8 + 6) * 3 + 1 + 1 + 2 + 1 + (8 + 6) * 2);
        for judged in judged {
            let (id, value) = (&judged.gate.id, judged.judgement.value);
            assert!(!judged.judgement.verdict.is_failure(), "{id}: {value:?}");
        }
    }

    /// Test of the gates: a larger amplitude is not linear, and fails them.
    #[test]
    fn an_amplitude_that_is_not_linear_is_seen() {
        let spec = ACOUSTIC_WAVE.spec("cubic-leapfrog", |s| s.amplitude = 1e-3);
        let record = ACOUSTIC_WAVE.run(&spec, &Context::default()).expect("a run");
        assert!(record.value(DECAY_ERROR).expect("measured") > 1e-4);
    }

    /// Growth of the energy of an undamped short wave a step, and ω dt.
    fn growth(variant: &str) -> [f64; 2] {
        let spec = ACOUSTIC_WAVE.spec(variant, |s| (s.nu, s.courant, s.kx) = (0.0, 0.5, 5));
        let record = ACOUSTIC_WAVE.run(&spec, &Context::default()).expect("a run");
        let [p, v] = ["p", "v_along"].map(|name| record.column("amplitudes", name));
        let energy = |k: usize| p[k] * p[k] + v[k] * v[k];
        let steps = p.len() - 1;
        let omega_dt = record.numerics["omega dt"].as_f64().expect("a number");
        [ln(energy(steps) / energy(0)) / steps as f64, omega_dt]
    }

    #[test]
    fn undamped_sound_grows_as_theory_says_and_not_in_the_leapfrog() {
        let [growth_of_midpoint, omega_dt] = growth("cubic-pc");
        let theory = ln(1.0 + 0.25 * omega_dt.powi(4));
        assert!((growth_of_midpoint / theory - 1.0).abs() < 1e-4, "{growth_of_midpoint} {theory}");
        // The leapfrog's energy beats by ω dt, and that is all.
        assert!(growth("cubic-leapfrog")[0].abs() < 0.3 * theory);
    }

    #[test]
    fn a_wave_that_the_lattice_does_not_carry_is_refused() {
        let refused = |set: fn(&mut WaveSettings)| {
            let spec = ACOUSTIC_WAVE.spec("cubic-pc", set);
            ACOUSTIC_WAVE.run(&spec, &Context::default()).err()
        };
        assert!(matches!(refused(|s| s.kx = 8), Some(RunError::TooMuch { .. })));
        assert!(matches!(refused(|s| s.dt = Some(1.0)), Some(RunError::TimeStep { .. })));
        let words = refused(|s| s.n = 4).map(|error| error.to_string()).unwrap_or_default();
        assert!(words.starts_with("with n=4 the scene is impossible: "), "{words}");
    }

    /// A viscosity of 1e-300 m²/s decays in 1e300 s: the run must be refused, not panic.
    #[test]
    fn a_shear_wave_that_never_decays_is_refused() {
        let spec = SHEAR_WAVE.spec("cubic-pc", |s| s.nu = 1e-300);
        let refused = SHEAR_WAVE.run(&spec, &Context::default());
        assert!(matches!(refused, Err(RunError::TooLong { .. })));
    }
}
