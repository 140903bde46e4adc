//! Terms that are exact for linear fields, on disordered particles.

use nalgebra::{Matrix2, Vector2};
use touchstone_solver::{
    ConsistentContinuity, ConsistentPressure, ConsistentViscosity, CubicSpline, Linear, Particle,
    QuinticSpline, Rate, Viscosity, lattice,
};
use touchstone_tests::{Random, assert_small, open_rates, patch};

const N: usize = 14;
const DX: f64 = 1.0 / N as f64;
const ROUND_OFF: f64 = 1e-11;

const EOS: Linear = Linear { density: 1.0, sound_speed: 10.0 };

/// The rates by all these terms.
fn consistent_rates(particles: &[Particle], nu: f64) -> Vec<Rate<()>> {
    let forces = (ConsistentPressure { eos: EOS }, ConsistentViscosity { nu });
    open_rates::<QuinticSpline, _, _, _>(DX, particles, forces, ConsistentContinuity)
}

/// A disturbed patch with v = A x + b and a density that gives p = g·x.
fn linear(seed: u64, gradient: Matrix2<f64>, slope: Vector2<f64>) -> Vec<Particle> {
    let mut particles = patch(N, 0.3, seed);
    for p in &mut particles {
        p.velocity = gradient * p.position + Vector2::new(0.4, -0.1);
        p.density = EOS.density + slope.dot(&p.position) / (EOS.sound_speed * EOS.sound_speed);
    }
    particles
}

#[test]
fn gradient_and_divergence_of_linear_fields_are_exact_anywhere() {
    let (gradient, slope) = (Matrix2::new(0.3, -1.7, 0.9, -0.2), Vector2::new(2.0, -0.7));
    for seed in 0..3 {
        let particles = linear(seed, gradient, slope);
        let rates = consistent_rates(&particles, 0.0);
        for (rate, p) in rates.iter().zip(&particles) {
            assert!((rate.velocity + slope / p.density).norm() < ROUND_OFF, "{}", rate.velocity);
            let off = rate.density + p.density * gradient.trace();
            assert_small("dρ/dt + ρ div v of a linear velocity", off, ROUND_OFF);
        }
    }
}

#[test]
fn a_linear_field_has_no_viscous_force_anywhere() {
    // At the density of rest, so without pressure.
    let particles = linear(5, Matrix2::new(0.3, -1.7, 0.9, -0.2), Vector2::zeros());
    let largest =
        |rates: Vec<Rate<()>>| rates.iter().map(|r| r.velocity.norm()).fold(0.0, f64::max);
    let drag = largest(consistent_rates(&particles, 1.0));
    assert_small("the largest viscous force in a linear velocity", drag, 1e-9);
    let morris = Viscosity { mu: 1.0, eta2: 1e-8 };
    let morris = largest(open_rates::<CubicSpline, _, _, _>(1.5 * DX, &particles, morris, ()));
    assert!(morris > 1.0, "Morris' form has one: {morris}");
}

/// On a lattice the moments are a number times the unit matrix: a parabola has the Laplacian 2.
#[test]
fn a_parabola_on_a_lattice_has_its_viscous_force() {
    let at = |x: Vector2<f64>| Vector2::new(x.y * x.y, x.x * x.x - 3.0 * x.x * x.y);
    let particles: Vec<Particle> = lattice(Vector2::repeat(0.5 * DX), DX, N, N)
        .map(|x| Particle::fluid(x, at(x), 1.0, DX * DX))
        .collect();
    let rates = consistent_rates(&particles, 0.7);
    let inside = |p: &Particle| p.position.iter().all(|x| (3.5 * DX..1.0 - 3.5 * DX).contains(x));
    let mut seen = 0;
    for (rate, p) in rates.iter().zip(&particles).filter(|(_, p)| inside(p)) {
        assert!(
            (rate.velocity - Vector2::repeat(1.4)).norm() < 1e-9,
            "{} {}",
            rate.velocity,
            p.position
        );
        seen += 1;
    }
    assert!(seen > 9, "expected more than 9 particles to be looked at, and {seen} were");
}

#[test]
fn particles_on_a_line_and_alone_feel_nothing_that_is_not_finite() {
    let mut random = Random::new(3);
    let at = |x: f64| Particle::fluid(Vector2::new(x, 0.0), Vector2::new(x, 1.0), 1.0, DX * DX);
    let line: Vec<Particle> =
        (0..9).map(|k| at(f64::from(k) * DX + random.between(0.0, 0.3 * DX))).collect();
    for particles in [&line[..], &line[..1]] {
        for rate in consistent_rates(particles, 1.0) {
            assert!(rate.velocity.iter().all(|v| v.is_finite()) && rate.density == 0.0);
        }
    }
}
