//! Walls: the two representations of section 4 of the paper (mirror particles; interface and wall
//! particles), boundary particles that extrapolate from the fluid, and images, which implement both mirror
//! particles and periodic copies.

mod extrapolating;
mod ghosts;
mod image;

pub use extrapolating::{CurvedNoSlip, ExtrapolatingWall, NoSlip, WallVelocity};
pub use ghosts::{Ghosts, Mirrors, PlaneWall, SlipGhosts};
pub(crate) use ghosts::{RIGHT_ANGLE, corners};
pub use image::Map;

use crate::terms::{Continuity, Term};
use nalgebra::Vector2;

/// How a scene treats its walls.
pub trait Walls<X>: Clone + Send + Sync + 'static {
    /// The terms by which wall particles evolve, or `()` if there are none; then no pair sweep over wall
    /// particles is compiled.
    type Terms: Term<X>;
    /// Whether [`Walls::Terms`] extrapolate from the fluid. They are then summed over fluid particles only,
    /// before each pair sweep, and their result is not a rate: it is the density of the wall particle, and
    /// what is added to its velocity, in the derived data.
    const EXTRAPOLATES: bool = false;
    /// Whether walls that extrapolate sum over the neighbours of the foot of each wall particle, the nearest
    /// point of the surface, in place of its own: [`crate::scene::Setting::feet`].
    const FEET: bool = false;
    /// What [`Walls::Terms`] read of the vector from a wall particle to its foot \[m\], if it has one.
    fn foot(_: Option<&Vector2<f64>>) -> <Self::Terms as Term<X>>::Derived {
        Default::default()
    }
    /// The values of [`Walls::Terms`].
    fn terms(&self) -> Self::Terms;
    /// Whether mirror particles behind [`Walls::mirrors`] keep the tangential velocity (free slip).
    const SLIPS: bool = false;
    /// The straight walls that mirror the fluid.
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

/// Walls represented by boundary particles (section 4.2 of the paper), which do not move: a layer of
/// [`crate::Role::Interface`] on the surface, with constant density and pressure, and layers of
/// [`crate::Role::Wall`] behind it, whose density and pressure evolve by (3) and (7). All carry the velocity
/// of the wall.
#[derive(Clone, Copy, Debug, Default)]
pub struct InterfaceWall;

impl<X> Walls<X> for InterfaceWall {
    type Terms = Continuity;
    fn terms(&self) -> Continuity {
        Continuity
    }
}
