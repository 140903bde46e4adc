//! The variants of the channel flows: one line of types each, and the settings that go with them.

use solver::{
    ArtificialStress, ArtificialViscosity, BodyForce, Compose, Continuity, CubicSpline,
    DensityDiffusion, ExtrapolatingWall, Ghosts, InterfaceWall, Leapfrog, NoSlip,
    PredictorCorrector, Pressure, QuinticSpline, Shifting, Tait, Term, Viscosity, WendlandC2, Xsph,
};

use super::{
    ChannelSettings, Flow, Ingredient,
    ingredients::OPTIONAL,
    run::{ChannelScheme, rules, run, uses},
};
use harness::{
    case::Variant,
    composed::{Composition, lacking},
};
use maths::theory::Stepping;

/// What drives a channel flow: a plate, or a body force.
pub trait Drive: Ingredient {
    /// The flow.
    const FLOW: Flow;
}

impl Drive for () {
    const FLOW: Flow = Flow::Couette;
}

impl Drive for BodyForce {
    const FLOW: Flow = Flow::Poiseuille;
}

/// Forces of a channel flow: pressure, viscosity, and the driving force `B`, `()` for Couette flow.
type Fluid<B, R = ()> = (Pressure<Tait, R>, Viscosity, B);
/// The same with artificial viscosity.
type Damped<B> = (Pressure<Tait>, Viscosity, B, ArtificialViscosity<Tait>);
/// What stabilises the modern variants.
type Stabilised = (Continuity, DensityDiffusion, Shifting);

// A channel flow stores x, v and ρ, shows its neighbours one number, p/ρ², and nothing else.
const _: () = assert!(size_of::<<Fluid<()> as Term<()>>::Derived>() == 8);
const _: () = assert!(size_of::<<Stabilised as Term<()>>::Derived>() == 0);

/// A variant of the flow driven by `B`: the scheme `S`.
fn variant<B, S>(
    name: &'static str,
    about: &'static str,
    adjust: fn(&mut ChannelSettings),
) -> Composition<ChannelSettings>
where
    B: Drive,
    S: ChannelScheme<Integrator: Stepping>,
{
    let lacks = lacking(OPTIONAL, &uses::<S>());
    let (run, rules) = (run::<B, S>, rules::<B, S>);
    Composition { variant: Variant { name, about }, adjust, run, rules, lacks }
}

/// Quintic spline, h = dx, η² a mere guard, long steps, c0 up to where sound costs no step.
fn modern(s: &mut ChannelSettings) {
    (s.h_over_dx, s.eta2_over_h2) = (1.0, 1e-6);
    (s.courant, s.viscous, s.c0_viscous) = (1.0, 0.4, 2.2);
}

type Seed<F, D, W = Ghosts> = Compose<CubicSpline, F, D, W, PredictorCorrector>;
type Modern<F, D, W = Ghosts> = Compose<QuinticSpline, F, D, W, Leapfrog>;

/// All variants of a channel flow driven by `B`.
pub fn variants<B: Drive>() -> Vec<Composition<ChannelSettings>> {
    let mut all = methods::<B>();
    all.extend(moderns::<B>());
    all.extend(cures::<B>());
    all
}

