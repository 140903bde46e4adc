//! Two particles, one term, and the formula of the paper written out again in plain numbers, with
//! ∇ᵢWᵢⱼ from differences of W: finds a wrong sign or a factor of two.

use nalgebra::Vector2;
use touchstone_base::functions::powf;
use touchstone_solver::{
    ArtificialStress, ArtificialViscosity, BodyForce, Continuity, CubicSpline, DensityDiffusion,
    Particle, Pressure, Rate, Shifting, Tait, Term, Viscosity, Xsph,
};
use touchstone_tests::{Random, V2, assert_small, open_rates};

const H: f64 = 0.3;
const RHO: f64 = 1000.0;
const C: f64 = 9.0;
const BACKGROUND: f64 = 2500.0;

/// The cubic B-spline, written as in textbooks.
fn w(r: V2) -> f64 {
    let q = r.norm() / H;
    let shape = match q {
        q if q < 1.0 => 1.0 - 1.5 * q * q + 0.75 * q * q * q,
        q if q < 2.0 => 0.25 * (2.0 - q).powi(3),
        _ => 0.0,
    };
    10.0 / (7.0 * std::f64::consts::PI * H * H) * shape
}

/// ∇ᵢWᵢⱼ by central differences.
fn grad_w(r: V2) -> V2 {
    let d = 1e-5 * H;
    let slope = |e: V2| (w(r + e * d) - w(r - e * d)) / (2.0 * d);
    Vector2::new(slope(Vector2::x()), slope(Vector2::y()))
}

/// Pairs of unequal particles that approach and recede, in tension and compression, without those
/// so close to the knots q = 0, 1, 2 that the difference quotient is inaccurate.
fn pairs() -> Vec<[Particle; 2]> {
    let mut random = Random::new(2024);
    let mut pairs = Vec::new();
    while pairs.len() < 60 {
        let mut particle = |reach: f64| {
            let place = random.vector(-reach, reach);
            let density = random.between(950.0, 1050.0);
            Particle::fluid(place, random.vector(-2.0, 2.0), density, random.between(0.01, 0.05))
        };
        let pair = [particle(0.1), particle(0.5)];
        let q = (pair[0].position - pair[1].position).norm() / H;
        if [0.0, 1.0, 2.0].iter().all(|knot| (q - knot).abs() > 0.05) && q < 2.0 {
            pairs.push(pair);
        }
    }
    pairs
}

/// The terms' rates of particle i against `formula(i, j, rᵢⱼ, vᵢⱼ)`, within 1e-7 of the largest.
fn check(
    forces: impl Term<()>,
    drift: impl Term<()>,
    formula: impl Fn(&Particle, &Particle, V2, V2) -> Rate<()>,
) {
    let mut active = 0;
    for pair in pairs() {
        let rates = open_rates::<CubicSpline, _, _, _>(H, &pair, forces.clone(), drift.clone());
        for (i, j) in [(0, 1), (1, 0)] {
            let (r, v) = (pair[i].position - pair[j].position, pair[i].velocity - pair[j].velocity);
            let expected = formula(&pair[i], &pair[j], r, v);
            let near = |a: f64, b: f64, size: f64| {
                assert!((a - b).abs() <= 1e-7 * size, "{a} is not {b}: pair {pair:?}");
            };
            for axis in 0..2 {
                let moved = rates[i].position - pair[i].velocity;
                near(moved[axis], expected.position[axis], expected.position.norm() + 1e-8);
                near(rates[i].velocity[axis], expected.velocity[axis], expected.velocity.norm());
            }
            near(rates[i].density, expected.density, expected.density.abs());
            let size = expected.position.norm() + expected.velocity.norm() + expected.density.abs();
            active += u32::from(size > 0.0);
        }
    }
    assert!(active >= 30, "only {active} of 120 rates are not 0");
}

fn eos() -> Tait {
    Tait { background: BACKGROUND, ..Tait::new(RHO, C) }
}

/// (7), (8)
fn p(i: &Particle) -> f64 {
    BACKGROUND + C * C * RHO / 7.0 * (powf(i.density / RHO, 7.0) - 1.0)
}

fn acceleration(velocity: V2) -> Rate<()> {
    Rate { velocity, ..Rate::default() }
}

#[test]
fn pressure_is_equation_5() {
    check(Pressure::new(eos()), (), |i, j, r, _| {
        let pair = p(i) / i.density.powi(2) + p(j) / j.density.powi(2);
        acceleration(-grad_w(r) * (j.mass * pair))
    });
}

