//! Moments, by which gradients become exact for linear fields wherever the particles are: the gradient of a
//! field f is ∇f = M⁻¹ Σⱼ Vⱼ (fᵢ − fⱼ) F rᵢⱼ with the moments M = Σⱼ Vⱼ rᵢⱼ ⊗ F rᵢⱼ of the particle's own
//! neighbours, the unit matrix in the continuum (Bonet & Lok 1999).

use nalgebra::Matrix3;

use super::{Common, Kernel, Lane, Numbers, Pair, Rate, Symmetric, Term, Vector2};

/// Least determinant of the moments: 1 inside a body of particles, 0 on a line.
const SINGULAR: f64 = 1e-3;

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
    let Symmetric { xx, yy, xy } = moments;
    let determinant = xx * yy - xy * xy;
    let inverse = || Symmetric::new(yy / determinant, xx / determinant, -xy / determinant);
    (determinant > SINGULAR).then(inverse)
}

/// Determinant and inverse of three by three numbers, for each size has a function of its own: that of
/// nalgebra is compiled with what inverts any size.
#[inline]
pub fn inverse_of_three(m: &Matrix3<f64>) -> (f64, Matrix3<f64>) {
    let [[a, d, g], [b, e, h], [c, f, i]] = m.data.0;
    let adjugate = [
        [e * i - h * f, g * f - d * i, d * h - g * e],
        [c * h - i * b, a * i - g * c, b * g - h * a],
        [b * f - e * c, c * d - f * a, a * e - d * b],
    ];
    let determinant = a * adjugate[0][0] + b * adjugate[0][1] + c * adjugate[0][2];
    (determinant, Matrix3::from(adjugate).map(|x| x / determinant))
}

/// M⁻¹ in the place of the rate of extra fields, 0 where there are too few neighbours: what
/// [`super::News::Inverse`] holds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InverseMoments;

impl Term<Symmetric> for InverseMoments {
    type Derived = ();
    type Sum = Symmetric;

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut Symmetric<V>) {
        *sum = *sum + weights(pair).1;
    }

    #[inline(always)]
    fn finish(&self, _: &Common, _: (), sum: Symmetric, rate: &mut Rate<Symmetric>) {
        rate.extra = inverse(sum).unwrap_or_default();
    }
}