/// The seed's method, and what changing its parts one by one leads to.
fn methods<B: Drive>() -> Vec<Composition<ChannelSettings>> {
    vec![
        variant::<B, Seed<Fluid<B>, Continuity>>(
            "seed",
            "as in the paper: cubic spline, h/dx 1.2, eta^2 = 0.01 h^2, ghosts, predictor-corrector",
            |_| {},
        ),
        variant::<B, Seed<Fluid<B>, Continuity, InterfaceWall>>(
            "interface-wall",
            "seed with interface and wall particles (4.2) for ghosts",
            |_| {},
        ),
        variant::<B, Seed<Fluid<B>, Continuity>>(
            "seed-small-eta",
            "seed with eta^2 = 1e-6 h^2",
            |s| s.eta2_over_h2 = 1e-6,
        ),
        variant::<B, Compose<CubicSpline, Fluid<B>, Continuity, Ghosts, Leapfrog>>(
            "cubic-leapfrog",
            "cubic spline, h/dx 1.5, small eta, leapfrog with long steps",
            |s| {
                modern(s);
                s.h_over_dx = 1.5;
                s.viscous = 0.27;
            },
        ),
        variant::<B, Compose<WendlandC2, Fluid<B>, Continuity, Ghosts, Leapfrog>>(
            "wendland-leapfrog",
            "Wendland C2, h/dx 2, small eta, leapfrog with long steps",
            |s| {
                modern(s);
                s.h_over_dx = 2.0;
                s.viscous = 0.23;
            },
        ),
        variant::<B, Compose<QuinticSpline, Fluid<B>, Continuity, Ghosts, PredictorCorrector>>(
            "quintic-pc",
            "quintic spline, h/dx 1, small eta, predictor-corrector, c0 as low as the seed's",
            |s| {
                modern(s);
                s.courant = 0.25;
                s.c0_viscous = 0.0;
            },
        ),
    ]
}

/// Quintic spline and leapfrog, from bare to stabilised.
fn moderns<B: Drive>() -> Vec<Composition<ChannelSettings>> {
    vec![
        variant::<B, Modern<Fluid<B>, Continuity>>(
            "plain",
            "quintic spline, h/dx 1, small eta, leapfrog: the modern variant without stabilisers",
            modern,
        ),
        variant::<B, Modern<Fluid<B>, Continuity>>(
            "curved",
            "plain with ghosts that know the curvature of the velocity at the wall",
            |s| {
                modern(s);
                s.wall_curvature = true;
            },
        ),
        variant::<B, Modern<Fluid<B>, Continuity, ExtrapolatingWall<Tait, NoSlip>>>(
            "extrapolating-wall",
            "plain with wall particles that extrapolate velocity and pressure (Adami, Hu & Adams 2012)",
            modern,
        ),
        variant::<B, Modern<Fluid<B>, Stabilised>>(
            "modern",
            "curved with density diffusion and shifting: one rule for every Reynolds number",
            |s| {
                modern(s);
                s.wall_curvature = true;
            },
        ),
        variant::<B, Modern<Fluid<B>, Stabilised>>(
            "modern-mirror",
            "modern with plainly mirroring ghosts",
            modern,
        ),
    ]
}

/// The seed's method with one thing against its instability.
fn cures<B: Drive>() -> Vec<Composition<ChannelSettings>> {
    vec![
        variant::<B, Seed<Fluid<B>, Continuity>>(
            "cure-background",
            "seed with a background pressure of 0.05 rho c0^2",
            |s| s.background = 0.05,
        ),
        variant::<B, Seed<Fluid<B, ArtificialStress>, Continuity>>(
            "cure-stress",
            "seed with artificial stress (18)(19)",
            |_| {},
        ),
        variant::<B, Seed<Damped<B>, Continuity>>(
            "cure-viscosity",
            "seed with artificial viscosity (16)(17), alpha 0.1",
            |_| {},
        ),
        variant::<B, Seed<Fluid<B>, (Continuity, Xsph)>>(
            "cure-xsph",
            "seed with XSPH (22), epsilon 0.5",
            |_| {},
        ),
        variant::<B, Seed<Fluid<B>, (Continuity, DensityDiffusion)>>(
            "cure-diffusion",
            "seed with density diffusion 0.1",
            |_| {},
        ),
        variant::<B, Seed<Fluid<B>, (Continuity, Shifting)>>(
            "cure-shifting",
            "seed with particle shifting 0.5",
            |_| {},
        ),
        variant::<B, Seed<Fluid<B>, Stabilised>>(
            "cure-both",
            "seed with density diffusion and shifting",
            |_| {},
        ),
        variant::<B, Compose<CubicSpline, Fluid<B>, Continuity, Ghosts, Leapfrog>>(
            "cure-leapfrog",
            "seed with the staggered leapfrog",
            |_| {},
        ),
    ]
}
