//! Case 1, start-up Couette flow (the paper's figure 1).

use harness::composed::Best;

use super::channel::{self, Channel, ChannelCase, Flow, variants};

/// Start-up Couette flow.
pub static COUETTE: ChannelCase = ChannelCase {
    name: "couette",
    problem: "Water between two plates, one of which starts to move",
    best: Best {
        variant: "modern",
        because: "with 20 rows its velocity is wrong by 0.05 %, the paper's by 0.8 %, and it holds up \
                  to Re 50",
        papers: Some("seed"),
    },
    about: "Water rests between two infinite plates, L = 1 mm apart, until the upper one starts at t = 0 \
            with constant speed V = Re nu/L, Re = 0.5. The exact velocity is a Fourier series in y, and \
            pressure and cross-flow are exactly zero.",
    variants: || variants::of_couette(&channel::COUETTE),
    is_stable: channel::is_stable,
    declaration: |tier| channel::declaration(CHANNEL, tier),
    plan: |tier| channel::plan(CHANNEL, tier),
    studies: |tier, runs| channel::studies(CHANNEL, tier, runs),
};

const CHANNEL: Channel = Channel { flow: Flow::Couette, case: &COUETTE };
