//! The variants of the channel flows: one line of types each, and the settings that go with them.

use harness::{
    composed::{Composition, Variants},
    method::{FromMedium, Method},
};
use solver::{
    ArtificialStress, ArtificialViscosity, BodyForce, Compose, Continuity, CubicSpline,
    DensityDiffusion, ExtrapolatingWall, Ghosts, InterfaceWall, Leapfrog, NoSlip,
    PredictorCorrector, Pressure, QuinticSpline, Shifting, Split, SuperSteps, Tait, Term,
    Viscosity, WendlandC2, Xsph,
};

use super::{ChannelProgram, ChannelSettings};

/// Forces of a channel flow: pressure, viscosity, and the driving force `B`, `()` for Couette flow.
pub type Fluid<B, R = ()> = (Pressure<Tait, R>, Viscosity, B);
/// The same with artificial viscosity.
type Damped = (Pressure<Tait>, Viscosity, BodyForce, ArtificialViscosity<Tait>);
/// The same with viscosity by super-time-stepping.
pub type StiffFluid<B> = Split<(Pressure<Tait>, B), Viscosity>;
/// What stabilises the modern variants.
pub type Stabilised = (Continuity, DensityDiffusion, Shifting);

// A channel flow stores x, v and ρ, shows its neighbours one number, p/ρ², and nothing else.
const _: () = assert!(size_of::<<Fluid<()> as Term<()>>::Derived>() == 8);
const _: () = assert!(size_of::<<Stabilised as Term<()>>::Derived>() == 0);

/// What drives a channel flow: a plate, `()`, or a [`solver::BodyForce`].
pub trait Drive: FromMedium + Term<()> {}
impl<B: FromMedium + Term<()>> Drive for B {}

/// Quintic spline, h = dx, η² a mere guard, long steps, c0 up to where sound costs no step.
fn modern(s: &mut ChannelSettings) {
    (s.h_over_dx, s.eta2_over_h2) = (1.0, 1e-6);
    (s.courant, s.viscous, s.c0_viscous) = (1.0, 0.4, 2.2);
}

/// Super-time-stepping: c0 by Morris' rule alone, and the share of the theoretical limit that the steps of
/// `modern` are of theirs. A flow that starts at rest changes over a time in proportion to its age, so that
/// accuracy needs a number of steps to each time of comparison: with 8 the error of time at νt/L² = 0.1 is a
/// tenth of the goal of 0.1 % (`theory::super_steps`).
fn stiff(s: &mut ChannelSettings) {
    modern(s);
    (s.c0_viscous, s.limit_share, s.least_steps) = (0.0, Some(0.75), 8);
    s.wall_curvature = true;
}

/// The paper's: cubic spline and predictor-corrector.
pub type Seed<F, D, W = Ghosts> = Compose<CubicSpline, F, D, W, PredictorCorrector>;
/// Quintic spline, leapfrog and super-time-stepping of viscosity.
pub type Stiff<B> = Compose<QuinticSpline, StiffFluid<B>, Stabilised, Ghosts, Leapfrog<SuperSteps>>;
/// Quintic spline and leapfrog.
pub type Modern<F, D, W = Ghosts> = Compose<QuinticSpline, F, D, W, Leapfrog>;

type All<'a> = Variants<'a, ChannelSettings, Method>;

/// The variants of Couette flow.
pub fn of_couette(program: &ChannelProgram) -> Vec<Composition<ChannelSettings>> {
    both::<()>(program).all
}

/// Those of Poiseuille flow, in which the seed is unstable.
pub fn of_poiseuille(program: &ChannelProgram) -> Vec<Composition<ChannelSettings>> {
    cures(both::<BodyForce>(program)).all
}

fn both<B: Drive>(program: &ChannelProgram) -> All<'_> {
    moderns::<B>(methods::<B>(Variants::of(program)))
}

