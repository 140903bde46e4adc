//! What cases of the elastic solid have in common: material, methods, settings, energies, and the
//! variants of a problem.

mod elements;
mod energy;
pub mod faces;
pub mod lagrangian;
mod material;
mod plates;
mod problem;
#[cfg(test)]
pub mod tests;

pub use elements::{Elements, Path, Quantities, compare, quantities};
pub use energy::{Energy, angular_momentum, norm_squared};
pub use lagrangian::{LAGRANGIAN, TOTAL};
pub use material::{Material, limits};
pub use plates::{FIRST_MODE, clamp, of_layers, thin_plate_period};
pub use problem::{Body, Scales, SharedSettings, Watch, leave_out, medium, no_variants, variants};
pub use touchstone_maths::{geometry::corners, metrics::norms::largest};

/// Declares the settings of a solid case: its own, then those that every solid case has, which are its
/// [`SharedSettings`]. The material has this Young's modulus \[Pa\] and Poisson's ratio.
#[macro_export]
macro_rules! solid_settings {
    (
        $(#[doc = $doc:literal])+
        pub struct $Struct:ident of [$young:literal, $poisson:literal] { $($own:tt)* }
    ) => {
        touchstone_base::settings! {
            $(#[doc = $doc])+
            pub struct $Struct {
                $($own)*
                /// Young's modulus
                young: f64 ["Pa"] in 1e-6..=1e15 = $young,
                /// Poisson's ratio
                poisson: f64 ["-"] in 0.0..=0.4999 = $poisson,
                /// density without stress
                rho: f64 ["kg/m^3"] in 1e-6..=1e6 = 1000.0,
                /// smoothing length over spacing; published runs of rubber rings have 1.5
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

        impl $crate::solids::solid::SharedSettings for $Struct {
            fn material(&self) -> $crate::solids::solid::Material {
                $crate::solids::solid::Material::from_young(self.rho, self.young, self.poisson)
            }
            fn h_over_dx(&self) -> f64 {
                self.h_over_dx
            }
            fn given_step(&self) -> [Option<f64>; 2] {
                [self.dt, self.courant]
            }
        }
    };
}
