//! Smoothing kernels: W(r, h) and the factor F = -W'(r)/r in two dimensions.
//!
//! A kernel is a shape w(q) with q = r/h, compact support and a norm N such that
//!
//! W(r) = N w(q) / h²  \[1/m²\],  F(r) = -W'(r)/r = N s(q) / h⁴  \[1/m⁴\],  s(q) = -w'(q)/q.
//!
//! All pair terms need ∇ᵢWᵢⱼ = -F rᵢⱼ only, so no term uses W' or a division by r.

use std::marker::PhantomData;

use crate::lane::Lane;

/// The dimensionless shape of a kernel.
pub trait Kernel: Copy + Default + Send + Sync + 'static {
    /// The name in settings and reports.
    const NAME: &'static str;
    /// Radius of the support \[h\].
    const SUPPORT: f64;
    /// N in two dimensions.
    const NORM: f64;

    /// w(q), 0 beyond the support.
    fn shape<V: Lane>(q: V) -> V;
    /// s(q) = -w'(q)/q, finite at q = 0 and 0 beyond the support.
    fn slope<V: Lane>(q: V) -> V;
}

/// Cubic B-spline M4 of the seed paper, support 2h (Monaghan & Lattanzio 1985).
#[derive(Clone, Copy, Debug, Default)]
pub struct CubicSpline;

/// Quintic B-spline M6, support 3h (Morris, Fox & Zhu 1997).
#[derive(Clone, Copy, Debug, Default)]
pub struct QuinticSpline;

/// Wendland's C2 function, support 2h: no pairing instability (Dehnen & Aly 2012).
#[derive(Clone, Copy, Debug, Default)]
pub struct WendlandC2;

/// Keeps q away from 0 in s(q) = -w'(q)/q. Coincident particles then have a finite F and, because
/// rᵢⱼ = 0, no force.
const TINY: f64 = 1e-9;

/// (n − q)₊.
#[inline(always)]
fn below<V: Lane>(n: f64, q: V) -> V {
    (V::all(n) - q).positive()
}

/// x⁴.
#[inline(always)]
fn fourth<V: Lane>(x: V) -> V {
    let square = x * x;
    square * square
}

impl Kernel for CubicSpline {
    const NAME: &'static str = "cubic";
    const SUPPORT: f64 = 2.0;
    const NORM: f64 = 10.0 / (7.0 * std::f64::consts::PI);

    #[inline(always)]
    fn shape<V: Lane>(q: V) -> V {
        let (a, b) = (below(2.0, q), below(1.0, q));
        V::all(0.25) * a * a * a - b * b * b
    }

    #[inline(always)]
    fn slope<V: Lane>(q: V) -> V {
        let q = q.at_least(V::all(TINY));
        let (a, b) = (below(2.0, q), below(1.0, q));
        (V::all(0.75) * a * a - V::all(3.0) * b * b) / q
    }
}

impl Kernel for QuinticSpline {
    const NAME: &'static str = "quintic";
    const SUPPORT: f64 = 3.0;
    const NORM: f64 = 7.0 / (478.0 * std::f64::consts::PI);

    #[inline(always)]
    fn shape<V: Lane>(q: V) -> V {
        let (a, b, c) = (below(3.0, q), below(2.0, q), below(1.0, q));
        a * fourth(a) - V::all(6.0) * b * fourth(b) + V::all(15.0) * c * fourth(c)
    }

    #[inline(always)]
    fn slope<V: Lane>(q: V) -> V {
        let q = q.at_least(V::all(TINY));
        let (a, b, c) = (below(3.0, q), below(2.0, q), below(1.0, q));
        (V::all(5.0) * fourth(a) - V::all(30.0) * fourth(b) + V::all(75.0) * fourth(c)) / q
    }
}

impl Kernel for WendlandC2 {
    const NAME: &'static str = "wendland-c2";
    const SUPPORT: f64 = 2.0;
    const NORM: f64 = 7.0 / (4.0 * std::f64::consts::PI);

    #[inline(always)]
    fn shape<V: Lane>(q: V) -> V {
        let a = (V::all(1.0) - V::all(0.5) * q).positive();
        (a * a) * (a * a) * (V::all(2.0) * q + V::all(1.0))
    }

    #[inline(always)]
    fn slope<V: Lane>(q: V) -> V {
        let a = (V::all(1.0) - V::all(0.5) * q).positive();
        V::all(5.0) * a * a * a
    }
}

/// A kernel with its smoothing length.
#[derive(Clone, Copy, Debug)]
pub struct Smoothing<K> {
    h: f64,
    inv_h: f64,
    w_factor: f64,
    f_factor: f64,
    kernel: PhantomData<K>,
}

