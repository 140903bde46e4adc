//! Whole short runs in another frame: moved, mirrored, turned, renumbered, in other units.

use nalgebra::Vector2;
use touchstone_solver::{
    Compose, Continuity, CubicSpline, Domain, Ghosts, Integrator, Leapfrog, Open, Outcome,
    Particle, PlaneWall, PredictorCorrector, Pressure, Scene, Simulation, Stepper, Tait, Viscosity,
    lattice,
};
use touchstone_tests::{Random, V2, assert_small, bits, difference, patch};

type Forces = (Pressure<Tait>, Viscosity);
type Scheme<I> = Compose<CubicSpline, Forces, Continuity, Open, I>;

const TORUS: [Option<f64>; 2] = [Some(1.0), Some(1.0)];
const H: f64 = 0.09;
const DT: f64 = 1.0 / 64.0;
const STEPS: u32 = 50;
/// Differences of round-off, 1e-16, after 50 steps of a flow that stretches them.
const ROUND_OFF: f64 = 1e-13;

fn scene<I: Integrator<Scheme<()>>>(particles: Vec<Particle>) -> Scene<Scheme<I>> {
    let pressure = Pressure::new(Tait { background: 0.3, ..Tait::new(1.0, 1.0) });
    let forces = (pressure, Viscosity { mu: 0.01, eta2: 1e-4 * H * H });
    Scene::new(H, Domain::torus(1.0, 1.0), particles, forces, Continuity, Open)
}

fn run<I: Integrator<Scheme<()>>>(particles: Vec<Particle>) -> Vec<Particle> {
    let mut simulation = scene::<I>(particles).build().unwrap();
    assert_eq!(simulation.advance(f64::from(STEPS) * DT, DT, &mut ()), Outcome::Reached);
    assert!(simulation.work().list_builds > 2, "rows were rebuilt on the way");
    simulation.particles()
}

fn start() -> Vec<Particle> {
    patch(12, 0.15, 11)
}

/// `seen` of the end must equal the end of `seen` of the start.
fn check<I: Integrator<Scheme<()>>>(
    name: &str,
    tolerance: f64,
    seen: impl Fn(Particle, f64) -> Particle,
) {
    let elsewhere = run::<I>(start().into_iter().map(|p| seen(p, 0.0)).collect());
    let time = f64::from(STEPS) * DT;
    let here: Vec<_> = run::<I>(start()).into_iter().map(|p| seen(p, time)).collect();
    let apart = difference(&elsewhere, &here, TORUS);
    println!("{name}, {}: {apart:e}", I::NAME);
    assert!(apart < tolerance, "{name}, {}: {apart:e}", I::NAME);
    assert!(difference(&here, &start(), TORUS) > 1e-2, "nothing happened");
}

fn check_all<I: Integrator<Scheme<()>>>() {
    // A moving frame loses the bits that its velocity takes: eps U/v.
    check::<I>("Galilean", 10.0 * ROUND_OFF, |p, t| {
        let frame = Vector2::new(3.0, -1.7);
        let position = p.position + frame * t;
        Particle { position, velocity: p.velocity + frame, ..p }
    });
    check::<I>("mirrored", ROUND_OFF, |p, _| {
        let mirror = |v: V2| Vector2::new(-v.x, v.y);
        Particle { position: mirror(p.position), velocity: mirror(p.velocity), ..p }
    });
    check::<I>("turned by 90 degrees", ROUND_OFF, |p, _| {
        let turn = |v: V2| Vector2::new(-v.y, v.x);
        Particle { position: turn(p.position), velocity: turn(p.velocity), ..p }
    });
    check::<I>("moved", ROUND_OFF, |p, _| Particle {
        position: p.position + Vector2::new(0.37, 0.81),
        ..p
    });
}

#[test]
fn leapfrog_is_the_same_in_every_frame() {
    check_all::<Leapfrog>();
}

#[test]
fn predictor_corrector_is_the_same_in_every_frame() {
    check_all::<PredictorCorrector>();
}

fn check_permutation<I: Integrator<Scheme<()>>>() {
    let mut order: Vec<usize> = (0..144).collect();
    Random::new(8).shuffle(&mut order);
    let start = start();
    let permuted = run::<I>(order.iter().map(|&k| start[k]).collect());
    let plain = run::<I>(start);
    let gathered: Vec<_> = order.iter().map(|&k| plain[k]).collect();
    assert_ne!(order, (0..144).collect::<Vec<_>>());
    assert_eq!(bits(&permuted), bits(&gathered));
}

#[test]
fn the_order_of_the_particles_does_not_change_a_bit() {
    check_permutation::<Leapfrog>();
    check_permutation::<PredictorCorrector>();
}

