//! A column of water that collapses on a dry floor, against two experiments: Martin & Moyce 1952, where
//! it runs out freely, and Lobovsky et al. 2014, where it strikes a wall.
//!
//! Judged against the measured fronts, heights, levels and impulses, and against conservation: mass is
//! exact, momentum follows gravity and the force of the walls, and every term accounts for its energy.

mod ablation;
mod declared;
mod front;
mod measure;
mod metrics;
mod plan;
mod reference;
mod run;
mod setup;
mod stability;
mod studies;

use harness::{
    case::Variant,
    composed::{Composed, Composition},
};
use solver::{
    ArtificialStress, ArtificialViscosity, BodyForce, Compose, Continuity, CubicSpline,
    DensityDiffusion, ExtrapolatingWall, Ghosts, InterfaceWall, Leapfrog, PredictorCorrector,
    Pressure, SlipGhosts, Tait, WendlandC2, Xsph, terms::Hydrostatic,
};

pub use run::{Watched, run_scene};
pub use setup::{Dam, Vessel};

use super::water::WaterScheme;

crate::water_settings! {
    /// Settings of a collapsing column; the column of Martin & Moyce unless set otherwise.
    pub struct DamSettings {
        /// spacings along the shorter side of the column
        n: usize ["-"] in 1..=2000 = 20,
        /// width of the column
        width: f64 ["m"] in 1e-6..=1e3 = 0.05715,
        /// height H of the column
        height: f64 ["m"] in 1e-6..=1e3 = 0.1143,
        /// length of the tank inside; by default the far wall is never reached
        tank: f64 ["m"] in 1e-6..=1e4 = 0.485775,
        /// height of the walls of the tank
        rim: f64 ["H"] in 0.1..=10.0 = 1.25,
        /// gravity
        gravity: f64 ["m/s^2"] in 1e-6..=1e6 = 9.81,
        /// sound speed: ten times the speed of a fall from the top of the column
        c0: f64 ["(g H)^(1/2)"] in 1.0..=1e3 = 14.142135623730951,
        /// end of the run
        end: f64 ["(H/g)^(1/2)"] in 1e-6..=100.0 = 1.8,
        /// the column starts this far to the left of its place and below it, with the densities of its place
        shift: f64 ["dx"] in 0.0..=0.5 = 0.0,
    }
}

/// Makes the settings those of Lobovsky et al.: a reservoir of 600 mm by 300 mm in a tank of 1610 mm, whose
/// walls are 600 mm high.
pub fn lobovsky(s: &mut DamSettings) {
    (s.width, s.height, s.tank, s.rim, s.end) = (0.6, 0.3, 1.61, 2.0, 6.0);
}

/// The name of the case.
pub const NAME: &str = "dam_break";

/// (14) with (7), (16), (17), and gravity; `R` is the artificial stress (18), (19).
pub type Water<R = ()> = (Pressure<Tait, R>, ArtificialViscosity<Tait>, BodyForce);
/// What the paper describes.
pub type Seed<W, I = PredictorCorrector> =
    Compose<CubicSpline, Water<ArtificialStress>, (Continuity, Xsph), W, I>;
/// Density diffusion that leaves a column at rest alone.
pub type Diffusion = DensityDiffusion<Hydrostatic>;
/// The best known settings.
pub type Modern<D = (Continuity, Diffusion), W = ExtrapolatingWall<Tait>> =
    Compose<WendlandC2, Water, D, W, Leapfrog>;

fn variant<S: WaterScheme<Walls: Vessel>>(
    name: &'static str,
    about: &'static str,
    adjust: fn(&mut DamSettings),
) -> Composition<DamSettings> {
    let lacks = S::lacks();
    Composition {
        variant: Variant { name, about },
        adjust,
        run: run::run::<S>,
        rules: run::rules::<S>,
        lacks,
    }
}

/// The seed's step: at Courant number 0.4 the predictor-corrector needs α = 0.03 on every pair, and
/// α = 0.1 on approaching ones is more than that.
fn seed(s: &mut DamSettings) {
    s.courant = 0.4;
}

