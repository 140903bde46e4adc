//! Viscous flows.

pub mod cavity;
pub mod channel;
pub mod manufactured;
pub mod periodic_hill;
pub mod taylor_couette;
pub mod taylor_green;
mod unit_flow;

use harness::case::Case;

/// The cases of the family.
pub const CASES: &[&dyn Case] = &[
    &channel::COUETTE,
    &channel::POISEUILLE,
    periodic_hill::PERIODIC_HILL,
    taylor_green::TAYLOR_GREEN,
    taylor_couette::TAYLOR_COUETTE,
    manufactured::MANUFACTURED,
    cavity::CAVITY,
];
