//! One Fourier mode on a periodic lattice, what sound wave and shear wave have in common.
//!
//! Particles are labelled by where they start, and amplitudes are projections over the labels: that
//! is the linear problem that [`maths::theory::lattice`] solves exactly. Without background pressure
//! a displacement meets a pressure of the same order, so moving particles are second order in the
//! amplitude; products of one wave number with itself have wave numbers 0 and 2k, so the mode k
//! itself is disturbed only to third order, relative to itself by amplitude² (unless 3k is a whole
//! number of turns from one particle to the next, where 2k looks like -k).
//!
//! Time error is not subtracted but divided out: the amplitudes of one step follow from those of the
//! last by a matrix that is known in closed form for each integrator, and the inverse of that form
//! turns the measured matrix into ω and γ of continuous time. See [`fit`].

pub mod fit;
mod run;

pub use run::{Wave, measure};

use solver::{
    Compose, Continuity, CubicSpline, DensityDiffusion, Integrator, Kernel, Leapfrog, Open,
    PredictorCorrector, Pressure, QuinticSpline, Tait, Viscosity, WendlandC2,
};

use base::{
    gate::{Bound, Evidence, Gate},
    record::MetricKey,
};
use harness::{
    case::{Planned, Tier},
    composed::{self, Best, Composed, Composition, Program, Variants},
    declare::Declaration,
    method::Method,
};
use maths::theory::Stepping;

base::settings! {
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
        /// density of the lattice over that density, less one; the sound speed rises with its cube, and a
        /// background pressure makes the pressure 0 again
        compression: f64 ["-"] in 0.0..=0.2 = 0.0,
        /// kinematic viscosity
        nu: f64 ["m^2/s"] in 0.0..=1e6 = 1e-3,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.5..=5.0 = 1.2,
        /// guard against 0/0 in the viscous term
        eta2_over_h2: f64 ["-"] in 1e-12..=0.1 = 0.01,
        /// density diffusion δ
        diffusion: f64 ["-"] in 0.0..=10.0 = 0.0,
        /// standard deviation of the initial displacements, for sums that no symmetry makes vanish;
        /// theory is that of the lattice
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

/// Which of the two kinds of wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Polarisation {
    /// Velocity along the gradient symbol.
    Sound,
    /// Velocity across it.
    Shear,
}

