//! Walls: the two representations of the paper's section 4, one that extrapolates from the fluid, and
//! what ghosts have in common with periodic edges: images.

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
    /// The terms by which wall particles evolve; `()` where there are none.
    type Rows: Term<X>;
    /// Whether [`Walls::Rows`] extrapolate: summed over the fluid alone, before each sweep, they give
    /// a wall particle the density that it shows, and what it shows beyond its velocity, where others
    /// give rates.
    const EXTRAPOLATES: bool = false;
    /// Those terms.
    fn rows(&self) -> Self::Rows;
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
    type Rows = ();
    fn rows(&self) {}
}
