//! Jaumann rate of the deviatoric stress of a hypoelastic solid, (11): dS/dt = 2μ dev ε + S Ωᵀ + Ω S.

use super::{Common, In, Kernel, Lane, Pair, Rate, Symmetric, Term, Vector2};

/// (11) dSᵃᵇ/dt = 2μ (εᵃᵇ − δᵃᵇ εᶜᶜ/3) + Sᵃᶜ Ωᵇᶜ + Ωᵃᶜ Sᶜᵇ \[Pa/s\], with ε and Ω the symmetric and the
/// antisymmetric part of ∂ᵇvᵃ = Σⱼ (mⱼ/ρⱼ)(vⱼᵃ − vᵢᵃ) ∂Wᵢⱼ/∂xᵢᵇ.
///
/// The 1/3 is for plane strain: Sᶻᶻ = −(Sˣˣ + Sʸʸ) is implied.
#[derive(Clone, Copy, Debug)]
pub struct JaumannRate {
    /// μ \[Pa\].
    pub shear_modulus: f64,
}

impl Term<Symmetric> for JaumannRate {
    /// S, for the particle's own rotation; neighbours do not use it.
    type Derived = Symmetric;
    /// ∇u and ∇v \[1/s\].
    type Sum = (Vector2<f64>, Vector2<f64>);

    #[inline(always)]
    fn derived(&self, _: &Common, deviator: &Symmetric) -> Symmetric {
        *deviator
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Symmetric>, sum: &mut In<Self::Sum, V>) {
        let gradient = pair.r * (pair.other.volume * pair.f);
        sum.0 += gradient * pair.v.x;
        sum.1 += gradient * pair.v.y;
    }

    #[inline(always)]
    fn finish(&self, _: &Common, s: Symmetric, (u, v): Self::Sum, rate: &mut Rate<Symmetric>) {
        let (two_mu, mean) = (2.0 * self.shear_modulus, (u.x + v.y) / 3.0);
        let spin = 0.5 * (u.y - v.x);
        rate.extra.xx += two_mu * (u.x - mean) + 2.0 * spin * s.xy;
        rate.extra.yy += two_mu * (v.y - mean) - 2.0 * spin * s.xy;
        rate.extra.xy += two_mu * 0.5 * (u.y + v.x) + spin * (s.yy - s.xx);
    }
}
