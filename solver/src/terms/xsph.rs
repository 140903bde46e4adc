//! XSPH, (22): drᵢ/dt = vᵢ − ε Σⱼ 2 mⱼ vᵢⱼ/(ρᵢ + ρⱼ) Wᵢⱼ (Monaghan 1989).

use super::{Common, Kernel, Lane, Pair, Rate, Term, Vector2};

/// (22) drᵢ/dt = vᵢ − ε Σⱼ 2 mⱼ vᵢⱼ/(ρᵢ+ρⱼ) Wᵢⱼ \[m/s\], 0 ≤ ε < 1 (Monaghan 1989).
///
/// The sign of the scan is unreadable; this one moves a particle with its neighbours' mean.
#[derive(Clone, Copy, Debug)]
pub struct Xsph {
    /// ε \[-\].
    pub epsilon: f64,
}

impl<X> Term<X> for Xsph {
    type Derived = ();
    type Sum = Vector2<f64>;

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut Vector2<V>) {
        *sum += pair.v * (pair.other.mass * pair.w() / (pair.own.density + pair.other.density));
    }

    #[inline(always)]
    fn finish(&self, _: &Common, _: Self::Derived, sum: Self::Sum, rate: &mut Rate<X>) {
        rate.position -= sum * (2.0 * self.epsilon);
    }
}
