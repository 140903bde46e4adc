use super::{Pair, Term};
use crate::{
    kernel::Kernel,
    lane::Lane,
    particles::{Common, Rate},
};

/// dρᵢ/dt += 2 δ h ⁰c Σⱼ Vⱼ F(dᵢⱼ) (ρⱼ − ρᵢ) \[kg/m³/s\] (Molteni & Colagrossi 2009).
///
/// Damps pressure noise at the scale of h and leaves the velocity alone. Not fit for a hydrostatic
/// column, whose density gradient it levels out.
#[derive(Clone, Copy, Debug)]
pub struct DensityDiffusion {
    /// δ h ⁰c \[m²/s\]; δ = 0.1 by custom.
    pub diffusivity: f64,
}

impl<X> Term<X> for DensityDiffusion {
    type Shows = ();
    type Sum = f64;

    #[inline(always)]
    fn shows(&self, _: &Common<f64>, _: &X) {}

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, _: (), _: (), sum: &mut V) {
        *sum += pair.other.volume * pair.f * (pair.other.density - pair.own.density);
    }

    #[inline(always)]
    fn finish(&self, _: &Common<f64>, _: Self::Shows, sum: f64, rate: &mut Rate<X>) {
        rate.density += 2.0 * self.diffusivity * sum;
    }
}
