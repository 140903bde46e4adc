//! Taylor-Green vortices in a periodic box: interior flow without walls, from a lattice that suits it
//! and from one that does not. Length L = 1 m, largest speed at the start U = 1 m/s, ρ = 1 kg/m³.

mod declaration;
mod plan;
mod run;
mod studies;

use base::record::Status;
use harness::composed::{Composed, Composition, lacking};
use maths::theory::Stepping;
use solver::{
    Compose, ConsistentContinuity, ConsistentPressure, ConsistentViscosity, Continuity,
    DensityDiffusion, Leapfrog, Open, Pressure, QuinticSpline, Scheme, ShiftAdvection, Shifting,
    Tait, Viscosity,
};

pub use run::{Setup, run_scene, scene};

use super::fluid::{Ingredient, OPTIONAL};
use harness::case::{Case, RunError, Variant};

base::settings! {
    /// Settings of the vortices. L = U = ρ = 1.
    pub struct VortexSettings {
        /// Reynolds number U L/ν
        re: f64 ["-"] in 1e-3..=1e6 = 100.0,
        /// particles along each side
        n: usize ["-"] in 8..=2000 = 50,
        /// largest displacement of the initial lattice along each axis; uniform
        perturb: f64 ["dx"] in 0.0..=0.5 = 0.0,
        /// seed of the displacements
        seed: usize ["-"] in 0..=1000000 = 1,
        /// end of the run
        end: f64 ["L/U"] in 1e-6..=1e3 = 2.0,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.5..=5.0 = 1.0,
        /// guard against 0/0 in the viscous term
        eta2_over_h2: f64 ["-"] in 1e-12..=0.1 = 1e-6,
        /// sound speed
        c0: f64 ["U"] in 2.0..=1e4 = 10.0,
        /// exponent of the Tait equation
        gamma: usize ["-"] in 1..=20 = 7,
        /// background pressure 0p
        background: f64 ["rho c0^2"] in 0.0..=10.0 = 0.0,
        /// time step; auto: the least of courant h/(c0 + U) and viscous h²/ν
        dt: Option<f64> ["s"] in 1e-15..=1e3 = None,
        /// Courant number of the time step
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
    adjust: fn(&mut VortexSettings),
) -> Composition<VortexSettings>
where
    S: Scheme<Extra = (), Walls = Open>,
    S::Forces: Ingredient,
    S::Drift: Ingredient,
    S::Integrator: Stepping,
{
    let lacks = lacking(OPTIONAL, &[S::Forces::uses(), S::Drift::uses()].concat());
    let (variant, rules) = (Variant { name, about }, |s: &_| Ok(Setup::new::<S>(s, true)?.rules()));
    Composition { variant, adjust, run: run::run::<S>, rules, lacks }
}

type Pairs = (Pressure<Tait>, Viscosity);
type Carried = (Pressure<Tait>, Viscosity, ShiftAdvection);
type Stabilised = (Continuity, DensityDiffusion, Shifting);
type Consistent = (ConsistentPressure<Tait>, ConsistentViscosity, ShiftAdvection);
type ConsistentDrift = (ConsistentContinuity, DensityDiffusion, Shifting);
type Quintic<F, D> = Compose<QuinticSpline, F, D, Open, Leapfrog>;

/// Shifting of amplitude A = 3. A lattice that is squeezed to half along one axis and stretched along the
/// other, as at a stagnation point within t = 0.11 L/U, crowds: shifting lets disorder grow there by a
/// factor of exp(14 A n/50), which makes round-off visible in time from A = 2.5 on at 50 particles a
/// side. By the linear theory of its sum an explicit step dt = 1.5 h/(c0 + U) allows 4.7 on a lattice and
/// 1.8 where it is squeezed most: there it overshoots from step to step for as long as the squeeze lasts,
/// and that this crowds no pair is for the gate `nearest` to say. At dt = h/(c0 + U) the bounds are 7 and
/// 2.7.
fn strong(s: &mut VortexSettings) {
    s.shift = 3.0;
}

fn variants() -> Vec<Composition<VortexSettings>> {
    vec![
        variant::<Quintic<Pairs, Continuity>>(
            "plain",
            "quintic spline, h/dx 1, leapfrog, no stabiliser",
            |_| {},
        ),
        variant::<Quintic<Pairs, (Continuity, Shifting)>>(
            "shifting",
            "plain with particle shifting",
            |_| {},
        ),
        variant::<Quintic<Pairs, Stabilised>>(
            "modern",
            "plain with density diffusion and shifting, as in the channels",
            |_| {},
        ),
        variant::<Quintic<Pairs, Stabilised>>("strong", "modern with stronger shifting", strong),
        variant::<Quintic<Carried, Stabilised>>(
            "carried",
            "strong, and a shifted particle takes the velocity of its new place",
            strong,
        ),
        variant::<Quintic<Consistent, ConsistentDrift>>(
            "consistent",
            "carried, with pressure, viscosity and continuity that are exact for linear fields",
            strong,
        ),
    ]
}

const NAME: &str = "taylor_green";

/// The settings of a variant with `key=value` texts applied.
pub fn settings(variant: &str, set: &[String]) -> Result<VortexSettings, RunError> {
    CASE.settings_of(variant, set)
}

static CASE: Composed<VortexSettings> = Composed {
    name: NAME,
    about: "A periodic array of vortices decays by viscosity without changing its shape: an exact solution \
            of the incompressible equations. Particles go round with the flow and are stretched at its \
            stagnation points, so that whatever order the start had is soon lost: the test of what a method \
            does with disorder. Started from a square lattice and from one that is disturbed.",
    variants,
    is_stable: |record| record.status == Status::Completed,
    declaration: declaration::declaration,
    plan: plan::plan,
    studies: studies::studies,
};

/// Taylor-Green vortices.
pub const TAYLOR_GREEN: &dyn Case = &CASE;
