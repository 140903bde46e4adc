//! Four numbers in one register of a processor that has AVX2: the only unsafe code of the crate.
//!
//! The default build may use only the registers that every x86-64 processor has, which hold two numbers.
//! Nearly all present processors have registers for four, which the program detects at run time. The pair
//! sweep and the construction of neighbour lists are compiled a second time for these registers, and a third
//! time for processors that have 32 of them (AVX-512). `touchstone doctor --bench` measures the speed.

#![allow(unsafe_code)]

use std::arch::x86_64::*;
use std::mem::transmute;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::{LANES, OnLanes};

/// Runs a loop compiled for such registers, 32 of them if there are as many, so that fewer sums have to
/// be put aside; gives it back where there are none. The standard library keeps the processor's answer.
pub(crate) fn run<W: OnLanes>(work: W) -> Option<W> {
    let are_many = is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl");
    match (is_x86_feature_detected!("avx2"), are_many) {
        // SAFETY: each where the features that it enables are there.
        (true, true) => unsafe { with_many_registers(work) },
        (true, false) => unsafe { with_registers_for_four(work) },
        (false, _) => return Some(work),
    }
    None
}

#[target_feature(enable = "avx2")]
fn with_registers_for_four(work: impl OnLanes) {
    work.run::<Ymm>();
}

#[target_feature(enable = "avx2,avx512f,avx512vl")]
fn with_many_registers(work: impl OnLanes) {
    work.run::<Ymm>();
}

/// Four numbers in one register.
///
/// # Safety
///
/// Private: no value of this type is made, and nothing of it called, but under the two functions above, where
/// the processor has AVX2. That is what every `unsafe` of this file relies on.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
struct Ymm(__m256d);

impl Ymm {
    /// The four numbers.
    fn to_array(self) -> [f64; 4] {
        // SAFETY: both are four f64 in the same order.
        unsafe { transmute(self.0) }
    }
}

/// The operators, each one instruction.
macro_rules! operators {
    ($($Op:ident $op:ident $OpAssign:ident $op_assign:ident $instruction:ident;)+) => {$(
        impl $Op for Ymm {
            type Output = Self;
            #[inline(always)]
            fn $op(self, other: Self) -> Self {
                // SAFETY: see `Ymm`.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }

        impl $OpAssign for Ymm {
            #[inline(always)]
            fn $op_assign(&mut self, other: Self) {
                *self = $Op::$op(*self, other);
            }
        }
    )+};
}

operators! {
    Add add AddAssign add_assign _mm256_add_pd;
    Sub sub SubAssign sub_assign _mm256_sub_pd;
    Mul mul MulAssign mul_assign _mm256_mul_pd;
    Div div DivAssign div_assign _mm256_div_pd;
}

impl Neg for Ymm {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see `Ymm`. A change of sign, of 0 too, as for f64.
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

impl PartialEq for Ymm {
    fn eq(&self, other: &Self) -> bool {
        self.to_array() == other.to_array()
    }
}

// SAFETY: see `Ymm`; what is transmuted is four `u32` in the same order. Roots are correctly rounded, as for
// f64; lanes are added as (a + c) + (b + d).
lane! {
    for Ymm:
    fn all(x: f64) -> Self = Self(unsafe { _mm256_set1_pd(x) });
    fn gather(read: impl Fn(usize) -> f64) -> Self =
        Self(unsafe { _mm256_setr_pd(read(0), read(1), read(2), read(3)) });
    fn gather_pair(read: impl Fn(usize) -> [f64; 2]) -> [Self; 2] = {
        // Neighbours 0 and 2, and 1 and 3, each with its two numbers as they stand in memory.
        let ([a, b], [c, d]) = (read(0), read(2));
        let ([e, f], [g, h]) = (read(1), read(3));
        let (even, odd) = unsafe { (_mm256_setr_pd(a, b, c, d), _mm256_setr_pd(e, f, g, h)) };
        unsafe { [Self(_mm256_unpacklo_pd(even, odd)), Self(_mm256_unpackhi_pd(even, odd))] }
    };
    fn sqrt(self) -> Self = Self(unsafe { _mm256_sqrt_pd(self.0) });
    fn abs(self) -> Self = Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) });
    fn at_least(self, floor: Self) -> Self = Self(unsafe { _mm256_max_pd(self.0, floor.0) });
    fn total(self) -> f64 = unsafe {
        let pairs = _mm_add_pd(_mm256_castpd256_pd128(self.0), _mm256_extractf128_pd::<1>(self.0));
        _mm_cvtsd_f64(_mm_add_pd(pairs, _mm_unpackhi_pd(pairs, pairs)))
    };
    fn bits_below(self, bound: f64) -> usize = unsafe {
        _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, _mm256_set1_pd(bound))) as usize
    };
    fn pack(columns: &[u32; LANES], bits: usize, own: u32, places: &mut [u32]) -> usize = {
        let places: &mut [u32; LANES] = places.first_chunk_mut().expect("four places");
        unsafe {
            let columns: __m128i = transmute(*columns);
            let own = _mm_cmpeq_epi32(columns, _mm_set1_epi32(own as i32));
            let kept = PACKED[bits & !_mm_movemask_ps(_mm_castsi128_ps(own)) as usize & 15];
            let from = _mm_srlv_epi32(_mm_set1_epi32(kept), _mm_setr_epi32(0, 4, 8, 12));
            let packed = _mm_permutevar_ps(_mm_castsi128_ps(columns), from);
            *places = transmute::<__m128, [u32; LANES]>(packed);
            (kept >> 16) as usize
        }
    };
}

