//! Particle shifting: drᵢ/dt −= A v_max h Σⱼ Vⱼ \[1 + 0.2 (Wᵢⱼ/W(⁰r))⁴\] ∇ᵢWᵢⱼ (Lind et al. 2012).

use super::{Common, Kernel, Lane, Pair, Rate, Term, Vector2};

/// Particle shifting: drᵢ/dt −= A v_max h Σⱼ Vⱼ \[1 + 0.2 (Wᵢⱼ/W(⁰r))⁴\] ∇ᵢWᵢⱼ \[m/s\].
///
/// A correction between steps: moves particles from crowded to sparse places without changing velocity or
/// density (Lind et al. 2012; the bracket, Monaghan 2000, keeps pairs apart). It is 0 on a perfect lattice. A
/// term of the drift, so it needs no pair sweep of its own.
#[derive(Clone, Copy, Debug)]
pub struct Shifting {
    amplitude: f64,
    h: f64,
    inverse_w: f64,
    max_speed: f64,
}

impl Shifting {
    /// Amplitude A \[-\] (0.5 by default elsewhere), h \[m\], and W at the initial spacing \[1/m²\].
    pub fn new(amplitude: f64, h: f64, w_at_spacing: f64) -> Self {
        Self { amplitude, h, inverse_w: 1.0 / w_at_spacing, max_speed: 0.0 }
    }

    /// −Vⱼ \[1 + 0.2 (Wᵢⱼ/W(⁰r))⁴\] ∇ᵢWᵢⱼ \[1/m\].
    #[inline(always)]
    pub(super) fn push<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>) -> Vector2<V> {
        let phi = pair.w() * V::all(self.inverse_w);
        let phi2 = phi * phi;
        let bracket = V::all(1.0) + V::all(0.2) * phi2 * phi2;
        pair.r * (pair.other.volume * pair.f * bracket)
    }

    /// The velocity of the shift \[m/s\] from the sum of the pushes.
    #[inline(always)]
    pub(super) fn velocity(&self, sum: Vector2<f64>) -> Vector2<f64> {
        sum * (self.amplitude * self.max_speed * self.h)
    }
}

impl<X> Term<X> for Shifting {
    type Derived = ();
    type Sum = Vector2<f64>;

    fn prepare(&mut self, max_speed: f64) {
        self.max_speed = max_speed;
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut Vector2<V>) {
        *sum += self.push(pair);
    }

    #[inline(always)]
    fn finish(&self, _: &Common, _: Self::Derived, sum: Self::Sum, rate: &mut Rate<X>) {
        rate.position += self.velocity(sum);
    }
}
