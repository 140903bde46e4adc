//! Deliberate changes of a run: errors and disorder. Of an error, one constant of the scene is multiplied by
//! a factor, while everything that is measured and judged follows the settings as before. A gate that such a
//! run passes cannot detect the error.

use std::fmt;

use serde::{Deserialize, Serialize};

/// One constant of the scene, and the factor by which it is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mutation {
    /// the constant
    pub of: Constant,
    /// the factor \[-\]
    pub factor: f64,
}

impl Mutation {
    /// The factor of this constant, 1 if another one is wrong.
    pub fn factor_of(self, constant: Constant) -> f64 {
        if self.of == constant { self.factor } else { 1.0 }
    }
}

/// A small disorder of the start of a run, no error: particles of the fluid are displaced along each axis by
/// uniform random numbers. Runs that differ in its seed alone are an ensemble.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Disorder {
    /// the largest displacement along each axis \[dx\]
    pub most: f64,
    /// seed of the displacements \[-\]
    pub seed: u32,
}

/// A physical constant of a problem or an ingredient of the method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Constant {
    /// viscosity
    Viscosity,
    /// body force: gravity, or the force that drives a channel
    BodyForce,
    /// velocity of the walls
    WallSpeed,
    /// velocity of the particles at the start
    Speed,
    /// sound speed; the bulk modulus goes with its square
    SoundSpeed,
    /// density at rest
    Density,
    /// shear modulus
    ShearModulus,
    /// height of the scene: fluid, body and walls are stretched along y at constant density
    Height,
    /// every sum over neighbours: their masses at constant density
    Normalisation,
    /// smoothing length at constant spacing
    SmoothingLength,
    /// time step
    TimeStep,
    /// artificial viscosity, both parts
    ArtificialViscosity,
    /// artificial stress
    ArtificialStress,
    /// XSPH
    Xsph,
    /// density diffusion
    DensityDiffusion,
    /// acoustic damper
    AcousticDamper,
    /// particle shifting
    Shifting,
    /// how far a particle may move before neighbour lists are built again
    ListLifetime,
}

impl Constant {
    /// Is it a constant of the problem, and not of the method?
    pub fn is_physical(self) -> bool {
        self <= Self::Height
    }

    /// Is it a constant of the discretisation, and not the strength of a term?
    pub fn is_of_sums(self) -> bool {
        use Constant::{ListLifetime, Normalisation, SmoothingLength, TimeStep};
        matches!(self, Normalisation | SmoothingLength | TimeStep | ListLifetime)
    }

    /// The largest relative error that may go undetected: 3 % of a physical constant, 10 % of an ingredient
    /// of the method.
    pub fn allowed(self) -> f64 {
        if self.is_physical() { 0.03 } else { 0.1 }
    }

    /// The name in words.
    pub fn words(self) -> String {
        self.to_string().replace('_', " ")
    }
}

/// The name in gates and documents.
impl fmt::Display for Constant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(f)
    }
}

/// How the smallest error that the gates of a run detect is found: an error counts as detected if the run
/// fails a gate with either sign of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Detect {
    /// the constant with the error
    pub of: Constant,
    /// try only the largest error that may go undetected, instead of a bisection
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub only_allowed: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_what_serde_writes() {
        for constant in [Constant::Viscosity, Constant::Height, Constant::Xsph, Constant::Shifting]
        {
            let text = serde_json::to_value(constant).unwrap();
            assert_eq!(text, constant.to_string());
        }
        assert!(Constant::Height.is_physical() && !Constant::Normalisation.is_physical());
    }
}