/// For each set of bits how many there are, and in the four digits after that which, the last digit first.
const PACKED: [i32; 16] = [
    0x0_0000, 0x1_0000, 0x1_0001, 0x2_0010, 0x1_0002, 0x2_0020, 0x2_0021, 0x3_0210, 0x1_0003,
    0x2_0030, 0x2_0031, 0x3_0310, 0x2_0032, 0x3_0320, 0x3_0321, 0x4_3210,
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Lane;
    use simba::simd::WideF64x4;

    /// Numbers with signs, a zero of either sign, and extremes.
    const A: [f64; 4] = [-0.0, 1.0 / 3.0, -1e-300, 2e200];
    const B: [f64; 4] = [0.0, -7.1, 3e-310, 1e150];

    /// What every operation makes of A and B, in lanes of type `V`.
    fn results<V: Lane>(array: impl Fn(V) -> [f64; 4]) -> Vec<u64> {
        let [a, b] = [A, B].map(|numbers| V::gather(|k| numbers[k]));
        let (mut sum, mut less, mut times, mut over) = (a, a, a, a);
        sum += b;
        less -= b;
        times *= b;
        over /= b;
        let all = [
            [a + b, a - b, a * b, a / b],
            [sum, less, times, over],
            [-a, -b, a.abs(), b.abs()],
            [a.at_least(b), b.at_least(a), a.positive(), b.positive()],
            [a.abs().sqrt(), b.abs().sqrt(), V::all(0.1), V::all(0.0)],
        ];
        let pair = V::gather_pair(|k| [A[k], B[k]]);
        let bits = |x: f64| if x.is_nan() { u64::MAX } else { x.to_bits() };
        let lanes = all.into_iter().flatten().chain(pair).flat_map(array).map(bits);
        let totals = [a.total(), b.total(), (a * b).total()].map(bits);
        let below = [-1.0, -0.0, 0.0, 1.0, f64::NAN]
            .map(|bound| [a.bits_below(bound), b.bits_below(bound)]);
        let packed = (0..16).flat_map(|bits| [9, 8].map(|own| packed::<V>(bits, own))).flatten();
        let whole = below.into_iter().flatten().map(|bits| bits as u64).chain(packed);
        lanes.chain(totals).chain(whole).collect()
    }

    /// How many of four columns are packed, and which.
    fn packed<V: Lane>(bits: usize, own: u32) -> Vec<u64> {
        let mut places = [0; 4];
        let count = V::pack(&[9, 7, 5, 3], bits, own, &mut places);
        [count as u64].into_iter().chain(places[..count].iter().map(|&c| c.into())).collect()
    }

    /// The results in the lanes that `run` takes, which are `Ymm`.
    struct Results<'a>(&'a mut Vec<u64>);

    impl OnLanes for Results<'_> {
        fn run<V: Lane>(self) {
            *self.0 = results::<V>(|lanes| {
                let any: &dyn std::any::Any = &lanes;
                any.downcast_ref::<Ymm>().expect("the lanes of this file").to_array()
            });
        }
    }

    #[test]
    fn every_operation_has_the_bits_of_the_portable_one() {
        let portable = results::<WideF64x4>(|lanes| lanes.0.to_array());
        assert!(portable.iter().any(|bits| *bits == (-0.0f64).to_bits()));
        let [mut few, mut many] = [portable.clone(), portable.clone()];
        // SAFETY: each where its registers are there.
        unsafe {
            if is_x86_feature_detected!("avx2") {
                with_registers_for_four(Results(&mut few));
            }
            if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl") {
                with_many_registers(Results(&mut many));
            }
        }
        assert_eq!([&few, &many], [&portable; 2]);
    }
}
