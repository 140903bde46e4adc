//! Case 1, start-up Couette flow (the paper's figure 1).

use super::channel::{self, ChannelSettings, Flow, variants};
use harness::composed::Composed;

/// Start-up Couette flow.
pub const COUETTE: Composed<ChannelSettings> = Composed {
    name: "couette",
    about: "Water at rest between two infinite plates L = 1 mm apart. At t = 0 the upper plate \
            starts at constant speed V = Re nu/L, Re = 0.5. The exact velocity is a Fourier series; \
            pressure and cross-flow are exactly zero.",
    variants: variants::<()>,
    plan: |tier| channel::plan::plan(Flow::Couette, tier),
    studies: |tier, runs| channel::studies(&COUETTE, Flow::Couette, tier, runs),
};