/// What tells the case of one wave from that of the other.
pub struct WaveCase {
    /// Name on the command line.
    pub name: &'static str,
    /// The problem in at most ten words.
    pub problem: &'static str,
    /// The problem in words.
    pub about: &'static str,
    /// Which wave.
    pub polarisation: Polarisation,
    /// Settings of the planned runs beside kernel and wave number.
    pub set: fn(&mut WaveSettings),
    /// What the gates are on: metric, why the bound is where it is.
    pub gates: &'static [(MetricKey, &'static str)],
    /// The same on a compressed lattice, one gate and one run for each variant.
    pub compressed: Option<(MetricKey, &'static str)>,
    /// The same on a disordered lattice: a gate on what holds there too.
    pub disordered: Option<(MetricKey, &'static str)>,
}

/// A kind of wave as a type, so that its variants are functions without state.
pub trait Kind {
    /// Its case.
    const CASE: &'static WaveCase;
}

/// Error of the frequency of a sound wave.
pub const FREQUENCY_ERROR: MetricKey = MetricKey::new(
    "frequency_error",
    "-",
    "|omega - c0 |g(k)||/(c0 |g(k)|), time error divided out",
);
/// Error of the decay of a sound wave.
pub const DECAY_ERROR: MetricKey =
    MetricKey::new("decay_error", "-", "|gamma - nu lambda(k)|/(nu lambda(k)), of omega if nu = 0");
/// Error of the decay of a shear wave.
pub const SHEAR_DECAY_ERROR: MetricKey = MetricKey::new(
    "decay_error",
    "-",
    "|gamma - nu lambda(k)|/(nu lambda(k)), time error divided out",
);
/// Distance of the amplitudes from exact steps.
pub const TRAJECTORY_ERROR: MetricKey = MetricKey::new(
    "trajectory_error",
    "-",
    "max|amplitudes - exact steps|/amplitude over p, v along, v across and all steps",
);
/// Change of momentum.
pub const MOMENTUM_ERROR: MetricKey = MetricKey::new(
    "momentum_error",
    "-",
    "|change of sum m v after the first step|/(sum m times the velocity amplitude)",
);

/// The scheme of a wave: no more than the equations.
pub type Scheme<K, I> = Compose<K, (Pressure<Tait>, Viscosity), Continuity, Open, I>;
/// The same with density diffusion.
pub type Diffusive<K, I> =
    Compose<K, (Pressure<Tait>, Viscosity), (Continuity, DensityDiffusion), Open, I>;

/// Gates allow this relative error. Measured at amplitudes 1e-3 to 1e-8: the error of γ is
/// 1.3e3 amplitude² for sound and 6e4 amplitude² for shear at ν = 1e-3 (rows slide by amplitude
/// c₀/γ), plus, for sound, round-off of about 3e-15/amplitude. At 1e-6 both leave two decades.
const TOLERANCE: f64 = 1e-6;

/// Total momentum may change by this much of Σ m |v|: round-off of a thousand sums.
const MOMENTUM: f64 = 1e-10;

/// Standard deviation of the places of a disordered lattice \[dx\].
const JITTER: f64 = 0.1;

/// δ of the variant with density diffusion: the customary one.
const DIFFUSION: f64 = 0.1;

/// Compression of the compressed lattice: with the exponent 6 for 7 its sound is 2.5 % slower.
const COMPRESSION: f64 = 0.05;

/// The variant with density diffusion, and its h/dx in the plan.
const DIFFUSIVE: (&str, f64) = ("cubic-leapfrog-diffusion", 1.2);

/// h/dx in the plan: of the quick tier, and more of the full one.
type Ratios = [&'static [f64]; 2];
const CUBIC: Ratios = [&[1.2, 1.3], &[1.0, 1.5, 2.0]];
const QUINTIC: Ratios = [&[1.0, 1.3], &[0.9, 1.5]];
const WENDLAND: Ratios = [&[1.5, 2.0], &[1.2, 2.5]];

/// The other variants and their h/dx in the plan.
const PLANNED: [(&str, Ratios); 6] = [
    ("cubic-leapfrog", CUBIC),
    ("cubic-pc", CUBIC),
    ("quintic-leapfrog", QUINTIC),
    ("quintic-pc", QUINTIC),
    ("wendland-leapfrog", WENDLAND),
    ("wendland-pc", WENDLAND),
];

fn variants<P: Kind>() -> Vec<Composition<WaveSettings>> {
    let program = Program {
        run: |method, variant, s, context| run::run(P::CASE, method, variant, s, context),
        rules: |method, s| run::rules(P::CASE.polarisation, method, s),
    };
    let about = "one kernel and one integrator; the equations and nothing else";
    let diffusive = "the cubic spline and the leapfrog, with density diffusion";
    Variants::of(&program)
        .with("cubic-leapfrog", about, plain::<CubicSpline, Leapfrog>(), |_| ())
        .with("cubic-pc", about, plain::<CubicSpline, PredictorCorrector>(), |_| ())
        .with("quintic-leapfrog", about, plain::<QuinticSpline, Leapfrog>(), |_| ())
        .with("quintic-pc", about, plain::<QuinticSpline, PredictorCorrector>(), |_| ())
        .with("wendland-leapfrog", about, plain::<WendlandC2, Leapfrog>(), |_| ())
        .with("wendland-pc", about, plain::<WendlandC2, PredictorCorrector>(), |_| ())
        .with(DIFFUSIVE.0, diffusive, Method::of::<Diffusive<CubicSpline, Leapfrog>>(), |s| {
            s.diffusion = DIFFUSION;
        })
        .all
}

/// The equations and nothing else.
pub fn plain<K: Kernel, I: Stepping + Integrator<Scheme<K, ()>>>() -> Method {
    Method::of::<Scheme<K, I>>()
}

/// The case of a kind of wave.
pub const fn case<P: Kind>() -> Composed<WaveSettings> {
    Composed {
        name: P::CASE.name,
        problem: P::CASE.problem,
        best: Best {
            variant: "cubic-leapfrog",
            because: "all kernels follow the theory of the lattice to round-off, and this one takes \
                      the fewest pairs",
            papers: None,
        },
        about: P::CASE.about,
        variants: variants::<P>,
        is_stable: composed::completed,
        declaration: |_| Declaration::default(),
        plan: plan::<P>,
        studies: composed::no_studies,
    }
}

/// The runs of a tier; the full one adds waves that are oblique to the lattice.
fn plan<P: Kind>(tier: Tier) -> Vec<Planned> {
    let case = P::CASE;
    let mut plan = Vec::new();
    for (variant, [quick, more]) in PLANNED {
        let one = |ratio, k| on_lattice::<P>(variant, case.gates, ratio, k);
        plan.extend(quick.iter().map(|&ratio| one(ratio, [1, 0])));
        plan.extend(compressed::<P>(variant, quick[0]));
        plan.extend(disordered::<P>(variant, quick[0]));
        if tier == Tier::Full {
            plan.extend(quick.iter().chain(more).map(|&ratio| one(ratio, [3, 2])));
        }
    }
    if case.polarisation == Polarisation::Sound {
        // Density diffusion has no inverse of its own in `fit`: the trajectory shows it.
        let on_trajectory = |gate: &&(MetricKey, _)| gate.0 == TRAJECTORY_ERROR;
        let gates: Vec<_> = case.gates.iter().filter(on_trajectory).copied().collect();
        let (variant, ratio) = DIFFUSIVE;
        let waves: &[[usize; 2]] = if tier == Tier::Full { &[[1, 0], [3, 2]] } else { &[[1, 0]] };
        plan.extend(waves.iter().map(|&k| on_lattice::<P>(variant, &gates, ratio, k)));
    }
    plan
}

/// A run on the lattice as it is.
fn on_lattice<P: Kind>(
    variant: &str,
    gates: &[(MetricKey, &str)],
    ratio: f64,
    [kx, ky]: [usize; 2],
) -> Planned {
    let id = format!("{}.{variant}.h{ratio}.k{kx}{ky}", P::CASE.name);
    let gate = |gate: &(MetricKey, &str)| gate_of(&id, gate, TOLERANCE, Evidence::Theory);
    let set = |s: &mut WaveSettings| (s.h_over_dx, s.kx, s.ky) = (ratio, kx, ky);
    planned::<P>(variant, set).judged(gates.iter().map(gate).collect())
}

/// A run on a compressed lattice.
fn compressed<P: Kind>(variant: &str, ratio: f64) -> Option<Planned> {
    let id = format!("{}.{variant}.h{ratio}.compressed{COMPRESSION}", P::CASE.name);
    let gate = gate_of(&id, &P::CASE.compressed?, TOLERANCE, Evidence::Theory);
    let set = |s: &mut WaveSettings| (s.h_over_dx, s.compression) = (ratio, COMPRESSION);
    Some(planned::<P>(variant, set).judged(vec![gate]))
}

/// A run on a disordered lattice.
fn disordered<P: Kind>(variant: &str, ratio: f64) -> Option<Planned> {
    let id = format!("{}.{variant}.h{ratio}.jitter{JITTER}", P::CASE.name);
    let gate = gate_of(&id, &P::CASE.disordered?, MOMENTUM, Evidence::Invariant);
    let set = |s: &mut WaveSettings| (s.h_over_dx, s.jitter) = (ratio, JITTER);
    Some(planned::<P>(variant, set).judged(vec![gate]))
}

fn planned<P: Kind>(variant: &str, set: impl FnOnce(&mut WaveSettings)) -> Planned {
    let set = |settings: &mut WaveSettings| {
        (P::CASE.set)(settings);
        set(settings);
    };
    case::<P>().planned(variant, set).taking(0.03)
}

fn gate_of(
    id: &str,
    &(metric, because): &(MetricKey, &str),
    most: f64,
    evidence: Evidence,
) -> Gate {
    let metric = String::from(metric);
    Gate::new(format!("{id}.{metric}"), metric, Bound::Below(most), evidence, because)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{acoustic_wave::ACOUSTIC_WAVE, shear_wave::SHEAR_WAVE, tests::judged};
    use harness::{
        case::{Case, RunError},
        context::Context,
    };

    /// Every kernel, integrator and smoothing length of the quick tier has the lattice's symbols.
    #[test]
    fn waves_have_the_symbols_of_the_lattice() {
        let judged = judged(&[&ACOUSTIC_WAVE, &SHEAR_WAVE]);
        assert_eq!(judged.len(), 12 * 3 + 6 + 6 + 1 + 12 * 2);
        for judged in judged {
            let (id, value) = (&judged.gate.id, judged.judgement.value);
            assert!(!judged.judgement.verdict.is_failure(), "{id}: {value:?}");
        }
    }

    /// What the gates are worth: a larger amplitude is not linear, and fails them.
    #[test]
    fn an_amplitude_that_is_not_linear_is_seen() {
        let spec = ACOUSTIC_WAVE.spec("cubic-leapfrog", |s| s.amplitude = 1e-3);
        let record = ACOUSTIC_WAVE.run(&spec, &Context::default()).expect("a run");
        assert!(record.value(DECAY_ERROR).expect("measured") > 1e-4);
    }

    #[test]
    fn a_wave_that_the_lattice_does_not_carry_is_refused() {
        let refused = |set: fn(&mut WaveSettings)| {
            let spec = ACOUSTIC_WAVE.spec("cubic-pc", set);
            ACOUSTIC_WAVE.run(&spec, &Context::default()).err()
        };
        assert!(matches!(refused(|s| s.kx = 8), Some(RunError::TooMuch { .. })));
        assert!(matches!(refused(|s| s.dt = Some(1.0)), Some(RunError::TimeStep { .. })));
        assert!(matches!(refused(|s| s.n = 4), Some(RunError::Scene(_))));
    }

    /// Seen with random settings: a viscosity of 1e-300 m²/s decays in 1e300 s, and the run panicked.
    #[test]
    fn a_shear_wave_that_never_decays_is_refused() {
        let spec = SHEAR_WAVE.spec("cubic-pc", |s| s.nu = 1e-300);
        let refused = SHEAR_WAVE.run(&spec, &Context::default());
        assert!(matches!(refused, Err(RunError::TooLong { .. })));
    }
}
