//! A new term in one file: a viscosity along the line of centres.

use nalgebra::Vector2;
use touchstone_solver::{Kernel, Rate, Term, lane::Lane, particles::Common, terms::Pair};

/// dvᵢ/dt += 8ν Σⱼ Vⱼ [vᵢⱼ·rᵢⱼ/(dᵢⱼ² + η²)] ∇ᵢWᵢⱼ \[m/s²\] (Monaghan & Gingold 1983).
///
/// Acts along the line of centres, so it conserves angular momentum too.
#[derive(Clone, Copy, Debug)]
pub struct CentralViscosity {
    /// Kinematic viscosity ν \[m²/s\].
    pub nu: f64,
    /// η² \[m²\], above 0.
    pub eta2: f64,
}

impl<X> Term<X> for CentralViscosity {
    type Derived = (); // what neighbours read beyond mass, density, volume: nothing
    type Sum = Vector2<f64>; // what a particle sums over its neighbours

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut Vector2<V>) {
        let along = pair.v_dot_r() / (pair.r2 + V::all(self.eta2));
        *sum += pair.r * (pair.other.volume * pair.f * along);
    }

    #[inline(always)]
    fn finish(&self, _: &Common, _: (), sum: Vector2<f64>, rate: &mut Rate<X>) {
        rate.velocity -= sum * (8.0 * self.nu); // minus: ∇ᵢWᵢⱼ = −F rᵢⱼ
    }
}
