//! Equations of state: Tait (7), (8) with its background pressure, and the solid's linear one (12).

use crate::lane::Lane;

/// Pressure from density.
pub trait EquationOfState: Copy + Send + Sync + 'static {
    /// p(ρ) \[Pa\].
    fn pressure(&self, density: f64) -> f64;
    /// c(ρ) = √(dp/dρ) \[m/s\].
    fn sound_speed<V: Lane>(&self, density: V) -> V;
}

/// (7) p = ⁰p + K \[(ρ/⁰ρ)^γ − 1\] with (8) K = ⁰c² ⁰ρ / γ.
#[derive(Clone, Copy, Debug)]
pub struct Tait {
    /// Initial (reference) density ⁰ρ \[kg/m³\].
    pub density: f64,
    /// Initial sound speed ⁰c \[m/s\].
    pub sound_speed: f64,
    /// Exponent γ, an integer; 7 for water (inferred: the scan of the paper lost it).
    pub gamma: i32,
    /// Background pressure ⁰p \[Pa\]: keeps p > 0, where the tensile instability cannot act.
    pub background: f64,
}

impl Tait {
    /// Water-like: γ = 7, no background pressure.
    pub fn new(density: f64, sound_speed: f64) -> Self {
        Self { density, sound_speed, gamma: 7, background: 0.0 }
    }
}

impl EquationOfState for Tait {
    #[inline(always)]
    fn pressure(&self, density: f64) -> f64 {
        let stiffness = self.sound_speed * self.sound_speed * self.density / f64::from(self.gamma);
        self.background + stiffness * (power(density / self.density, self.gamma) - 1.0)
    }

    /// c² = dp/dρ = ⁰c² (ρ/⁰ρ)^(γ−1).
    #[inline(always)]
    fn sound_speed<V: Lane>(&self, density: V) -> V {
        let ratio = density / V::all(self.density);
        V::all(self.sound_speed) * power(ratio, self.gamma - 1).simd_sqrt()
    }
}

/// (12) p = ⁰c² (ρ − ⁰ρ), so that (13) K = ⁰ρ ⁰c² is the bulk modulus of the solid.
#[derive(Clone, Copy, Debug)]
pub struct Linear {
    /// Initial (reference) density ⁰ρ \[kg/m³\].
    pub density: f64,
    /// Bulk sound speed ⁰c \[m/s\].
    pub sound_speed: f64,
}

impl EquationOfState for Linear {
    #[inline(always)]
    fn pressure(&self, density: f64) -> f64 {
        self.sound_speed * self.sound_speed * (density - self.density)
    }

    #[inline(always)]
    fn sound_speed<V: Lane>(&self, _: V) -> V {
        V::all(self.sound_speed)
    }
}

/// xⁿ by squaring, n ≥ 0. Not `powi`: its order of multiplication, and so its bits, change with what
/// the compiler knows about n where it is inlined.
#[inline(always)]
fn power<V: Lane>(x: V, n: i32) -> V {
    let (mut product, mut square, mut n) = (V::all(1.0), x, n);
    while n > 0 {
        if n & 1 == 1 {
            product *= square;
        }
        square *= square;
        n >>= 1;
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_solid_has_one_sound_speed() {
        let rubber = Linear { density: 1010.0, sound_speed: 852.0 };
        assert_eq!(rubber.pressure(1010.0), 0.0);
        assert_eq!(rubber.pressure(1011.0), 852.0 * 852.0);
        assert_eq!(rubber.sound_speed(3.0), 852.0);
    }

    #[test]
    fn sound_speed_is_the_slope_of_the_pressure() {
        for gamma in [1, 6, 7] {
            let water = Tait { gamma, background: 3.0, ..Tait::new(1000.0, 12.0) };
            assert_eq!(water.pressure(1000.0), 3.0);
            assert_eq!((power(1.5, gamma), power(1.5, 0)), (1.5_f64.powf(gamma.into()), 1.0));
            for density in [980.0, 1000.0, 1030.0] {
                let d = 0.01;
                let slope = (water.pressure(density + d) - water.pressure(density - d)) / (2.0 * d);
                let c: f64 = water.sound_speed(density);
                assert_relative_eq!(c * c, slope, max_relative = 1e-8);
            }
        }
    }
}
