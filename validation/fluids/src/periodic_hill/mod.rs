//! Laminar flow over periodic hills, driven to a given flux: curved walls, separation, recirculation.
//! Lengths by the height H = 1 m of the hill, velocities by the bulk velocity over the crest U_b = 1 m/s,
//! ρ = 1 kg/m³.
//!
//! Judged against finite elements (`references/periodic_hill`), for nobody has published these numbers.

mod control;
mod declaration;
mod measure;
mod plan;
mod reference;
mod run;
mod setup;
mod stability;
mod studies;

use harness::composed::{Composed, Composition, lacking};
use maths::theory::Stepping;
use solver::{
    BodyForce, Compose, ConsistentContinuity, ConsistentPressure, ConsistentViscosity, Continuity,
    DensityDiffusion, ExtrapolatingWall, InterfaceWall, Leapfrog, NoSlip, Pressure, QuinticSpline,
    Scheme, ShiftAdvection, Shifting, Tait, Viscosity,
};

pub use control::Driven;
pub use run::{run_scene, scene};
pub use setup::{HillWall, Setup};

use super::fluid::{Ingredient, OPTIONAL};
use harness::case::{Case, RunError, Variant};

base::settings! {
    /// Settings of the flow over hills. H = U_b = ρ = 1.
    pub struct HillSettings {
        /// Reynolds number U_b H/ν
        re: f64 ["-"] in 1e-3..=1e3 = 50.0,
        /// spacings along the height of the hill
        n: usize ["-"] in 4..=400 = 10,
        /// height of the crest; 0 is a flat channel
        crest: f64 ["H"] in 0.0..=1.5 = 1.0,
        /// flux, of that of the reference
        flux: f64 ["2.035 U_b H"] in 0.0..=10.0 = 1.0,
        /// start from an interpolation of the reference instead of from rest
        from_reference: bool = false,
        /// force of the start
        force: f64 ["U_b^2/H"] in -1e3..=1e3 = 0.0,
        /// time in which the controller closes a gap in flux; 0 keeps the force
        response: f64 ["H/U_b"] in 0.0..=1e3 = 1.0,
        /// end of the run
        end: f64 ["H/U_b"] in 1e-3..=1e4 = 40.0,
        /// last part of the run, over which profiles are averaged
        average: f64 ["of the run"] in 0.01..=0.3 = 0.2,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.9..=3.0 = 1.0,
        /// guard against 0/0 in the viscous term
        eta2_over_h2: f64 ["-"] in 1e-12..=0.1 = 1e-6,
        /// sound speed; the largest speed of the flow is 1.6 U_b at most
        c0: f64 ["U_b"] in 2.0..=1e4 = 15.0,
        /// exponent of the Tait equation
        gamma: usize ["-"] in 1..=20 = 7,
        /// background pressure 0p
        background: f64 ["rho c0^2"] in 0.0..=10.0 = 0.0,
        /// Courant number of the time step: two thirds of the theoretical limit
        courant: f64 ["-"] in 1e-6..=100.0 = 1.5,
        /// viscous number of the time step
        viscous: f64 ["-"] in 1e-6..=100.0 = 0.25,
        /// density diffusion δ
        diffusion: f64 ["-"] in 0.0..=10.0 = 0.1,
        /// particle shifting, amplitude
        shift: f64 ["-"] in 0.0..=10.0 = 0.5,
        /// reach of neighbour rows beyond the support
        skin: f64 ["h"] in 0.0..=2.0 = 0.15,
    }
}

fn variant<S>(
    name: &'static str,
    about: &'static str,
    adjust: fn(&mut HillSettings),
) -> Composition<HillSettings>
where
    S: Scheme<Extra = ()>,
    S::Forces: Ingredient + Driven,
    S::Drift: Ingredient,
    S::Walls: HillWall,
    S::Integrator: Stepping,
{
    let lacks = lacking(OPTIONAL, &[S::Forces::uses(), S::Drift::uses()].concat());
    let (variant, rules) = (Variant { name, about }, |s: &_| Ok(Setup::new::<S>(s, true)?.rules()));
    Composition { variant, adjust, run: run::run::<S>, rules, lacks }
}

type Extrapolating = ExtrapolatingWall<Tait, NoSlip>;
type Pairs = (Pressure<Tait>, Viscosity, BodyForce);
type Carried = (Pressure<Tait>, Viscosity, BodyForce, ShiftAdvection);
type Mixed = (ConsistentPressure<Tait>, Viscosity, BodyForce, ShiftAdvection);
type Consistent = (ConsistentPressure<Tait>, ConsistentViscosity, BodyForce, ShiftAdvection);
type Stabilised = (Continuity, DensityDiffusion, Shifting);
type ConsistentDrift = (ConsistentContinuity, DensityDiffusion, Shifting);
type Quintic<F, D, W = Extrapolating> = Compose<QuinticSpline, F, D, W, Leapfrog>;

/// The amplitude of the vortices' `strong`, for the same reason.
fn strong(s: &mut HillSettings) {
    s.shift = 3.0;
}

fn variants() -> Vec<Composition<HillSettings>> {
    vec![
        variant::<Quintic<Pairs, Continuity>>(
            "plain",
            "quintic spline, h/dx 1, leapfrog, extrapolating walls, no stabiliser",
            |_| {},
        ),
        variant::<Quintic<Pairs, Stabilised, InterfaceWall>>(
            "interface-wall",
            "modern with interface and wall particles (4.2)",
            |_| {},
        ),
        variant::<Quintic<Pairs, Stabilised>>(
            "modern",
            "plain with density diffusion and shifting, as in the channels",
            |_| {},
        ),
        variant::<Quintic<Carried, Stabilised>>(
            "carried",
            "modern with stronger shifting, and a shifted particle takes the velocity of its new place",
            strong,
        ),
        variant::<Quintic<Mixed, ConsistentDrift>>(
            "mixed",
            "carried, with pressure and continuity that are exact for linear fields",
            strong,
        ),
        variant::<Quintic<Consistent, ConsistentDrift>>(
            "consistent",
            "mixed, with a viscosity that is exact for linear fields too",
            strong,
        ),
    ]
}

const NAME: &str = "periodic_hill";

/// The settings of a variant with `key=value` texts applied.
pub fn settings(variant: &str, set: &[String]) -> Result<HillSettings, RunError> {
    CASE.settings_of(variant, set)
}

static CASE: Composed<HillSettings> = Composed {
    name: NAME,
    about: "A channel with hills on its floor, one every nine heights, and a flat lid. A body force drives a \
            given flux through it. From Re 50 on the flow leaves the wall behind the crest and comes back \
            to it in the trough, or on the next hill: steady, laminar, with curved walls that are convex at \
            the crest and concave at the foot. The reference is a finite-element computation of this \
            project, for none is published.",
    variants,
    is_stable: stability::is_stable,
    declaration: declaration::declaration,
    plan: plan::plan,
    studies: studies::studies,
};

/// Flow over periodic hills.
pub const PERIODIC_HILL: &dyn Case = &CASE;
