//! The variants of the channel flows: methods, and the settings that go with them.

use harness::{
    composed::{Composition, Variants},
    method::Method,
};
use schemes::flow::{self, OfChannels};

use super::{
    ChannelProgram, ChannelSettings,
    run::{COUETTE, POISEUILLE},
};

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

type All<'a> = Variants<'a, ChannelSettings, Method>;

/// The variants of Couette flow.
pub fn of_couette() -> Vec<Composition<ChannelSettings>> {
    both(&COUETTE, OfChannels::couette()).all
}

/// Those of Poiseuille flow, whose profile is curved, and in which the seed is unstable.
pub fn of_poiseuille() -> Vec<Composition<ChannelSettings>> {
    let both = both(&POISEUILLE, OfChannels::poiseuille()).with(
        "curved",
        "plain with ghosts that know the curvature of the velocity at the wall: is it their error?",
        flow::poiseuille(),
        curved,
    );
    cures(both).all
}

fn both(program: &ChannelProgram, methods: OfChannels) -> All<'_> {
    Variants::of(program)
        .with(
            "seed",
            "as in the paper: cubic spline, h/dx 1.2, eta^2 = 0.01 h^2, ghosts, predictor-corrector",
            methods.seed,
            |_| {},
        )
        .with(
            "interface-wall",
            "seed with interface and wall particles (section 4.2 of the paper): as good as ghosts?",
            methods.interface_wall,
            |_| {},
        )
        .with(
            "wendland-leapfrog",
            "Wendland C2, h/dx 2, small eta, leapfrog: is the error of another kernel cheaper?",
            methods.wendland,
            |s| {
                modern(s);
                (s.h_over_dx, s.viscous) = (2.0, 0.23);
            },
        )
        .with(
            "plain",
            "quintic spline, h/dx 1, small eta, leapfrog: what is the error without stabilisers?",
            methods.plain,
            modern,
        )
        .with(
            "extrapolating-wall",
            "plain with walls that extrapolate (Adami, Hu & Adams 2012): are they better than ghosts?",
            methods.extrapolating,
            modern,
        )
        .with(
            "modern",
            "plain, curved ghosts, density diffusion and shifting: one rule for every Reynolds number?",
            methods.modern,
            curved,
        )
        .with(
            "single-sweep",
            "modern with one pair sweep a step in place of two: is its error cheaper?",
            methods.single_sweep,
            single_sweep,
        )
        .with(
            "stiff",
            "modern with super-time-stepping: what does a step save that viscosity does not limit?",
            methods.stiff,
            stiff,
        )
}

/// The seed's method with one thing against its instability: does it cure it?
fn cures(all: All) -> All {
    all.with(
        "cure-stress",
        "seed with artificial stress, equations (18) and (19): does it cure the seed's instability?",
        flow::cure_stress(),
        |_| {},
    )
    .with(
        "cure-viscosity",
        "seed with artificial viscosity, equations (16) and (17): does it cure the seed's instability?",
        flow::cure_viscosity(),
        |_| {},
    )
    .with(
        "cure-xsph",
        "seed with XSPH, equation (22), epsilon 0.5: does it cure the seed's instability?",
        flow::cure_xsph(),
        |_| {},
    )
    .with(
        "cure-shifting",
        "seed with particle shifting 0.5: does it cure the seed's instability?",
        flow::cure_shifting(),
        |_| {},
    )
}
