//! Case 2, start-up Poiseuille flow (the paper's figure 2).

use harness::composed::Composed;
use solver::BodyForce;

use super::channel::{self, ChannelSettings, Flow, variants};

/// Start-up Poiseuille flow.
pub const POISEUILLE: Composed<ChannelSettings> = Composed {
    name: "poiseuille",
    about: "Water at rest between two infinite plates L = 1 mm apart. At t = 0 a body force \
            F = 8 nu V/L^2 along the plates sets in; V = Re nu/L is the centre-line velocity of the \
            steady parabola. The exact velocity is a Fourier series; pressure and cross-flow are \
            exactly zero.",
    variants: variants::<BodyForce>,
    plan: |tier| channel::plan::plan(Flow::Poiseuille, tier),
    studies: |tier, runs| channel::studies(&POISEUILLE, Flow::Poiseuille, tier, runs),
};
