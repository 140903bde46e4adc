//! Lanes: the number type of the pair loop, one neighbour (`f64`) or four at once (`WideF64x4`, and
//! [`Ymm`] where the processor has registers for four).
//!
//! Every kernel and term is written once, generic over [`Lane`]. Tests read it as scalar code; the
//! row loop runs it on four neighbours. No form contracts `a * b + c`, and the lanes are added in a
//! fixed order, so the bits do not depend on the machine.

use std::{fmt::Debug, ops::Neg};

use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign, Vector2};
use num_traits::Zero;
use simba::simd::WideF64x4;

#[cfg(target_arch = "x86_64")]
pub(crate) use crate::ymm::Ymm;

/// A real number per neighbour.
pub trait Lane:
    Copy
    + PartialEq
    + Debug
    + Send
    + Sync
    + 'static
    + Zero
    + Neg<Output = Self>
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
{
    /// The same number for every neighbour.
    fn all(x: f64) -> Self;
    /// Reads one number a neighbour.
    fn gather(read: impl Fn(usize) -> f64) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// The magnitude.
    fn abs(self) -> Self;
    /// The larger of two numbers that are not NaN.
    fn at_least(self, floor: Self) -> Self;
    /// The sum over the neighbours, always in the same order.
    fn total(self) -> f64;

    /// Nothing.
    #[inline(always)]
    fn nil() -> Self {
        Self::all(0.0)
    }

    /// The positive part, max(self, 0).
    #[inline(always)]
    fn positive(self) -> Self {
        self.at_least(Self::nil())
    }
}

impl Lane for f64 {
    #[inline(always)]
    fn all(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn gather(read: impl Fn(usize) -> f64) -> Self {
        read(0)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
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
    fn all(x: f64) -> Self {
        WideF64x4(wide::f64x4::splat(x))
    }
    #[inline(always)]
    fn gather(read: impl Fn(usize) -> f64) -> Self {
        WideF64x4(wide::f64x4::from([read(0), read(1), read(2), read(3)]))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        WideF64x4(self.0.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        WideF64x4(self.0.abs())
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
