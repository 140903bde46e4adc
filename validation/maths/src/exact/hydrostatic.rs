//! A column of Tait fluid at rest under gravity: dp/dy = −ρ g with (7).

use touchstone_base::functions::powf;
use touchstone_solver::Tait;

/// A column, compressed by its own weight.
#[derive(Clone, Copy, Debug)]
pub struct Hydrostatic {
    /// Equation of state (7), with γ > 1; ⁰ρ and ⁰c are the values at the surface, where p = 0.
    pub eos: Tait,
    /// Gravity g \[m/s²\].
    pub gravity: f64,
}

impl Hydrostatic {
    /// ρ/⁰ρ to the power γ − 1, 1 + (γ−1) g d/⁰c² at the depth d \[m\], negative above the surface.
    fn power(&self, depth: f64) -> f64 {
        let Tait { sound_speed, gamma, .. } = self.eos;
        1.0 + f64::from(gamma - 1) * self.gravity * depth / (sound_speed * sound_speed)
    }

    /// ρ at a depth \[m\], ⁰ρ \[1 + (γ−1) g d/⁰c²\]^(1/(γ−1)).
    pub fn density(&self, depth: f64) -> f64 {
        self.eos.density * powf(self.power(depth), 1.0 / f64::from(self.eos.gamma - 1))
    }

    /// p at a depth \[m\], (⁰ρ ⁰c²/γ) {\[1 + (γ−1) g d/⁰c²\]^(γ/(γ−1)) − 1} \[Pa\].
    pub fn pressure(&self, depth: f64) -> f64 {
        let Tait { density, sound_speed, gamma, .. } = self.eos;
        let gamma = f64::from(gamma);
        let stiffness = density * sound_speed * sound_speed / gamma;
        stiffness * (powf(self.power(depth), gamma / (gamma - 1.0)) - 1.0)
    }

    /// Sound speed at a depth \[m\], ⁰c \[1 + (γ−1) g d/⁰c²\]^(1/2) \[m/s\].
    pub fn sound_speed(&self, depth: f64) -> f64 {
        self.eos.sound_speed * self.power(depth).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use touchstone_solver::EquationOfState;

    #[test]
    fn the_column_is_in_equilibrium_and_obeys_the_equation_of_state() {
        for compressibility in [1e-4_f64, 1e-2, 0.1, 1.0] {
            let sound_speed = (9.81 / compressibility).sqrt();
            let eos = Tait::new(1000.0, sound_speed);
            let column = Hydrostatic { eos, gravity: 9.81 };
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
