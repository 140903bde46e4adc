use nalgebra::Vector2;

use super::{Pair, Term};
use crate::{
    kernel::Kernel,
    lane::Lane,
    particles::{Common, Rate},
};

/// (22) drᵢ/dt = vᵢ − ε Σⱼ 2 mⱼ vᵢⱼ/(ρᵢ+ρⱼ) Wᵢⱼ \[m/s\], 0 ≤ ε < 1 (Monaghan 1989).
///
/// The sign of the scan is unreadable; this one moves a particle with its neighbours' mean.
#[derive(Clone, Copy, Debug)]
pub struct Xsph {
    /// ε \[-\].
    pub epsilon: f64,
}

impl<X> Term<X> for Xsph {
    type Shows = ();
    type Sum = Vector2<f64>;

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, _: (), _: (), sum: &mut Vector2<V>) {
        *sum += pair.v * (pair.other.mass * pair.w() / (pair.own.density + pair.other.density));
    }

    #[inline(always)]
    fn finish(&self, _: &Common<f64>, _: Self::Shows, sum: Vector2<f64>, rate: &mut Rate<X>) {
        rate.position -= sum * (2.0 * self.epsilon);
    }
}
