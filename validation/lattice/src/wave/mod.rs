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

pub use run::{Diffusive, Wave, measure, measure_scene, run_scene};

use solver::{
    Compose, Continuity, CubicSpline, Kernel, Leapfrog, Open, PredictorCorrector, Pressure,
    QuinticSpline, Tait, Viscosity, WendlandC2,
};

use base::{
    gate::{Bound, Evidence, Gate},
    record::Record,
    settings::{self, Field, Settings},
};
use harness::{
    case::{self, Case, Planned, RunError, Tier, Variant},
    runner::Context,
    suite::{JudgedRun, Study},
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
        /// standard deviation of the initial places, for sums that no symmetry makes vanish; theory
        /// is that of the lattice
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

/// A wave as a [`Case`].
pub struct WaveCase {
    /// Name on the command line.
    pub name: &'static str,
    /// The problem in words.
    pub about: &'static str,
    /// Which wave.
    pub polarisation: Polarisation,
    /// Settings of the planned runs beside kernel and wave number.
    pub set: &'static [&'static str],
    /// What the gates are on: metric, why the bound is where it is.
    pub gates: &'static [(&'static str, &'static str)],
    /// The same on a compressed lattice, one gate and one run for each variant.
    pub compressed: Option<(&'static str, &'static str)>,
    /// The same on a disordered lattice: a gate on what holds there too.
    pub disordered: Option<(&'static str, &'static str)>,
}

type Run = fn(&WaveCase, &str, &WaveSettings, &Context) -> Result<Record, RunError>;

/// A composition of kernel and integrator.
struct WaveVariant {
    variant: Variant,
    run: Run,
    /// Whether density diffusion is in it.
    diffuses: bool,
    /// h/dx of the plan: quick tier, and more in the full one.
    ratios: [&'static [f64]; 2],
}

/// The scheme of a wave: no more than the equations.
pub type Scheme<K, I> = SchemeWith<K, Continuity, I>;

/// The same with the density following `D`.
pub type SchemeWith<K, D, I> = Compose<K, (Pressure<Tait>, Viscosity), D, Open, I>;

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

#[rustfmt::skip] // one line a variant: a table
fn variants() -> Vec<WaveVariant> {
    type Ratios = [&'static [f64]; 2];
    fn variant<K: Kernel, I: Stepping>(name: &'static str, ratios: Ratios) -> WaveVariant {
        let about = "one kernel and one integrator; the equations and nothing else";
        let variant = Variant { name, about };
        WaveVariant { variant, run: run::run::<K, I>, diffuses: false, ratios }
    }
    let diffusive = WaveVariant {
        variant: Variant {
            name: "cubic-leapfrog-diffusion",
            about: "the cubic spline and the leapfrog, with density diffusion",
        },
        run: run::run_diffusive::<CubicSpline, Leapfrog>,
        diffuses: true,
        ratios: [&[1.2], &[]],
    };
    const CUBIC: Ratios = [&[1.2, 1.3], &[1.0, 1.5, 2.0]];
    const QUINTIC: Ratios = [&[1.0, 1.3], &[0.9, 1.5]];
    const WENDLAND: Ratios = [&[1.5, 2.0], &[1.2, 2.5]];
    vec![
        variant::<CubicSpline, Leapfrog>("cubic-leapfrog", CUBIC),
        variant::<CubicSpline, PredictorCorrector>("cubic-pc", CUBIC),
        variant::<QuinticSpline, Leapfrog>("quintic-leapfrog", QUINTIC),
        variant::<QuinticSpline, PredictorCorrector>("quintic-pc", QUINTIC),
        variant::<WendlandC2, Leapfrog>("wendland-leapfrog", WENDLAND),
        variant::<WendlandC2, PredictorCorrector>("wendland-pc", WENDLAND),
        diffusive,
    ]
}

impl WaveCase {
    /// One run of the plan; the full tier adds waves that are oblique to the lattice.
    fn planned(&self, variant: &WaveVariant, ratio: f64, [kx, ky]: [usize; 2]) -> Planned {
        let set = vec![format!("h_over_dx={ratio}"), format!("kx={kx}"), format!("ky={ky}")];
        let name = variant.variant.name;
        let id = format!("{}.{name}.h{ratio}.k{kx}{ky}", self.name);
        // Density diffusion has no inverse of its own in `fit`: the trajectory shows it.
        let is_seen = |gate: &&(&str, &str)| !variant.diffuses || gate.0 == "trajectory_error";
        let gates: Vec<_> = self.gates.iter().filter(is_seen).copied().collect();
        self.judged(name, &set, &id, &gates, TOLERANCE, Evidence::Theory)
    }

    /// The run of the plan on a compressed lattice.
    fn compressed(&self, variant: &'static str, ratio: f64) -> Option<Planned> {
        let set = [format!("h_over_dx={ratio}"), format!("compression={COMPRESSION}")];
        let id = format!("{}.{variant}.h{ratio}.compressed{COMPRESSION}", self.name);
        self.compressed
            .map(|gate| self.judged(variant, &set, &id, &[gate], TOLERANCE, Evidence::Theory))
    }

    /// The run of the plan on a disordered lattice.
    fn disordered(&self, variant: &'static str, ratio: f64) -> Option<Planned> {
        let set = [format!("h_over_dx={ratio}"), format!("jitter={JITTER}")];
        let id = format!("{}.{variant}.h{ratio}.jitter{JITTER}", self.name);
        self.disordered
            .map(|gate| self.judged(variant, &set, &id, &[gate], MOMENTUM, Evidence::Invariant))
    }

    fn judged(
        &self,
        variant: &'static str,
        set: &[String],
        id: &str,
        gates: &[(&'static str, &'static str)],
        most: f64,
        evidence: Evidence,
    ) -> Planned {
        let mut set = set.to_vec();
        set.extend(self.set.iter().map(|text| text.to_string()));
        let gate = |(metric, because): &(&str, &str)| {
            let id = format!("{id}.{metric}");
            Gate::new(id, *metric, Bound::Below(most), evidence, *because)
        };
        Planned::new(variant, &set).judged(gates.iter().map(gate).collect())
    }
}

impl WaveVariant {
    /// The variant's settings with `key=value` texts applied.
    fn settings(&self, set: &[String]) -> Result<WaveSettings, RunError> {
        let diffusion = if self.diffuses { DIFFUSION } else { 0.0 };
        let mut settings = WaveSettings { diffusion, ..WaveSettings::default() };
        settings::apply(&mut settings, set)?;
        if !self.diffuses && settings.diffusion != 0.0 {
            let variant = self.variant.name.to_string();
            return Err(RunError::Unused { key: "diffusion".into(), variant });
        }
        Ok(settings)
    }
}

/// The settings of a variant with `key=value` texts applied.
pub fn settings(variant: &str, set: &[String]) -> Result<WaveSettings, RunError> {
    let variants = variants();
    case::find("wave", &variants, variant, |v| v.variant.name)?.settings(set)
}

impl Case for WaveCase {
    fn name(&self) -> &'static str {
        self.name
    }

    fn about(&self) -> &'static str {
        self.about
    }

