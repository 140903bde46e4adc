//! Lanes: the number type of the pair loop, one neighbour (`f64`) or four at once (`WideF64x4`, and
//! `Ymm` where the processor has registers for four).
//!
//! Every kernel and term is written once, generic over [`Lane`]. Tests read it as scalar code; the
//! row loop runs it on four neighbours. No form contracts `a * b + c`, and the lanes are added in a
//! fixed order, so the bits do not depend on the machine.

use std::ops::Neg;

use nalgebra::{
    ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign, Scalar, Vector2,
};
use simba::simd::WideF64x4;

/// A real number per neighbour.
pub trait Lane:
    Copy
    + Scalar
    + Send
    + Sync
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
    /// Reads two numbers a neighbour that stand side by side.
    fn gather_pair(read: impl Fn(usize) -> [f64; 2]) -> [Self; 2];
    /// The square root.
    fn sqrt(self) -> Self;
    /// The magnitude.
    fn abs(self) -> Self;
    /// The larger of two numbers that are not NaN.
    fn at_least(self, floor: Self) -> Self;
    /// The sum over the neighbours, always in the same order.
    fn total(self) -> f64;

    /// The positive part, max(self, 0).
    #[inline(always)]
    fn positive(self) -> Self {
        self.at_least(Self::all(0.0))
    }
}

/// A loop that is written once for lanes of any type.
pub(crate) trait OnLanes {
    /// Does it. To be inlined always: what is not is right, but slow, compiled for every processor.
    fn run<V: Lane>(self);
}

/// Does it on the widest lanes that the processor has.
pub(crate) fn on_widest(work: impl OnLanes) {
    #[cfg(target_arch = "x86_64")]
    let Some(work) = crate::ymm::run(work) else { return };
    work.run::<WideF64x4>();
}

/// Implements [`Lane`] by what each operation is for the type.
macro_rules! lane {
    (
        $Type:ty: all($x:ident) = $all:expr, gather($read:ident) = $gather:expr,
        gather_pair = $gather_pair:expr,
        sqrt($a:ident) = $sqrt:expr, abs = $abs:expr, at_least($floor:ident) = $at_least:expr,
        total = $total:expr
    ) => {
        impl $crate::lane::Lane for $Type {
            #[inline(always)]
            fn all($x: f64) -> Self {
                $all
            }
            #[inline(always)]
            fn gather($read: impl Fn(usize) -> f64) -> Self {
                $gather
            }
            #[inline(always)]
            fn gather_pair($read: impl Fn(usize) -> [f64; 2]) -> [Self; 2] {
                $gather_pair
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                let $a = self;
                $sqrt
            }
            #[inline(always)]
            fn abs(self) -> Self {
                let $a = self;
                $abs
            }
            #[inline(always)]
            fn at_least(self, $floor: Self) -> Self {
                let $a = self;
                $at_least
            }
            #[inline(always)]
            fn total(self) -> f64 {
                let $a = self;
                $total
            }
        }
    };
}
pub(crate) use lane;

lane! {
    f64: all(x) = x, gather(read) = read(0), gather_pair = read(0),
    sqrt(a) = a.sqrt(), abs = a.abs(), at_least(floor) = a.max(floor), total = a
}

lane! {
    WideF64x4: all(x) = Self(wide::f64x4::splat(x)),
    gather(read) = Self(wide::f64x4::from([read(0), read(1), read(2), read(3)])),
    gather_pair = [Self::gather(|k| read(k)[0]), Self::gather(|k| read(k)[1])],
    sqrt(a) = Self(a.0.sqrt()), abs = Self(a.0.abs()), at_least(floor) = Self(a.0.fast_max(floor.0)),
    total = { let [a, b, c, d] = a.0.to_array(); (a + c) + (b + d) }
}

/// A vector per neighbour.
#[inline(always)]
pub(crate) fn gather_vector<V: Lane>(read: impl Fn(usize) -> Vector2<f64>) -> Vector2<V> {
    Vector2::from(V::gather_pair(|k| read(k).into()))
}
