//! The elastic material, and the medium that it is at a spacing.

use touchstone_harness::{
    limits::{Mechanism, TimeStepLimits},
    method::{Medium, Properties},
};
use touchstone_maths::theory::time_step;
use touchstone_solver::{Linear, Tait};

use super::lagrangian;

/// An isotropic elastic solid: small-strain moduli, plane strain with the 1/3 of three dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Density ⁰ρ without stress \[kg/m³\].
    pub density: f64,
    /// K, the bulk modulus of three dimensions \[Pa\].
    pub bulk: f64,
    /// μ, the shear modulus \[Pa\].
    pub shear: f64,
}

impl Material {
    /// From Young's modulus E \[Pa\] and Poisson's ratio: K = E/(3(1 − 2ν)), μ = E/(2(1 + ν)).
    pub fn from_young(density: f64, young: f64, poisson: f64) -> Self {
        let (bulk, shear) =
            (young / (3.0 * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)));
        Self { density, bulk, shear }
    }

    /// (13) ⁰c = √(K/⁰ρ) \[m/s\].
    pub fn sound_speed(&self) -> f64 {
        (self.bulk / self.density).sqrt()
    }

    /// c_p = √((K + 4μ/3)/⁰ρ) \[m/s\]: the fastest wave, which limits the time step.
    pub fn p_wave_speed(&self) -> f64 {
        ((self.bulk + 4.0 / 3.0 * self.shear) / self.density).sqrt()
    }

    /// (μ/⁰ρ)^(1/2), the speed of shear waves \[m/s\].
    pub fn shear_wave_speed(&self) -> f64 {
        (self.shear / self.density).sqrt()
    }

    /// (12).
    pub fn eos(&self) -> Linear {
        Linear { density: self.density, sound_speed: self.sound_speed() }
    }

    /// The medium of a method at this spacing \[m\] and smoothing length \[m\], without any stabilisation.
    pub fn medium(&self, method: &Properties, lengths: [f64; 2]) -> Medium {
        let Linear { density, sound_speed } = self.eos();
        let eos = Tait { density, sound_speed, gamma: 7, background: 0.0 };
        Medium { shear_modulus: self.shear, ..method.medium(eos, lengths) }
    }
}

/// Side of the periodic box whose waves give the limit of the time step.
const LIMIT_BOX: usize = 24;

