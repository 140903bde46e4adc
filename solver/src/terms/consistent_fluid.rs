//! Terms of a fluid that are exact for linear fields (schemes of Negi & Ramachandran 2022).
//!
//! Momentum is not conserved: the forces of a pair are not opposite, and no force separates crowded
//! particles. These terms need [`super::Shifting`].

use super::{
    Common, EquationOfState, In, Kernel, Lane, Pair, Rate, Symmetric, Term, Vector2,
    moments::{inverse, weights},
};

/// Least trace of the moments: 2 inside a body of particles.
const LEAST_TRACE: f64 = 1e-3;

/// dvᵢ/dt += −∇p/ρᵢ \[m/s²\], in place of [`crate::Pressure`]; 0 where neighbours are on one line.
#[derive(Clone, Copy, Debug)]
pub struct ConsistentPressure<E> {
    /// Equation of state p(ρ).
    pub eos: E,
}

impl<X, E: EquationOfState> Term<X> for ConsistentPressure<E> {
    /// p \[Pa\].
    type Derived = f64;
    type Sum = (Vector2<f64>, Symmetric);

    #[inline(always)]
    fn derived(&self, own: &Common, _: &X) -> f64 {
        self.eos.pressure(own.density)
    }

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K, f64>, sum: &mut In<Self::Sum, V>) {
        let (weight, moments) = weights(pair);
        sum.0 += weight * (pair.derived[0] - pair.derived[1]);
        sum.1 = sum.1 + moments;
    }

    #[inline(always)]
    fn finish(&self, own: &Common, _: f64, sum: Self::Sum, rate: &mut Rate<X>) {
        if let Some(inverse) = inverse(sum.1) {
            rate.velocity -= inverse.times(sum.0) / own.density;
        }
    }
}

/// dvᵢ/dt += −(4ν/tr M) Σⱼ Vⱼ F (vᵢⱼ − (rᵢⱼ·∇)v) \[m/s²\], in place of [`crate::Viscosity`]: 0 for a linear
/// field on any particles, exact for a parabola where M is a multiple of the unit matrix, as on a lattice.
/// Where neighbours are on one line, the second part is omitted.
#[derive(Clone, Copy, Debug)]
pub struct ConsistentViscosity {
    /// Kinematic viscosity ν \[m²/s\].
    pub nu: f64,
}

impl<X> Term<X> for ConsistentViscosity {
    type Derived = ();
    /// Σ V F v, Σ V F r, Σ V F v x, Σ V F v y, M.
    type Sum = (Vector2<f64>, Vector2<f64>, Vector2<f64>, Vector2<f64>, Symmetric);

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut In<Self::Sum, V>) {
        let (weight, moments) = weights(pair);
        sum.0 += pair.v * (pair.other.volume * pair.f);
        sum.1 += weight;
        sum.2 += pair.v * weight.x;
        sum.3 += pair.v * weight.y;
        sum.4 = sum.4 + moments;
    }

    #[inline(always)]
    fn finish(&self, _: &Common, _: (), sum: Self::Sum, rate: &mut Rate<X>) {
        let (laplacian, weight, along_x, along_y, moments) = sum;
        let trace = moments.xx + moments.yy;
        let place = inverse(moments).map_or(Vector2::zeros(), |inverse| inverse.times(weight));
        let linear = along_x * place.x + along_y * place.y;
        if trace > LEAST_TRACE {
            rate.velocity -= (laplacian - linear) * (4.0 * self.nu / trace);
        }
    }
}

/// dρᵢ/dt += −ρᵢ ∇·v \[kg/m³/s\], in place of [`crate::Continuity`]; 0 where neighbours are on one line.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConsistentContinuity;

impl<X> Term<X> for ConsistentContinuity {
    type Derived = ();
    /// Σ V F v x, Σ V F v y, M.
    type Sum = (Vector2<f64>, Vector2<f64>, Symmetric);

    #[inline(always)]
    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut In<Self::Sum, V>) {
        let (weight, moments) = weights(pair);
        sum.0 += pair.v * weight.x;
        sum.1 += pair.v * weight.y;
        sum.2 = sum.2 + moments;
    }

    #[inline(always)]
    fn finish(&self, own: &Common, _: (), sum: Self::Sum, rate: &mut Rate<X>) {
        if let Some(inverse) = inverse(sum.2) {
            // The diagonal of the gradient, whose columns before correction are the sums.
            let xx = sum.0.x * inverse.xx + sum.1.x * inverse.xy;
            let yy = sum.0.y * inverse.xy + sum.1.y * inverse.yy;
            rate.density -= own.density * (xx + yy);
        }
    }
}
