//! Waves on a lattice against their theory, the limit of the time step, and long runs.

use super::common::{
    Block, DENSITY, MODULI, block, build, energy, forces, free, number, put, scene,
};
use nalgebra::Vector2;
use std::f64::consts::TAU;
use touchstone_solver::lagrangian::{
    BetweenFaces, Hencky, Law, SaintVenantKirchhoff, SolidScene, Weight, contact_stiffness,
};
use touchstone_solver::{
    DivergenceBounds, Domain, Open, Outcome, PlaneWall, SlipGhosts, Smoothing, Stepper, WendlandC2,
};

const SIDE: usize = 12;

/// 8/3 μ: c = 8/3 χ μ/G₁ with χ = 1. [`shear_waves_are_of_fourth_order`] with no other number.
const HOURGLASS: f64 = 8.0 / 3.0 * 0.7;

/// q² and s − G₁ q²/2 of a wave and G₁, by sums over the lattice, in units of the spacing.
fn symbols(k: Vector2<f64>) -> (f64, f64, f64) {
    let kernel = Smoothing::<WendlandC2>::new(1.2);
    let (mut factor, mut q, mut s) = (0.0, Vector2::zeros(), 0.0);
    for x in -3..=3 {
        for y in -3..=3 {
            let r = Vector2::new(f64::from(x), f64::from(y));
            let f = if x == 0 && y == 0 { 0.0 } else { kernel.f(r.norm_squared()) };
            factor += f * r.x * r.x;
            q += r * (f * libm::sin(k.dot(&r)));
            s += f * (1.0 - libm::cos(k.dot(&r)));
        }
    }
    let q2 = q.norm_squared() / (factor * factor);
    (q2, s - 0.5 * factor * q2, factor)
}

fn torus<L: Law>() -> Block<L> {
    let side = SIDE as f64;
    build(SolidScene {
        domain: Domain::torus(side, side),
        ..scene(block(SIDE, SIDE, 0.0), Open, ())
    })
}

/// ρ ω² of the wave with this displacement, and how far the force is from along it.
fn stiffness<L: Law>(k: Vector2<f64>, along: Vector2<f64>) -> f64 {
    let mut solid = torus::<L>();
    let wave = |x: Vector2<f64>| along * (1e-7 * libm::cos(k.dot(&x) + 0.3));
    put(&mut solid, |_, x| x + wave(x), |_| Vector2::zeros());
    let places = solid.body.reference.places.clone();
    let (mut sum, mut norm, mut off) = (0.0, 0.0, 0.0_f64);
    for ((_, _, _, force), place) in forces(&solid).iter().zip(places) {
        let wave = wave(place);
        (sum, norm) = (sum - force.dot(&wave), norm + wave.norm_squared());
        off = off.max(force.perp(&along).abs());
    }
    assert!(off < 1e-6 * 1e-7, "the force has another direction: {off:e}");
    sum / norm
}

#[test]
fn longitudinal_and_shear_waves_have_the_frequencies_of_theory() {
    fn check<L: Law>() {
        for turns in [1.0, 2.0, 5.0, 6.0] {
            for direction in [Vector2::x(), Vector2::new(1.0, 1.0)] {
                let k = direction * (TAU * turns / SIDE as f64);
                let (q2, rest, factor) = symbols(k);
                let c = HOURGLASS / factor;
                let unit = direction.normalize();
                let along = stiffness::<L>(k, unit);
                let across = stiffness::<L>(k, Vector2::new(-unit.y, unit.x));
                let expected = [MODULI.longitudinal(), MODULI.shear].map(|m| m * q2 + c * rest);
                for (found, expected) in [along, across].iter().zip(expected) {
                    let error = (found / expected - 1.0).abs();
                    let of = format!("{} {turns} {direction}", L::NAME);
                    assert!(error < 2e-6, "{of}: {found} Pa, expected {expected} Pa");
                }
            }
        }
    }
    check::<Hencky>();
    check::<SaintVenantKirchhoff>();
}

