//! Case 2, start-up Poiseuille flow (the paper's figure 2).

use harness::composed::Best;

use super::channel::{self, Channel, ChannelCase, Flow, variants};

/// Start-up Poiseuille flow.
pub static POISEUILLE: ChannelCase = ChannelCase {
    name: "poiseuille",
    problem: "Water between two plates, driven by a body force",
    best: Best {
        variant: "curved",
        because: "with 20 rows its velocity is wrong by 0.08 %, the paper's by 1.4 %: its ghosts know \
                  the curvature at the wall",
        papers: Some("seed"),
    },
    about: "Water rests between two infinite plates, L = 1 mm apart. At t = 0 a body force F = 8 nu V/L^2 \
            along the plates sets in; V = Re nu/L is the centre-line velocity of the steady parabola. The \
            exact velocity is a Fourier series; pressure and cross-flow are exactly zero.",
    variants: || variants::of_poiseuille(&channel::POISEUILLE),
    is_stable: channel::is_stable,
    declaration: |tier| channel::declaration(CHANNEL, tier),
    plan: |tier| channel::plan(CHANNEL, tier),
    studies: |tier, runs| channel::studies(CHANNEL, tier, runs),
};

const CHANNEL: Channel = Channel { flow: Flow::Poiseuille, case: &POISEUILLE };
