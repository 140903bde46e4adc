//! A new wall in one file: boundary particles with a smoothed density.

use touchstone_solver::{Continuity, DensityDiffusion, walls::Walls};

/// Interface and wall particles as in section 4.2, whose density is smoothed as well.
#[derive(Clone, Copy, Debug)]
pub struct SmoothedWall {
    /// Diffusion of the density of wall particles.
    pub diffusion: DensityDiffusion,
}

impl<X> Walls<X> for SmoothedWall {
    type Terms = (Continuity, DensityDiffusion); // how particles of Role::Wall evolve
    type Extrapolation = (); // nor do they follow from the fluid at once

    fn terms(&self) -> Self::Terms {
        (Continuity, self.diffusion)
    }
    fn extrapolation(&self) {}
    // fn mirrors(&self) -> &[PlaneWall]: straight walls that mirror the fluid; none by default
}
