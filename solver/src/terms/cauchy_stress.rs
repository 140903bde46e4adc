//! Cauchy stress of an elastic solid, (9), (10): dvᵢ/dt = Σⱼ mⱼ (σᵢ/ρᵢ² + σⱼ/ρⱼ²)·∇ᵢWᵢⱼ.

use super::{Common, EquationOfState, Kernel, Lane, Pair, Rate, Symmetric, Tensile, Term, Vector2};

/// (9) dvᵢᵃ/dt = Σⱼ mⱼ (σᵢᵃᵇ/ρᵢ² + σⱼᵃᵇ/ρⱼ²) ∂Wᵢⱼ/∂xᵢᵇ \[m/s²\], (10) σᵃᵇ = −p δᵃᵇ + Sᵃᵇ, and the stress
/// part of (15) with R ≠ ().
///
/// The scheme integrates S as its extra field `X` by [`super::JaumannRate`]. The pair force need not be
/// central: linear momentum is conserved exactly, angular momentum is not.
#[derive(Clone, Copy, Debug)]
pub struct CauchyStress<E, R = ()> {
    /// Equation of state p(ρ), [`crate::Linear`] in the seed.
    pub eos: E,
    /// `()`, [`super::PrincipalStress`] or [`super::ComponentStress`].
    pub tensile: R,
}

impl<E: EquationOfState, R: Tensile<Symmetric>> Term<Symmetric> for CauchyStress<E, R> {
    /// σ/ρ² \[m⁵/(kg s²)\] and the derived data of the artificial stress.
    type Derived = (Symmetric, R::Derived);
    type Sum = Vector2<f64>;

    #[inline(always)]
    fn derived(&self, own: &Common, deviator: &Symmetric) -> Self::Derived {
        let p = self.eos.pressure(own.density);
        let Symmetric { xx, yy, xy } = *deviator;
        let stress = Symmetric { xx: xx - p, yy: yy - p, xy } * (1.0 / (own.density * own.density));
        (stress, self.tensile.derived(stress))
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Self::Derived>, sum: &mut Vector2<V>) {
        let [own, other] = pair.derived;
        let stress = own.0 + other.0 + self.tensile.pair(&pair.with([own.1, other.1]));
        *sum -= stress.times(pair.r) * (pair.other.mass * pair.f);
    }

    #[inline(always)]
    fn finish(&self, _: &Common, _: Self::Derived, sum: Self::Sum, rate: &mut Rate<Symmetric>) {
        rate.velocity += sum;
    }
}
