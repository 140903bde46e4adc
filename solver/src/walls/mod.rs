//! Walls, in the two representations of the paper's section 4, and what they have in common with
//! periodic edges: images.

mod ghosts;
mod image;
mod interface;

pub use ghosts::{Ghosts, PlaneWall};
pub use image::Map;
pub use interface::InterfaceWall;

use crate::terms::Term;

/// How a scene treats its walls.
pub trait Walls<X>: Clone + Send + Sync + 'static {
    /// The terms by which wall particles evolve; `()` where there are none.
    type Rows: Term<X>;
    /// Those terms.
    fn rows(&self) -> Self::Rows;
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
