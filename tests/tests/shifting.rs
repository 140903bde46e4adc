//! Particle shifting alone: invariants, and the fields of a moved particle.

use nalgebra::{Matrix2, Vector2};
use touchstone_solver::{
    CubicSpline, Domain, Kernel, Particle, QuinticSpline, ShiftAdvection, Shifting, Smoothing,
};
use touchstone_tests::{Random, assert_small, open_rates, patch, rates, relative_sum};

const N: usize = 16;
const DX: f64 = 1.0 / N as f64;
const H: f64 = 1.3 * DX;
const ROUND_OFF: f64 = 1e-12;

fn shifting<K: Kernel>(h: f64) -> Shifting {
    Shifting::new(0.5, h, Smoothing::<K>::new(h).w(DX * DX))
}

/// The velocities of the shift in a periodic box, over the largest speed; 1 is the speed of flow.
fn shifts(particles: &[Particle]) -> Vec<Vector2<f64>> {
    let (domain, terms) = (Domain::torus(1.0, 1.0), ((), shifting::<CubicSpline>(H)));
    let speed = particles.iter().map(|p| p.velocity.norm()).fold(0.0, f64::max);
    let rates = rates::<CubicSpline, _, _>(H, domain, particles, terms);
    assert!(rates.iter().all(|r| r.velocity == Vector2::zeros() && r.density == 0.0));
    rates.iter().zip(particles).map(|(r, p)| (r.position - p.velocity) / speed).collect()
}

#[test]
fn a_perfect_lattice_is_not_shifted_and_a_disturbed_one_is() {
    let [perfect, disturbed] = [0.0, 0.2].map(|jitter| shifts(&patch(N, jitter, 1)));
    let largest = |shifts: &[Vector2<f64>]| shifts.iter().map(|s| s.norm()).fold(0.0, f64::max);
    assert!(largest(&perfect) < ROUND_OFF, "{:e}", largest(&perfect));
    assert!(largest(&disturbed) > 0.01, "{:e}", largest(&disturbed));
}

/// Pushes of a pair are opposite where volumes are equal, so the centre of mass stays.
#[test]
fn shifting_moves_no_centre_of_mass() {
    let particles = patch(N, 0.3, 7);
    let shifts = shifts(&particles);
    for axis in 0..2 {
        let sum = relative_sum(particles.iter().zip(&shifts).map(|(p, s)| p.mass * s[axis]));
        assert_small("the shift of the centre of mass over that of the particles", sum, 1e-6);
    }
}

/// A linear field is advected exactly on any particles: dv = A dr.
#[test]
fn a_shifted_particle_takes_the_velocity_of_its_new_place() {
    let gradient = Matrix2::new(0.3, -1.7, 0.9, -0.2);
    for (seed, h) in [(1, DX), (2, 1.3 * DX)] {
        let mut particles = patch(N, 0.3, seed);
        for p in &mut particles {
            p.velocity = gradient * p.position + Vector2::new(0.4, -0.1);
        }
        let shifting = shifting::<QuinticSpline>(h);
        let rates =
            open_rates::<QuinticSpline, _, _, _>(h, &particles, ShiftAdvection(shifting), shifting);
        let largest = rates.iter().map(|r| r.velocity.norm()).fold(0.0, f64::max);
        assert!(
            largest > 0.01,
            "a shift to see: expected more than 0.01 dx, the largest is {largest}"
        );
        for (rate, p) in rates.iter().zip(&particles) {
            let expected = gradient * (rate.position - p.velocity);
            let off = (rate.velocity - expected).norm();
            assert_small("a rate less the expected one", off, ROUND_OFF * (1.0 + largest));
        }
    }
}

#[test]
fn on_a_line_and_alone_nothing_is_carried() {
    let mut random = Random::new(3);
    let at =
        |x: f64, u: f64| Particle::fluid(Vector2::new(x, 0.0), Vector2::new(u, 1.0), 1.0, DX * DX);
    let line: Vec<Particle> =
        (0..9).map(|k| at(f64::from(k) * DX + random.between(0.0, 0.3 * DX), 0.1)).collect();
    for particles in [&line[..], &line[..1]] {
        let shifting = shifting::<QuinticSpline>(DX);
        let rates =
            open_rates::<QuinticSpline, _, _, _>(DX, particles, ShiftAdvection(shifting), shifting);
        assert!(rates.iter().all(|r| r.velocity == Vector2::zeros()));
    }
}