/// A run in units that are 2^l, 2^t, 2^m times as small, read back in the units of [`run`].
fn in_units<I: Integrator<Scheme<()>>>([l, t, m]: [i32; 3]) -> Vec<Particle> {
    let [length, time, mass] = [l, t, m].map(|k| 2.0_f64.powi(k));
    let (speed, density) = (length / time, mass / (length * length));
    let scale = |p: Particle| Particle {
        position: p.position * length,
        velocity: p.velocity * speed,
        density: p.density * density,
        mass: p.mass * mass,
        ..p
    };
    let particles = start().into_iter().map(scale).collect();
    let background = 0.3 * density * speed * speed;
    let pressure = Pressure::new(Tait { background, ..Tait::new(density, speed) });
    let h = H * length;
    let viscosity = Viscosity { mu: 0.01 * density * length * speed, eta2: 1e-4 * h * h };
    let domain = Domain::torus(length, length);
    let scene =
        Scene::<Scheme<I>>::new(h, domain, particles, (pressure, viscosity), Continuity, Open);
    let mut simulation = scene.build().unwrap();
    let dt = DT * time;
    assert_eq!(simulation.advance(f64::from(STEPS) * dt, dt, &mut ()), Outcome::Reached);
    let back = |p: Particle| Particle {
        position: p.position / length,
        velocity: p.velocity / speed,
        density: p.density / density,
        mass: p.mass / mass,
        ..p
    };
    simulation.particles().into_iter().map(back).collect()
}

#[test]
fn units_by_powers_of_two_do_not_change_a_bit() {
    let plain = bits(&run::<Leapfrog>(start()));
    for units in [[10, 0, 0], [0, -7, 0], [0, 0, 40], [-20, 9, 3], [33, 50, -60]] {
        assert_eq!(bits(&in_units::<Leapfrog>(units)), plain, "units {units:?}");
    }
    let plain = bits(&run::<PredictorCorrector>(start()));
    assert_eq!(bits(&in_units::<PredictorCorrector>([-20, 9, 3])), plain);
}

type Channel = Compose<CubicSpline, Forces, Continuity, Ghosts, Leapfrog>;

/// A disordered Couette flow between ghosts, walls moving with `below` and `above`.
fn channel(particles: Vec<Particle>, below: f64, above: f64) -> Simulation<Channel> {
    let wall = |y, up, u| {
        PlaneWall::new(Vector2::new(0.0, y), Vector2::new(0.0, up), Vector2::new(u, 0.0))
    };
    let walls = Ghosts { walls: vec![wall(0.0, 1.0, below), wall(1.0, -1.0, above)] };
    let pressure = Pressure::new(Tait { background: 0.3, ..Tait::new(1.0, 10.0) });
    let forces = (pressure, Viscosity { mu: 0.1, eta2: 1e-4 * H * H });
    let scene = Scene::new(H, Domain::channel(0.5), particles, forces, Continuity, walls);
    let mut simulation = scene.build().unwrap();
    assert_eq!(simulation.advance(0.25, 1.0 / 512.0, &mut ()), Outcome::Reached);
    simulation
}

fn at_rest() -> Vec<Particle> {
    let (mut random, dx) = (Random::new(3), 1.0 / 16.0);
    lattice(Vector2::repeat(0.5 * dx), dx, 8, 16)
        .map(|p| p + random.vector(-0.1, 0.1) * dx)
        .map(|p| Particle::fluid(p, Vector2::zeros(), 1.0, dx * dx))
        .collect()
}

#[test]
fn swapping_the_walls_of_a_ghost_channel_mirrors_its_flow() {
    let flip = |p: Particle| Particle {
        position: Vector2::new(p.position.x, 1.0 - p.position.y),
        velocity: Vector2::new(p.velocity.x, -p.velocity.y),
        ..p
    };
    let flipped = |particles: Vec<Particle>| particles.into_iter().map(flip).collect::<Vec<_>>();
    let lower = channel(at_rest(), 1.0, 0.0).particles();
    let upper = flipped(channel(flipped(at_rest()), 0.0, 1.0).particles());
    let apart = difference(&lower, &upper, [Some(0.5), None]);
    assert_small("what swapping the walls changes", apart, 10.0 * ROUND_OFF);
    let fastest = lower.iter().map(|p| p.velocity.x).fold(0.0, f64::max);
    assert!((0.8..1.05).contains(&fastest), "the wall drags its fluid along: {fastest}");
}

/// Both walls and the fluid at U: at rest in the frame of the walls.
#[test]
fn a_ghost_channel_that_moves_as_a_whole_is_one_at_rest() {
    let frame = Vector2::new(2.0, 0.0);
    let moving = at_rest().into_iter().map(|p| Particle { velocity: frame, ..p }).collect();
    let back = |p: Particle| Particle {
        position: p.position - frame * 0.25,
        velocity: p.velocity - frame,
        ..p
    };
    let seen: Vec<_> = channel(moving, 2.0, 2.0).particles().into_iter().map(back).collect();
    let rest = channel(at_rest(), 0.0, 0.0).particles();
    let apart = difference(&seen, &rest, [Some(0.5), None]);
    assert_small("what a moving observer sees otherwise", apart, 100.0 * ROUND_OFF);
}
