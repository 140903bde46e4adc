//! Water at rest in an open tank: a column of Tait fluid, compressed by its own weight, whose density
//! and pressure are known exactly. What walls and density treatments do to it is all that happens.

mod column;
mod plan;
mod run;

use harness::composed::{Best, Composed, Composition, Variants, completed};
use solver::{Continuity, DensityDiffusion, Ghosts, InterfaceWall};

use crate::water::{Diffusion, Modern, Seed, method};

base::settings! {
    /// Settings of water at rest in an open tank.
    pub struct HydrostaticSettings {
        /// spacings from the bottom to the surface
        rows: usize ["-"] in 4..=2000 = 20,
        /// spacings across the tank
        columns: usize ["-"] in 4..=2000 = 10,
        /// depth of the water H
        depth: f64 ["m"] in 1e-6..=1e4 = 1.0,
        /// density at the surface
        rho: f64 ["kg/m^3"] in 1e-3..=1e5 = 1000.0,
        /// gravity
        g: f64 ["m/s^2"] in 1e-6..=1e6 = 9.81,
        /// g H/c0^2, which sets the sound speed
        compressibility: f64 ["-"] in 1e-8..=1.0 = 0.01,
        /// exponent of the Tait equation
        gamma: usize ["-"] in 2..=12 = 7,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.9..=3.0 = 1.2,
        /// Courant number of the time step, with the sound speed at the bottom
        courant: f64 ["-"] in 1e-6..=10.0 = 0.25,
        /// end of the run
        end: f64 ["4 H/c0"] in 1e-3..=1e5 = 20.0,
        /// each particle starts this far from its place, at random
        jitter: f64 ["dx"] in 0.0..=0.5 = 0.0,
        /// start with the density of the surface everywhere, instead of with the exact one
        uniform: bool = false,
        /// linear artificial viscosity
        alpha: f64 ["-"] in 0.0..=10.0 = 0.1,
        /// quadratic artificial viscosity
        beta: f64 ["-"] in 0.0..=10.0 = 0.0,
        /// XSPH: ε
        xsph: f64 ["-"] in 0.0..=0.99 = 0.5,
        /// strength of the artificial stress
        xi: f64 ["-"] in 0.0..=10.0 = 0.3,
        /// exponent of the artificial stress
        exponent: usize ["-"] in 1..=16 = 4,
        /// density diffusion delta
        diffusion: f64 ["-"] in 0.0..=1.0 = 0.1,
        /// share of gravity in the extrapolation of a wall; less than 1 only to show its effect
        wall_gravity: f64 ["g"] in 0.0..=2.0 = 1.0,
    }
}

/// Wendland C2 at h = 1.5 dx, long steps, and a fifth of the artificial viscosity: in water at rest there
/// is little to damp.
fn modern(s: &mut HydrostaticSettings) {
    (s.h_over_dx, s.courant, s.alpha) = (1.5, 0.8, 0.02);
}

fn variants() -> Vec<Composition<HydrostaticSettings>> {
    Variants::of(&run::PROGRAM)
        .with(
            "seed",
            "as in the paper: cubic spline, interface and wall particles, artificial viscosity and \
             stress, XSPH, predictor-corrector",
            method::<Seed<InterfaceWall>>(),
            |_| {},
        )
        .with("ghosts", "seed with ghosts for walls", method::<Seed<Ghosts>>(), |_| {})
        .with(
            "modern",
            "Wendland C2, h/dx 1.5, walls that extrapolate pressure, density diffusion that keeps \
             a hydrostatic column, leapfrog",
            method::<Modern>(),
            modern,
        )
        .with(
            "extrapolating-molteni",
            "modern with the diffusion of Molteni and Colagrossi: does plain diffusion level out the column?",
            method::<Modern<(Continuity, DensityDiffusion)>>(),
            modern,
        )
        .with(
            "interface-hydrostatic",
            "modern with interface and wall particles: are the paper's walls enough for the rest of it?",
            method::<Modern<(Continuity, Diffusion), InterfaceWall>>(),
            modern,
        )
        .all
}

const NAME: &str = "hydrostatic";

/// Water at rest in an open tank.
pub static HYDROSTATIC: Composed<HydrostaticSettings> = Composed {
    name: NAME,
    problem: "Water at rest in an open tank",
    best: Best {
        variant: "modern",
        because: "with 20 rows its pressure is wrong by 0.8 %, the paper's by 1.2 %, for a third of the \
                  pairs",
        papers: Some("seed"),
    },
    about: "Water rests in an open tank and is compressed by g H/c0^2 by its own weight. The exact \
            solution is rho = rho0 (1 + (gamma - 1) g d/c0^2)^(1/(gamma - 1)) at the depth d, and nothing \
            moves. After 20 acoustic periods 4 H/c0 the pressure, the level, the kinetic energy, the gap \
            between water and bottom, and the particles outside of the tank are compared with it.",
    variants,
    is_stable: completed,
    declaration: plan::declaration,
    plan: |tier| plan::table(tier).plan(),
    studies: plan::studies,
};
