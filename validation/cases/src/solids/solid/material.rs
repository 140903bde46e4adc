//! The medium that an elastic material is at a spacing, and its limits of the time step.

use touchstone_harness::{
    limits::{Mechanism, TimeStepLimits},
    method::{Medium, Properties},
};
use touchstone_maths::{metrics::elastic::Material, theory::time_step};
use touchstone_solver::{Linear, Tait};

use super::lagrangian;

/// The medium of a method at this spacing \[m\] and smoothing length \[m\], without any stabilisation.
pub fn medium_of(material: &Material, method: &Properties, dx: f64, h: f64) -> Medium {
    let Linear { density, sound_speed } = material.eos();
    let eos = Tait { density, sound_speed, gamma: 7, background: 0.0 };
    Medium { shear_modulus: material.shear, ..method.medium(eos, dx, h) }
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
    let limits = method.limits(&method.square(h_over_dx, 0.01), LIMIT_BOX, &waves);
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
            let medium = Medium { alpha, ..medium_of(&material, &method.properties, 1.0, 1.5) };
            limits(&method.properties, &material, &medium, 1.5, 0.0).together
                * material.p_wave_speed()
        };
        // Without viscosity, and without shear: 1.87 h/c_p, and 1.03 with α = 1.
        assert_relative_eq!(limit(0.22, 0.0) / 1.5, 1.87, max_relative = 1e-2);
        assert_relative_eq!(limit(0.0, 1.0) / 1.5, 1.03, max_relative = 1e-2);
        let wave = Material { density: 1.0, bulk: 1.0, shear: 0.22 }.p_wave_speed();
        assert_relative_eq!(limit(0.22, wave), limit(0.0, 1.0), max_relative = 1e-12);
    }

    const SIDE: usize = 24;
    const RUBBER: Material = Material { density: 1.0, bulk: 1.0, shear: 0.22 };

    /// The largest speed of a lattice at rest after 60 steps of `of_limit` times the limit, over the noise at
    /// the start.
    fn growth(of_limit: f64) -> f64 {
        let method = corrected();
        let medium = medium_of(&RUBBER, &method.properties, 1.0, 1.5);
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
            limits(&method, &RUBBER, &medium_of(&RUBBER, &method, 1.0, 1.5), 1.5, 0.0).together
        }
        let ratio = limit(corrected().properties) / limit(bare().properties);
        let factor = bare().properties.square(1.5, 0.0).gradient_factor();
        assert!((ratio / factor - 1.0).abs() < 1e-12 && factor > 1.006, "{ratio} {factor}");
    }
}
