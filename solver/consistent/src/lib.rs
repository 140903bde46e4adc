//! Terms that few scenes use, by the public trait [`solver::Term`].
//!
//! Most have gradients that are exact for linear fields on any particles, by the inverse of the moments
//! of each particle ([`solver::terms::moments`]): for fluids, where they give up conservation, and for
//! elastic solids, where the forces are conjugate to the gradients and conserve.
//!
//! Notation and the numbers of equations are those of the crate `solver`. Nothing is stored for the moments:
//! a term sums them in its own pair sweep, except for [`ConjugateStress`], which needs those of neighbours.

mod fluid;
mod fluid_pairs;
mod solid;

pub use fluid::{ConsistentContinuity, ConsistentPressure, ConsistentViscosity};
pub use fluid_pairs::FluidPairs;
pub use solid::{ConjugateStress, ConsistentJaumannRate};
