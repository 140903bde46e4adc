//! Lanes: the number type of the pair loop and of the neighbour search of an SPH solver. A lane type holds
//! one pair (`f64`), four ([`Portable`], and a second type for processors with registers for four) or eight
//! (processors with registers for eight).
//!
//! Every kernel and term is written once, generic over [`Lane`]. Tests call it as scalar code; the pair sweep
//! calls it by [`on_widest`] on the widest registers of the processor. No operation contracts `a * b + c`,
//! and no sum depends on the number of lanes, so the bits do not depend on the machine.

use std::ops::Neg;

use nalgebra::{
    ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign, Scalar, Vector2,
};

/// Lanes of [`on_four`].
pub const LANES: usize = 4;

/// The most lanes of [`on_widest`], a multiple of the lanes of any form.
pub const MOST: usize = 8;

/// A real number for each of several particles.
pub trait PerParticle: Copy + Scalar + Send + Sync {
    /// This number for every particle.
    fn all(x: f64) -> Self;
}

impl<const N: usize> PerParticle for [f64; N] {
    fn all(x: f64) -> Self {
        [x; N]
    }
}

/// A real number per lane.
pub trait Lane:
    PerParticle
    + Neg<Output = Self>
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
{
    /// How many lanes there are.
    const LANES: usize;
    /// The first numbers, one a lane.
    fn load(from: &[f64]) -> Self;
    /// Writes the numbers to the first places of these.
    fn store(self, to: &mut [f64]);
    /// Reads one number a lane.
    fn gather(read: impl Fn(usize) -> f64) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// The magnitude.
    fn abs(self) -> Self;
    /// The larger of two numbers, neither of which may be NaN.
    fn at_least(self, floor: Self) -> Self;
    /// Bit k is set if number k is below the bound. For the neighbour search.
    fn bits_below(self, bound: f64) -> usize;

    /// Reads two adjacent numbers a lane.
    #[inline(always)]
    fn gather_pair(read: impl Fn(usize) -> [f64; 2]) -> [Self; 2] {
        [Self::gather(|k| read(k)[0]), Self::gather(|k| read(k)[1])]
    }

    /// The k-th number.
    #[inline(always)]
    fn lane(self, k: usize) -> f64 {
        let mut numbers = [0.0; MOST];
        self.store(&mut numbers);
        numbers[k]
    }

    /// Packs the columns (one a lane) whose bit is set, in order, to the front of `places`; may overwrite as
    /// many entries as there are lanes. Returns their number. For the neighbour search.
    #[inline(always)]
    fn pack(columns: &[u32], bits: usize, places: &mut [u32]) -> usize {
        let mut count = 0;
        for (k, &column) in columns.iter().enumerate() {
            // Always written, counted only if kept: no branch to mispredict.
            places[count] = column;
            count += bits >> k & 1;
        }
        count
    }

    /// The positive part, max(self, 0).
    #[inline(always)]
    fn positive(self) -> Self {
        self.at_least(Self::all(0.0))
    }
}

/// A loop written once for every lane type.
pub trait OnLanes {
    /// Runs the loop. Must be inlined, with everything it calls: code outside is correct, but compiled
    /// without the wide registers.
    fn run<V: Lane>(self);
}

/// Runs the loop on the widest lanes that the processor has. Never inlined, so that a program has a symbol a
/// loop, which tests count.
#[inline(never)]
pub fn on_widest(work: impl OnLanes) {
    #[cfg(target_arch = "x86_64")]
    let Some(work) = registers::run(work) else { return };
    work.run::<Portable>();
}

/// Runs the loop on four lanes on every processor, so that sums over lanes have one order.
#[inline(never)]
pub fn on_four(work: impl OnLanes) {
    #[cfg(target_arch = "x86_64")]
    let Some(work) = registers::run_four(work) else { return };
    work.run::<Portable>();
}

/// Implements [`Lane`] with the given expressions; all operations are inlined.
macro_rules! lane {
    (for $Type:ty, $lanes:literal: fn all($x:ident: f64) -> Self = $all:expr;
     $(fn $name:ident($($takes:tt)*) $(-> $Gives:ty)? = $is:expr;)+) => {
        impl $crate::lane::PerParticle for $Type {
            #[inline(always)]
            fn all($x: f64) -> Self {
                $all
            }
        }

        impl $crate::lane::Lane for $Type {
            const LANES: usize = $lanes;
            $(
            #[inline(always)]
            fn $name($($takes)*) $(-> $Gives)? {
                $is
            }
        )+}
    };
}
#[cfg(target_arch = "x86_64")]
mod registers; // after the macro that it uses

/// Four numbers, in the registers that every processor of its kind has.
#[cfg(target_arch = "x86_64")]
pub type Portable = registers::Xmm;
/// Four numbers, in the registers that every processor of its kind has.
#[cfg(not(target_arch = "x86_64"))]
pub type Portable = simba::simd::WideF64x4;

lane! {
    for f64, 1:
    fn all(x: f64) -> Self = x;
    fn load(from: &[f64]) -> Self = from[0];
    fn store(self, to: &mut [f64]) = to[0] = self;
    fn gather(read: impl Fn(usize) -> f64) -> Self = read(0);
    fn sqrt(self) -> Self = f64::sqrt(self);
    fn abs(self) -> Self = f64::abs(self);
    fn at_least(self, floor: Self) -> Self = self.max(floor);
    fn bits_below(self, bound: f64) -> usize = usize::from(self < bound);
}

#[cfg(not(target_arch = "x86_64"))]
lane! {
    for Portable, 4:
    fn all(x: f64) -> Self = Self(wide::f64x4::splat(x));
    fn load(from: &[f64]) -> Self =
        Self(wide::f64x4::from(*from.first_chunk::<LANES>().expect("four numbers")));
    fn store(self, to: &mut [f64]) =
        *to.first_chunk_mut().expect("four places") = self.0.to_array();
    fn gather(read: impl Fn(usize) -> f64) -> Self =
        Self(wide::f64x4::from([read(0), read(1), read(2), read(3)]));
    fn sqrt(self) -> Self = Self(self.0.sqrt());
    fn abs(self) -> Self = Self(self.0.abs());
    fn at_least(self, floor: Self) -> Self = Self(self.0.fast_max(floor.0));
    fn bits_below(self, bound: f64) -> usize =
        self.0.simd_lt(wide::f64x4::splat(bound)).to_bitmask() as usize;
}

/// The sum of four lanes, always in one order. Only for [`on_four`]: no sum may depend on the number of
/// lanes.
#[inline(always)]
pub fn total<V: Lane>(lanes: V) -> f64 {
    const { assert!(V::LANES == LANES) };
    (lanes.lane(0) + lanes.lane(2)) + (lanes.lane(1) + lanes.lane(3))
}

/// A vector per lane.
#[inline(always)]
pub fn gather_vector<V: Lane>(read: impl Fn(usize) -> Vector2<f64>) -> Vector2<V> {
    Vector2::from(V::gather_pair(|k| read(k).into()))
}
