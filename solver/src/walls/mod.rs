//! Walls: the two representations of the paper's section 4, one that extrapolates from the fluid, and
//! what mirror particles have in common with periodic edges: images.

mod extrapolating;
mod ghosts;
mod image;
mod interface;

pub use extrapolating::{ExtrapolatingWall, NoSlip, WallVelocity};
pub use ghosts::{Ghosts, PlaneWall, SlipGhosts};
pub(crate) use ghosts::{RIGHT_ANGLE, corners};
pub use image::Map;
pub use interface::InterfaceWall;

use crate::terms::Term;

/// How a scene treats its walls.
pub trait Walls<X>: Clone + Send + Sync + 'static {
    /// The terms by which wall particles evolve; where there are none, `()`, and then no pair sweep over
    /// wall particles is compiled.
    type Terms: Term<X>;
    /// Whether [`Walls::Terms`] extrapolate: summed over the fluid alone, before each sweep, they give
    /// a wall particle the density of its column, and what it has there beyond its velocity, where others
    /// give rates.
    const EXTRAPOLATES: bool = false;
    /// Those terms.
    fn terms(&self) -> Self::Terms;
    /// Whether images in [`Walls::mirrors`] keep the velocity along the wall.
    const SLIPS: bool = false;
    /// Walls that mirror the fluid.
    fn mirrors(&self) -> &[PlaneWall] {
        &[]
    }
}

/// No walls.
#[derive(Clone, Copy, Debug, Default)]
pub struct Open;

impl<X> Walls<X> for Open {
    type Terms = ();
    fn terms(&self) {}
}
