//! Laminar viscosity, (6): dvᵢ/dt = 2μ Σⱼ mⱼ/(ρᵢρⱼ) \[rᵢⱼ·∇ᵢWᵢⱼ/(dᵢⱼ² + η²)\] vᵢⱼ (Morris, Fox & Zhu 1997).

use super::{Common, Kernel, Lane, Pair, Rate, Term, Vector2};

/// (6) Vᵢ = 2μ Σⱼ mⱼ/(ρᵢρⱼ) \[rᵢⱼ·∇ᵢWᵢⱼ/(dᵢⱼ² + η²)\] vᵢⱼ \[m/s²\] (Morris, Fox & Zhu 1997).
///
/// Conserves linear, not exactly angular, momentum. On a lattice η² = 0.01 h², the seed's value,
/// lowers the effective viscosity by 0.6–1.3 %; as a guard against 0/0 alone 1e-6 h² is enough.
#[derive(Clone, Copy, Debug)]
pub struct Viscosity {
    /// Dynamic viscosity μ \[Pa s\].
    pub mu: f64,
    /// η² \[m²\], above 0.
    pub eta2: f64,
}

impl<X> Term<X> for Viscosity {
    type Derived = ();
    type Sum = Vector2<f64>;

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut Vector2<V>) {
        let weight = pair.other.volume * pair.f * (pair.r2 / (pair.r2 + V::all(self.eta2)));
        *sum += pair.v * weight;
    }

    #[inline(always)]
    fn finish(&self, own: &Common, _: Self::Derived, sum: Vector2<f64>, rate: &mut Rate<X>) {
        rate.velocity -= sum * (2.0 * self.mu / own.density);
    }
}