/// The rule c = 8/3 μ/G₁: of long shear waves the error falls as the fourth power of k.
#[test]
fn shear_waves_are_of_fourth_order() {
    let error = |k: f64| {
        let (q2, rest, factor) = symbols(Vector2::new(k, 0.0));
        (q2 + HOURGLASS / MODULI.shear / factor * rest) / (k * k) - 1.0
    };
    let (coarse, fine) = (error(0.2), error(0.1));
    let ratio = coarse / fine;
    assert!(
        (ratio - 16.0).abs() < 0.3,
        "errors {coarse:e} over {fine:e}: expected 16, it is {ratio}"
    );
    let short = error(TAU / 6.0);
    assert!(
        fine.abs() < 1e-5 && short.abs() < 0.05,
        "error of waves of 63 spacings {fine:e}, expected below 1e-5; of 6 spacings {short:e}, below 0.05"
    );
    let plain = |k: f64| symbols(Vector2::new(k, 0.0)).0 / (k * k) - 1.0;
    let ratio = plain(0.2) / plain(0.1);
    assert!(
        (ratio - 4.0).abs() < 0.1,
        "without the correction: expected a ratio of 4, it is {ratio}"
    );
}

/// The longest stable step from the largest frequency: 2/ω.
fn limit() -> f64 {
    let mut most = 0.0_f64;
    for i in 0..=SIDE / 2 {
        for j in 0..=i {
            let k = Vector2::new(i as f64, j as f64) * (TAU / SIDE as f64);
            let (q2, rest, factor) = symbols(k);
            let c = HOURGLASS / factor;
            most = most.max(MODULI.longitudinal() * q2 + c * rest);
        }
    }
    2.0 / (most / DENSITY).sqrt()
}

#[test]
fn the_step_limit_is_that_of_theory() {
    let grows = |share: f64| {
        let mut solid = torus::<Hencky>();
        let noise = |k: usize| Vector2::new(number(3 * k), number(5 * k + 1)) * 1e-9;
        put(&mut solid, |_, x| x, noise);
        let dt = share * limit();
        solid.advance(1500.0 * dt, dt, &mut ()) != Outcome::Reached
            || solid.data().fluid().any(|(_, e)| !(e.velocity.norm() < 1e-6))
    };
    assert!(!grows(0.99), "stable at 0.99 of {} s", limit());
    assert!(grows(1.01), "unstable at 1.01 of {} s", limit());
}

/// Two layers between planes along which they slip, four columns of particles each, which overlap by 0.6
/// of a spacing without stress and so press against each other, at rest; and the contact.
fn pressed() -> (Block<Hencky, BetweenFaces>, BetweenFaces) {
    let mut particles = block(8, 5, 0.0);
    for p in particles.iter_mut().filter(|p| p.position.x > 4.0) {
        // Opposite to the gaps of the other face: where particles are opposite each other, faces slip.
        p.position += Vector2::new(-0.6, 0.5);
    }
    let plane = |x, normal| PlaneWall::new(Vector2::new(x, 0.0), normal, Vector2::zeros());
    let walls = vec![plane(0.0, Vector2::x()), plane(7.4, -Vector2::x())];
    let contact = BetweenFaces::new(contact_stiffness(&MODULI));
    let mut solid = build::<Hencky, _, _>(SolidScene {
        domain: Domain { low: Vector2::zeros(), period: [None, Some(5.0)] },
        bodies: particles.iter().map(|p| u32::from(p.position.x > 3.7)).collect(),
        ..scene(particles, SlipGhosts { walls }, contact)
    });
    for k in 1..=3000 {
        let dt = 0.4 * limit();
        solid.advance(f64::from(k) * dt, dt, &mut ());
        let mut slowed = solid.checkpoint();
        slowed.particles.iter_mut().for_each(|(_, p)| p.velocity *= 0.9);
        solid.restore(&slowed).expect("the same scene");
    }
    (solid, contact)
}

