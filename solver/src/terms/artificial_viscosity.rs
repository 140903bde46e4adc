//! Artificial viscosity, (14) to (17): −Σⱼ mⱼ Πᵢⱼ ∇ᵢWᵢⱼ between approaching particles (Monaghan 1992).

use super::{Common, EquationOfState, Kernel, Lane, Pair, Rate, Term, Vector2};

/// −Σⱼ mⱼ Πᵢⱼ ∇ᵢWᵢⱼ \[m/s²\] of (14), (15), with
///
/// (16) Πᵢⱼ = −ζ₁ (cᵢ+cⱼ)(hᵢ+hⱼ)/\[2(ρᵢ+ρⱼ)\] ψᵢⱼ + ζ₂ (hᵢ+hⱼ)²/\[2(ρᵢ+ρⱼ)\] ψᵢⱼ²,
/// (17) ψᵢⱼ = vᵢⱼ·rᵢⱼ/(dᵢⱼ² + η²) where vᵢⱼ·rᵢⱼ < 0, else 0; η² = 0.01 h² (inferred).
///
/// Identical to Monaghan's form with α = ζ₁, β = ζ₂. Central, so angular momentum is conserved. With `ALWAYS`
/// ψ acts also on particles that recede from each other: odd in v, and linear for β = 0, so that its symbol
/// and its time-step limit are exact.
#[derive(Clone, Copy, Debug)]
pub struct ArtificialViscosity<E, const ALWAYS: bool = false> {
    /// ζ₁ = α \[-\].
    pub alpha: f64,
    /// ζ₂ = β \[-\].
    pub beta: f64,
    /// η² \[m²\], above 0.
    pub eta2: f64,
    /// Gives c(ρ).
    pub eos: E,
}

impl<E, const ALWAYS: bool> ArtificialViscosity<E, ALWAYS> {
    /// α, β, the smoothing length \[m\] for η² = 0.01 h², and the equation of state.
    pub fn new(alpha: f64, beta: f64, h: f64, eos: E) -> Self {
        Self { alpha, beta, eta2: 0.01 * h * h, eos }
    }
}

impl<X, E: EquationOfState, const ALWAYS: bool> Term<X> for ArtificialViscosity<E, ALWAYS> {
    type Derived = E::Sound;
    type Sum = Vector2<f64>;

    #[inline(always)]
    fn derived(&self, own: &Common, _: &X) -> E::Sound {
        self.eos.sound(own.density)
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Self::Derived>, sum: &mut Vector2<V>) {
        let h = V::all(pair.kernel.h());
        let (distance2, density) =
            (pair.r2 + V::all(self.eta2), pair.own.density + pair.other.density);
        // One division for both quotients.
        let inverse = V::all(1.0) / (distance2 * density);
        let approach = pair.v_dot_r();
        let approach = if ALWAYS { approach } else { -(-approach).positive() };
        let mu = h * approach * (density * inverse);
        let [own, other] = pair.derived;
        let c = self.eos.speed_of(own) + self.eos.speed_of(other);
        // |μ|, not μ: for a pair that recedes, +β μ² would push it on.
        let quadratic = V::all(-2.0 * self.beta) * mu.abs();
        let pi = mu * (quadratic - V::all(self.alpha) * c) * (distance2 * inverse);
        *sum += pair.r * (pair.other.mass * pair.f * pi);
    }

    #[inline(always)]
    fn finish(&self, _: &Common, _: Self::Derived, sum: Self::Sum, rate: &mut Rate<X>) {
        rate.velocity += sum;
    }
}
