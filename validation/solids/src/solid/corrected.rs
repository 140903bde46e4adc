//! The limits of steps with corrected gradients.

use crate::solid::{Material, limits};
use harness::{
    context::Context,
    method::{Method, Parts},
};
use nalgebra::Vector2;
use schemes::solid::{bare, corrected_bare};
use solver::{Domain, Outcome, Particle, Symmetric};

const SIDE: usize = 24;
const RUBBER: Material = Material { density: 1.0, bulk: 1.0, shear: 0.22 };

/// The largest speed of a lattice at rest after 60 steps of so many limits, over that of the noise at the
/// start.
fn growth(of_limit: f64) -> f64 {
    let method = corrected_bare();
    let medium = RUBBER.medium(&method, [1.0, 1.5]);
    let dt = of_limit * limits(&method, &RUBBER, &medium, 1.5, 0.0).together;
    let noise = |k: usize| 1e-12 * ((k as f64 * 0.618_033_988_749_895).fract() - 0.5);
    let places = solver::lattice(Vector2::repeat(0.5), 1.0, SIDE, SIDE).enumerate();
    let particles = places
        .map(|(k, x)| Particle::fluid(x, Vector2::new(noise(3 * k), noise(7 * k)), 1.0, 1.0))
        .collect();
    let domain = Domain::torus(SIDE as f64, SIDE as f64);
    let parts = Parts::new(medium, domain, particles, &Context::default());
    let mut simulation = (method.build)(parts).expect("a scene");
    assert_eq!(simulation.advance(60.0 * dt, dt, &mut ()), Outcome::Reached);
    simulation.fluid().map(|(_, p)| p.velocity.norm()).fold(0.0, f64::max) / 1e-12
}

#[test]
fn the_step_limit_is_that_of_the_lattice_within_half_a_per_cent() {
    let [below, above] = [0.995, 1.005].map(growth);
    assert!(below < 10.0 && above > 1e2, "{below:e} {above:e}");
}

/// 1.0067, the factor of gradients at h = 1.5 dx: without correction the limit is as much shorter.
#[test]
fn correction_lengthens_the_step_by_the_factor_of_gradients() {
    fn limit(method: Method<Symmetric>) -> f64 {
        limits(&method, &RUBBER, &RUBBER.medium(&method, [1.0, 1.5]), 1.5, 0.0).together
    }
    let ratio = limit(corrected_bare()) / limit(bare());
    let factor = bare().square([1.5, 0.0]).gradient_factor();
    assert!((ratio / factor - 1.0).abs() < 1e-12 && factor > 1.006, "{ratio} {factor}");
}
