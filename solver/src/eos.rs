//! Equations of state: Tait (7), (8) with its background pressure, and the solid's linear one (12).

use crate::lane::Lane;

use crate::numbers::{In, Numbers};

/// Pressure from density.
pub trait EquationOfState: Copy + Send + Sync + 'static {
    /// p(ρ) \[Pa\].
    fn pressure<V: Lane>(&self, density: V) -> V;
    /// ρ(p) \[kg/m³\], the inverse.
    fn density(&self, pressure: f64) -> f64;
    /// Derived number of a particle for its sound speed c(ρ) = √(dp/dρ) \[m/s\]; `()` if c is a constant.
    type Sound: Numbers;
    /// [`EquationOfState::Sound`] from the density \[kg/m³\].
    fn sound(&self, density: f64) -> Self::Sound;
    /// c \[m/s\] from [`EquationOfState::Sound`].
    fn speed_of<V: Lane>(&self, sound: In<Self::Sound, V>) -> V;
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

    /// (8) K \[Pa\].
    #[inline(always)]
    fn stiffness(&self) -> f64 {
        self.sound_speed * self.sound_speed * self.density / f64::from(self.gamma)
    }

    /// The enthalpy w = ∫ dp/ρ from ⁰ρ = ⁰c² \[(ρ/⁰ρ)^(γ−1) − 1\]/(γ−1) \[J/kg\], for γ > 1. In a fluid at
    /// rest ∇w is gravity, at any density.
    #[inline(always)]
    pub fn enthalpy(&self, density: f64) -> f64 {
        let scale = self.sound_speed * self.sound_speed / f64::from(self.gamma - 1);
        scale * (power(density * (1.0 / self.density), self.gamma - 1) - 1.0)
    }
}

impl EquationOfState for Tait {
    #[inline(always)]
    fn pressure<V: Lane>(&self, density: V) -> V {
        let compression = power(density / V::all(self.density), self.gamma) - V::all(1.0);
        V::all(self.background) + V::all(self.stiffness()) * compression
    }

    /// The least pressure with a density is ⁰p − K, where the density is almost 0.
    fn density(&self, pressure: f64) -> f64 {
        let ratio = (pressure - self.background) / self.stiffness() + 1.0;
        // Not `max`, which would make a number of NaN.
        self.density * root(if ratio < f64::EPSILON { f64::EPSILON } else { ratio }, self.gamma)
    }

    type Sound = f64;
    /// c² = dp/dρ = ⁰c² (ρ/⁰ρ)^(γ−1).
    #[inline(always)]
    fn sound(&self, density: f64) -> f64 {
        let (ratio, n) = (density * (1.0 / self.density), self.gamma - 1);
        self.sound_speed * if n % 2 == 0 { power(ratio, n / 2) } else { power(ratio, n).sqrt() }
    }
    #[inline(always)]
    fn speed_of<V: Lane>(&self, sound: V) -> V {
        sound
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
    fn pressure<V: Lane>(&self, density: V) -> V {
        V::all(self.sound_speed * self.sound_speed) * (density - V::all(self.density))
    }

    fn density(&self, pressure: f64) -> f64 {
        self.density + pressure / (self.sound_speed * self.sound_speed)
    }

    type Sound = ();
    fn sound(&self, _: f64) {}
    #[inline(always)]
    fn speed_of<V: Lane>(&self, (): ()) -> V {
        V::all(self.sound_speed)
    }
}

/// xⁿ by squaring, n ≥ 0. Not `powi`: the compiler changes its order of multiplication, and so its bits,
/// where n is known at compile time.
#[inline(always)]
fn power<V: Lane>(x: V, n: i32) -> V {
    let (x2, x4) = (x * x, (x * x) * (x * x));
    // The powers of water without a loop, which would take 3 % of the time step of a dam break.
    match n {
        3 => return x * x2,
        6 => return x2 * x4,
        7 => return x * x2 * x4,
        _ => {}
    }
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

/// The n-th root of x > 0 by Newton's method, n ≥ 1, with + − × ÷ only: the bits are equal on every machine,
/// which `powf` does not guarantee.
fn root(x: f64, n: i32) -> f64 {
    // Not below the root (Bernoulli), from where every step of Newton's leads down, as xⁿ is convex.
    let mut root = 1.0 + (x - 1.0) / f64::from(n);
    loop {
        let next = root - (root - x / power(root, n - 1)) / f64::from(n);
        if next < root {
            root = next;
        } else {
            return root;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn density_is_the_inverse_of_pressure() {
        for gamma in [1, 2, 7] {
            let water = Tait { gamma, background: 3.0, ..Tait::new(1000.0, 12.0) };
            assert_eq!(water.density(3.0), 1000.0, "without a rounding");
            for density in [500.0, 999.9, 1000.0, 1001.0, 1300.0, 4000.0] {
                let back = water.density(water.pressure(density));
                assert_relative_eq!(back, density, max_relative = 1e-13);
            }
            let torn = water.density(-1e9);
            assert!(torn > 0.0 && torn < 10.0, "no density has that pressure: {torn}");
            assert!(water.density(f64::NAN).is_nan());
        }
        let rubber = Linear { density: 1010.0, sound_speed: 852.0 };
        assert_eq!(rubber.density(rubber.pressure(1011.0)), 1011.0);
    }

    /// dw = dp/ρ.
    #[test]
    fn the_slope_of_the_enthalpy_is_the_volume() {
        let water = Tait { background: 3.0, ..Tait::new(1000.0, 12.0) };
        assert_eq!(water.enthalpy(1000.0), 0.0);
        for density in [980.0, 1000.0, 1030.0] {
            let d = 0.01;
            let rise = water.pressure(density + d) - water.pressure(density - d);
            let enthalpy = water.enthalpy(density + d) - water.enthalpy(density - d);
            assert_relative_eq!(enthalpy * density, rise, max_relative = 1e-8);
        }
    }

    #[test]
    fn the_solid_has_one_sound_speed() {
        let rubber = Linear { density: 1010.0, sound_speed: 852.0 };
        assert_eq!(rubber.pressure(1010.0), 0.0);
        assert_eq!(rubber.pressure(1011.0), 852.0 * 852.0);
        assert_eq!(rubber.speed_of::<f64>(()), 852.0);
    }

    #[test]
    #[allow(
        clippy::disallowed_methods,
        reason = "a whole power, which the C library gives exactly too"
    )]
    fn sound_speed_is_the_slope_of_the_pressure() {
        for gamma in [1, 6, 7] {
            let water = Tait { gamma, background: 3.0, ..Tait::new(1000.0, 12.0) };
            assert_eq!(water.pressure(1000.0), 3.0);
            assert_eq!((power(1.5, gamma), power(1.5, 0)), (1.5_f64.powf(gamma.into()), 1.0));
            for density in [980.0, 1000.0, 1030.0] {
                let d = 0.01;
                let slope = (water.pressure(density + d) - water.pressure(density - d)) / (2.0 * d);
                let c = water.sound(density);
                assert_relative_eq!(c * c, slope, max_relative = 1e-8);
            }
        }
    }
}
