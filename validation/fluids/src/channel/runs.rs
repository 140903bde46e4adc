//! What the runs of a channel flow are for.

use super::ChannelSettings;
use harness::table::Table;

/// What a run is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum For {
    /// Error over spacing and cost at Re 0.5.
    Ladder,
    /// The same with fewer rows than orders are fitted to: what the cheapest settings cost.
    Coarse,
    /// Error over cost at the Reynolds number of other codes.
    Peers,
    /// Walls that extrapolate.
    Walls,
    /// One rule for every Reynolds number.
    Reynolds,
    /// Steps that viscosity does not limit.
    Stiff,
    /// Smoothing lengths that are too short and too long.
    Smoothing,
    /// H3: waves between the walls.
    Waves,
    /// H4 and H5: outcomes over Reynolds number and sound speed.
    Map,
    /// What cures the instability.
    Cures,
}

/// The runs of a flow.
pub type ChannelTable = Table<ChannelSettings, For>;
