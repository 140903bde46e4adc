//! The settings of the channel flows.

use super::TIMES;

base::settings! {
    /// Settings of a flow between two plates. Lengths by the width L, times by L²/ν.
    pub struct ChannelSettings {
        /// Reynolds number V L/ν, V the speed of the plate or of the centre line
        re: f64 ["-"] in 1e-9..=1e6 = 0.5,
        /// rows of particles between the plates: spacing dx = L/rows
        rows: usize ["-"] in 4..=2000 = 20,
        /// particles along the channel; 0: as few as the kernel allows, for the flow does not depend on x
        columns: usize ["-"] in 0..=100000 = 0,
        /// distance of the plates L (inferred)
        width: f64 ["m"] in 1e-9..=1e3 = 1e-3,
        /// kinematic viscosity, water
        nu: f64 ["m^2/s"] in 1e-12..=1e3 = 1e-6,
        /// initial density, water
        rho: f64 ["kg/m^3"] in 1e-6..=1e6 = 1000.0,
        /// end of the run
        end: f64 ["L^2/nu"] in 1e-6..=100.0 = 1.0,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.8..=5.0 = 1.2,
        /// guard against 0/0 in the viscous term; the seed's 0.01 lowers the viscosity by about 1 %
        eta2_over_h2: f64 ["-"] in 1e-12..=0.1 = 0.01,
        /// sound speed; auto: the larger one of Morris' rule and c0_viscous ν/h
        c0: Option<f64> ["m/s"] in 1e-12..=1e6 = None,
        /// density variation δ that Morris' rule allows: c0² = max(V², ν V/L, F L)/δ
        density_variation: f64 ["-"] in 1e-8..=1.0 = 0.01,
        /// least c0 in units of ν/h; sound no stiffer than viscosity does not shorten the time step
        c0_viscous: f64 ["nu/h"] in 0.0..=100.0 = 0.0,
        /// exponent of the Tait equation
        gamma: usize ["-"] in 1..=20 = 7,
        /// background pressure p0
        background: f64 ["rho c0^2"] in 0.0..=10.0 = 0.0,
        /// time step; auto: the least of courant h/(c0 + V), viscous h²/ν (or of limit_share), √(h/F)/4
        dt: Option<f64> ["s"] in 1e-15..=1e3 = None,
        /// Courant number of the time step
        courant: f64 ["-"] in 1e-6..=100.0 = 0.25,
        /// viscous number of the time step
        viscous: f64 ["-"] in 1e-6..=100.0 = 0.125,
        /// time step as a share of its theoretical limit, in place of both numbers; auto: not
        limit_share: Option<f64> ["-"] in 0.01..=1.0 = None,
        /// least number of time steps from one time of comparison to the next
        least_steps: usize ["-"] in 1..=100000 = 1,
        /// wall ghosts know the curvature -F/ν of the velocity at the wall
        wall_curvature: bool = false,
        /// artificial viscosity, linear
        alpha: f64 ["-"] in 0.0..=10.0 = 0.1,
        /// artificial viscosity, quadratic
        beta: f64 ["-"] in 0.0..=10.0 = 0.0,
        /// XSPH: ε
        xsph: f64 ["-"] in 0.0..=0.99 = 0.5,
        /// artificial stress, strength ξ
        xi: f64 ["-"] in 0.0..=10.0 = 0.3,
        /// artificial stress, exponent n
        exponent: usize ["-"] in 1..=16 = 4,
        /// density diffusion δ
        diffusion: f64 ["-"] in 0.0..=10.0 = 0.1,
        /// particle shifting, amplitude
        shift: f64 ["-"] in 0.0..=10.0 = 0.5,
        /// random displacement of the initial lattice, standard deviation
        jitter: f64 ["dx"] in 0.0..=0.5 = 0.0,
        /// Verlet skin: reach of neighbour lists beyond the support radius
        skin: f64 ["h"] in 0.0..=2.0 = 0.15,
        /// keep the lowest pressure mode of the last 60 L/c0; profiles are compared at the end alone
        watch_mode: bool = false,
    }
}

impl ChannelSettings {
    /// V = Re ν/L \[m/s\].
    pub fn speed(&self) -> f64 {
        self.re * self.nu / self.width
    }

    /// L²/ν, the unit of times \[s\].
    pub fn unit_of_time(&self) -> f64 {
        self.width.powi(2) / self.nu
    }

    /// νt/L² at which a run compares its profile with the exact one: [`TIMES`] before its end, and the end.
    pub fn compared(&self) -> Vec<f64> {
        let before = TIMES.into_iter().filter(|tau| *tau < self.end && !self.watch_mode);
        before.chain([self.end]).collect()
    }
}
