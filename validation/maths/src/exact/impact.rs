//! Two equal elastic strips that meet head-on in uniaxial strain: the exact jump conditions.
//!
//! With J = ⁰ρ/ρ the stress of (12) and (11) is −σ = K (1/J − 1) − (4/3) μ ln J, for the Jaumann rate
//! integrates a strain without rotation to its logarithm. A compression that stops material of speed
//! V travels through the strip at U with ⁰ρ U V = −σ and V = U (1 − J); as V → 0, −σ = ⁰ρ c_p V and
//! U = c_p. Each strip of length L gives its momentum 2 ⁰ρ L V to the other in 2 L/U.

use touchstone_base::functions::ln_1p;

use crate::halved;

/// Stress and wave speed of an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// −σ of the contact \[Pa\].
    pub stress: f64,
    /// U in the strip's own length \[m/s\].
    pub speed: f64,
}

impl Impact {
    /// Strips of bulk modulus K \[Pa\], shear modulus μ \[Pa\] and density \[kg/m³\], each at the speed
    /// V \[m/s\], above 0.
    pub fn new(bulk: f64, shear: f64, density: f64, v: f64) -> Self {
        let excess = |e: f64| stress(bulk, shear, e) * e - density * v * v; // J = 1 − e
        let [low, high] = halved([0.0, 0.999], 200, |e| excess(e) < 0.0);
        let e = 0.5 * (low + high);
        Self { stress: stress(bulk, shear, e), speed: v / e }
    }
}

/// −σ at J = 1 − e \[Pa\].
fn stress(bulk: f64, shear: f64, e: f64) -> f64 {
    bulk * e / (1.0 - e) - 4.0 / 3.0 * shear * ln_1p(-e)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn slow_strips_meet_as_linear_theory_has_it() {
        let (bulk, shear, density) = (3.0_f64, 0.7_f64, 2.0_f64);
        let c = ((bulk + 4.0 / 3.0 * shear) / density).sqrt();
        let slow = Impact::new(bulk, shear, density, 1e-5 * c);
        assert_relative_eq!(slow.stress, density * c * 1e-5 * c, max_relative = 2e-5);
        assert_relative_eq!(slow.speed, c, max_relative = 2e-5);
    }

    #[test]
    fn fast_strips_keep_mass_and_momentum() {
        for v in [0.1, 0.5, 1.0] {
            let Impact { stress, speed } = Impact::new(3.0, 0.7, 2.0, v);
            assert_relative_eq!(stress, 2.0 * speed * v, max_relative = 1e-12);
            // Without shear, U² − U V = c²: closed form.
            let fluid = Impact::new(3.0, 0.0, 2.0, v).speed;
            assert_relative_eq!(fluid * (fluid - v), 1.5, max_relative = 1e-12);
        }
    }
}
