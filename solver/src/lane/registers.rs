//! Eight numbers in one register of a processor that has AVX-512, four of one that has AVX2, and four in two
//! registers of any x86-64 processor: the only unsafe code of the crate.
//!
//! The default build may use only the registers that every x86-64 processor has, which hold two numbers.
//! Nearly all present processors have wider ones, which the program detects at run time: the pair sweep and
//! the construction of neighbour lists are compiled a second and a third time, for registers of four numbers
//! and of eight. `touchstone doctor --bench` measures the speed. Registers of two numbers are types of this
//! file, too: the crate `wide`, which has them, takes longer to compile than this one.

#![allow(unsafe_code)]

use std::arch::x86_64::{
    __m128, __m128d, __m128i, __m256d, __m256i, __m512d, _CMP_LT_OQ, _mm_add_pd, _mm_andnot_pd,
    _mm_castsi128_ps, _mm_cmplt_pd, _mm_div_pd, _mm_max_pd, _mm_movemask_pd, _mm_mul_pd,
    _mm_permutevar_ps, _mm_set1_epi32, _mm_set1_pd, _mm_setr_epi32, _mm_setr_pd, _mm_sqrt_pd,
    _mm_srlv_epi32, _mm_sub_pd, _mm256_add_pd, _mm256_andnot_pd, _mm256_cmp_pd, _mm256_div_pd,
    _mm256_maskz_compress_epi32, _mm256_max_pd, _mm256_movemask_pd, _mm256_mul_pd, _mm256_set1_pd,
    _mm256_setr_pd, _mm256_sqrt_pd, _mm256_sub_pd, _mm256_unpackhi_pd, _mm256_unpacklo_pd,
    _mm512_abs_pd, _mm512_add_pd, _mm512_cmp_pd_mask, _mm512_div_pd, _mm512_max_pd, _mm512_mul_pd,
    _mm512_set1_pd, _mm512_setr_pd, _mm512_sqrt_pd, _mm512_sub_pd,
};
use std::mem::transmute;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use super::{LANES, MOST, OnLanes, PerParticle};

/// Whether the processor has AVX2, and AVX-512 too. The standard library keeps the processor's answer.
fn has() -> [bool; 2] {
    let eight = is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl");
    [is_x86_feature_detected!("avx2"), eight]
}

/// Runs a loop on the widest registers that the processor has; returns the loop if it has only narrow ones.
pub(crate) fn run<W: OnLanes>(work: W) -> Option<W> {
    match has() {
        // SAFETY: called only if the processor has the features that the function enables.
        [true, true] => unsafe { with_registers_for_eight(work) },
        [true, false] => unsafe { with_registers_for_four(work) },
        [false, _] => return Some(work),
    }
    None
}

/// Runs the loop on four lanes, with 32 registers where the processor has them.
pub(crate) fn run_four<W: OnLanes>(work: W) -> Option<W> {
    match has() {
        // SAFETY: called only if the processor has the features that the function enables.
        [true, true] => unsafe { with_many_registers_for_four(work) },
        [true, false] => unsafe { with_registers_for_four(work) },
        [false, _] => return Some(work),
    }
    None
}

#[target_feature(enable = "avx2")]
fn with_registers_for_four(work: impl OnLanes) {
    work.run::<Ymm>();
}

#[target_feature(enable = "avx2,avx512f,avx512vl")]
fn with_many_registers_for_four(work: impl OnLanes) {
    work.run::<Ymm>();
}

#[target_feature(enable = "avx2,avx512f,avx512vl")]
fn with_registers_for_eight(work: impl OnLanes) {
    work.run::<Zmm>();
}

/// Four numbers in two registers.
///
/// # Safety
///
/// Every x86-64 processor has such registers and their instructions (SSE2).
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Xmm([__m128d; 2]);

/// Four numbers in one register.
///
/// # Safety
///
/// Private: values of this type are made, and its functions called, only under the functions above, on
/// processors with AVX2. Every `unsafe` block of this type relies on this.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
struct Ymm(__m256d);

/// Eight numbers in one register.
///
/// # Safety
///
/// As for [`Ymm`], where the processor has AVX-512 (F and VL).
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
struct Zmm(__m512d);

