//! Viscous flows.

pub mod cavity;
pub mod channel;
pub mod manufactured;
pub mod periodic_hill;
pub mod slip_channel;
pub mod taylor_couette;
pub mod taylor_green;
mod unit_flow;
