//! Random numbers equal on every machine and in every version: SplitMix64 (Steele, Lea & Flood 2014).
//! Published results depend on randomly disturbed lattices, so an update of a library must not change the
//! numbers.

use crate::functions::{cos, ln};

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The stream of this seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A normal variate with mean 0 and standard deviation 1 (Box & Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.uniform(), self.uniform());
        (-2.0 * ln(u)).sqrt() * cos(std::f64::consts::TAU * v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stream_is_the_published_one_and_its_moments_are_right() {
        // First output of SplitMix64 with seed 1234567: 6457827717110365317.
        let expected = (6_457_827_717_110_365_317_u64 >> 11) as f64 / (1_u64 << 53) as f64;
        assert_eq!(Random::new(1_234_567).uniform(), expected);
        let mut random = Random::new(1);
        let (mut mean, mut square) = (0.0, 0.0);
        for _ in 0..100_000 {
            let x = random.normal();
            mean += x / 1e5;
            square += x * x / 1e5;
        }
        assert!(mean.abs() < 0.015 && (square - 1.0).abs() < 0.02, "{mean} {square}");
    }
}
