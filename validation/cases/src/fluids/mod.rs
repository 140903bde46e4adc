//! Viscous flows.

pub(crate) mod cavity;
pub mod channel;
pub(crate) mod manufactured;
pub(crate) mod periodic_hill;
pub(crate) mod slip_channel;
pub(crate) mod taylor_couette;
pub(crate) mod taylor_green;
mod unit_flow;