/// ω² of the fastest mode, by power iteration on differences of forces.
fn fastest(solid: &mut Block<Hencky, BetweenFaces>) -> f64 {
    let start = solid.checkpoint();
    let mut mode: Vec<_> = (0..start.particles.len())
        .map(|k| Vector2::new(number(3 * k), number(5 * k + 1)))
        .collect();
    let mut squared = 0.0;
    for _ in 0..400 {
        let size = mode.iter().fold(0.0, |sum, v| sum + v.norm_squared()).sqrt();
        mode.iter_mut().for_each(|v| *v /= size);
        let mut at = |by: f64| {
            let mut moved = start.clone();
            moved.particles.iter_mut().zip(&mode).for_each(|((_, p), v)| p.position += v * by);
            solid.restore(&moved).expect("the same scene");
            solid.total_rates().iter().map(|rate| rate.velocity).collect::<Vec<_>>()
        };
        let (more, less) = (at(1e-5), at(-1e-5));
        let pushed: Vec<_> = less.iter().zip(&more).map(|(a, b)| (a - b) / 2e-5).collect();
        squared = pushed.iter().zip(&mode).fold(0.0, |sum, (a, v)| sum + a.dot(v));
        mode = pushed;
    }
    solid.restore(&start).expect("the same scene");
    squared
}

/// The limit follows from the fastest mode of the bodies and their contact together, which the rule
/// estimates.
#[test]
fn the_step_limit_of_bodies_in_contact_is_that_of_their_fastest_mode() {
    let (mut solid, contact) = pressed();
    let pressure = -solid.data().fluid().fold(0.0, |sum, (_, e)| {
        sum + (e.extra.xx - MODULI.bulk * (e.density / DENSITY - 1.0)) / 40.0
    });
    let strain = pressure / MODULI.longitudinal();
    assert!(
        strain > 0.03,
        "the bodies press each other by {strain} of the modulus, expected above 0.03"
    );
    let longest = 2.0 / fastest(&mut solid).sqrt();
    let compressed = limit() * (1.0 - pressure / MODULI.longitudinal());
    let rule = contact.step_limit(compressed, DENSITY, 1.0, pressure);
    let start = solid.checkpoint();
    let mut grows = |share: f64| {
        let mut noisy = start.clone();
        for (k, (_, p)) in noisy.particles.iter_mut().enumerate() {
            p.velocity = Vector2::new(number(3 * k), number(5 * k + 1)) * 1e-9;
        }
        solid.restore(&noisy).expect("the same scene");
        let dt = share * longest;
        let now = solid.time();
        solid.advance(now + 1500.0 * dt, dt, &mut ()) != Outcome::Reached
            || solid.data().fluid().any(|(_, e)| !(e.velocity.norm() < 1e-6))
    };
    assert!(!grows(0.98), "stable below");
    assert!(grows(1.02), "unstable above");
    assert!(
        (rule / longest - 1.0).abs() < 0.03,
        "the rule allows {rule} s, and the fastest mode {longest} s: expected equal within 3 %"
    );
    assert!(longest < 0.7 * limit(), "contact matters: {longest}");
}

/// The rule itself, by an independent program: with the derivatives of the kernel in closed form, sums along
/// the row by Simpson's rule. Without contact it is the limit of the lattice.
#[test]
fn the_rule_of_the_step_limit_in_contact_has_its_numbers() {
    let contact = BetweenFaces::new(contact_stiffness(&MODULI));
    for (pressure, expected) in [(0.1, 0.867_108), (0.5, 0.613_709)] {
        let found = contact.step_limit(1.3, DENSITY, 1.0, pressure);
        let error = (found / expected - 1.0).abs();
        assert!(error < 1e-5, "at {pressure} Pa: {found} s, expected {expected} s");
    }
    let none = BetweenFaces::new(0.0);
    let found = none.step_limit(1.3, DENSITY, 1.0, 0.0);
    assert!((found - 1.3).abs() < 1e-14, "without contact: {found} s, expected 1.3 s");
}

