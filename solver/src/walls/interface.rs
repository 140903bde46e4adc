//! Walls of boundary particles: interface and wall particles (section 4.2 of the paper).

use super::Walls;
use crate::terms::Continuity;

/// Walls represented by boundary particles, which do not move: a layer of [`crate::Role::Interface`] on the
/// surface, with constant density and pressure, and layers of [`crate::Role::Wall`] behind it, whose density
/// and pressure evolve by (3) and (7). All carry the velocity of the wall.
#[derive(Clone, Copy, Debug, Default)]
pub struct InterfaceWall;

impl<X> Walls<X> for InterfaceWall {
    type Terms = Continuity;
    fn terms(&self) -> Continuity {
        Continuity
    }
}
