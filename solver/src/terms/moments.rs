//! Moments, by which gradients become exact for linear fields wherever the particles are: the gradient of a
//! field f is ∇f = M⁻¹ Σⱼ Vⱼ (fᵢ − fⱼ) F rᵢⱼ with the moments M = Σⱼ Vⱼ rᵢⱼ ⊗ F rᵢⱼ of the particle's own
//! neighbours, the unit matrix in the continuum (Bonet & Lok 1999).

use super::{Kernel, Lane, Numbers, Pair, PairSum, Symmetric, Vector2};
use crate::{
    inverse::{LEAST_DETERMINANT, of_symmetric},
    particles::SweptParticle,
};

/// Vⱼ F rᵢⱼ \[1/m\], and its share of the moments.
#[inline(always)]
pub fn weights<V: Lane, K: Kernel, D: Numbers>(pair: &Pair<V, K, D>) -> (Vector2<V>, Symmetric<V>) {
    let weight = pair.r * (pair.other.volume * pair.f);
    let (xx, yy, xy) = (pair.r.x * weight.x, pair.r.y * weight.y, pair.r.x * weight.y);
    (weight, Symmetric { xx, yy, xy })
}

/// M⁻¹, `None` where there are too few neighbours for a gradient.
#[inline(always)]
pub fn inverse(moments: Symmetric) -> Option<Symmetric> {
    of_symmetric(moments).above(LEAST_DETERMINANT)
}

/// Sums M⁻¹ of each particle, 0 where there are too few neighbours: for [`Term::set_inverse`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct InverseMoments;

impl<S> PairSum<S, Symmetric> for InverseMoments {
    type Derived = ();
    type Sum = Symmetric;

    #[inline(always)]
    fn read(&self, _: usize, _: &S) {}

    #[inline(always)]
    fn add<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut Symmetric<V>) {
        *sum = *sum + weights(pair).1;
    }

    #[inline(always)]
    fn result(&self, _: &SweptParticle<S>, sum: Symmetric) -> Symmetric {
        inverse(sum).unwrap_or_default()
    }
}