/// The seed's method, and what changing its parts one by one leads to.
fn methods<B: Drive>(all: All) -> All {
    all.with(
        "seed",
        "as in the paper: cubic spline, h/dx 1.2, eta^2 = 0.01 h^2, ghosts, predictor-corrector",
        Method::of::<Seed<Fluid<B>, Continuity>>(),
        |_| {},
    )
    .with(
        "interface-wall",
        "seed with interface and wall particles (section 4.2 of the paper) in place of ghosts",
        Method::of::<Seed<Fluid<B>, Continuity, InterfaceWall>>(),
        |_| {},
    )
    .with(
        "seed-small-eta",
        "seed with eta^2 = 1e-6 h^2",
        Method::of::<Seed<Fluid<B>, Continuity>>(),
        |s| s.eta2_over_h2 = 1e-6,
    )
    .with(
        "cubic-leapfrog",
        "cubic spline, h/dx 1.5, small eta, leapfrog with long steps",
        Method::of::<Compose<CubicSpline, Fluid<B>, Continuity, Ghosts, Leapfrog>>(),
        |s| {
            modern(s);
            s.h_over_dx = 1.5;
            s.viscous = 0.27;
        },
    )
    .with(
        "wendland-leapfrog",
        "Wendland C2, h/dx 2, small eta, leapfrog with long steps",
        Method::of::<Compose<WendlandC2, Fluid<B>, Continuity, Ghosts, Leapfrog>>(),
        |s| {
            modern(s);
            s.h_over_dx = 2.0;
            s.viscous = 0.23;
        },
    )
    .with(
        "quintic-pc",
        "quintic spline, h/dx 1, small eta, predictor-corrector, c0 as low as the seed's",
        Method::of::<Compose<QuinticSpline, Fluid<B>, Continuity, Ghosts, PredictorCorrector>>(),
        |s| {
            modern(s);
            s.courant = 0.25;
            s.c0_viscous = 0.0;
        },
    )
}

/// Quintic spline and leapfrog, from bare to stabilised.
fn moderns<B: Drive>(all: All) -> All {
    all.with(
        "plain",
        "quintic spline, h/dx 1, small eta, leapfrog: the modern variant without stabilisers",
        Method::of::<Modern<Fluid<B>, Continuity>>(),
        modern,
    )
    .with(
        "curved",
        "plain with ghosts that know the curvature of the velocity at the wall",
        Method::of::<Modern<Fluid<B>, Continuity>>(),
        |s| {
            modern(s);
            s.wall_curvature = true;
        },
    )
    .with(
        "extrapolating-wall",
        "plain with wall particles that extrapolate velocity and pressure (Adami, Hu & Adams 2012)",
        Method::of::<Modern<Fluid<B>, Continuity, ExtrapolatingWall<Tait, NoSlip>>>(),
        modern,
    )
    .with(
        "modern",
        "curved with density diffusion and shifting: one rule for every Reynolds number",
        Method::of::<Modern<Fluid<B>, Stabilised>>(),
        |s| {
            modern(s);
            s.wall_curvature = true;
        },
    )
    .with(
        "stiff",
        "modern with super-time-stepping of viscosity, which limits neither step nor c0",
        Method::of::<Stiff<B>>(),
        stiff,
    )
    .with(
        "modern-mirror",
        "modern with ghosts that do not know the curvature",
        Method::of::<Modern<Fluid<B>, Stabilised>>(),
        modern,
    )
}

/// The seed's method with one thing against its instability.
fn cures(all: All) -> All {
    all.with(
        "cure-background",
        "seed with a background pressure of 0.05 rho c0^2",
        Method::of::<Seed<Fluid<BodyForce>, Continuity>>(),
        |s| s.background = 0.05,
    )
    .with(
        "cure-stress",
        "seed with artificial stress, equations (18) and (19)",
        Method::of::<Seed<Fluid<BodyForce, ArtificialStress>, Continuity>>(),
        |_| {},
    )
    .with(
        "cure-viscosity",
        "seed with artificial viscosity, equations (16) and (17), alpha 0.1",
        Method::of::<Seed<Damped, Continuity>>(),
        |_| {},
    )
    .with(
        "cure-xsph",
        "seed with XSPH, equation (22), epsilon 0.5",
        Method::of::<Seed<Fluid<BodyForce>, (Continuity, Xsph)>>(),
        |_| {},
    )
    .with(
        "cure-diffusion",
        "seed with density diffusion 0.1",
        Method::of::<Seed<Fluid<BodyForce>, (Continuity, DensityDiffusion)>>(),
        |_| {},
    )
    .with(
        "cure-shifting",
        "seed with particle shifting 0.5",
        Method::of::<Seed<Fluid<BodyForce>, (Continuity, Shifting)>>(),
        |_| {},
    )
    .with(
        "cure-both",
        "seed with density diffusion and shifting",
        Method::of::<Seed<Fluid<BodyForce>, Stabilised>>(),
        |_| {},
    )
    .with(
        "cure-leapfrog",
        "seed with the staggered leapfrog",
        Method::of::<Compose<CubicSpline, Fluid<BodyForce>, Continuity, Ghosts, Leapfrog>>(),
        |_| {},
    )
}
