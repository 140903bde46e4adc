//! Artificial stress (20), R = −ξ σ/ρ² in tension: in principal axes (Gray et al. 2001) or by component.

use std::marker::PhantomData;

use super::{Kernel, Lane, Pair, Symmetric, Tensile};

/// The tensile part of a stress, in the axes in which (20) tests for tension.
pub trait Axes: Copy + Send + Sync + 'static {
    /// σ where in tension, 0 where in compression, in any unit.
    fn tension(stress: Symmetric) -> Symmetric;
}

/// Principal axes (Gray, Monaghan & Swift 2001): R has the axes of σ. Frame-invariant.
#[derive(Clone, Copy, Debug)]
pub struct Principal;

/// Component by component, as the paper writes (20): where σᵃᵇ > 0. Not frame-invariant.
#[derive(Clone, Copy, Debug)]
pub struct Componentwise;

impl Axes for Principal {
    #[inline(always)]
    fn tension(stress: Symmetric) -> Symmetric {
        // σ = m + r D with D = [[cos 2θ, sin 2θ], [sin 2θ, -cos 2θ]] has the eigenvalues m ± r.
        let (m, d) = (0.5 * (stress.xx + stress.yy), 0.5 * (stress.xx - stress.yy));
        let r = (d * d + stress.xy * stress.xy).sqrt();
        let (high, low) = ((m + r).max(0.0), (m - r).max(0.0));
        let mean = 0.5 * (high + low);
        let along = if r > 0.0 { 0.5 * (high - low) / r } else { 0.0 };
        Symmetric { xx: mean + along * d, yy: mean - along * d, xy: along * stress.xy }
    }
}

impl Axes for Componentwise {
    #[inline(always)]
    fn tension(stress: Symmetric) -> Symmetric {
        Symmetric { xx: stress.xx.max(0.0), yy: stress.yy.max(0.0), xy: stress.xy.max(0.0) }
    }
}

/// (20) R = −ξ σ/ρ² where σ is in tension in the axes `A`, else 0; (18) φᵢⱼ = W(dᵢⱼ)/W(⁰r).
#[derive(Clone, Copy, Debug)]
pub struct InTension<A> {
    xi: f64,
    n: u32,
    inverse_w: f64,
    axes: PhantomData<A>,
}

/// (20) in principal axes.
pub type PrincipalStress = InTension<Principal>;

/// (20) component by component.
pub type ComponentStress = InTension<Componentwise>;

impl<A> InTension<A> {
    /// Strength ξ, exponent n, and W at the initial spacing \[1/m²\].
    pub fn new(xi: f64, n: u32, w_at_spacing: f64) -> Self {
        Self { xi, n, inverse_w: 1.0 / w_at_spacing, axes: PhantomData }
    }
}

impl<A: Axes> Tensile<Symmetric> for InTension<A> {
    type Derived = Symmetric;

    #[inline(always)]
    fn derived(&self, stress: Symmetric) -> Symmetric {
        A::tension(stress) * -self.xi
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, Symmetric>) -> Symmetric<V> {
        let [own, other] = pair.derived;
        let phi = pair.w() * V::all(self.inverse_w);
        (own + other) * (0..self.n).fold(V::all(1.0), |product, _| product * phi)
    }
}
