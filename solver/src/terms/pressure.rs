//! Pressure gradient, (5): dvᵢ/dt = −Σⱼ mⱼ (pᵢ/ρᵢ² + pⱼ/ρⱼ²) ∇ᵢWᵢⱼ.

use super::{Common, EquationOfState, Kernel, Lane, Pair, Rate, Tensile, Term, Vector2};

/// (5) Pᵢ = −Σⱼ mⱼ (pᵢ/ρᵢ² + pⱼ/ρⱼ²) ∇ᵢWᵢⱼ \[m/s²\], and (14) with R ≠ ().
///
/// The form with p/ρ² is the one whose work balances the compression energy of (3) exactly.
/// `R` is the artificial stress (18), (19), which acts only through this term.
#[derive(Clone, Copy, Debug)]
pub struct Pressure<E, R = ()> {
    /// Equation of state p(ρ).
    pub eos: E,
    /// `()` or [`ArtificialStress`](super::ArtificialStress).
    pub tensile: R,
}

impl<E> Pressure<E> {
    /// The pressure term (5) without artificial stress.
    pub fn new(eos: E) -> Self {
        Self { eos, tensile: () }
    }
}

impl<X, E: EquationOfState, R: Tensile<f64>> Term<X> for Pressure<E, R> {
    /// p/ρ² \[m⁵/(kg s²)\] and the derived data of the artificial stress.
    type Derived = (f64, R::Derived);
    type Sum = Vector2<f64>;

    #[inline(always)]
    fn derived(&self, own: &Common, _: &X) -> Self::Derived {
        let p = self.eos.pressure(own.density) / (own.density * own.density);
        (p, self.tensile.derived(p))
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Self::Derived>, sum: &mut Vector2<V>) {
        let [own, other] = pair.derived;
        let stress = own.0 + other.0 + self.tensile.pair(&pair.with([own.1, other.1]));
        *sum += pair.r * (pair.other.mass * pair.f * stress);
    }

    #[inline(always)]
    fn finish(&self, _: &Common, _: Self::Derived, sum: Self::Sum, rate: &mut Rate<X>) {
        rate.velocity += sum;
    }
}
