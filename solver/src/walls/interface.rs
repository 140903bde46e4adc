//! Interface and wall particles (section 4.2 of the paper): boundary particles.

use super::Walls;
use crate::terms::Continuity;

/// Walls represented by boundary particles, which stand still: a layer of [`crate::Role::Interface`] on the
/// surface, density and pressure frozen, and layers of [`crate::Role::Wall`] behind it, whose density
/// and pressure evolve by (3) and (7). All have the wall's velocity.
#[derive(Clone, Copy, Debug, Default)]
pub struct InterfaceWall;

impl<X> Walls<X> for InterfaceWall {
    type Terms = Continuity;
    fn terms(&self) -> Continuity {
        Continuity
    }
}