/// The operators, each one instruction, and a change of sign, of 0 too, as for f64.
macro_rules! operators {
    ($Register:ident, $lanes:literal, $Held:ty;
     $($Op:ident $op:ident $OpAssign:ident $op_assign:ident = |$a:ident, $b:ident| $is:expr;)+) => {
        impl $Register {
            /// One number a lane.
            #[inline(always)]
            fn of_array(numbers: [f64; $lanes]) -> Self {
                // SAFETY: both types hold `$lanes` f64 in one order.
                Self(unsafe { transmute::<[f64; $lanes], $Held>(numbers) })
            }

            /// The numbers.
            #[inline(always)]
            fn to_array(self) -> [f64; $lanes] {
                // SAFETY: both types hold `$lanes` f64 in one order.
                unsafe { transmute(self.0) }
            }
        }

        impl Neg for $Register {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                self * Self::all(-1.0)
            }
        }

        impl PartialEq for $Register {
            fn eq(&self, other: &Self) -> bool {
                self.to_array() == other.to_array()
            }
        }

        $(impl $Op for $Register {
            type Output = Self;
            #[inline(always)]
            fn $op(self, other: Self) -> Self {
                let ($a, $b) = (self.0, other.0);
                // SAFETY: see `Xmm`, `Ymm` and `Zmm`.
                Self(unsafe { $is })
            }
        }

        impl $OpAssign for $Register {
            #[inline(always)]
            fn $op_assign(&mut self, other: Self) {
                *self = $Op::$op(*self, other);
            }
        })+
    };
}

operators! {
    Xmm, 4, [__m128d; 2];
    Add add AddAssign add_assign = |a, b| [_mm_add_pd(a[0], b[0]), _mm_add_pd(a[1], b[1])];
    Sub sub SubAssign sub_assign = |a, b| [_mm_sub_pd(a[0], b[0]), _mm_sub_pd(a[1], b[1])];
    Mul mul MulAssign mul_assign = |a, b| [_mm_mul_pd(a[0], b[0]), _mm_mul_pd(a[1], b[1])];
    Div div DivAssign div_assign = |a, b| [_mm_div_pd(a[0], b[0]), _mm_div_pd(a[1], b[1])];
}

operators! {
    Ymm, 4, __m256d;
    Add add AddAssign add_assign = |a, b| _mm256_add_pd(a, b);
    Sub sub SubAssign sub_assign = |a, b| _mm256_sub_pd(a, b);
    Mul mul MulAssign mul_assign = |a, b| _mm256_mul_pd(a, b);
    Div div DivAssign div_assign = |a, b| _mm256_div_pd(a, b);
}

operators! {
    Zmm, 8, __m512d;
    Add add AddAssign add_assign = |a, b| _mm512_add_pd(a, b);
    Sub sub SubAssign sub_assign = |a, b| _mm512_sub_pd(a, b);
    Mul mul MulAssign mul_assign = |a, b| _mm512_mul_pd(a, b);
    Div div DivAssign div_assign = |a, b| _mm512_div_pd(a, b);
}

// SAFETY: see `Xmm`.
lane! {
    for Xmm, 4:
    fn all(x: f64) -> Self = Self([unsafe { _mm_set1_pd(x) }; 2]);
    fn load(from: &[f64]) -> Self = Self::of_array(*from.first_chunk().expect("four numbers"));
    fn store(self, to: &mut [f64]) = *to.first_chunk_mut().expect("four places") = self.to_array();
    fn gather(read: impl Fn(usize) -> f64) -> Self =
        Self(unsafe { [_mm_setr_pd(read(0), read(1)), _mm_setr_pd(read(2), read(3))] });
    fn sqrt(self) -> Self = Self(self.0.map(|x| unsafe { _mm_sqrt_pd(x) }));
    fn abs(self) -> Self = Self(self.0.map(|x| unsafe { _mm_andnot_pd(_mm_set1_pd(-0.0), x) }));
    fn at_least(self, floor: Self) -> Self = {
        let ([a, b], [c, d]) = (self.0, floor.0);
        Self(unsafe { [_mm_max_pd(a, c), _mm_max_pd(b, d)] })
    };
    fn bits_below(self, bound: f64) -> usize = {
        let [low, high] = self.0.map(|x| unsafe {
            _mm_movemask_pd(_mm_cmplt_pd(x, _mm_set1_pd(bound))) as usize
        });
        low | high << 2
    };
}

