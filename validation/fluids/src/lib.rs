//! Viscous flows.

pub mod channel;
pub mod couette;
pub mod fluid;
pub mod periodic_hill;
pub mod poiseuille;
pub mod taylor_couette;
pub mod taylor_green;
