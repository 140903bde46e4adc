//! Case 1, start-up Couette flow (the paper's figure 1).

use super::channel::{self, ChannelCase, Flow, variants};
use crate::{
    case::{Planned, Tier},
    suite::{JudgedRun, Study},
};

/// Start-up Couette flow.
pub const COUETTE: ChannelCase = ChannelCase {
    name: "couette",
    about: "Water at rest between two infinite plates L = 1 mm apart. At t = 0 the upper plate \
            starts at constant speed V = Re nu/L, Re = 0.5. The exact velocity is a Fourier series; \
            pressure and cross-flow are exactly zero.",
    flow: Flow::Couette,
    variants: variants::<()>,
    plan,
    studies,
};

fn plan(tier: Tier) -> Vec<Planned> {
    channel::plan::plan(Flow::Couette, tier)
}

fn studies(tier: Tier, runs: &[JudgedRun]) -> Vec<Study> {
    channel::studies(&COUETTE, Flow::Couette, tier, runs)
}