/// The limits of the step of a method on a stress-free lattice of this material, with artificial viscosity
/// on every pair: together with α = 1 about 1.1 h/c_p for the leapfrog.
///
/// The fastest waves have the speed c_p. The c of the artificial viscosity is the equation of state's, c₀, so
/// its α counts as α c₀/c_p of c_p. Bodies may meet at the speed `approach` \[m/s\], 0 without contact.
pub fn limits(
    method: &Properties,
    material: &Material,
    medium: &Medium,
    h_over_dx: f64,
    approach: f64,
) -> TimeStepLimits {
    let meeting = medium.h / approach;
    if let Some(limit) = method.limit {
        let lattice = limit(medium);
        let mut limits = TimeStepLimits::of_waves(lattice).with(Mechanism::Contact, meeting);
        if approach > 0.0 {
            // Each of two equal bodies changes its velocity by V, half of that, which takes rho c_p V and
            // compresses it by V/c_p; the frequencies of compressed matter grow as its density.
            let (cp, v) = (material.p_wave_speed(), 0.5 * approach);
            let compressed = lattice * (1.0 - v / cp).max(0.1);
            let pressure = material.density * cp * v;
            limits.together = lagrangian::limit_in_contact(compressed, medium, pressure);
        }
        return limits;
    }
    let wave = material.p_wave_speed();
    let alpha = medium.alpha * material.sound_speed() / wave;
    let waves = time_step::WaveMedium { alpha, ..time_step::WaveMedium::of_sound(wave, medium.h) };
    let limits = method.limits([h_over_dx, 0.01], LIMIT_BOX, &waves);
    // Both kinds of waves have the rates of one gradient.
    let shear = limits.alone(Mechanism::Waves) * wave / material.shear_wave_speed();
    limits.with(Mechanism::ShearWaves, shear).with(Mechanism::Contact, meeting)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::Vector2;
    use touchstone_harness::method::Parts;
    use touchstone_schemes::solid::{bare, corrected};
    use touchstone_solver::{Domain, Outcome, Particle};

    /// The viscosity is α h c0, not α h c_p: both rings and bars must use this.
    #[test]
    fn the_step_limit_has_the_viscosity_of_the_bulk_sound_speed() {
        let method = touchstone_schemes::solid::clamped_plain();
        let limit = |shear: f64, alpha: f64| {
            let material = Material { density: 1.0, bulk: 1.0, shear };
            let medium = Medium { alpha, ..material.medium(&method.properties, [1.0, 1.5]) };
            limits(&method.properties, &material, &medium, 1.5, 0.0).together
                * material.p_wave_speed()
        };
        // Without viscosity, and without shear: 1.87 h/c_p, and 1.03 with α = 1.
        assert_relative_eq!(limit(0.22, 0.0) / 1.5, 1.87, max_relative = 1e-2);
        assert_relative_eq!(limit(0.0, 1.0) / 1.5, 1.03, max_relative = 1e-2);
        let wave = Material { density: 1.0, bulk: 1.0, shear: 0.22 }.p_wave_speed();
        assert_relative_eq!(limit(0.22, wave), limit(0.0, 1.0), max_relative = 1e-12);
    }

    #[test]
    fn rubber_has_the_moduli_and_wave_speeds_of_the_rings() {
        let rubber = Material::from_young(1000.0, 2e6, 0.3975);
        assert_relative_eq!(rubber.shear / rubber.bulk, 0.22, max_relative = 1e-3);
        let (c, cp) = (rubber.sound_speed(), rubber.p_wave_speed());
        assert_relative_eq!(cp / c, 1.137, max_relative = 1e-3);
        assert_relative_eq!(c, 57.02, max_relative = 1e-3);
        // As docs/limits.md has them: c_p over the speed of shear waves.
        for (poisson, ratio) in [(0.3975, 2.42), (0.49, 7.14), (0.499, 22.4), (0.4999, 70.7)] {
            let rubber = Material::from_young(1000.0, 2e6, poisson);
            let found = rubber.p_wave_speed() / rubber.shear_wave_speed();
            assert_relative_eq!(found, ratio, max_relative = 2e-3);
        }
        // K = E/(3(1-2nu)) and mu = E/(2(1+nu)) have 9 K mu/(3 K + mu) = E.
        let young = 9.0 * rubber.bulk * rubber.shear / (3.0 * rubber.bulk + rubber.shear);
        assert_relative_eq!(young, 2e6, max_relative = 1e-12);
    }

    const SIDE: usize = 24;
    const RUBBER: Material = Material { density: 1.0, bulk: 1.0, shear: 0.22 };

    /// The largest speed of a lattice at rest after 60 steps of `of_limit` times the limit, over the noise at
    /// the start.
    fn growth(of_limit: f64) -> f64 {
        let method = corrected();
        let medium = RUBBER.medium(&method.properties, [1.0, 1.5]);
        let dt = of_limit * limits(&method.properties, &RUBBER, &medium, 1.5, 0.0).together;
        let noise = |k: usize| 1e-12 * ((k as f64 * 0.618_033_988_749_895).fract() - 0.5);
        let places = touchstone_solver::lattice(Vector2::repeat(0.5), 1.0, SIDE, SIDE).enumerate();
        let particles = places
            .map(|(k, x)| Particle::fluid(x, Vector2::new(noise(3 * k), noise(7 * k)), 1.0, 1.0))
            .collect();
        let domain = Domain::torus(SIDE as f64, SIDE as f64);
        let parts = Parts::new(medium, domain, particles);
        let mut simulation = (method.build)(parts).expect("a scene");
        assert_eq!(simulation.advance(60.0 * dt, dt, &mut ()), Outcome::Reached);
        simulation.data().fluid().map(|(_, p)| p.velocity.norm()).fold(0.0, f64::max) / 1e-12
    }

    #[test]
    fn the_step_limit_is_that_of_the_lattice_within_half_a_per_cent() {
        let [below, above] = [0.995, 1.005].map(growth);
        assert!(below < 10.0 && above > 1e2, "{below:e} {above:e}");
    }

    /// 1.0067, the factor of gradients at h = 1.5 dx: without correction the limit is as much shorter.
    #[test]
    fn correction_lengthens_the_step_by_the_factor_of_gradients() {
        fn limit(method: Properties) -> f64 {
            limits(&method, &RUBBER, &RUBBER.medium(&method, [1.0, 1.5]), 1.5, 0.0).together
        }
        let ratio = limit(corrected().properties) / limit(bare().properties);
        let factor = bare().properties.square([1.5, 0.0]).gradient_factor();
        assert!((ratio / factor - 1.0).abs() < 1e-12 && factor > 1.006, "{ratio} {factor}");
    }
}