// SAFETY: see `Ymm`; the transmuted value is four `u32` in one order. Roots are correctly rounded, as for
// f64.
lane! {
    for Ymm, 4:
    fn all(x: f64) -> Self = Self(unsafe { _mm256_set1_pd(x) });
    fn load(from: &[f64]) -> Self = Self::of_array(*from.first_chunk().expect("four numbers"));
    fn store(self, to: &mut [f64]) = *to.first_chunk_mut().expect("four places") = self.to_array();
    fn gather(read: impl Fn(usize) -> f64) -> Self =
        Self(unsafe { _mm256_setr_pd(read(0), read(1), read(2), read(3)) });
    fn gather_pair(read: impl Fn(usize) -> [f64; 2]) -> [Self; 2] = {
        // Neighbours 0 and 2, and 1 and 3, each with its two numbers in the order of memory.
        let ([a, b], [c, d]) = (read(0), read(2));
        let ([e, f], [g, h]) = (read(1), read(3));
        let (even, odd) = unsafe { (_mm256_setr_pd(a, b, c, d), _mm256_setr_pd(e, f, g, h)) };
        unsafe { [Self(_mm256_unpacklo_pd(even, odd)), Self(_mm256_unpackhi_pd(even, odd))] }
    };
    fn sqrt(self) -> Self = Self(unsafe { _mm256_sqrt_pd(self.0) });
    fn abs(self) -> Self = Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) });
    fn at_least(self, floor: Self) -> Self = Self(unsafe { _mm256_max_pd(self.0, floor.0) });
    fn bits_below(self, bound: f64) -> usize = unsafe {
        _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, _mm256_set1_pd(bound))) as usize
    };
    fn pack(columns: &[u32], bits: usize, places: &mut [u32]) -> usize = {
        let columns: &[u32; LANES] = columns.try_into().expect("four columns");
        let places: &mut [u32; LANES] = places.first_chunk_mut().expect("four places");
        unsafe {
            let columns = transmute::<[u32; LANES], __m128i>(*columns);
            let kept = PACKED[bits & 15];
            let from = _mm_srlv_epi32(_mm_set1_epi32(kept), _mm_setr_epi32(0, 4, 8, 12));
            let packed = _mm_permutevar_ps(_mm_castsi128_ps(columns), from);
            *places = transmute::<__m128, [u32; LANES]>(packed);
            (kept >> 16) as usize
        }
    };
}

// SAFETY: see `Zmm`; the transmuted value is eight `u32` in one order.
lane! {
    for Zmm, 8:
    fn all(x: f64) -> Self = Self(unsafe { _mm512_set1_pd(x) });
    fn load(from: &[f64]) -> Self = Self::of_array(*from.first_chunk().expect("eight numbers"));
    fn store(self, to: &mut [f64]) = *to.first_chunk_mut().expect("eight places") = self.to_array();
    fn gather(read: impl Fn(usize) -> f64) -> Self = Self(unsafe {
        _mm512_setr_pd(read(0), read(1), read(2), read(3), read(4), read(5), read(6), read(7))
    });
    fn sqrt(self) -> Self = Self(unsafe { _mm512_sqrt_pd(self.0) });
    fn abs(self) -> Self = Self(unsafe { _mm512_abs_pd(self.0) });
    fn at_least(self, floor: Self) -> Self = Self(unsafe { _mm512_max_pd(self.0, floor.0) });
    fn bits_below(self, bound: f64) -> usize = unsafe {
        _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, _mm512_set1_pd(bound)) as usize
    };
    fn pack(columns: &[u32], bits: usize, places: &mut [u32]) -> usize = {
        let columns: &[u32; MOST] = columns.try_into().expect("eight columns");
        let places: &mut [u32; MOST] = places.first_chunk_mut().expect("eight places");
        unsafe {
            let columns = transmute::<[u32; MOST], __m256i>(*columns);
            let packed = _mm256_maskz_compress_epi32(bits as u8, columns);
            *places = transmute::<__m256i, [u32; MOST]>(packed);
        }
        (bits as u8).count_ones() as usize
    };
}

