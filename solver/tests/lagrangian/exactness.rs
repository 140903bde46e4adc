//! Exact at every state: gradients of linear fields, forces as derivatives of the energy, momentum.

use super::common::{
    DENSITY, MODULI, block, build, energy, forces, free, number, put, scene, stored,
};
use nalgebra::{Matrix2, Vector2};
use touchstone_solver::lagrangian::{
    BetweenFaces, Hencky, Law, Load, SaintVenantKirchhoff, SolidScene, Weight, contact_stiffness,
};
use touchstone_solver::{
    Domain, Ghosts, Open, PlaneWall, SlipGhosts, Stepper, Symmetric, walls::Walls,
};

/// A place that is out of order, by up to `by` along each axis.
fn jolted(by: f64) -> impl Fn(usize, Vector2<f64>) -> Vector2<f64> {
    move |k, x| x + Vector2::new(number(11 * k + 4), number(13 * k + 1)) * (2.0 * by)
}

fn at_rest(_: usize) -> Vector2<f64> {
    Vector2::zeros()
}

#[test]
fn a_linear_deformation_is_exact_at_every_particle_and_has_no_hourglass_energy() {
    let gradient = Matrix2::new(0.3, -0.2, 0.5, -0.1);
    let mut solid = free::<Hencky>(block(7, 5, 0.2));
    put(&mut solid, |_, x| x + gradient * x + Vector2::new(3.0, -1.0), at_rest);
    let count = solid.data().fluid_count();
    for k in 0..count {
        let error = (solid.body.gradient(k) - gradient).norm();
        assert!(error < 3e-14, "particle {k}: {error:e}");
    }
    let energies = solid.potential().unwrap();
    assert!(
        energies.hourglass < 1e-26 && energies.shear > 1.0,
        "energy of hourglass modes: expected none, it is {:e}; of shear: expected above 1, it is {:e}",
        energies.hourglass,
        energies.shear
    );
    // The density of every particle follows from the deformation, and the stress is uniform.
    let ratio = (Matrix2::identity() + gradient).determinant();
    assert!(solid.data().fluid().all(|(_, e)| (e.density * ratio / DENSITY - 1.0).abs() < 1e-13));
}

#[test]
fn a_rotation_has_neither_stress_nor_force() {
    fn check<L: Law>() {
        let rotation = Matrix2::new(-0.28, -0.96, 0.96, -0.28);
        let mut solid = free::<L>(block(7, 5, 0.2));
        put(&mut solid, |_, x| rotation * x + Vector2::new(3.0, -1.0), at_rest);
        let largest = forces(&solid).iter().map(|(.., f)| f.norm()).fold(0.0, f64::max);
        assert!(largest < 1e-13, "{}: {largest:e}", L::NAME);
        assert!(stored(&solid).abs() < 1e-13);
        assert!(solid.data().fluid().all(|(_, e)| e.extra.xx.abs() + e.extra.xy.abs() < 1e-13));
    }
    check::<Hencky>();
    check::<SaintVenantKirchhoff>();
}

/// The force on some particles against a central difference of the stored energy.
fn check_forces<L: Law, W: Walls<Symmetric>, C: Load>(scene: SolidScene<W, C>, jolt: f64) {
    let mut solid = build::<L, W, C>(scene);
    put(&mut solid, jolted(jolt), at_rest);
    let start = solid.checkpoint();
    let found = forces(&solid);
    let largest = found.iter().map(|(.., f)| f.norm()).fold(0.0, f64::max);
    let d = 1e-5;
    for k in (0..found.len()).step_by(3) {
        for axis in 0..2 {
            let mut at = |by: f64| {
                let mut moved = start.clone();
                moved.particles[k].1.position[axis] += by;
                solid.restore(&moved).unwrap();
                stored(&solid)
            };
            let expected = -(at(d) - at(-d)) / (2.0 * d);
            let error = (found[k].3[axis] - expected).abs();
            assert!(error < 1e-7 * largest, "{} {k} {axis}: {error:e} of {largest:e}", L::NAME);
        }
    }
}

#[test]
fn forces_are_derivatives_of_the_stored_energy() {
    let block = || block(7, 5, 0.15);
    check_forces::<Hencky, _, _>(scene(block(), Open, ()), 0.1);
    check_forces::<SaintVenantKirchhoff, _, _>(scene(block(), Open, ()), 0.1);
    // The force against modes that deform no particle alone, and stress without it.
    let soft = touchstone_solver::lagrangian::Moduli { bulk: 0.0, ..MODULI };
    check_forces::<Hencky, _, _>(
        SolidScene { moduli: soft, hourglass: 50.0, ..scene(block(), Open, ()) },
        0.1,
    );
    check_forces::<Hencky, _, _>(SolidScene { hourglass: 0.0, ..scene(block(), Open, ()) }, 0.1);
}

