//! Laminar flow over periodic hills, driven to a given flux: curved walls, separation, recirculation.
//! Lengths by the height H = 1 m of the hill, velocities by the bulk velocity over the crest U_b = 1 m/s,
//! ρ = 1 kg/m³.
//!
//! Judged against finite elements (`references/periodic_hill`), because no published numbers exist for this
//! flow.

mod columns;
mod measure;
mod plan;
mod reference;
mod run;
mod studies;

use touchstone_harness::prelude::*;
use touchstone_schemes::hill;

use crate::fluids::unit_flow::Numerics;

pub use run::HillSetup;

touchstone_base::settings! {
    /// Settings of the flow over hills. H = U_b = ρ = 1.
    pub struct HillSettings {
        /// Reynolds number U_b H/ν
        re: f64 ["-"] in 1e-3..=1e3 = 50.0,
        /// spacings along the height of the hill
        n: usize ["-"] in 4..=400 = 10,
        /// height of the crest; 0 is a flat channel
        crest: f64 ["H"] in 0.0..=1.5 = 1.0,
        /// flux over the flux of the reference
        flux: f64 ["2.035 U_b H"] in 0.0..=10.0 = 1.0,
        /// start from an interpolation of the reference instead of from rest
        from_reference: bool = false,
        /// body force at the start
        force: f64 ["U_b^2/H"] in -1e3..=1e3 = 0.0,
        /// time constant of the flux controller; 0 keeps the force constant
        response: f64 ["H/U_b"] in 0.0..=1e3 = 1.0,
        /// end of the run
        end: f64 ["H/U_b"] in 1e-3..=1e4 = 30.0,
        /// final share of the run over which profiles are averaged
        average: f64 ["of the run"] in 0.01..=0.3 = 0.2,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.9..=3.0 = 1.0,
        /// sound speed; the largest speed of the flow is 1.6 U_b at most
        c0: f64 ["U_b"] in 2.0..=1e4 = 15.0,
        /// numerical settings
        numerics: Numerics = Numerics::default(),
    }
}

/// The amplitude of the vortices' `strong`, for the same reason.
fn strong(s: &mut HillSettings) {
    s.numerics.shift = 3.0;
}

fn variants() -> Compositions<HillSettings> {
    let plain =
        "quintic spline, h/dx 1, leapfrog, extrapolating walls, no stabiliser: is one needed?";
    let interface =
        "modern with the paper's interface and wall particles (section 4.2): how good are they?";
    let modern = "plain with density diffusion and shifting: do the stabilisers of the channels suit curved \
                  walls?";
    let carried = "modern with stronger shifting, in which particles take the velocity of their new place, \
                   and walls that include the curvature of the velocity";
    let consistent = "carried with sums that are exact for linear fields: are they worth the extra work per \
                      pair?";
    Variants::of(HillSetup::new)
        .with("plain", plain, hill::plain(), |_| {})
        .with("interface-wall", interface, hill::interface_wall(), |_| {})
        .with("modern", modern, hill::modern(), |_| {})
        .with(RECOMMENDED, carried, hill::carried(), strong)
        .with("consistent", consistent, hill::consistent(), strong)
        .all
}

const NAME: &str = "periodic_hill";

/// The variant that is held to the goals.
const RECOMMENDED: &str = "carried";

/// Flow over periodic hills.
pub static CASE: Composed<HillSettings> = Composed {
    name: NAME,
    problem: "Flow over a row of hills, with separation",
    recommended: Recommended {
        variant: RECOMMENDED,
        because: "with ten spacings a hill at Re 50 its velocity error is 1.1 %<!-- periodic_hill.carried; \
                  n=10 end=30; l2_u --> of the mean and its force error 0.4 %<!-- periodic_hill.carried; \
                  n=10 end=30; force_error -->, without sums that cost more for each pair",
        papers: Some("interface-wall"),
    },
    about: "A body force keeps a given flux through a channel with hills on its floor, one every nine \
            heights. From Re 50 on the flow leaves the wall behind the crest and comes back to it in the \
            trough, or on the next hill. It is steady and laminar. The reference is a finite-element \
            computation of this project, because none is published.",
    variants,
    facts: studies::facts,
    studies: studies::studies,
};
