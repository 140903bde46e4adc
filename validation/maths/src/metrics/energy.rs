//! The energies of weakly compressible water under gravity, from its particles.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use touchstone_base::functions::{exp_m1, ln};
use touchstone_solver::{EquationOfState, Numbers, Rate, State, Stepper, Tait};

/// Parameters of the energy of a particle.
#[derive(Clone, Copy, Debug)]
pub struct Water {
    /// Equation of state (7).
    pub eos: Tait,
    /// Acceleration g \[m/s²\].
    pub gravity: Vector2<f64>,
}

/// Energies \[J/m\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FluidEnergy {
    /// Σ m v²/2.
    pub kinetic: f64,
    /// −Σ m g·x.
    pub potential: f64,
    /// Σ m e with de = p dρ/ρ², including wall particles, which store the work of the water on them.
    pub compression: f64,
}

impl FluidEnergy {
    /// Their sum.
    pub fn sum(&self) -> f64 {
        self.kinetic + self.potential + self.compression
    }
}

impl Water {
    /// e(ρ) = ∫ p/ρ² dρ from ⁰ρ \[J/kg\]: with x = ρ/⁰ρ and K of (8),
    /// (K/⁰ρ) \[(x^(γ−1) − 1)/(γ−1) + 1/x − 1\] + (⁰p/⁰ρ) (1 − 1/x).
    pub fn compression(&self, density: f64) -> f64 {
        let Tait { density: rho, sound_speed, gamma, background } = self.eos;
        let (x, gamma) = (density / rho, f64::from(gamma));
        let k = sound_speed * sound_speed / gamma;
        // (x^n − 1)/n → ln x for γ = 1.
        let power = match gamma - 1.0 {
            0.0 => ln(x),
            n => exp_m1(n * ln(x)) / n,
        };
        k * (power + 1.0 / x - 1.0) + background / rho * (1.0 - 1.0 / x)
    }

    /// The energy of all particles.
    pub fn energy<X: Numbers>(&self, simulation: &dyn Stepper<X>) -> FluidEnergy {
        let mut sum = FluidEnergy::default();
        for (mass, p) in simulation.data().fluid() {
            sum.kinetic += 0.5 * mass * p.velocity.norm_squared();
            sum.potential -= mass * self.gravity.dot(&p.position);
            sum.compression += mass * self.compression(p.density);
        }
        for (mass, p) in simulation.data().walls() {
            sum.compression += mass * self.compression(p.density);
        }
        sum
    }
}

/// The slope of that energy: m (v·v̇ + (p/ρ²) ρ̇ − g·ẋ), ẋ without v, whose part is the work of
/// gravity on both sides.
pub fn water_slope<X>(water: &Water) -> impl Fn(f64, &State<X>, &Rate<X>) -> f64 + use<X> {
    let Water { eos, gravity } = *water;
    move |mass, particle, rate| {
        let State { velocity, density, .. } = particle;
        let pressure = eos.pressure(*density) / (density * density);
        mass * (velocity.dot(&rate.velocity) + pressure * rate.density
            - gravity.dot(&rate.position))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_compression_energy_is_the_work_of_the_pressure() {
        for gamma in [1, 7] {
            let eos = Tait { gamma, background: 5.0, ..Tait::new(2.0, 9.0) };
            let water = Water { eos, gravity: Vector2::zeros() };
            assert_eq!(water.compression(2.0), 0.0);
            for density in [1.9, 1.999, 2.03, 2.4] {
                let d = 1e-5;
                let slope = water.compression(density + d) - water.compression(density - d);
                let expected = eos.pressure(density) / (density * density);
                let error = (slope / (2.0 * d) / expected - 1.0).abs();
                assert!(error < 1e-6, "gamma {gamma}, {density}: {error:e}");
            }
        }
    }
}