#[test]
fn forces_at_planes_and_across_periods_are_derivatives_of_the_stored_energy() {
    let wall = PlaneWall::new(Vector2::new(0.0, 1.0), Vector2::x(), Vector2::zeros());
    let floor = PlaneWall::new(Vector2::zeros(), Vector2::y(), Vector2::zeros());
    let held = |walls: &[PlaneWall]| Ghosts { walls: walls.to_vec() };
    let slips = |walls: &[PlaneWall]| SlipGhosts { walls: walls.to_vec() };
    let block = || block(7, 5, 0.15);
    check_forces::<Hencky, _, _>(scene(block(), held(&[wall]), ()), 0.1);
    check_forces::<Hencky, _, _>(scene(block(), slips(&[wall]), ()), 0.1);
    check_forces::<Hencky, _, _>(scene(block(), held(&[wall, floor]), ()), 0.1);
    check_forces::<SaintVenantKirchhoff, _, _>(scene(block(), slips(&[wall, floor]), ()), 0.1);
    let domain = Domain { low: Vector2::zeros(), period: [None, Some(5.0)] };
    check_forces::<Hencky, _, _>(SolidScene { domain, ..scene(block(), held(&[wall]), ()) }, 0.1);
    check_forces::<Hencky, _, _>(
        SolidScene { domain: Domain::torus(7.0, 5.0), ..scene(block(), Open, ()) },
        0.1,
    );
}

/// Two blocks side by side, half a spacing too close to each other, and a plane.
fn two<C: Load>(loads: C) -> SolidScene<Open, C> {
    let left = block(4, 5, 0.1);
    let right = left.iter().map(|p| touchstone_solver::Particle {
        position: p.position + Vector2::new(3.7, 0.3),
        ..*p
    });
    let particles: Vec<_> = left.iter().copied().chain(right).collect();
    let bodies = (0..particles.len()).map(|k| u32::from(k >= left.len())).collect();
    SolidScene { bodies, ..scene(particles, Open, loads) }
}

fn contact() -> BetweenFaces {
    BetweenFaces::new(contact_stiffness(&MODULI))
}

/// The forces of a load on a block that it reaches.
fn check_load<C: Load + Copy>(load: C) {
    let solid = build::<Hencky, _, _>(scene(block(5, 4, 0.1), Open, load));
    assert!(solid.potential().unwrap().loads.abs() > 1e-3, "nothing touches");
    check_forces::<Hencky, _, _>(scene(block(5, 4, 0.1), Open, load), 0.05);
}

#[test]
fn forces_of_loads_are_derivatives_of_their_energy() {
    check_load(Weight(Vector2::new(0.3, -2.0)));
    let solid = build::<Hencky, _, _>(two(contact()));
    let energies = solid.potential().unwrap();
    assert!(
        energies.loads > 0.01 && energies.shear < 1e-25,
        "energy of the contact: expected above 0.01, it is {:e}; of shear: expected none, it is {:e}",
        energies.loads,
        energies.shear
    );
    check_forces::<Hencky, _, _>(two(contact()), 0.05);
}

#[test]
fn linear_and_angular_momentum_are_those_of_no_force_at_every_state() {
    fn check<L: Law, C: Load>(scene: SolidScene<Open, C>) {
        let mut solid = build::<L, _, _>(scene);
        let turned = Matrix2::new(0.8, -0.9, 0.7, 0.5);
        put(&mut solid, |k, x| turned * jolted(0.12)(k, x), at_rest);
        let all = forces(&solid);
        let size = all.iter().map(|(.., f)| f.norm()).fold(0.0, f64::max);
        let force = all.iter().fold(Vector2::zeros(), |sum, (.., f)| sum + f);
        let torque = all.iter().fold(0.0, |sum, (_, x, _, f)| sum + x.perp(f));
        assert!(size > 0.1 && force.norm() < 1e-13 * size, "{}: {force}", L::NAME);
        assert!(torque.abs() < 1e-12 * size, "{}: {torque:e} of {size:e}", L::NAME);
    }
    check::<Hencky, _>(scene(block(7, 5, 0.15), Open, ()));
    check::<SaintVenantKirchhoff, _>(scene(block(7, 5, 0.15), Open, ()));
    check::<Hencky, _>(two(contact()));
}

