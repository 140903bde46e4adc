//! Two rubber rings that collide head-on (Monaghan 2000; Gray, Monaghan & Swift 2001), in units of
//! ring size L, density ρ and bulk sound speed c₀ = √(K/ρ), plane strain.
//!
//! Judged against conservation, mirror symmetry, and an independent finite-element run of one ring
//! against a frictionless plane (`references/rubber_rings`), which is half of this problem.

mod budget;
mod measure;
mod plan;
mod reference;
mod run;
mod setup;
mod studies;

use solver::{
    ComponentStress, Leapfrog, PredictorCorrector, PrincipalStress, Symmetric, terms::TensileStress,
};

pub use budget::powers;
pub use run::{Rubber, run_scene};
pub use setup::{Rings, Tensile};

use super::channel::Stepping;
use crate::{
    case::{self, Case, Planned, RunError, Tier, Variant},
    record::Record,
    runner::Context,
    settings::{self, Field, Settings},
    suite::{JudgedRun, Study},
};

crate::settings! {
    /// Settings of the collision of two rings; L is 1 m.
    pub struct RingSettings {
        /// inner radius
        inner: f64 ["m"] in 0.1..=1e3 = 3.0,
        /// outer radius
        outer: f64 ["m"] in 0.1..=1e3 = 4.0,
        /// distance of the ring centres from the plane in which the rings meet
        centre: f64 ["m"] in 0.1..=1e4 = 5.0,
        /// initial spacing of particles
        spacing: f64 ["m"] in 1e-3..=10.0 = 0.1,
        /// density
        rho: f64 ["kg/m^3"] in 1e-6..=1e6 = 1.0,
        /// bulk modulus K, so that c0 = (K/rho)^(1/2)
        bulk_modulus: f64 ["Pa"] in 1e-12..=1e15 = 1.0,
        /// shear modulus
        shear_modulus: f64 ["K"] in 0.0..=1.5 = 0.22,
        /// speed of each ring
        speed: f64 ["c0"] in 0.0..=1.0 = 0.059,
        /// direction of the flight: the whole scene is turned by this angle
        angle: f64 ["deg"] in -360.0..=360.0 = 0.0,
        /// end of the run
        end: f64 ["L/c0"] in 1e-3..=1e6 = 200.0,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.9..=3.0 = 1.5,
        /// time step; auto: courant h/(c_p + speed), c_p = ((K + 4 mu/3)/rho)^(1/2)
        dt: Option<f64> ["s"] in 1e-15..=1e6 = None,
        /// Courant number of the time step: half the theoretical limit
        courant: f64 ["-"] in 1e-6..=10.0 = 0.6,
        /// linear artificial viscosity
        alpha: f64 ["-"] in 0.0..=10.0 = 1.0,
        /// quadratic artificial viscosity
        beta: f64 ["-"] in 0.0..=10.0 = 2.0,
        /// XSPH
        xsph: f64 ["-"] in 0.0..=0.99 = 0.5,
        /// strength of the artificial stress
        xi: f64 ["-"] in 0.0..=10.0 = 0.3,
        /// exponent of the artificial stress
        stress_exponent: usize ["-"] in 1..=16 = 4,
    }
}

type Run = fn(&str, &RingSettings, &Context) -> Result<Record, RunError>;

/// A composition.
struct RingVariant {
    variant: Variant,
    run: Run,
    has_stress: bool,
    courant: f64,
}

#[rustfmt::skip] // one line a variant: a table
fn variants() -> Vec<RingVariant> {
    fn variant<R, I>(name: &'static str, about: &'static str, has_stress: bool) -> RingVariant
    where
        R: Tensile + TensileStress,
        I: Stepping<Symmetric>,
    {
        let courant = RingSettings::default().courant;
        RingVariant { variant: Variant { name, about }, run: run::run::<R, I>, has_stress, courant }
    }
    type Midpoint = PredictorCorrector<Symmetric>;
    vec![
        variant::<PrincipalStress, Midpoint>("seed",
            "the paper's: cubic spline, predictor-corrector, artificial viscosity, XSPH, artificial \
             stress in principal axes", true),
        variant::<(), Midpoint>("no-artificial-stress",
            "the seed without artificial stress", false),
        variant::<ComponentStress, Midpoint>("componentwise",
            "the seed with artificial stress component by component, as the paper writes it", true),
        RingVariant { courant: LONG_STEPS, ..variant::<PrincipalStress, Leapfrog>("leapfrog",
            "the seed with the staggered leapfrog: one right-hand side a step, and longer steps", true) },
    ]
}

impl RingVariant {
    fn settings(&self, set: &[String]) -> Result<RingSettings, RunError> {
        for assignment in set {
            let key = assignment.split('=').next().unwrap_or_default().trim();
            if !self.has_stress && ["xi", "stress_exponent"].contains(&key) {
                let variant = self.variant.name.to_string();
                return Err(RunError::Unused { key: key.into(), variant });
            }
        }
        let mut settings = RingSettings { courant: self.courant, ..RingSettings::default() };
        settings::apply(&mut settings, set)?;
        Ok(settings)
    }
}

/// The settings of a variant with `key=value` texts applied.
pub fn settings(variant: &str, set: &[String]) -> Result<RingSettings, RunError> {
    case::find(NAME, &variants(), variant, |v| v.variant.name)?.settings(set)
}

const NAME: &str = "rubber_rings";

/// The Courant number of `leapfrog`: two thirds of the theoretical limit. At the paper's speed the error
/// is that of the spacing: half of it changes the restitution by 0.15 % of its value.
const LONG_STEPS: f64 = 0.8;

/// The collision as a [`Case`].
struct RubberRings;

/// Colliding rubber rings.
pub const RUBBER_RINGS: &dyn Case = &RubberRings;

impl Case for RubberRings {
    fn name(&self) -> &'static str {
        NAME
    }

    fn about(&self) -> &'static str {
        "Two rubber rings, inner radius 3, outer radius 4, fly at each other at 0.059 of the bulk sound \
         speed each, touch, flatten, and part. Plane strain, shear modulus 0.22 K. By symmetry it is one \
         ring against a frictionless plane, which finite elements have computed independently. Momentum \
         and mirror symmetry are exact, and a ring must not break: numerical fracture is the tensile \
         instability that artificial stress is there to prevent."
    }

    fn variants(&self) -> Vec<Variant> {
        variants().into_iter().map(|v| v.variant).collect()
    }

    fn fields(&self) -> &'static [Field] {
        RingSettings::FIELDS
    }

    fn settings(&self, variant: &str, set: &[String]) -> Result<serde_json::Value, RunError> {
        Ok(serde_json::to_value(settings(variant, set)?).unwrap_or_default())
    }

    fn run(&self, variant: &str, set: &[String], context: &Context) -> Result<Record, RunError> {
        let variants = variants();
        let chosen = case::find(NAME, &variants, variant, |v| v.variant.name)?;
        (chosen.run)(variant, &chosen.settings(set)?, context)
    }

    fn plan(&self, tier: Tier) -> Vec<Planned> {
        plan::plan(tier)
    }

    fn studies(&self, tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
        studies::studies(RUBBER_RINGS, tier, runs)
    }
}