/// 24 neighbours, α as customary with density diffusion, and half of the leapfrog's limit.
fn modern(s: &mut DamSettings) {
    (s.alpha, s.courant) = (0.02, 1.0);
}

/// The variants that are judged, then those of the ablation.
fn variants() -> Vec<Composition<DamSettings>> {
    let mut all = vec![
        variant::<Seed<InterfaceWall>>(
            "seed",
            "the paper's: cubic spline, interface and wall particles, XSPH, artificial viscosity and \
             stress, predictor-corrector",
            seed,
        ),
        variant::<Seed<Ghosts>>(
            "ghosts",
            "the seed with ghosts; in a corner a particle has a third one, turned by half a turn about \
             it, with its own velocity",
            seed,
        ),
        variant::<Modern>(
            "modern",
            "Wendland C2, density diffusion that keeps a column at rest, leapfrog, walls that \
             extrapolate the pressure, not below 0, so that they cannot suck, little artificial \
             viscosity",
            modern,
        ),
    ];
    all.extend(ablations());
    all
}

/// The seed, and the modern variant, with one part changed.
fn ablations() -> Vec<Composition<DamSettings>> {
    type Midpoint = PredictorCorrector;
    vec![
        variant::<Seed<InterfaceWall, Leapfrog>>("seed-leapfrog", "the seed, leapfrog", seed),
        variant::<Seed<ExtrapolatingWall<Tait>>>(
            "seed-extrapolating",
            "the seed with walls that extrapolate the pressure",
            seed,
        ),
        variant::<Compose<CubicSpline, Water, (Continuity, Xsph), InterfaceWall, Midpoint>>(
            "seed-no-stress",
            "the seed without artificial stress",
            seed,
        ),
        variant::<
            Compose<
                CubicSpline,
                Water<ArtificialStress>,
                (Continuity, Xsph, Diffusion),
                InterfaceWall,
                Midpoint,
            >,
        >("seed-diffusion", "the seed with density diffusion", seed),
        variant::<
            Compose<
                WendlandC2,
                Water<ArtificialStress>,
                (Continuity, Xsph),
                InterfaceWall,
                Midpoint,
            >,
        >("seed-wendland", "the seed with Wendland C2", seed),
        variant::<Seed<SlipGhosts>>(
            "ghosts-slip",
            "the seed with ghosts that keep the velocity along the wall",
            seed,
        ),
        variant::<Modern<Continuity>>("modern-bare", "modern without density diffusion", modern),
        variant::<Modern<(Continuity, DensityDiffusion)>>(
            "modern-plain-diffusion",
            "modern with density diffusion that levels out a column at rest",
            modern,
        ),
        variant::<Modern<(Continuity, Diffusion), InterfaceWall>>(
            "modern-interface",
            "modern with interface and wall particles",
            modern,
        ),
        variant::<Modern<(Continuity, Diffusion), Ghosts>>(
            "modern-ghosts",
            "modern with ghosts",
            modern,
        ),
        variant::<Modern<(Continuity, Diffusion), SlipGhosts>>(
            "modern-ghosts-slip",
            "modern with ghosts that keep the velocity along the wall",
            modern,
        ),
    ]
}

/// Collapsing columns.
pub static DAM_BREAK: Composed<DamSettings> = Composed {
    name: NAME,
    about: "A column of water, held by a wall on its left, is released at once and collapses on a dry floor \
            (Martin & Moyce 1952: twice as high as wide, on an endless floor; Lobovsky et al. 2014: 600 mm \
            by 300 mm in a tank of 1610 mm, whose far wall it strikes). Front, residual height, levels, \
            pressures and impulses are compared with the experiments; energy and momentum are accounted for \
            term by term.",
    variants,
    is_stable: stability::is_stable,
    declaration: declared::declaration,
    plan: plan::plan,
    studies: studies::studies,
};
