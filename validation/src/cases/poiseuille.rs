//! Case 2, start-up Poiseuille flow (the paper's figure 2).

use solver::BodyForce;

use super::channel::{self, ChannelCase, Flow, variants};
use crate::{
    case::{Planned, Tier},
    suite::{JudgedRun, Study},
};

/// Start-up Poiseuille flow.
pub const POISEUILLE: ChannelCase = ChannelCase {
    name: "poiseuille",
    about: "Water at rest between two infinite plates L = 1 mm apart. At t = 0 a body force \
            F = 8 nu V/L^2 along the plates sets in; V = Re nu/L is the centre-line velocity of the \
            steady parabola. The exact velocity is a Fourier series; pressure and cross-flow are \
            exactly zero.",
    flow: Flow::Poiseuille,
    variants: variants::<BodyForce>,
    plan,
    studies,
};

fn plan(tier: Tier) -> Vec<Planned> {
    channel::plan::plan(Flow::Poiseuille, tier)
}

fn studies(tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
    channel::studies(&POISEUILLE, Flow::Poiseuille, tier, runs)
}