impl<K: Kernel> Smoothing<K> {
    /// The kernel `K` with smoothing length `h` \[m\], which [`crate::Scene`] checks.
    pub fn new(h: f64) -> Self {
        let inv_h = 1.0 / h;
        let w_factor = K::NORM * inv_h * inv_h;
        Self { h, inv_h, w_factor, f_factor: w_factor * inv_h * inv_h, kernel: PhantomData }
    }

    /// Smoothing length h \[m\].
    pub fn h(&self) -> f64 {
        self.h
    }

    /// Radius beyond which W and F are 0 \[m\].
    pub fn support(&self) -> f64 {
        K::SUPPORT * self.h
    }

    /// W(r) \[1/m²\] from r² \[m²\].
    #[inline(always)]
    pub fn w<V: Lane>(&self, r2: V) -> V {
        K::shape(r2.sqrt() * V::all(self.inv_h)) * V::all(self.w_factor)
    }

    /// F(r) = -W'(r)/r \[1/m⁴\] from r² \[m²\].
    #[inline(always)]
    pub fn f<V: Lane>(&self, r2: V) -> V {
        K::slope(r2.sqrt() * V::all(self.inv_h)) * V::all(self.f_factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::{PerParticle, Portable, total};
    use approx::assert_relative_eq;

    fn radii(support: f64) -> impl Iterator<Item = f64> {
        (0..200).map(move |k| (k as f64 + 0.5) / 200.0 * support)
    }

    /// Over 200 q: F against a central difference of W, and the lanes against the scalar.
    fn check_gradient<K: Kernel>() {
        let kernel = Smoothing::<K>::new(0.7);
        for r in radii(kernel.support()) {
            let d = 1e-5;
            let slope = (kernel.w((r + d) * (r + d)) - kernel.w((r - d) * (r - d))) / (2.0 * d);
            let scale = kernel.w(0.0) / kernel.h();
            assert!((kernel.f(r * r) * r + slope).abs() < 2e-9 * scale, "{} at r = {r}", K::NAME);
            let four = Portable::all(r * r);
            assert_eq!(total(kernel.f(four)), 4.0 * kernel.f(r * r));
            assert_eq!(total(kernel.w(four)), 4.0 * kernel.w(r * r));
        }
    }

    /// ∫ W dA = 1 by Simpson's rule, and the moment of the gradient, ∫ F x² dA = 1.
    fn check_normalisation<K: Kernel>() {
        let kernel = Smoothing::<K>::new(1.3);
        let (n, two_pi) = (6000, 2.0 * std::f64::consts::PI);
        let dr = kernel.support() / n as f64;
        let (mut volume, mut moment) = (0.0, 0.0);
        for k in 0..=n {
            let weight = if k == 0 || k == n { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 };
            let r = k as f64 * dr;
            volume += weight * dr / 3.0 * two_pi * r * kernel.w(r * r);
            moment += weight * dr / 3.0 * two_pi / 2.0 * r * r * r * kernel.f(r * r);
        }
        assert_relative_eq!(volume, 1.0, epsilon = 1e-11);
        assert_relative_eq!(moment, 1.0, epsilon = 1e-11);
    }

    fn check_support<K: Kernel>() {
        let kernel = Smoothing::<K>::new(0.25);
        let inside = 0.999 * kernel.support();
        assert!(kernel.w(inside * inside) > 0.0 && kernel.f(inside * inside) > 0.0);
        for r in [1.0, 1.001, 10.0, 1e100].map(|s| s * kernel.support()) {
            assert_eq!((kernel.w(r * r), kernel.f(r * r)), (0.0, 0.0), "{} at {r}", K::NAME);
        }
        for r in [0.0, 1e-300, 1e-14] {
            assert!(kernel.f(r * r).is_finite() && kernel.f(r * r) >= 0.0);
        }
    }

    #[test]
    fn gradient_is_the_derivative_of_the_kernel() {
        check_gradient::<CubicSpline>();
        check_gradient::<QuinticSpline>();
        check_gradient::<WendlandC2>();
    }

    #[test]
    fn kernels_are_normalised_in_two_dimensions() {
        check_normalisation::<CubicSpline>();
        check_normalisation::<QuinticSpline>();
        check_normalisation::<WendlandC2>();
    }

    #[test]
    fn support_is_compact_and_the_centre_is_finite() {
        check_support::<CubicSpline>();
        check_support::<QuinticSpline>();
        check_support::<WendlandC2>();
    }
}