/// For each set of bits how many there are, and in the four digits after that which, the last digit first.
const PACKED: [i32; 16] = [
    0x0_0000, 0x1_0000, 0x1_0001, 0x2_0010, 0x1_0002, 0x2_0020, 0x2_0021, 0x3_0210, 0x1_0003,
    0x2_0030, 0x2_0031, 0x3_0310, 0x2_0032, 0x3_0320, 0x3_0321, 0x4_3210,
];

#[cfg(test)]
mod tests {
    use super::super::Lane;
    use super::*;

    /// Numbers with signs, zeros of either sign, and extremes.
    const A: [f64; 8] = [-0.0, 1.0 / 3.0, -1e-300, 2e200, 0.7, -3.3e7, 0.0, 5e-324];
    const B: [f64; 8] = [0.0, -7.1, 3e-310, 1e150, -0.0, 1e-3, 2.5, 4e30];

    /// The bits of every operation on A and B, with lanes of type `V`.
    fn results<V: Lane>() -> Vec<u64> {
        (0..A.len()).step_by(V::LANES).flat_map(|first| results_from::<V>(first)).collect()
    }

    /// The bits of every operation on the numbers from `first` on, lane by lane.
    fn results_from<V: Lane>(first: usize) -> Vec<u64> {
        let [a, b] = [A, B].map(|numbers| V::load(&numbers[first..]));
        let (mut sum, mut less, mut times, mut over) = (a, a, a, a);
        sum += b;
        less -= b;
        times *= b;
        over /= b;
        let pair = V::gather_pair(|k| [A[first + k], B[first + k]]);
        let all = [
            [a + b, a - b, a * b, a / b],
            [sum, less, times, over],
            [-a, -b, a.abs(), b.abs()],
            [a.at_least(b), b.at_least(a), a.positive(), b.positive()],
            [a.abs().sqrt(), b.abs().sqrt(), V::all(0.1), V::all(0.0)],
            [pair[0], pair[1], a, V::gather(|k| B[first + k])],
        ];
        let bits = |x: f64| if x.is_nan() { u64::MAX } else { x.to_bits() };
        let below = |k: usize, x: V| {
            [-1.0, -0.0, 0.0, 1.0, f64::NAN].map(|bound| (x.bits_below(bound) >> k & 1) as u64)
        };
        let of_lane = |k: usize| {
            let numbers = all.iter().flatten().map(move |x| bits(x.lane(k))).collect::<Vec<_>>();
            [numbers, below(k, a).to_vec(), below(k, b).to_vec()].concat()
        };
        let mut stored = [0.0; MOST];
        b.store(&mut stored);
        (0..V::LANES).flat_map(|k| [of_lane(k), vec![bits(stored[k])]].concat()).collect()
    }

    /// Packs every subset of as many columns as there are lanes.
    fn check_packing<V: Lane>() {
        let columns: Vec<u32> = (0..V::LANES as u32).map(|k| 9 + 2 * k).collect();
        for bits in 0..1_usize << V::LANES {
            let mut places = [0; MOST];
            let count = V::pack(&columns, bits, &mut places);
            let kept = columns.iter().enumerate().filter(|(k, _)| bits >> k & 1 == 1);
            assert!(places[..count].iter().eq(kept.map(|(_, column)| column)), "{bits:b}");
        }
    }

    /// The results in the lanes that `run` takes.
    struct Results<'a>(&'a mut Vec<u64>);

    impl OnLanes for Results<'_> {
        fn run<V: Lane>(self) {
            check_packing::<V>();
            *self.0 = results::<V>();
        }
    }

    #[test]
    fn every_operation_has_the_bits_of_the_portable_one() {
        let of = |run: &dyn Fn(Results)| {
            let mut results = Vec::new();
            run(Results(&mut results));
            results
        };
        let portable = of(&|results| results.run::<Xmm>());
        assert!(portable.iter().any(|bits| *bits == (-0.0f64).to_bits()));
        let [four, eight] = has();
        // SAFETY: each where its registers are there.
        if four {
            assert_eq!(of(&|results| unsafe { with_registers_for_four(results) }), portable);
        }
        if eight {
            assert_eq!(of(&|results| unsafe { with_many_registers_for_four(results) }), portable);
            assert_eq!(of(&|results| unsafe { with_registers_for_eight(results) }), portable);
        }
    }
}
