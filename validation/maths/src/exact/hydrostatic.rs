//! A column of Tait fluid at rest under gravity: dp/dy = −ρ g with (7).

use base::functions::powf;

/// A column, compressed by its own weight.
#[derive(Clone, Copy, Debug)]
pub struct Hydrostatic {
    /// Density at the surface ⁰ρ, where p = 0 \[kg/m³\].
    pub density: f64,
    /// Sound speed at the surface ⁰c \[m/s\].
    pub sound_speed: f64,
    /// Exponent γ > 1.
    pub gamma: f64,
    /// Gravity g \[m/s²\].
    pub gravity: f64,
}

impl Hydrostatic {
    /// ρ/⁰ρ to the power γ − 1, 1 + (γ−1) g d/⁰c² at the depth d \[m\], negative above the surface.
    fn power(&self, depth: f64) -> f64 {
        1.0 + (self.gamma - 1.0) * self.gravity * depth / (self.sound_speed * self.sound_speed)
    }

    /// ρ at a depth \[m\], ⁰ρ \[1 + (γ−1) g d/⁰c²\]^(1/(γ−1)).
    pub fn density(&self, depth: f64) -> f64 {
        self.density * powf(self.power(depth), 1.0 / (self.gamma - 1.0))
    }

    /// p at a depth \[m\], (⁰ρ ⁰c²/γ) {\[1 + (γ−1) g d/⁰c²\]^(γ/(γ−1)) − 1} \[Pa\].
    pub fn pressure(&self, depth: f64) -> f64 {
        let stiffness = self.density * self.sound_speed * self.sound_speed / self.gamma;
        stiffness * (powf(self.power(depth), self.gamma / (self.gamma - 1.0)) - 1.0)
    }

    /// Sound speed at a depth \[m\], ⁰c \[1 + (γ−1) g d/⁰c²\]^(1/2) \[m/s\].
    pub fn sound_speed(&self, depth: f64) -> f64 {
        self.sound_speed * self.power(depth).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use solver::{EquationOfState, Tait};

    #[test]
    fn the_column_is_in_equilibrium_and_obeys_the_equation_of_state() {
        for compressibility in [1e-4_f64, 1e-2, 0.1, 1.0] {
            let sound_speed = (9.81 / compressibility).sqrt();
            let column = Hydrostatic { density: 1000.0, sound_speed, gamma: 7.0, gravity: 9.81 };
            let eos = Tait::new(1000.0, sound_speed);
            assert_eq!((column.pressure(0.0), column.density(0.0)), (0.0, 1000.0));
            for depth in [-0.02, 0.1, 0.5, 1.0] {
                let (p, rho) = (column.pressure(depth), column.density(depth));
                assert_relative_eq!(eos.pressure(rho), p, max_relative = 1e-8);
                let c = eos.sound(rho);
                assert_relative_eq!(c, column.sound_speed(depth), max_relative = 1e-12);
                let d = 1e-4;
                let slope = (column.pressure(depth + d) - column.pressure(depth - d)) / (2.0 * d);
                assert_relative_eq!(slope, rho * 9.81, max_relative = 1e-7);
            }
        }
    }
}
