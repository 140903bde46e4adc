use std::marker::PhantomData;

use super::{Common, EquationOfState, Kernel, Lane, Pair, Rate, Term, Vector2};

/// Which pairs artificial viscosity acts on.
pub trait Switch: Copy + Send + Sync + 'static {
    /// vᵢⱼ·rᵢⱼ, or 0 where the pair is left alone.
    fn admit<V: Lane>(vr: V) -> V;
}

/// The seed's switch (17): pairs that approach, vᵢⱼ·rᵢⱼ < 0.
#[derive(Clone, Copy, Debug)]
pub struct Approaching;

/// Every pair: odd in v, and with β = 0 linear, so that its symbol and its time-step limit are exact.
#[derive(Clone, Copy, Debug)]
pub struct Always;

impl Switch for Approaching {
    #[inline(always)]
    fn admit<V: Lane>(vr: V) -> V {
        -(-vr).positive()
    }
}

impl Switch for Always {
    #[inline(always)]
    fn admit<V: Lane>(vr: V) -> V {
        vr
    }
}

/// −Σⱼ mⱼ Πᵢⱼ ∇ᵢWᵢⱼ \[m/s²\] of (14), (15), with
///
/// (16) Πᵢⱼ = −ζ₁ (cᵢ+cⱼ)(hᵢ+hⱼ)/\[2(ρᵢ+ρⱼ)\] ψᵢⱼ + ζ₂ (hᵢ+hⱼ)²/\[2(ρᵢ+ρⱼ)\] ψᵢⱼ²,
/// (17) ψᵢⱼ = vᵢⱼ·rᵢⱼ/(dᵢⱼ² + η²) where vᵢⱼ·rᵢⱼ < 0, else 0; η² = 0.01 h² (inferred).
///
/// Identical to Monaghan's form with α = ζ₁, β = ζ₂. Central, so it conserves angular momentum.
#[derive(Clone, Copy, Debug)]
pub struct ArtificialViscosity<E, S = Approaching> {
    /// ζ₁ = α \[-\].
    pub alpha: f64,
    /// ζ₂ = β \[-\].
    pub beta: f64,
    /// η² \[m²\], above 0.
    pub eta2: f64,
    /// Gives c(ρ).
    pub eos: E,
    /// The pairs it acts on.
    pub switch: PhantomData<S>,
}

impl<E, S> ArtificialViscosity<E, S> {
    /// α, β, the smoothing length \[m\] for η² = 0.01 h², and the equation of state.
    pub fn new(alpha: f64, beta: f64, h: f64, eos: E) -> Self {
        Self { alpha, beta, eta2: 0.01 * h * h, eos, switch: PhantomData }
    }
}

impl<X, E: EquationOfState, S: Switch> Term<X> for ArtificialViscosity<E, S> {
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
        let mu = h * S::admit(pair.v_dot_r()) * (density * inverse);
        let [own, other] = pair.derived;
        let c = self.eos.speed_of(own) + self.eos.speed_of(other);
        // |μ|, not μ: for a pair that recedes under `Always`, +β μ² would push it on.
        let quadratic = V::all(-2.0 * self.beta) * mu.abs();
        let pi = mu * (quadratic - V::all(self.alpha) * c) * (distance2 * inverse);
        *sum += pair.r * (pair.other.mass * pair.f * pi);
    }

    #[inline(always)]
    fn finish(&self, _: &Common, _: Self::Derived, sum: Self::Sum, rate: &mut Rate<X>) {
        rate.velocity += sum;
    }
}