#[test]
fn pressure_with_artificial_stress_is_equations_14_18_19() {
    let spacing = Vector2::new(0.25, 0.0);
    let stress = ArtificialStress::new(0.3, 4, w(spacing));
    check(Pressure { eos: eos(), tensile: stress }, (), |i, j, r, _| {
        let repulsion = |k: &Particle| {
            if p(k) < 0.0 { 0.3 * p(k).abs() / k.density.powi(2) } else { 0.0 }
        };
        let phi = w(r) / w(spacing);
        let pair = p(i) / i.density.powi(2) + p(j) / j.density.powi(2);
        let extra = (repulsion(i) + repulsion(j)) * powf(phi, 4.0);
        acceleration(-grad_w(r) * (j.mass * (pair + extra)))
    });
}

#[test]
fn viscosity_is_equation_6() {
    let (mu, eta2) = (1.7, 0.01 * H * H);
    check(Viscosity { mu, eta2 }, (), |i, j, r, v| {
        let weight = r.dot(&grad_w(r)) / (r.norm_squared() + eta2);
        acceleration(v * (2.0 * mu * j.mass / (i.density * j.density) * weight))
    });
}

/// Πᵢⱼ of (16), (17) with z1, z2; `all` takes receding pairs as well.
fn pi(i: &Particle, j: &Particle, r: V2, v: V2, [z1, z2]: [f64; 2]) -> f64 {
    let c = |k: &Particle| C * powf(k.density / RHO, 3.0);
    let psi = v.dot(&r) / (r.norm_squared() + 0.01 * H * H);
    let sum = i.density + j.density;
    -z1 * (c(i) + c(j)) * (H + H) / (2.0 * sum) * psi
        + z2 * (H + H).powi(2) / (2.0 * sum) * psi * psi
}

#[test]
fn artificial_viscosity_is_equations_16_and_17() {
    let z = [0.4, 0.9];
    let term = ArtificialViscosity::<_, false>::new(z[0], z[1], H, eos());
    check(term, (), |i, j, r, v| {
        let stress = if v.dot(&r) < 0.0 { pi(i, j, r, v, z) } else { 0.0 };
        acceleration(-grad_w(r) * (j.mass * stress))
    });
}

#[test]
fn artificial_viscosity_of_every_pair_is_odd_in_the_velocity() {
    let z = [0.4, 0.9];
    let term = ArtificialViscosity::<_, true>::new(z[0], z[1], H, eos());
    check(term, (), |i, j, r, v| {
        let sign = if v.dot(&r) < 0.0 { 1.0 } else { -1.0 };
        acceleration(-grad_w(r) * (j.mass * sign * pi(i, j, r, v * sign, z)))
    });
}

#[test]
fn continuity_is_equation_3() {
    check((), Continuity, |_, j, r, v| Rate {
        density: j.mass * v.dot(&grad_w(r)),
        ..Rate::default()
    });
}

#[test]
fn xsph_is_equation_22() {
    check((), Xsph { epsilon: 0.4 }, |i, j, r, v| {
        let position = -v * (0.4 * 2.0 * j.mass / (i.density + j.density) * w(r));
        Rate { position, ..Rate::default() }
    });
}

/// Molteni & Colagrossi: 2 δ h c Σ Vⱼ (ρⱼ − ρᵢ) (rⱼ − rᵢ)·∇ᵢWᵢⱼ / d².
#[test]
fn density_diffusion_is_that_of_molteni_and_colagrossi() {
    check((), DensityDiffusion::new(0.1 * H * C), |i, j, r, _| {
        let slope = (-r).dot(&grad_w(r)) / r.norm_squared();
        let density = 2.0 * 0.1 * H * C * j.mass / j.density * (j.density - i.density) * slope;
        Rate { density, ..Rate::default() }
    });
}

#[test]
fn shifting_moves_down_the_gradient_of_the_crowding() {
    let spacing = Vector2::new(0.25, 0.0);
    check((), Shifting::new(0.5, H, w(spacing)), |i, j, r, _| {
        let fastest = i.velocity.norm().max(j.velocity.norm());
        let bracket = 1.0 + 0.2 * powf(w(r) / w(spacing), 4.0);
        let position = -grad_w(r) * (0.5 * fastest * H * j.mass / j.density * bracket);
        Rate { position, ..Rate::default() }
    });
}

#[test]
fn body_force_is_an_acceleration() {
    check(BodyForce(Vector2::new(3.0, -4.0)), (), |_, _, _, _| {
        acceleration(Vector2::new(3.0, -4.0))
    });
}

#[test]
fn a_tuple_of_terms_is_their_sum() {
    let (viscosity, force) = (Viscosity { mu: 1.7, eta2: 1e-4 }, BodyForce(Vector2::new(0.0, 9.0)));
    for pair in pairs() {
        let rate = |forces| open_rates::<CubicSpline, _, _, _>(H, &pair, forces, ())[0].velocity;
        let both = rate((viscosity, force));
        let alone = open_rates::<CubicSpline, _, _, _>(H, &pair, viscosity, ())[0].velocity;
        let off = (both - alone - force.0).norm() / both.norm();
        assert_small("a force with a body force less both alone, over itself", off, 1e-12);
    }
}
