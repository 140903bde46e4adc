//! Elementary functions with equal bits on every processor.
//!
//! The standard library passes `sin`, `exp` and others to the C library, which chooses a form with or without
//! FMA at run time, so the last bit of a result depends on the processor. The functions below are compiled
//! from the Rust of the crate `libm`, with `+`, `-`, `*`, `/` and integers only. Every state, metric, time
//! step and verdict uses these functions; clippy refuses the ones of the standard library (`clippy.toml`).
//!
//! Methods of `f64` that stay: `sqrt`, `abs`, `floor`, `ceil`, `round`, `trunc`, `%` and conversions are
//! exact or correctly rounded everywhere; `powi` is a sequence of multiplications, fixed when compiled, and
//! the faster one where the power is known and whole.
//!
//! Angles are in radians. [`exp_m1`] and [`ln_1p`] are eˣ − 1 and ln(1 + x) without cancellation for small x,
//! [`erfc`] is 1 − erf x without cancellation for large x, and [`hypot`] is (x² + y²)^(1/2) without overflow
//! of the squares.

use nalgebra::{Complex, Matrix2, Rotation2};

#[doc(no_inline)]
pub use libm::{
    acos, atan2, cos, cosh, erfc, exp, exp2, expm1 as exp_m1, hypot, log as ln, log1p as ln_1p,
    log2, log10, pow as powf, sin, sinh,
};

/// Sine and cosine of an angle in radians.
pub fn sin_cos(x: f64) -> (f64, f64) {
    (sin(x), cos(x))
}

/// The modulus |z|.
pub fn modulus(z: Complex<f64>) -> f64 {
    hypot(z.re, z.im)
}

/// The square root with a real part that is not negative.
pub fn complex_sqrt(z: Complex<f64>) -> Complex<f64> {
    // The part with a sum that does not cancel; the other part is Im z/2 over this one.
    let large = (0.5 * (modulus(z) + z.re.abs())).sqrt();
    if large == 0.0 {
        return Complex::new(0.0, z.im);
    }
    let small = 0.5 * z.im / large;
    match z.re >= 0.0 {
        true => Complex::new(large, small),
        false => Complex::new(small.abs(), large.copysign(z.im)),
    }
}

/// The turn by an angle in radians, counter-clockwise.
pub fn rotation(angle: f64) -> Rotation2<f64> {
    let (sin, cos) = sin_cos(angle);
    Rotation2::from_matrix_unchecked(Matrix2::new(cos, -sin, sin, cos))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods, reason = "compares with the standard library")]

    use super::*;

    /// How many numbers apart two are, at equal signs.
    fn apart(a: f64, b: f64) -> u64 {
        if a == b { 0 } else { a.to_bits().abs_diff(b.to_bits()) }
    }

    #[test]
    fn functions_agree_with_the_standard_library_to_two_units_in_the_last_place() {
        type Pair = (&'static str, fn(f64) -> f64, fn(f64) -> f64, [f64; 2]);
        let all: [Pair; 12] = [
            ("sin", sin, f64::sin, [-20.0, 20.0]),
            ("cos", cos, f64::cos, [-20.0, 20.0]),
            ("acos", acos, f64::acos, [-1.0, 1.0]),
            ("sinh", sinh, f64::sinh, [-10.0, 10.0]),
            ("cosh", cosh, f64::cosh, [-10.0, 10.0]),
            ("exp", exp, f64::exp, [-40.0, 40.0]),
            ("exp2", exp2, f64::exp2, [-40.0, 40.0]),
            ("exp_m1", exp_m1, f64::exp_m1, [-2.0, 2.0]),
            ("ln", ln, f64::ln, [0.0, 40.0]),
            ("ln_1p", ln_1p, f64::ln_1p, [-1.0, 2.0]),
            ("log2", log2, f64::log2, [0.0, 40.0]),
            ("log10", log10, f64::log10, [0.0, 40.0]),
        ];
        let part = |k: u32| (f64::from(k) + 0.5) / 2000.0;
        for (name, ours, theirs, [low, high]) in all {
            for k in 0..2000 {
                let x = low + (high - low) * part(k);
                let (a, b) = (ours(x), theirs(x));
                assert!(apart(a, b) <= 2, "{name}({x:e}) = {a:e}, not {b:e}");
            }
        }
        for k in 0..2000 {
            let (x, y) = (10.0 * part(k), 20.0 * (part(1999 * k % 2000) - 0.5));
            assert!(apart(powf(x, y), x.powf(y)) <= 1, "{x:e} to the power {y:e}");
            assert!(apart(hypot(x, y), x.hypot(y)) <= 1, "hypot of {x:e} and {y:e}");
            assert_eq!(sin_cos(x), (sin(x), cos(x)));
        }
        assert!((erfc(0.5) - 0.479_500_122_186_953_5).abs() < 1e-15);
    }

    #[test]
    fn some_bits_are_those_of_every_processor() {
        let bits = [sin(1.0), exp(0.3), ln(0.7), powf(1.7, 0.3), cosh(2.1), log10(0.7), erfc(0.5)];
        let expected: [u64; 7] = [
            0x3fea_ed54_8f09_0cee,
            0x3ff5_9905_8c8c_1a96,
            0xbfd6_d3c3_24e1_3f50,
            0x3ff2_c2cd_2586_22da,
            0x4010_93c6_d4ed_2d72,
            0xbfc3_d3d3_d21c_cf04,
            0x3fde_b021_47ce_245c,
        ];
        assert_eq!(bits.map(f64::to_bits), expected);
    }

    #[test]
    fn complex_functions_and_turns_are_what_they_say() {
        for k in 0..500 {
            let z = Complex::new(0.008 * f64::from(k) - 2.0, 0.008 * f64::from(77 * k % 500) - 2.0);
            let root = complex_sqrt(z);
            assert!(root.re >= 0.0 && modulus(root * root - z) <= 2e-15 * modulus(z), "{z}");
            assert!((rotation(z.re).matrix() - Rotation2::new(z.re).matrix()).amax() < 1e-15);
        }
        let roots = [
            ([0.0, 0.0], [0.0, 0.0]),
            ([4.0, 0.0], [2.0, 0.0]),
            ([-4.0, 0.0], [0.0, 2.0]),
            ([-4.0, -0.0], [0.0, -2.0]),
            ([0.0, 2.0], [1.0, 1.0]),
            ([0.0, -2.0], [1.0, -1.0]),
        ];
        for ([re, im], [a, b]) in roots {
            assert_eq!(complex_sqrt(Complex::new(re, im)), Complex::new(a, b), "{re} {im}");
        }
    }
}
