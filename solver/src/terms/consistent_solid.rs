//! Stress of an elastic solid with gradients that are exact for linear fields, and with the forces that are
//! conjugate to them. With the moments M the velocity gradient is
//!
//! Gᵢ = Σⱼ Vⱼ vᵢⱼ ⊗ (M⁻¹ᵢ F rᵢⱼ),
//!
//! and the power of the stress is Σ Vᵢ σᵢ : Gᵢ. The factor of vᵢ in this power is the force
//!
//! mᵢ dvᵢ/dt = −Σⱼ Vᵢ Vⱼ (σᵢ M⁻¹ᵢ + σⱼ M⁻¹ⱼ) F rᵢⱼ,
//!
//! so that Σ m v·dv/dt = −Σ V σ : G at every state. The forces of a pair are opposite. Their torque is Σ r ×
//! m dv/dt = −Σ Vᵢ (the antisymmetric part of σᵢ M⁻¹ᵢ Mᵢ = σᵢ), which is 0. So linear and angular momentum
//! are exact on any particles (Bonet & Lok 1999). Particles with all neighbours on one line have no gradient
//! and no stress.

use super::{
    Common, EquationOfState, In, JaumannRate, Kernel, Lane, Pair, Rate, Symmetric, Tensile, Term,
    Vector2,
    moments::{inverse, weights},
};

/// (11) with the gradient Gᵢ, in place of [`JaumannRate`]. Requires the density of
/// [`crate::ConsistentContinuity`].
#[derive(Clone, Copy, Debug)]
pub struct ConsistentJaumannRate(pub JaumannRate);

impl Term<Symmetric> for ConsistentJaumannRate {
    /// S.
    type Derived = Symmetric;
    /// ∇u and ∇v before correction \[1/s\], and M.
    type Sum = (<JaumannRate as Term<Symmetric>>::Sum, Symmetric);

    #[inline(always)]
    fn derived(&self, own: &Common, deviator: &Symmetric) -> Symmetric {
        self.0.derived(own, deviator)
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Symmetric>, sum: &mut In<Self::Sum, V>) {
        self.0.pair(pair, &mut sum.0);
        sum.1 = sum.1 + weights(pair).1;
    }

    #[inline(always)]
    fn finish(&self, own: &Common, s: Symmetric, sum: Self::Sum, rate: &mut Rate<Symmetric>) {
        let ((u, v), moments) = sum;
        if let Some(inverse) = inverse(moments) {
            self.0.finish(own, s, (inverse.times(u), inverse.times(v)), rate);
        }
    }
}

/// dvᵢ/dt = −(1/ρᵢ) Σⱼ Vⱼ (σᵢ M⁻¹ᵢ + σⱼ M⁻¹ⱼ + Rᵢⱼ φᵢⱼⁿ) F rᵢⱼ \[m/s²\] with (10) σ = −p δ + S, in place of
/// [`crate::CauchyStress`]. Artificial stress R ≠ () is as there, not conjugate to anything, and its torque
/// is not 0.
#[derive(Clone, Copy, Debug)]
pub struct ConjugateStress<E, R = ()> {
    /// Equation of state p(ρ).
    pub eos: E,
    /// `()`, [`crate::PrincipalStress`] or [`crate::ComponentStress`].
    pub tensile: R,
}

impl<E: EquationOfState, R: Tensile<Symmetric>> Term<Symmetric> for ConjugateStress<E, R> {
    /// The rows of σ M⁻¹ \[Pa\], and the derived data of the artificial stress.
    type Derived = ((Vector2<f64>, Vector2<f64>), R::Derived);
    type Sum = Vector2<f64>;
    const NORMALISES: bool = true;

    #[inline(always)]
    fn derived(&self, own: &Common, deviator: &Symmetric) -> Self::Derived {
        let p = self.eos.pressure(own.density);
        let stress = Symmetric::new(deviator.xx - p, deviator.yy - p, deviator.xy);
        let rows = (Vector2::new(stress.xx, stress.xy), Vector2::new(stress.xy, stress.yy));
        (rows, self.tensile.derived(stress))
    }

    #[inline(always)]
    fn set_inverse((rows, _): &mut Self::Derived, inverse: Symmetric) {
        *rows = (inverse.times(rows.0), inverse.times(rows.1));
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Self::Derived>, sum: &mut Vector2<V>) {
        let [(own, own_tension), (other, other_tension)] = pair.derived;
        let (r, x, y) = (pair.r, own.0 + other.0, own.1 + other.1);
        let stress = Vector2::new(x.x * r.x + x.y * r.y, y.x * r.x + y.y * r.y);
        let tensile = self.tensile.pair(&pair.with([own_tension, other_tension])).times(r);
        *sum -= (stress + tensile) * (pair.other.volume * pair.f);
    }

    #[inline(always)]
    fn finish(&self, own: &Common, _: Self::Derived, sum: Self::Sum, rate: &mut Rate<Symmetric>) {
        rate.velocity += sum / own.density;
    }
}