/// Overlapping bodies repel each other; bodies apart do not act on each other at any distance.
#[test]
fn contact_pushes_and_never_pulls() {
    for apart in [0.0, 0.3, 0.9, 1.3, 2.0, 9.0] {
        let mut solid = build::<Hencky, _, _>(two(contact()));
        let half = solid.data().fluid_count() / 2;
        let shift = move |k| if k >= half { Vector2::new(apart, 0.0) } else { Vector2::zeros() };
        put(&mut solid, |k, x| x + shift(k), at_rest);
        let ids: Vec<u32> = solid.checkpoint().particles.iter().map(|(id, _)| *id).collect();
        let right = forces(&solid).into_iter().zip(ids).filter(|(_, id)| *id as usize >= half);
        let push = right.fold(0.0, |sum, ((.., f), _)| sum + f.x);
        if apart < 0.2 {
            assert!(push > 0.1, "{apart}: {push}");
        } else if apart >= 1.3 {
            // The rest is the round-off of internal forces at a displacement.
            assert!(push.abs() < 1e-12 && stored(&solid) < 1e-24, "{apart}: {push}");
        }
        assert!(push > -1e-12);
    }
}

/// The force between straight faces equals the pressure at any relative position of their particles:
/// particles do not catch on each other.
#[test]
fn faces_that_slide_along_each_other_feel_the_same_pressure_everywhere() {
    let domain = Domain { low: Vector2::zeros(), period: [None, Some(6.0)] };
    let contact = contact();
    for (distance, rough) in [(0.95, 0.01), (0.8, 0.02), (0.6, 0.04)] {
        let expected = contact.pressure(distance);
        for aside in [0.0, 0.1, 0.25, 0.4, 0.5] {
            let mut particles = block(8, 6, 0.0);
            for p in particles.iter_mut().filter(|p| p.position.x > 4.0) {
                p.position += Vector2::new(distance - 1.0, aside);
            }
            let bodies: Vec<u32> = (0..48).map(|k| u32::from(k % 8 >= 4)).collect();
            let of = SolidScene { domain, bodies, ..scene(particles, Open, contact) };
            let solid = build::<Hencky, _, _>(of);
            let right = forces(&solid).into_iter().filter(|(_, x, ..)| x.x > 3.75);
            let push = right.fold(Vector2::zeros(), |sum, (.., f)| sum + f) / 6.0;
            assert!(
                (push.x / expected - 1.0).abs() < rough,
                "{distance} {aside}: {push} {expected}"
            );
            assert!(push.y.abs() < rough * expected, "{distance} {aside}: {push}");
        }
    }
    assert_eq!(contact.pressure(1.0), 0.0);
}

/// k o at first, with k = (K + 4μ/3)/4 for K = 2 Pa and μ = 0.7 Pa.
#[test]
fn the_stiffness_of_contact_is_a_quarter_of_the_modulus_of_longitudinal_waves() {
    let expected = 0.733_333;
    let found = contact().pressure(0.9999) / 1e-4;
    assert!((found / expected - 1.0).abs() < 1e-3, "faces: {found} Pa, expected {expected} Pa");
}

/// Two blocks meet and part: the energy that contact stores is given back, and momentum stays.
#[test]
fn bodies_that_collide_keep_momentum_and_energy_and_part() {
    let mut solid = build::<Hencky, _, _>(two(contact()));
    let half = solid.data().fluid_count() / 2;
    let sign = move |k: usize| if k >= half { 1.0 } else { -1.0 };
    let apart = move |k: usize, x: Vector2<f64>| x + Vector2::new(0.6 * sign(k), 0.0);
    put(&mut solid, apart, |k| Vector2::new(-0.1 * sign(k), 0.02));
    let before = energy(&solid);
    let (mut most, mut series) = (0.0_f64, Vec::new());
    for k in 1..=400 {
        let outcome = solid.advance(0.1 * f64::from(k), 0.02, &mut ());
        assert_eq!(outcome, touchstone_solver::Outcome::Reached);
        most = most.max(solid.potential().unwrap().loads);
        series.push((energy(&solid) / before - 1.0).abs());
    }
    let worst = series.iter().copied().fold(0.0, f64::max);
    assert!(most > 0.1 * before, "they meet: {most:e} of {before:e}");
    assert!(worst < 2e-3, "the energy changed by {worst:e} of itself, expected below 2e-3");
    assert_eq!(solid.potential().unwrap().loads, 0.0, "they have parted");
    let all = forces(&solid);
    let momentum = all.iter().fold(Vector2::zeros(), |sum, (m, _, v, _)| sum + v * *m);
    let mass = all.iter().fold(0.0, |sum, (m, ..)| sum + m);
    let off = (momentum - Vector2::new(0.0, 0.02) * mass).norm();
    assert!(off < 1e-12, "momentum {:?} is {off:e} off 0.02 of the mass, upwards", momentum / mass);
}

