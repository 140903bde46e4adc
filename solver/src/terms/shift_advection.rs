//! Advection of the velocity by particle shifting: dvᵢ/dt += (δuᵢ·∇)v (Sun et al. 2019).

use super::moments::{inverse, weights};
use super::{Common, In, Kernel, Lane, Pair, Rate, Shifting, Symmetric, Term, Vector2};

/// The change of velocity that belongs to shifting: dvᵢ/dt += (δuᵢ·∇)v \[m/s²\], δu the velocity of
/// [`Shifting`].
///
/// A particle shifted by δu carries its velocity to a place with another fluid velocity; with this term it
/// takes the velocity of its new place (quasi-Lagrangian form, Sun et al. 2019). The gradient is ∇v = [Σⱼ Vⱼ
/// vᵢⱼ ⊗ F rᵢⱼ] [Σⱼ Vⱼ rᵢⱼ ⊗ F rᵢⱼ]⁻¹, exact for a linear field on any particles, and 0 where neighbours are
/// on one line. A term of the forces, used with an equal [`Shifting`] in the drift. Momentum is not conserved
/// exactly.
#[derive(Clone, Copy, Debug)]
pub struct ShiftAdvection(pub Shifting);

impl<X> Term<X> for ShiftAdvection {
    type Derived = ();
    /// Σ of the shift, Σ Vⱼ vᵢⱼ F x, Σ Vⱼ vᵢⱼ F y, Σ Vⱼ rᵢⱼ ⊗ F rᵢⱼ.
    type Sum = (Vector2<f64>, Vector2<f64>, Vector2<f64>, Symmetric);

    fn prepare(&mut self, max_speed: f64) {
        <Shifting as Term<X>>::prepare(&mut self.0, max_speed);
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut In<Self::Sum, V>) {
        let (weight, moments) = weights(pair);
        sum.0 += self.0.push(pair);
        sum.1 += pair.v * weight.x;
        sum.2 += pair.v * weight.y;
        sum.3 = sum.3 + moments;
    }

    #[inline(always)]
    fn finish(&self, _: &Common, _: (), sum: Self::Sum, rate: &mut Rate<X>) {
        let (push, along_x, along_y, moments) = sum;
        if let Some(inverse) = inverse(moments) {
            let moved = inverse.times(self.0.velocity(push));
            rate.velocity += along_x * moved.x + along_y * moved.y;
        }
    }
}
