//! The energies of an elastic body per unit depth, from its particles.

use nalgebra::Vector2;
use touchstone_base::functions::ln_1p;
use touchstone_solver::{Numbers, Particle, Potential, State, Stepper, Symmetric};

use super::Material;

/// Energies \[J/m\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Σ m v²/2.
    pub kinetic: f64,
    /// Σ m e with de = p dρ/ρ² and (12): e = ⁰c² (ln(ρ/⁰ρ) + ⁰ρ/ρ − 1).
    pub compression: f64,
    /// Σ (m/ρ) S:S/(4μ) with Sᶻᶻ = −(Sˣˣ + Sʸʸ).
    pub shear: f64,
}

impl Energy {
    /// The energy of all fluid particles of a simulation. If its forces have potentials, these are used:
    /// energy of loads counts as compression, and energy of the hourglass resistance as shear.
    pub fn of(simulation: &dyn Stepper<Symmetric>, of: &Material) -> Self {
        if let Some(known) = Self::known(simulation) {
            return known;
        }
        simulation.data().fluid().fold(Self::default(), |sum, (mass, p)| sum.with(mass, p, of))
    }

    /// The energy of a simulation whose forces have potentials.
    pub fn known(simulation: &dyn Stepper<Symmetric>) -> Option<Self> {
        let Potential { compression, shear, hourglass, loads } = simulation.potential()?;
        let half = |(mass, p): (f64, &State<Symmetric>)| 0.5 * mass * p.velocity.norm_squared();
        let kinetic = simulation.data().fluid().map(half).fold(0.0, |sum, one| sum + one);
        Some(Self { kinetic, compression: compression + loads, shear: shear + hourglass })
    }

    /// The energy of these particles.
    pub fn of_all(particles: &[Particle<Symmetric>], of: &Material) -> Self {
        particles.iter().fold(Self::default(), |sum, p| {
            let Particle { position, velocity, density, extra, .. } = *p;
            sum.with(p.mass, &State { position, velocity, density, extra }, of)
        })
    }

    /// The sum with one more particle of this mass \[kg/m\].
    fn with(self, mass: f64, particle: &State<Symmetric>, material: &Material) -> Self {
        let ratio = particle.density / material.density;
        let c2 = material.bulk / material.density;
        // ln(1 + x) − x/(1 + x): neither term alone is small where their difference is.
        let x = ratio - 1.0;
        // Without a shear modulus there is no shear stress to hold energy.
        let shear = if material.shear > 0.0 {
            mass / particle.density * norm_squared(&particle.extra) / (4.0 * material.shear)
        } else {
            0.0
        };
        Self {
            kinetic: self.kinetic + 0.5 * mass * particle.velocity.norm_squared(),
            compression: self.compression + mass * c2 * (ln_1p(x) - x / ratio),
            shear: self.shear + shear,
        }
    }

    /// Total energy.
    pub fn total(&self) -> f64 {
        self.kinetic + (self.compression + self.shear)
    }
}

/// S:S of a deviator of plane strain \[Pa²\]: Sᶻᶻ = −(Sˣˣ + Sʸʸ) counts too.
pub fn norm_squared(s: &Symmetric) -> f64 {
    let zz = s.xx + s.yy;
    s.xx * s.xx + s.yy * s.yy + zz * zz + 2.0 * s.xy * s.xy
}

/// Angular momentum about the centre of mass \[kg m²/s per m\].
pub fn angular_momentum<X: Numbers>(simulation: &dyn Stepper<X>) -> f64 {
    let sums = simulation.data().fluid().fold(
        (0.0, Vector2::zeros(), Vector2::zeros()),
        |(mass, first, momentum), (m, p)| {
            (mass + m, first + p.position * m, momentum + p.velocity * m)
        },
    );
    let (centre, drift) = (sums.1 / sums.0, sums.2 / sums.0);
    let spin = |(m, p): (f64, &State<X>)| m * (p.position - centre).perp(&(p.velocity - drift));
    simulation.data().fluid().map(spin).fold(0.0, |sum, one| sum + one)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn particle(density: f64, speed: f64, extra: Symmetric) -> State<Symmetric> {
        let velocity = Vector2::new(0.6 * speed, -0.8 * speed);
        State { position: Vector2::zeros(), velocity, density, extra }
    }

    fn of_one(mass: f64, particle: &State<Symmetric>, material: &Material) -> Energy {
        Energy::default().with(mass, particle, material)
    }

    #[test]
    fn simple_states_have_the_energies_of_the_books() {
        let material = Material { density: 2.0, bulk: 8.0, shear: 3.0 };
        let nothing = Symmetric::default();
        let at_rest = of_one(5.0, &particle(2.0, 0.0, nothing), &material);
        assert_eq!(at_rest, Energy::default());
        let moving = of_one(5.0, &particle(2.0, 3.0, nothing), &material);
        assert_relative_eq!(moving.total(), 22.5, max_relative = 1e-15);
        // Small compression: V K e²/2; V = 2.5.
        let e = 1e-5;
        let pressed = of_one(5.0, &particle(2.0 * (1.0 + e), 0.0, nothing), &material);
        assert_relative_eq!(pressed.compression, 2.5 * 8.0 * e * e / 2.0, max_relative = 1e-4);
        // Simple shear by g: S_xy = mu g, energy V mu g²/2.
        let sheared = Symmetric { xy: 3.0 * 0.01, ..nothing };
        let sheared = of_one(5.0, &particle(2.0, 0.0, sheared), &material);
        assert_relative_eq!(sheared.shear, 2.5 * 3.0 * 1e-4 / 2.0, max_relative = 1e-12);
        // Uniaxial strain e: S = 2 mu e (2/3, -1/3, -1/3), energy V (4/3) mu e²/2.
        let (xx, yy) = (4.0 / 3.0 * 3.0 * e, -2.0 / 3.0 * 3.0 * e);
        let along = of_one(5.0, &particle(2.0, 0.0, Symmetric { xx, yy, xy: 0.0 }), &material);
        assert_relative_eq!(along.shear, 2.5 * 4.0 / 3.0 * 3.0 * e * e / 2.0, max_relative = 1e-12);
    }

    /// The compression energy is the work of (12): de = p dρ/ρ².
    #[test]
    fn the_compression_energy_is_the_work_of_the_pressure() {
        let material = Material { density: 2.0, bulk: 8.0, shear: 3.0 };
        let energy = |rho: f64| of_one(1.0, &particle(rho, 0.0, Symmetric::default()), &material);
        for rho in [1.6, 1.9, 2.3, 3.0] {
            let d = 1e-5;
            let slope = (energy(rho + d).compression - energy(rho - d).compression) / (2.0 * d);
            assert_relative_eq!(slope, 4.0 * (rho - 2.0) / (rho * rho), max_relative = 1e-7);
        }
    }
}