    fn variants(&self) -> Vec<Variant> {
        variants().into_iter().map(|v| v.variant).collect()
    }

    fn fields(&self) -> &'static [Field] {
        WaveSettings::FIELDS
    }

    fn settings(&self, variant: &str, set: &[String]) -> Result<serde_json::Value, RunError> {
        let variants = variants();
        let chosen = case::find(self.name, &variants, variant, |v| v.variant.name)?;
        Ok(serde_json::to_value(chosen.settings(set)?).unwrap_or_default())
    }

    fn run(&self, variant: &str, set: &[String], context: &Context) -> Result<Record, RunError> {
        let variants = variants();
        let chosen = case::find(self.name, &variants, variant, |v| v.variant.name)?;
        (chosen.run)(self, variant, &chosen.settings(set)?, context)
    }

    fn plan(&self, tier: Tier) -> Vec<Planned> {
        let mut plan = Vec::new();
        for chosen in
            variants().iter().filter(|v| self.polarisation == Polarisation::Sound || !v.diffuses)
        {
            let (name, [quick, more]) = (chosen.variant.name, chosen.ratios);
            plan.extend(quick.iter().map(|&ratio| self.planned(chosen, ratio, [1, 0])));
            if !chosen.diffuses {
                plan.extend(self.compressed(name, quick[0]));
                plan.extend(self.disordered(name, quick[0]));
            }
            if tier == Tier::Full {
                let oblique = quick.iter().chain(more);
                plan.extend(oblique.map(|&ratio| self.planned(chosen, ratio, [3, 2])));
            }
        }
        plan
    }

    fn studies(&self, _tier: Tier, _runs: &[JudgedRun]) -> Vec<Study> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use harness::suite::{Watch, run};
    use harness::case::find_in;

    /// Every kernel, integrator and smoothing length of the quick tier has the lattice's symbols.
    #[test]
    fn waves_have_the_symbols_of_the_lattice() {
        let cases = ["acoustic_wave", "shear_wave"].map(|name| find_in(crate::CASES, name).expect("a case"));
        let suite = run(&cases, Tier::Quick, None, &Watch::default()).expect("planned runs");
        assert_eq!(suite.judged().count(), 12 * 3 + 6 + 6 + 1 + 12 * 2);
        for judged in suite.judged() {
            let (id, value) = (&judged.gate.id, judged.judgement.value);
            assert!(!judged.judgement.verdict.is_failure(), "{id}: {value:?}");
        }
    }

    /// What the gates are worth: a larger amplitude is not linear, and fails them.
    #[test]
    fn an_amplitude_that_is_not_linear_is_seen() {
        let case = find_in(crate::CASES, "acoustic_wave").expect("a case");
        let set = ["amplitude=1e-3".to_string()];
        let record = case.run("cubic-leapfrog", &set, &Context::default()).expect("a run");
        assert!(record.metric("decay_error").expect("measured") > 1e-4);
    }

    #[test]
    fn a_wave_that_the_lattice_does_not_carry_is_refused() {
        let case = find_in(crate::CASES, "acoustic_wave").expect("a case");
        let refused = |set: &str| case.run("cubic-pc", &[set.into()], &Context::default()).err();
        assert!(matches!(refused("kx=8"), Some(RunError::TooMuch { .. })));
        assert!(matches!(refused("dt=1"), Some(RunError::TimeStep { .. })));
        assert!(matches!(refused("n=4"), Some(RunError::Scene(_))));
    }
}
