//! The variants of the channel flows: methods, and the settings that go with them.

use touchstone_harness::{
    composed::{Compositions, Variants},
    method::Method,
};
use touchstone_schemes::flow::{self, OfChannels};

use super::{ChannelSettings, ChannelSetup, Flow};

/// Quintic spline, h = dx, η² a mere guard, long steps, c0 up to where sound costs no step.
fn modern(s: &mut ChannelSettings) {
    (s.h_over_dx, s.eta2_over_h2) = (1.0, 1e-6);
    (s.courant, s.viscous, s.c0_viscous) = (1.0, 0.4, 2.2);
}

/// The support of Wendland's kernel and the viscous number for it.
fn wendland(s: &mut ChannelSettings) {
    modern(s);
    (s.h_over_dx, s.viscous) = (2.0, 0.23);
}

/// `modern` with ghosts that include the curvature of the velocity at the wall.
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

/// One pair sweep a step, at the same fraction of its limit: sound has 1/8^(1/2) of the limit of the
/// leapfrog, so that c0 is lower by this factor where sound costs no step.
fn single_sweep(s: &mut ChannelSettings) {
    curved(s);
    (s.courant, s.c0_viscous) = (s.courant / 8_f64.sqrt(), s.c0_viscous / 8_f64.sqrt());
}

/// The variants of Couette flow.
pub fn of_couette() -> Compositions<ChannelSettings> {
    both(Flow::Couette, flow::couette()).all
}

/// Variants of Poiseuille flow, whose profile is curved, and in which the seed is unstable: each adds one
/// remedy to the paper's method.
pub fn of_poiseuille() -> Compositions<ChannelSettings> {
    let bent = "plain with ghosts that include the curvature of the velocity at the wall: is this their \
                error?";
    let stress = "seed with artificial stress, equations (18) and (19): does it cure the seed's instability?";
    let viscosity = "seed with artificial viscosity, equations (16) and (17): does it cure the seed's \
                     instability?";
    let xsph = "seed with XSPH, equation (22), epsilon 0.5: does it cure the seed's instability?";
    let shifting = "seed with particle shifting 0.5: does it cure the seed's instability?";
    both(Flow::Poiseuille, flow::poiseuille())
        .with("curved", bent, flow::poiseuille().plain, curved)
        .with("cure-stress", stress, flow::cure_stress(), |_| {})
        .with("cure-viscosity", viscosity, flow::cure_viscosity(), |_| {})
        .with("cure-xsph", xsph, flow::cure_xsph(), |_| {})
        .with("cure-shifting", shifting, flow::cure_shifting(), |_| {})
        .all
}

fn both(flow: Flow, methods: OfChannels) -> Variants<ChannelSettings, Method> {
    let seed =
        "as in the paper: cubic spline, h/dx 1.2, eta^2 = 0.01 h^2, ghosts, predictor-corrector";
    let interface =
        "seed with interface and wall particles (section 4.2 of the paper): as good as ghosts?";
    let kernel =
        "Wendland C2, h/dx 2, small eta, leapfrog: does another kernel cost less for equal error?";
    let plain =
        "quintic spline, h/dx 1, small eta, leapfrog: what is the error without stabilisers?";
    let extrapolating =
        "plain with walls that extrapolate (Adami, Hu & Adams 2012): are they better than ghosts?";
    let modern_is =
        "plain, curved ghosts, density diffusion and shifting: one rule for every Reynolds number?";
    let single =
        "modern with one pair sweep per step instead of two: does it cost less for equal error?";
    let steps = "modern with super-time-stepping: how much does it save if viscosity does not limit the \
                 step?";
    let consistent =
        "modern with sums that are exact for linear fields: does the error fall at any spacing?";
    Variants::of(move |m, s| ChannelSetup::new(flow, s, m))
        .with("seed", seed, methods.seed, |_| {})
        .with("interface-wall", interface, methods.interface_wall, |_| {})
        .with("wendland-leapfrog", kernel, methods.wendland, wendland)
        .with("plain", plain, methods.plain, modern)
        .with("extrapolating-wall", extrapolating, methods.extrapolating, modern)
        .with("modern", modern_is, methods.modern, curved)
        .with("single-sweep", single, methods.single_sweep, single_sweep)
        .with("stiff", steps, methods.stiff, stiff)
        .with("consistent", consistent, methods.consistent, curved)
}
