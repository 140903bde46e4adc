//! Common parts of the cases of the elastic solid: material, methods, settings, energies, and the variants of
//! a problem.

mod elements;
mod energy;
pub mod faces;
pub mod lagrangian;
mod material;
mod problem;
#[cfg(test)]
pub mod tests;

pub use elements::{Elements, Quantities, compare, quantities};
pub use energy::{ElasticEnergy, angular_momentum};
pub use lagrangian::{LAGRANGIAN, TOTAL};
pub use material::{limits, medium_of};
pub use problem::{
    ElasticBody, SolidParameters, SolidScales, Watch, leave_out, no_variants, variants,
};
#[cfg(test)]
pub use problem::{clamp, medium};
pub use touchstone_maths::{
    geometry::corners,
    metrics::{
        elastic::{Material, norm_squared},
        norms::largest,
        path::Path,
    },
};

touchstone_base::settings! {
    /// The settings that cases of solids have in common.
    pub struct SolidSettings {
        /// Young's modulus
        young: f64 ["Pa"] in 1e-6..=1e15 = 2e6,
        /// Poisson's ratio
        poisson: f64 ["-"] in 0.0..=0.4999 = 0.3975,
        /// density without stress
        rho: f64 ["kg/m^3"] in 1e-6..=1e6 = 1000.0,
        /// smoothing length over spacing; published runs of rubber rings use 1.5
        h_over_dx: f64 ["-"] in 0.8..=3.0 = 1.5,
        /// artificial viscosity α
        alpha: f64 ["-"] in 0.0..=10.0 = 1.0,
        /// artificial viscosity β
        beta: f64 ["-"] in 0.0..=20.0 = 2.0,
        /// artificial stress: strength ξ
        xi: f64 ["-"] in 0.0..=1.0 = 0.3,
        /// artificial stress: exponent n
        exponent: usize ["-"] in 1..=12 = 4,
        /// XSPH: ε
        xsph: f64 ["-"] in 0.0..=0.99 = 0.5,
        /// Courant number dt (c_p + V)/h; auto: 0.4 with the leapfrog, 0.25 with the
        /// predictor-corrector
        courant: Option<f64> ["-"] in 1e-6..=10.0 = None,
        /// time step; auto: by the Courant number
        dt: Option<f64> ["s"] in 1e-15..=1e6 = None,
    }
}

impl SolidSettings {
    /// The numbers that these settings state.
    pub fn common(&self) -> SolidParameters {
        let &Self { h_over_dx, dt, courant, .. } = self;
        let material = Material::from_young(self.rho, self.young, self.poisson);
        SolidParameters { material, h_over_dx, dt, courant }
    }
}
