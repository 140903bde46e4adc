//! Density diffusion: dρᵢ/dt += 2 δ h ⁰c Σⱼ Vⱼ F(dᵢⱼ) (ρⱼ − ρᵢ) (Molteni & Colagrossi 2009).

use super::{Common, Kernel, Lane, Numbers, Pair, Rate, Term, Vector2};
use crate::eos::Tait;

/// The state that [`DensityDiffusion`] leaves alone: `()`, a uniform density, or [`Hydrostatic`].
pub trait Rest: Copy + Send + Sync + 'static {
    /// Derived numbers of a particle.
    type Derived: Numbers;
    /// From the density of a particle \[kg/m³\].
    fn derived(&self, density: f64) -> Self::Derived;
    /// ρⱼ − ρᵢ beyond the difference at rest \[kg/m³\]; odd in the pair.
    fn excess<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Self::Derived>) -> V;
}

impl Rest for () {
    type Derived = ();
    #[inline(always)]
    fn derived(&self, _: f64) {}
    #[inline(always)]
    fn excess<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>) -> V {
        pair.other.density - pair.own.density
    }
}

/// A column of fluid at rest under gravity: (⁰ρ/⁰c²) \[w(ρⱼ) − w(ρᵢ) − g·(rⱼ − rᵢ)\] in place of
/// ρⱼ − ρᵢ, w the enthalpy of (7).
///
/// At rest ∇w = g, so the term is 0 for every pair of particles at any compression of the column. For ρ − ⁰ρ
/// ≪ ⁰ρ it is the hydrostatic correction of Fourtakas et al. 2019. Where pressure does not balance g, as in
/// free fall, the term still drives the density to a hydrostatic profile.
#[derive(Clone, Copy, Debug)]
pub struct Hydrostatic {
    /// Gives w(ρ).
    pub eos: Tait,
    /// g \[m/s²\].
    pub gravity: Vector2<f64>,
}

impl Rest for Hydrostatic {
    /// w(ρ) \[J/kg\].
    type Derived = f64;
    #[inline(always)]
    fn derived(&self, density: f64) -> f64 {
        self.eos.enthalpy(density)
    }
    #[inline(always)]
    fn excess<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, f64>) -> V {
        let (Self { eos, gravity }, [own, other]) = (self, pair.derived);
        let fall = V::all(gravity.x) * pair.r.x + V::all(gravity.y) * pair.r.y;
        V::all(eos.density / (eos.sound_speed * eos.sound_speed)) * (other - own + fall)
    }
}

/// dρᵢ/dt += 2 δ h ⁰c Σⱼ Vⱼ F(dᵢⱼ) (ρⱼ − ρᵢ) \[kg/m³/s\] (Molteni & Colagrossi 2009).
///
/// Damps pressure noise at the scale of h and does not change the velocity. With `R` = `()` it levels out the
/// density of a hydrostatic column; with [`Hydrostatic`] it keeps the column.
#[derive(Clone, Copy, Debug)]
pub struct DensityDiffusion<R = ()> {
    /// δ h ⁰c \[m²/s\]; δ = 0.1 by custom.
    pub diffusivity: f64,
    /// The state of rest, on which the term is 0.
    pub rest: R,
}

impl DensityDiffusion {
    /// Towards a uniform density, with δ h ⁰c \[m²/s\].
    pub fn new(diffusivity: f64) -> Self {
        Self { diffusivity, rest: () }
    }
}

impl<X, R: Rest> Term<X> for DensityDiffusion<R> {
    type Derived = R::Derived;
    type Sum = f64;

    #[inline(always)]
    fn derived(&self, own: &Common, _: &X) -> R::Derived {
        self.rest.derived(own.density)
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Self::Derived>, sum: &mut V) {
        *sum += pair.other.volume * pair.f * self.rest.excess(pair);
    }

    #[inline(always)]
    fn finish(&self, _: &Common, _: Self::Derived, sum: f64, rate: &mut Rate<X>) {
        rate.density += 2.0 * self.diffusivity * sum;
    }
}
