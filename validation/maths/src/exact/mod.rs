//! Exact solutions of the continuous equations, the references of runs.

pub mod elliptic_drop;
pub mod hydrostatic;
pub mod impact;
pub mod manufactured;
pub mod plane_wave;
pub mod start_up;
pub mod taylor_couette;
pub mod taylor_green;
pub mod thin_plate;

pub use elliptic_drop::EllipticDrop;
pub use hydrostatic::Hydrostatic;
pub use start_up::StartUp;
pub use taylor_couette::TaylorCouette;
pub use taylor_green::TaylorGreen;
