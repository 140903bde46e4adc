//! A column of water that collapses on a dry floor, against two experiments: Martin & Moyce 1952, where
//! it runs out freely, and Lobovsky et al. 2014, where it strikes a wall.
//!
//! Judged against the measured fronts, heights, levels and impulses, against the same model by volume of
//! fluid, and against conservation: mass is exact, momentum follows gravity and the force of the walls, and
//! the energy budget closes over all terms.

mod columns;
mod curves;
mod ensembles;
mod measure;
mod metrics;
mod plan;
mod reference;
mod run;
mod studies;

use touchstone_harness::prelude::*;

use crate::waters::water::WaterSettings;

pub use run::Dam;

touchstone_base::settings! {
    /// Settings of a collapsing column; the column of Martin & Moyce unless set otherwise.
    pub struct DamSettings {
        /// spacings along the shorter side of the column; with fewer than 5 no particle is below a quarter of
        /// its height, where the front is measured
        n: usize ["-"] in 5..=2000 = 20,
        /// width of the column
        width: f64 ["m"] in 1e-6..=1e3 = 0.05715,
        /// height H of the column
        height: f64 ["m"] in 1e-6..=1e3 = 0.1143,
        /// inner length of the tank; by default water never reaches the far wall
        tank: f64 ["m"] in 1e-6..=1e4 = 0.485775,
        /// height of the walls of the tank
        rim: f64 ["H"] in 0.1..=10.0 = 1.25,
        /// gravity
        gravity: f64 ["m/s^2"] in 1e-6..=1e6 = 9.81,
        /// sound speed: ten times the speed of free fall from the top of the column
        c0: f64 ["(g H)^(1/2)"] in 1.0..=1e3 = 14.142135623730951,
        /// end of the run
        end: f64 ["(H/g)^(1/2)"] in 1e-6..=100.0 = 1.8,
        /// shift of the initial column to the left and downwards, without a change of its densities
        offset: f64 ["dx"] in 0.0..=0.5 = 0.0,
        /// settings of water
        water: WaterSettings = WaterSettings::default(),
    }
}

impl DamSettings {
    /// (H/g)^(1/2) \[s\], the unit of time.
    pub fn unit_time(&self) -> f64 {
        (self.height / self.gravity).sqrt()
    }

    /// The experiment whose scene the settings are, at any scale.
    pub fn scene(&self) -> Option<Experiment> {
        let is = |ratio: f64, expected: f64| (ratio / expected - 1.0).abs() < 1e-9;
        // The end of the floor is where not even a front of shallow water, at twice (g H)^(1/2), would come.
        let is_endless = self.tank >= self.width + 2.0 * self.end * self.height;
        match self.height / self.width {
            ratio if is(ratio, 2.0) && is_endless => Some(Experiment::MartinMoyce),
            ratio if is(ratio, 0.5) && is(self.tank / self.height, 1.61 / 0.3) => {
                Some(Experiment::Lobovsky)
            }
            _ => None,
        }
    }
}

/// An experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Experiment {
    /// Martin & Moyce 1952: a column twice as high as wide, on an endless floor.
    MartinMoyce,
    /// Lobovsky et al. 2014: a column half as high as wide, in a tank.
    Lobovsky,
}

/// Sets the settings of Lobovsky et al.: a reservoir of 600 mm by 300 mm in a tank of 1610 mm, with walls 600
/// mm high.
pub fn lobovsky(s: &mut DamSettings) {
    (s.width, s.height, s.tank, s.rim, s.end) = (0.6, 0.3, 1.61, 2.0, 6.0);
}

/// The name of the case.
pub const NAME: &str = "dam_break";

/// The seed's step: at Courant number 0.4 the predictor-corrector needs α = 0.03 on every pair, and
/// α = 0.1 on approaching ones is more than that.
fn seed(s: &mut DamSettings) {
    s.water.courant = 0.4;
}

/// 24 neighbours, α as customary with density diffusion, and half of the leapfrog's limit.
fn modern(s: &mut DamSettings) {
    (s.water.alpha, s.water.courant) = (0.02, 1.0);
}

/// `modern` with a wider kernel and a higher sound speed, and half of the limit of its step, which the damper
/// lowers from 1.8 to 1.0 h/c0.
fn damped(s: &mut DamSettings) {
    modern(s);
    (s.c0, s.water.h_over_dx, s.water.courant) = (20.0, 2.0, 0.6);
}

/// The variants, each with the question that it answers.
fn variants() -> Compositions<DamSettings> {
    use touchstone_schemes::water;
    let paper = "the paper's: cubic spline, interface and wall particles, XSPH, artificial viscosity and \
                 stress, predictor-corrector";
    let ghosts = "the seed with ghosts; in a corner a particle has a third ghost, rotated by 180 degrees \
                  about the corner, with the velocity of the particle";
    let modern_is = "Wendland C2, density diffusion that keeps a column at rest, leapfrog, walls that \
                extrapolate the pressure without suction (at least 0), little artificial viscosity, none \
                between water and walls (free slip)";
    let slip = "the seed with ghosts that keep the velocity along the wall: does the opposite velocity make \
                `ghosts` noisy?";
    let sticking = "modern with artificial viscosity also between water and resting wall particles: how \
                    much do they drag the water?";
    let damped_is = "modern with an acoustic damper, a bulk viscosity of rho h c0 in the momentum equation, \
        h/dx 2 and c0 20: does the pressure on a wall ring less?";
    Variants::of(Dam::new)
        .with("seed", paper, water::seed(), seed)
        .with("ghosts", ghosts, water::ghosts(), seed)
        .with("modern", modern_is, water::modern(), modern)
        .with("ghosts-slip", slip, water::slip_ghosts(), seed)
        .with("damped", damped_is, water::damped(), damped)
        .with("modern-sticking", sticking, water::sticking(), modern)
        .all
}

/// Collapsing columns.
pub static DAM_BREAK: Composed<DamSettings> = Composed {
    name: NAME,
    problem: "A column of water collapses on a dry floor",
    recommended: Recommended {
        variant: "modern",
        because: "with 20 spacings a column width its front at T = 2 differs by \
                  -0.058<!-- dam_break.modern; n=20; front_away@2 --> a from volume of fluid, the paper's \
                  by -0.28<!-- dam_break.seed; n=20; front_away@2 --> a; against the experiment as \
                  released the order is reversed, 0.28<!-- dam_break.modern; n=20; front_rms --> and \
                  0.08<!-- dam_break.seed; n=20; front_rms --> a rms, because the experiment starts late",
        papers: Some("seed"),
    },
    about: "A column of water, held by a wall on its left, is released at once and collapses on a dry \
            floor. In Martin & Moyce 1952 it is twice as high as wide, on an endless floor. In Lobovsky et \
            al. 2014 it is 600 mm by 300 mm in a tank of 1610 mm, whose far wall it strikes. Front, \
            residual height, levels, pressures and impulses are compared with the experiments and with the \
            same model by volume of fluid; energy and momentum are accounted for term by term.",
    variants,
    facts: studies::facts,
    studies: studies::studies,
};