/// A hook, bent so far that its two ends touch: they repel each other, but neighbours in the reference do
/// not.
#[test]
fn a_body_touches_itself_where_it_is_no_neighbour() {
    let hook = || {
        let at =
            |x: Vector2<f64>| touchstone_solver::Particle::fluid(x, Vector2::zeros(), 1.0, 1.0);
        let lattice = touchstone_solver::lattice(Vector2::repeat(0.5), 1.0, 8, 7);
        let is_hook = |x: &Vector2<f64>| x.x < 2.0 || x.y < 2.0 || x.y > 5.0;
        lattice.filter(is_hook).map(at).collect::<Vec<touchstone_solver::Particle<Symmetric>>>()
    };
    let bent = |by: f64| {
        move |_: usize, x: Vector2<f64>| {
            x - Vector2::new(0.0, if x.y > 5.0 { by * (x.x - 1.0).max(0.0) } else { 0.0 })
        }
    };
    let energy = |by: f64| {
        let mut solid = build::<Hencky, _, _>(scene(hook(), Open, contact()));
        put(&mut solid, bent(by), at_rest);
        solid.potential().unwrap().loads
    };
    assert_eq!(energy(0.0), 0.0);
    assert_eq!(energy(0.2), 0.0);
    assert!(energy(0.5) > 0.01);
}

/// Pairs of these places, each counted twice, that are nearer than a distance and that `is_pair` accepts.
fn near(at: &[Vector2<f64>], most: f64, is_pair: impl Fn(usize, usize) -> bool) -> u64 {
    let near = |i: usize, j: usize| i != j && (at[i] - at[j]).norm() < most && is_pair(i, j);
    let of = |i: usize| (0..at.len()).filter(|j| near(i, *j)).count() as u64;
    (0..at.len()).map(of).sum()
}

/// A step sweeps twice over the neighbours of the reference, for gradients and for forces, and twice over the
/// faces in contact reach, for ψ and for the forces of contact. Particles of two bodies are not neighbours in
/// the reference, even if they are near each other there.
#[test]
fn a_step_counts_each_sweep_over_the_reference_and_over_the_contact() {
    let scene = two(contact());
    let bodies = scene.bodies.clone();
    let places: Vec<Vector2<f64>> = scene.particles.iter().map(|p| p.position).collect();
    let mut solid = build::<Hencky, _, _>(scene);
    let before = solid.work();
    assert_eq!(solid.advance(1e-3, 1e-3, &mut ()), touchstone_solver::Outcome::Reached);
    let within = near(&places, 2.0 * 1.2, |i, j| bodies[i] == bodies[j]);
    let across = near(&places, 2.0 * 1.2, |i, j| bodies[i] != bodies[j]);
    let sizes: Vec<f64> = solid.body.reference.sizes.clone();
    let state = solid.checkpoint();
    let at: Vec<(u32, Vector2<f64>)> =
        state.particles.iter().map(|(id, particle)| (*id, particle.position)).collect();
    let faces = solid.body.reference.faces.clone();
    let seen = |i: &u32, j: &u32| {
        let [i, j] = [*i as usize, *j as usize];
        let apart = (at[i].1 - at[j].1).norm();
        bodies[at[i].0 as usize] != bodies[at[j].0 as usize] && apart < sizes[i] + sizes[j]
    };
    let touching =
        faces.iter().map(|i| faces.iter().filter(|j| seen(i, j)).count() as u64).sum::<u64>();
    assert!(within > 400 && across > 50 && touching > 10, "{within} {across} {touching}");
    assert_eq!(solid.work().pair_interactions - before.pair_interactions, 2 * (within + touching));
    assert_eq!(solid.work().right_hand_sides, places.len() as u64);
}

/// Images at planes and across periods are neighbours too: on a lattice in a periodic box each particle has
/// all that are within 2.4 spacings.
#[test]
fn neighbours_across_periods_count_and_restoring_counts_nothing() {
    let domain = Domain::torus(8.0, 6.0);
    let mut solid =
        build::<Hencky, _, _>(SolidScene { domain, ..scene(block(8, 6, 0.0), Open, ()) });
    assert_eq!(solid.advance(1e-3, 1e-3, &mut ()), touchstone_solver::Outcome::Reached);
    assert_eq!(solid.work().pair_interactions, 2 * 48 * 20);
    let state = solid.checkpoint();
    solid.restore(&state).unwrap();
    assert_eq!(solid.work().pair_interactions, 2 * 48 * 20);
}
