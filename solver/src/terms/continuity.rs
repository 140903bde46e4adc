//! Conservation of mass, (3): dρᵢ/dt = Σⱼ mⱼ vᵢⱼ·∇ᵢWᵢⱼ.

use super::{Common, Kernel, Lane, Pair, Rate, Term};

/// (3) dρᵢ/dt = Σⱼ mⱼ vᵢⱼ · ∇ᵢWᵢⱼ \[kg/m³/s\].
///
/// Exactly the time derivative of the density sum Σⱼ mⱼ Wᵢⱼ, so free surfaces need no special code.
#[derive(Clone, Copy, Debug, Default)]
pub struct Continuity;

impl<X> Term<X> for Continuity {
    type Derived = ();
    type Sum = f64;

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut V) {
        *sum += pair.other.mass * pair.f * pair.v_dot_r();
    }

    #[inline(always)]
    fn finish(&self, _: &Common, _: Self::Derived, sum: f64, rate: &mut Rate<X>) {
        rate.density -= sum;
    }
}
