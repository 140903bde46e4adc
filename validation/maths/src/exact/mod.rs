//! Exact solutions of the continuous equations, the references of runs.

mod elliptic_drop;
pub mod hydrostatic;
pub mod impact;
pub mod manufactured;
pub mod plane_wave;
mod start_up;
mod taylor_couette;
mod taylor_green;
pub mod thin_plate;

pub use elliptic_drop::EllipticDrop;
pub use hydrostatic::Hydrostatic;
pub use start_up::StartUp;
pub use taylor_couette::TaylorCouette;
pub use taylor_green::TaylorGreen;
