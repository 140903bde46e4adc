//! The variants of the channel flows: one line of types each, and the settings that go with them.

use harness::{
    composed::{Composition, Variants},
    method::{FromMedium, Method},
};
use solver::*;

use super::{
    ChannelProgram, ChannelSettings,
    run::{COUETTE, POISEUILLE},
};

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

/// The same with ghosts that know the curvature of the velocity at the wall.
fn curved(s: &mut ChannelSettings) {
    modern(s);
    s.wall_curvature = true;
}

/// Super-time-stepping: c0 by Morris' rule alone, and the share of the theoretical limit that the steps of
/// `modern` are of theirs. A flow that starts at rest changes over a time in proportion to its age, so that
/// accuracy needs a number of steps to each time of comparison: with 8 the error of time at νt/L² = 0.1 is a
/// tenth of the goal of 0.1 % (`theory::super_steps`).
fn stiff(s: &mut ChannelSettings) {
    curved(s);
    (s.c0_viscous, s.limit_share, s.least_steps) = (0.0, Some(0.75), 8);
}

/// One pair sweep a step, in the same share of its limit: sound has 1/8^(1/2) of that of the leapfrog, so
/// that c0 is lower by as much where sound costs no step.
fn single_sweep(s: &mut ChannelSettings) {
    curved(s);
    (s.courant, s.c0_viscous) = (s.courant / 8_f64.sqrt(), s.c0_viscous / 8_f64.sqrt());
}

/// The paper's: cubic spline and predictor-corrector.
pub type Seed<F, D, W = Ghosts> = Compose<CubicSpline, F, D, W, PredictorCorrector>;
/// Quintic spline, leapfrog and super-time-stepping of viscosity.
pub type Stiff<B> = Compose<QuinticSpline, StiffFluid<B>, Stabilised, Ghosts, Leapfrog<SuperSteps>>;
/// Quintic spline and, as a rule, leapfrog.
pub type Modern<F, D, W = Ghosts, I = Leapfrog> = Compose<QuinticSpline, F, D, W, I>;

type All<'a> = Variants<'a, ChannelSettings, Method>;

/// The variants of Couette flow.
pub fn of_couette() -> Vec<Composition<ChannelSettings>> {
    both::<()>(&COUETTE).all
}

/// Those of Poiseuille flow, whose profile is curved, and in which the seed is unstable.
pub fn of_poiseuille() -> Vec<Composition<ChannelSettings>> {
    let both = both::<BodyForce>(&POISEUILLE).with(
        "curved",
        "plain with ghosts that know the curvature of the velocity at the wall: is it their error?",
        Method::of::<Modern<Fluid<BodyForce>, Continuity>>(),
        curved,
    );
    cures(both).all
}

fn both<B: Drive>(program: &ChannelProgram) -> All<'_> {
    Variants::of(program)
        .with(
            "seed",
            "as in the paper: cubic spline, h/dx 1.2, eta^2 = 0.01 h^2, ghosts, predictor-corrector",
            Method::of::<Seed<Fluid<B>, Continuity>>(),
            |_| {},
        )
        .with(
            "interface-wall",
            "seed with interface and wall particles (section 4.2 of the paper): as good as ghosts?",
            Method::of::<Seed<Fluid<B>, Continuity, InterfaceWall>>(),
            |_| {},
        )
        .with(
            "wendland-leapfrog",
            "Wendland C2, h/dx 2, small eta, leapfrog: is the error of another kernel cheaper?",
            Method::of::<Compose<WendlandC2, Fluid<B>, Continuity, Ghosts, Leapfrog>>(),
            |s| {
                modern(s);
                (s.h_over_dx, s.viscous) = (2.0, 0.23);
            },
        )
        .with(
            "plain",
            "quintic spline, h/dx 1, small eta, leapfrog: what is the error without stabilisers?",
            Method::of::<Modern<Fluid<B>, Continuity>>(),
            modern,
        )
        .with(
            "extrapolating-wall",
            "plain with walls that extrapolate (Adami, Hu & Adams 2012): are they better than ghosts?",
            Method::of::<Modern<Fluid<B>, Continuity, ExtrapolatingWall<Tait, NoSlip>>>(),
            modern,
        )
        .with(
            "modern",
            "plain, curved ghosts, density diffusion and shifting: one rule for every Reynolds number?",
            Method::of::<Modern<Fluid<B>, Stabilised>>(),
            curved,
        )
        .with(
            "single-sweep",
            "modern with one pair sweep a step in place of two: is its error cheaper?",
            Method::of::<Modern<Fluid<B>, Stabilised, Ghosts, SingleSweep>>(),
            single_sweep,
        )
        .with(
            "stiff",
            "modern with super-time-stepping: what does a step save that viscosity does not limit?",
            Method::of::<Stiff<B>>(),
            stiff,
        )
}

/// The seed's method with one thing against its instability: does it cure it?
fn cures(all: All) -> All {
    all.with(
        "cure-stress",
        "seed with artificial stress, equations (18) and (19): does it cure the seed's instability?",
        Method::of::<Seed<Fluid<BodyForce, ArtificialStress>, Continuity>>(),
        |_| {},
    )
    .with(
        "cure-viscosity",
        "seed with artificial viscosity, equations (16) and (17): does it cure the seed's instability?",
        Method::of::<Seed<Damped, Continuity>>(),
        |_| {},
    )
    .with(
        "cure-xsph",
        "seed with XSPH, equation (22), epsilon 0.5: does it cure the seed's instability?",
        Method::of::<Seed<Fluid<BodyForce>, (Continuity, Xsph)>>(),
        |_| {},
    )
    .with(
        "cure-shifting",
        "seed with particle shifting 0.5: does it cure the seed's instability?",
        Method::of::<Seed<Fluid<BodyForce>, (Continuity, Shifting)>>(),
        |_| {},
    )
}
