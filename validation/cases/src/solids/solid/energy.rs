//! The energies of an elastic body per unit depth, from its particles.

use serde::{Deserialize, Serialize};
use touchstone_base::absent::Absent;
use touchstone_harness::snapshot::{Moments, Point, Snapshot, kinetic};
use touchstone_solver::{Potential, Symmetric};

use super::Material;

/// Energies \[J/m\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ElasticEnergy<T = f64> {
    /// Σ m v²/2.
    pub kinetic: T,
    /// Σ m e with de = p dρ/ρ² and (12): e = ⁰c² (ln(ρ/⁰ρ) + ⁰ρ/ρ − 1).
    pub compression: T,
    /// Σ (m/ρ) S:S/(4μ) with Sᶻᶻ = −(Sˣˣ + Sʸʸ).
    pub shear: T,
}

impl ElasticEnergy {
    /// The energy of all fluid particles of a simulation. If its forces have potentials, these are used:
    /// energy of loads counts as compression, and energy of the hourglass resistance as shear.
    pub fn of(now: &Snapshot<Symmetric>, of: &Material) -> Result<Self, Absent> {
        let of_points = || Self::of_points(now.stored(), now, of);
        Self::known(now).map_or_else(of_points, Ok)
    }

    /// The energy that a method states whose forces derive from energies.
    pub fn known(now: &Snapshot<Symmetric>) -> Option<Self> {
        let potential = now.sums(|simulation| simulation.potential()).ok()??;
        let Potential { compression, shear, hourglass, loads } = potential;
        let (compression, shear) = (compression + loads, shear + hourglass);
        Some(Self { kinetic: kinetic(now.stored()), compression, shear })
    }

    /// The energy of particles of a snapshot.
    ///
    /// # Errors
    /// As [`ElasticEnergy::of`].
    pub fn of_points(
        points: impl Iterator<Item = Point> + Clone,
        now: &Snapshot<Symmetric>,
        of: &Material,
    ) -> Result<Self, Absent> {
        let ElasticEnergy { kinetic, compression, shear } = Self::each(points, now, of);
        Ok(Self { kinetic: kinetic?, compression: compression?, shear: shear? })
    }

    /// The energies of particles of a snapshot, each with the columns that it needs.
    pub fn each(
        points: impl Iterator<Item = Point> + Clone,
        now: &Snapshot<Symmetric>,
        of: &Material,
    ) -> ElasticEnergy<Result<f64, Absent>> {
        let compression = now.density().map(|density| {
            let energy = |p: Point| of.compression_energy(p.mass, density.of(&p));
            points.clone().map(energy).fold(0.0, |sum, one| sum + one)
        });
        let shear = now.density().and_then(|density| {
            let stress = now.stress()?;
            let energy = |p: Point| of.shear_energy(p.mass / density.of(&p), &stress.of(&p));
            Ok(points.clone().map(energy).fold(0.0, |sum, one| sum + one))
        });
        ElasticEnergy { kinetic: Ok(kinetic(points)), compression, shear }
    }

    /// Total energy.
    pub fn total(&self) -> f64 {
        self.kinetic + (self.compression + self.shear)
    }
}

/// Angular momentum about the centre of mass \[kg m²/s per m\].
pub fn angular_momentum(now: &Snapshot<Symmetric>) -> f64 {
    let Moments { centre, velocity, .. } = Moments::of(now.stored());
    let spin = |p: Point| p.mass * (p.position - centre).perp(&(p.velocity - velocity));
    now.stored().map(spin).fold(0.0, |sum, one| sum + one)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::Vector2;
    use touchstone_solver::Particle;

    fn particle(density: f64, speed: f64, extra: Symmetric) -> Particle<Symmetric> {
        let velocity = Vector2::new(0.6 * speed, -0.8 * speed);
        Particle { density, extra, ..Particle::fluid(Vector2::zeros(), velocity, 1.0, 1.0) }
    }

    fn of_one(mass: f64, particle: &Particle<Symmetric>, material: &Material) -> ElasticEnergy {
        let now = Snapshot::of(0.0, &[Particle { mass, ..*particle }]);
        ElasticEnergy::of(&now, material).expect("every column")
    }

    #[test]
    fn simple_states_have_the_energies_of_the_books() {
        let material = Material { density: 2.0, bulk: 8.0, shear: 3.0 };
        let nothing = Symmetric::default();
        let at_rest = of_one(5.0, &particle(2.0, 0.0, nothing), &material);
        assert_eq!(at_rest, ElasticEnergy::default());
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