/// A block that is thrown, turns and vibrates, for 10⁵ steps.
#[test]
fn energy_stays_bounded_and_momenta_stay_over_many_steps() {
    let mut solid = free::<Hencky>(block(6, 4, 0.1));
    let velocity = |k: usize| {
        Vector2::new(0.05 * number(3 * k) + 0.02, 0.05 * number(5 * k + 1) + 0.01 * k as f64 / 24.0)
    };
    put(&mut solid, |_, x| x, velocity);
    let momenta = |solid: &Block| {
        forces(solid)
            .iter()
            .fold((Vector2::zeros(), 0.0), |(p, l), (m, x, v, _)| (p + v * *m, l + m * x.perp(v)))
    };
    let (start, first) = (energy(&solid), momenta(&solid));
    let dt = 0.1 * limit();
    let mut changes = Vec::new();
    for k in 1..=1000_u32 {
        assert_eq!(solid.advance(f64::from(100 * k) * dt, dt, &mut ()), Outcome::Reached);
        changes.push(energy(&solid) / start - 1.0);
    }
    let last = momenta(&solid);
    assert_eq!(solid.work().steps, 100_000);
    // The leapfrog swings by (ω dt)²/8 about the energy, here at most 0.5 %, and does not drift.
    let mean = |of: &[f64]| of.iter().fold(0.0, |sum, one| sum + one) / of.len() as f64;
    let [early, late] = [mean(&changes[..200]), mean(&changes[800..])];
    let worst = changes.iter().fold(0.0_f64, |most, change| most.max(change.abs()));
    let is_small = changes.iter().all(|change| change.abs() < 5e-3);
    assert!(is_small, "the energy changed by {worst:e} of itself, expected below 5e-3");
    let drift = late - early;
    assert!(drift.abs() < 1e-4, "the mean of the energy drifted by {drift:e}, expected below 1e-4");
    let moved = (last.0 - first.0).norm() / first.0.norm();
    assert!(moved < 1e-11, "momentum changed by {moved:e} of itself, expected below 1e-11");
    let turned = last.1 / first.1 - 1.0;
    assert!(
        turned.abs() < 1e-11,
        "angular momentum changed by {turned:e} of itself, not below 1e-11"
    );
}

#[test]
fn bits_are_equal_for_threads_and_after_a_restart() {
    // So many particles that cheap loops over them use threads.
    let bar = || block(80, 30, 0.1);
    let run = |parallel_from: usize, stop: bool| {
        let mut solid = build::<Hencky, _, _>(SolidScene {
            parallel_from,
            limits: DivergenceBounds::default(),
            ..scene(bar(), Open, Weight(Vector2::new(0.0, -0.1)))
        });
        put(&mut solid, |_, x| x, |k| Vector2::new(number(3 * k), number(5 * k)) * 0.1);
        let dt = 0.5 * limit();
        if stop {
            solid.advance(10.0 * dt, dt, &mut ());
            let kept = solid.checkpoint();
            let weight = Weight(Vector2::new(0.0, -0.1));
            let mut again = build::<Hencky, _, _>(scene(bar(), Open, weight));
            again.restore(&kept).expect("the same scene");
            solid = again;
            solid.advance(20.0 * dt, dt, &mut ());
        } else {
            solid.advance(10.0 * dt, dt, &mut ());
            solid.advance(20.0 * dt, dt, &mut ());
        }
        let bits = |p: &touchstone_solver::Particle<touchstone_solver::Symmetric>| {
            [p.position.x, p.velocity.y, p.density, p.extra.xy].map(f64::to_bits)
        };
        solid.particles().iter().map(bits).collect::<Vec<_>>()
    };
    let alone = run(usize::MAX, false);
    assert!(alone == run(1, false), "threads");
    assert!(alone == run(usize::MAX, true), "restart");
}

#[test]
fn what_is_no_solid_is_refused() {
    let line = block(9, 1, 0.0);
    let refused = scene(line, Open, ()).build::<WendlandC2, Hencky>().err().expect("a line");
    assert!(refused.to_string().contains("determinant"), "{refused}");
    let odd = SolidScene { bodies: vec![0; 3], ..scene(block(4, 4, 0.0), Open, ()) };
    assert!(odd.build::<WendlandC2, Hencky>().is_err());
    let mut solid = free::<Hencky>(block(4, 4, 0.0));
    let other = free::<Hencky>(block(4, 4, 0.1)).checkpoint();
    assert_eq!(solid.restore(&other), Err("particles of another reference"));
}
