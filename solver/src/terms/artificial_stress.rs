//! Artificial stress against clumping in tension, (18), (19): Rᵢⱼ φᵢⱼⁿ in a pair stress (Monaghan 2000).

use super::{In, Kernel, Lane, Numbers, Pair};

/// Addition to the pair pressure of [`super::Pressure`] or to the pair stress of [`super::CauchyStress`]
/// where the material is in tension: nothing, or an artificial stress Rᵢⱼ φᵢⱼⁿ with (21) Rᵢⱼ = Rᵢ + Rⱼ. `S`
/// is `f64` for a pressure and [`super::Symmetric`] for a stress.
pub trait Tensile<S: Numbers>: Copy + Send + Sync + 'static {
    /// Derived numbers of a particle.
    type Derived: Numbers;
    /// From p/ρ², σ/ρ² or σ of a particle, in its unit.
    fn derived(&self, stress: S) -> Self::Derived;
    /// Rᵢⱼ φᵢⱼⁿ, in the unit of [`Tensile::Derived`].
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Self::Derived>) -> In<S, V>;
}

impl<S: Numbers> Tensile<S> for () {
    type Derived = ();
    #[inline(always)]
    fn derived(&self, _: S) {}
    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, _: &Pair<V, K>) -> In<S, V> {
        S::default().spread::<V>()
    }
}

/// (18) φᵢⱼ = W(dᵢⱼ)/W(⁰r), (19) Rᵢ = ξ |pᵢ|/ρᵢ² where pᵢ < 0, else 0, Rᵢⱼ = Rᵢ + Rⱼ (Monaghan 2000).
#[derive(Clone, Copy, Debug)]
pub struct ArtificialStress {
    /// Strength ξ \[-\]; 0.3 in the seed.
    pub xi: f64,
    /// Exponent n; 4 (inferred).
    pub n: u32,
    /// 1/W(⁰r) at the initial spacing ⁰r \[m²\].
    pub inverse_w: f64,
}

impl ArtificialStress {
    /// Strength ξ, exponent n, and W at the initial spacing \[1/m²\].
    pub fn new(xi: f64, n: u32, w_at_spacing: f64) -> Self {
        Self { xi, n, inverse_w: 1.0 / w_at_spacing }
    }
}

impl Tensile<f64> for ArtificialStress {
    type Derived = f64;

    #[inline(always)]
    fn derived(&self, p: f64) -> f64 {
        self.xi * (-p).max(0.0)
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, f64>) -> V {
        let [own, other] = pair.derived;
        let phi = pair.w() * V::all(self.inverse_w);
        (0..self.n).fold(own + other, |product, _| product * phi)
    }
}
