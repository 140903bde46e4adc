//! Flow between two parallel plates from rest: Couette and Poiseuille flow, which have settings, the rules
//! that turn them into a scene, variants and measurements in common.

mod maps;
mod measure;
mod plan;
mod setup;
mod stiff;
mod studies;
pub mod variants;
mod waves;

use touchstone_harness::{
    composed::{Composed, Recommended},
    table::Table,
};

use studies::{facts, studies};

pub use measure::velocities;
pub use plan::{CONSISTENT, GHOSTS, ladder};
pub use setup::{ChannelSettings, ChannelSetup, Flow};

/// νt/L² at which profiles are compared.
pub const TIMES: [f64; 7] = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 1.5];

/// A case of a channel flow.
pub type ChannelCase = Composed<ChannelSettings>;

/// Purpose of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Error over spacing and cost at Re 0.5.
    Ladder,
    /// One rule for every Reynolds number.
    Reynolds,
    /// Steps that viscosity does not limit.
    Stiff,
    /// H3: waves between the walls.
    Waves,
    /// H4 and H5: outcomes over Reynolds number and sound speed.
    Map,
    /// Remedies of the instability.
    Cures,
}

/// The runs of a flow.
pub type ChannelTable = Table<ChannelSettings, Group>;
/// One of them.
pub type Row = touchstone_harness::table::Row<ChannelSettings, Group>;

/// Case 1, start-up Couette flow (the paper's figure 1).
pub static COUETTE: ChannelCase = ChannelCase {
    name: "couette",
    problem: "Water between two plates, one of which starts to move",
    recommended: Recommended {
        variant: "consistent",
        because: "its velocity error falls with the second order at every time; with 20 rows it is \
                  0.041 %<!-- couette.consistent; rows=20; l2_worst -->, of `modern`, which stops \
                  converging, 0.062 %<!-- couette.modern; rows=20; l2_worst -->, the paper's \
                  0.78 %<!-- couette.seed; rows=20; l2_worst -->",
        papers: Some("seed"),
    },
    about: "Water rests between two infinite plates, L = 1 mm apart, until the upper one starts at t = 0 \
            with constant speed V = Re nu/L, Re = 0.5. The exact velocity is a Fourier series in y, and \
            pressure and cross-flow are exactly zero.",
    variants: variants::of_couette,
    facts,
    studies: |tier| studies(Flow::Couette, tier),
};

/// Case 2, start-up Poiseuille flow (the paper's figure 2).
pub static POISEUILLE: ChannelCase = ChannelCase {
    name: "poiseuille",
    problem: "Water between two plates, driven by a body force",
    recommended: Recommended {
        variant: "consistent",
        because: "its velocity error falls with the spacing and stays below 1 %<!-- gate \
                  poiseuille.consistent.re20.l2_worst --> at every Reynolds number; with 20 rows it is 0.11 \
                  %<!-- poiseuille.consistent; rows=20; l2_worst -->, the paper's 1.4 %<!-- poiseuille.seed; \
                  rows=20; l2_worst -->. `curved` has 0.081 %<!-- poiseuille.curved; rows=20; l2_worst -->, \
                  where two errors cancel, and does not converge",
        papers: Some("seed"),
    },
    about: "Water rests between two infinite plates, L = 1 mm apart. At t = 0 a body force F = 8 nu V/L^2 \
            along the plates sets in; V = Re nu/L is the centre-line velocity of the steady parabola. The \
            exact velocity is a Fourier series; pressure and cross-flow are exactly zero.",
    variants: variants::of_poiseuille,
    facts,
    studies: |tier| studies(Flow::Poiseuille, tier),
};
