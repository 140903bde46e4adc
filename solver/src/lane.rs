//! Lanes: the number type of the pair loop, one neighbour (`f64`) or four at once (`WideF64x4`).
//!
//! Every kernel and term is written once, generic over [`Lane`]. Tests read it as scalar code; the
//! row loop runs it on four neighbours. Neither form contracts `a * b + c`, and the lanes are added
//! in a fixed order, so the bits do not depend on the machine.

use nalgebra::Vector2;
use simba::simd::{SimdRealField, SimdValue, WideF64x4};

/// A real number per neighbour.
pub trait Lane: SimdRealField + SimdValue<Element = f64> + Copy + Send + Sync {
    /// Reads one number a neighbour.
    fn gather(read: impl Fn(usize) -> f64) -> Self;
    /// The positive part, max(self, 0).
    fn positive(self) -> Self;
    /// The larger of two numbers that are not NaN.
    fn at_least(self, floor: Self) -> Self;
    /// The sum over the neighbours, always in the same order.
    fn total(self) -> f64;

    /// The same number for every neighbour.
    #[inline(always)]
    fn all(x: f64) -> Self {
        Self::splat(x)
    }

    /// Nothing.
    #[inline(always)]
    fn nil() -> Self {
        Self::splat(0.0)
    }
}

impl Lane for f64 {
    #[inline(always)]
    fn gather(read: impl Fn(usize) -> f64) -> Self {
        read(0)
    }
    #[inline(always)]
    fn positive(self) -> Self {
        self.max(0.0)
    }
    #[inline(always)]
    fn at_least(self, floor: Self) -> Self {
        self.max(floor)
    }
    #[inline(always)]
    fn total(self) -> f64 {
        self
    }
}

impl Lane for WideF64x4 {
    #[inline(always)]
    fn gather(read: impl Fn(usize) -> f64) -> Self {
        WideF64x4(wide::f64x4::from([read(0), read(1), read(2), read(3)]))
    }
    #[inline(always)]
    fn positive(self) -> Self {
        WideF64x4(self.0.fast_max(wide::f64x4::ZERO))
    }
    #[inline(always)]
    fn at_least(self, floor: Self) -> Self {
        WideF64x4(self.0.fast_max(floor.0))
    }
    #[inline(always)]
    fn total(self) -> f64 {
        let [a, b, c, d] = self.0.to_array();
        (a + c) + (b + d)
    }
}

/// A vector per neighbour.
#[inline(always)]
pub(crate) fn gather_vector<V: Lane>(read: impl Fn(usize) -> Vector2<f64>) -> Vector2<V> {
    Vector2::new(V::gather(|k| read(k).x), V::gather(|k| read(k).y))
}
