//! How each term is made from the settings of water, and which settings it reads.

use solver::terms::{Approaching, Hydrostatic, Tensile};
use solver::{
    ArtificialStress, ArtificialViscosity, BodyForce, Continuity, DensityDiffusion, Kernel,
    Pressure, Tait, Xsph,
};

use super::Medium;
use maths::metrics::budget::Itemised;

/// A term that can be made from the settings of water.
pub trait Ingredient: Itemised<()> {
    /// The term, in a scene with the kernel `K`.
    fn new<K: Kernel>(medium: &Medium) -> Self;
    /// Settings that only this term, or a term inside it, reads.
    fn uses() -> Vec<&'static str> {
        Vec::new()
    }
}

/// Settings that some term of some variant reads, and others do not have.
pub const OPTIONAL: &[&str] = &["alpha", "beta", "xsph", "xi", "exponent", "diffusion"];

impl Ingredient for Continuity {
    fn new<K: Kernel>(_: &Medium) -> Self {
        Continuity
    }
}

/// An artificial stress, or none.
pub trait TensileIngredient: Tensile {
    /// Settings that it reads.
    const USES: &'static [&'static str];
    /// Its value.
    fn new<K: Kernel>(medium: &Medium) -> Self;
}

impl TensileIngredient for () {
    const USES: &'static [&'static str] = &[];
    fn new<K: Kernel>(_: &Medium) -> Self {}
}

impl TensileIngredient for ArtificialStress {
    const USES: &'static [&'static str] = &["xi", "exponent"];
    fn new<K: Kernel>(medium: &Medium) -> Self {
        let numerics = &medium.numerics;
        ArtificialStress::new(numerics.xi, numerics.exponent, medium.w_at_spacing::<K>())
    }
}

impl<R: TensileIngredient> Ingredient for Pressure<Tait, R>
where
    Self: Itemised<()>,
{
    fn new<K: Kernel>(medium: &Medium) -> Self {
        Pressure { eos: medium.eos, tensile: R::new::<K>(medium) }
    }
    fn uses() -> Vec<&'static str> {
        R::USES.to_vec()
    }
}

impl Ingredient for ArtificialViscosity<Tait, Approaching> {
    fn new<K: Kernel>(medium: &Medium) -> Self {
        Self::new(medium.numerics.alpha, medium.numerics.beta, medium.h, medium.eos)
    }
    fn uses() -> Vec<&'static str> {
        vec!["alpha", "beta"]
    }
}

impl Ingredient for BodyForce {
    fn new<K: Kernel>(medium: &Medium) -> Self {
        BodyForce(medium.gravity)
    }
}

impl Ingredient for Xsph {
    fn new<K: Kernel>(medium: &Medium) -> Self {
        Xsph { epsilon: medium.numerics.xsph }
    }
    fn uses() -> Vec<&'static str> {
        vec!["xsph"]
    }
}

impl Ingredient for DensityDiffusion {
    fn new<K: Kernel>(medium: &Medium) -> Self {
        DensityDiffusion::new(medium.diffusivity())
    }
    fn uses() -> Vec<&'static str> {
        vec!["diffusion"]
    }
}

impl Ingredient for DensityDiffusion<Hydrostatic> {
    fn new<K: Kernel>(medium: &Medium) -> Self {
        DensityDiffusion::hydrostatic(medium.diffusivity(), medium.eos, medium.gravity)
    }
    fn uses() -> Vec<&'static str> {
        vec!["diffusion"]
    }
}

macro_rules! tuple_of_ingredients {
    ($($member:ident),+) => {
        impl<$($member: Ingredient),+> Ingredient for ($($member,)+) {
            fn new<K: Kernel>(medium: &Medium) -> Self {
                ($($member::new::<K>(medium),)+)
            }
            fn uses() -> Vec<&'static str> {
                [$($member::uses()),+].concat()
            }
        }
    };
}

tuple_of_ingredients!(A, B);
tuple_of_ingredients!(A, B, C);
