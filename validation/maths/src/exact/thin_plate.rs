//! The first mode of a thin elastic plate that is clamped at one end (Landau & Lifshitz).

use std::f64::consts::TAU;

use touchstone_base::functions::{cos, cosh, sin, sinh};

/// k L of the first mode of a cantilever: cos kL cosh kL = −1.
pub const FIRST_MODE: f64 = 1.875_104_068_711_961;

/// A plate that is clamped at one end.
#[derive(Clone, Copy, Debug)]
pub struct ThinPlate {
    /// \[m\].
    pub length: f64,
    /// \[m\].
    pub thickness: f64,
    /// Young's modulus \[Pa\].
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// \[kg/m³\].
    pub density: f64,
}

impl ThinPlate {
    /// 2π/ω \[s\], with ω² = E H² k⁴/(12 ρ (1 − ν²)).
    pub fn period(&self) -> f64 {
        let Self { length, thickness, young, poisson, density } = self;
        let k = FIRST_MODE / length;
        let stiffness = young * thickness * thickness / (12.0 * (1.0 - poisson * poisson));
        TAU / (k * k * (stiffness / density).sqrt())
    }
}

/// The deflection of the first mode at x/L, 1 at the tip.
pub fn mode(x: f64) -> f64 {
    let q = FIRST_MODE;
    let f = |x: f64| {
        let z = q * x;
        (cos(q) + cosh(q)) * (cosh(z) - cos(z)) + (sin(q) - sinh(q)) * (sinh(z) - sin(z))
    };
    f(x) / f(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Held and level at the clamp, no moment and no shear at the tip.
    #[test]
    fn the_mode_is_that_of_a_cantilever() {
        let (d, q) = (1e-4, FIRST_MODE);
        assert!((cos(q) * cosh(q) + 1.0).abs() < 1e-12);
        assert_eq!((mode(0.0), mode(1.0)), (0.0, 1.0));
        assert!(mode(d).abs() < 1e-7);
        let second = |x: f64| (mode(x + d) - 2.0 * mode(x) + mode(x - d)) / (d * d);
        assert!(second(1.0).abs() < 1e-5 * second(0.0));
        assert!((second(1.0 + d) - second(1.0 - d)).abs() / (2.0 * d) < 1e-2 * second(0.0));
    }
}
