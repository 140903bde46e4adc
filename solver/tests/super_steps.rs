//! Super-time-stepping of viscosity against its exact properties.

use nalgebra::Vector2;
use std::ops::ControlFlow;
use touchstone_solver::{
    BodyForce, Compose, Continuity, CubicSpline, Domain, ExtrapolatingWall, Ghosts, Leapfrog,
    NoSlip, Observer, Open, Outcome, Particle, PlaneWall, Pressure, Role, Scene, Simulation, Split,
    Stepper, SuperSteps, Tait, Viscosity, integrator::stages, lattice, walls::Walls,
};

type Others = (Pressure<Tait>, BodyForce);
type Super<W> = Compose<CubicSpline, Split<Others, Viscosity>, Continuity, W, Leapfrog<SuperSteps>>;
type Plain<W> = Compose<CubicSpline, (Others, Viscosity), Continuity, W, Leapfrog>;

const N: usize = 16;
const DX: f64 = 1.0 / N as f64;
const H: f64 = 1.3 * DX;
/// So slow that no particle moves by one bit: the forces are linear, so the digits do not depend on the
/// speed.
const SLOW: f64 = 1e-30;
/// 2 over the largest eigenvalue of the lattice at ν = 1 and h = 1.3 dx, less 5 %.
const EXPLICIT: f64 = 0.34 * H * H;

fn viscosity() -> Viscosity {
    Viscosity { mu: 1.0, eta2: 1e-6 * H * H }
}

fn others(force: f64) -> Others {
    (Pressure::new(Tait::new(1.0, 1.0)), BodyForce(Vector2::new(force, 0.0)))
}

fn particles(velocity: impl Fn(Vector2<f64>) -> f64) -> Vec<Particle> {
    let particle =
        |x: Vector2<f64>| Particle::fluid(x, Vector2::new(velocity(x), 0.0), 1.0, DX * DX);
    lattice(Vector2::repeat(0.5 * DX), DX, N, N).map(particle).collect()
}

/// The scene with viscosity by super-time-stepping.
fn split<W: Walls<()>>(
    (domain, walls): (Domain, W),
    force: f64,
    particles: Vec<Particle>,
) -> Scene<Super<W>> {
    let forces = Split(others(force), viscosity(), EXPLICIT);
    Scene::new(H, domain, particles, forces, Continuity, walls)
}

fn torus() -> (Domain, Open) {
    (Domain::torus(1.0, 1.0), Open)
}

fn advance<S: touchstone_solver::Scheme<Extra = ()>>(
    scene: Scene<S>,
    until: f64,
    dt: f64,
) -> Simulation<S> {
    let mut simulation = scene.build().expect("a scene");
    assert_eq!(simulation.advance(until, dt, &mut ()), Outcome::Reached);
    simulation
}

fn speeds(simulation: &impl Stepper<()>) -> Vec<f64> {
    let fluid = simulation.particles().into_iter().filter(|p| p.role == Role::Fluid);
    fluid.map(|p| p.velocity.x / SLOW).collect()
}

fn farthest(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// cos(k a) from cos a.
fn multiple(cos: f64, k: usize) -> f64 {
    let (mut before, mut last) = (cos, 1.0);
    for _ in 0..k {
        (before, last) = (last, 2.0 * cos * last - before);
    }
    last
}

/// The cosine of whole waves over the height, at the rows of the lattice.
fn wave(waves: usize) -> impl Fn(Vector2<f64>) -> f64 {
    // cos π/8 by halves of angles.
    let turn = multiple((2.0 + 2.0_f64.sqrt()).sqrt() / 2.0, waves);
    move |x| SLOW * multiple(turn, (x.y / DX) as usize)
}

/// Legendre's polynomial of this degree.
fn legendre(degree: u32, x: f64) -> f64 {
    let (mut before, mut last) = (1.0, x);
    for j in 2..=degree {
        let j = f64::from(j);
        (before, last) = (last, ((2.0 * j - 1.0) * x * last - (j - 1.0) * before) / j);
    }
    last
}

/// The stage polynomial of s stages over dt, for a wave that decays at the rate γ.
fn factor(dt: f64, gamma: f64) -> f64 {
    let count = stages(dt / EXPLICIT);
    let s = f64::from(count);
    let b = (s * s + s - 2.0) / (2.0 * s * (s + 1.0));
    1.0 - b + b * legendre(count, 1.0 - 4.0 * gamma * dt / (s * s + s - 2.0))
}

#[test]
fn a_shear_wave_decays_by_the_stage_polynomial_of_its_eigenvalue() {
    for waves in [1, 3, 8] {
        let start = particles(wave(waves));
        let rest = advance(split(torus(), 0.0, start.clone()), 0.0, 1.0);
        let (fastest, rate) = rest
            .data()
            .fluid()
            .zip(rest.rates(&viscosity()))
            .map(|((_, p), rate)| (p.velocity.x, rate.velocity.x))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .expect("particles");
        let gamma = -rate / fastest;
        for ratio in [0.5, 2.4, 7.0, 30.0, 200.0] {
            let (dt, steps) = (ratio * EXPLICIT, 4.0);
            let end = advance(split(torus(), 0.0, start.clone()), steps * dt, dt);
            let expected = factor(0.5 * dt, gamma).powi(2) * factor(dt, gamma).powi(3);
            let decayed: Vec<f64> = start.iter().map(|p| p.velocity.x / SLOW * expected).collect();
            let apart = farthest(&speeds(&end), &decayed);
            assert!(apart < 1e-13, "{waves} waves, dt {ratio} limits: {apart:e} at {expected:e}");
            let sweeps = u64::from(stages(0.5 * ratio) + 3 * stages(ratio) + 4);
            let pairs = end.work().pair_interactions;
            assert_eq!(pairs % sweeps, 0, "each stage but the first is a sweep and counted");
            assert_eq!(pairs / sweeps, rest_pairs(&start), "pairs of one sweep");
        }
    }
}

/// Pairs that a leapfrog visits in one of its two sweeps.
fn rest_pairs(start: &[Particle]) -> u64 {
    type Method = Compose<CubicSpline, Pressure<Tait>, Continuity, Open, Leapfrog>;
    let (domain, walls) = torus();
    let pressure = others(0.0).0;
    let scene = Scene::<Method>::new(H, domain, start.to_vec(), pressure, Continuity, walls);
    // One step of two sweeps; the half kick that brings velocities to its end is not counted.
    advance(scene, 0.01 * EXPLICIT, EXPLICIT).work().pair_interactions / 2
}

#[test]
fn viscosity_is_of_second_order_in_dt() {
    let start = particles(wave(1));
    let end = |steps: u32| {
        let until = 20.0 * EXPLICIT;
        speeds(&advance(split(torus(), 0.0, start.clone()), until, until / f64::from(steps)))
    };
    let [coarse, middle, fine] = [8, 16, 32].map(end);
    let ratio = farthest(&coarse, &middle) / farthest(&middle, &fine);
    assert!(
        (3.7..4.6).contains(&ratio),
        "half of the step leaves a quarter of the error, so 3.7 to 4.6 is expected, and it is {ratio}"
    );
}

fn plate(y: f64, up: f64, speed: f64, curvature: f64) -> PlaneWall {
    let mut wall = PlaneWall::new(Vector2::y() * y, Vector2::y() * up, Vector2::x() * speed * SLOW);
    wall.curvature = Vector2::x() * (curvature * SLOW);
    wall
}

/// Three rows of boundary particles behind each plate, the upper one moving.
fn with_plates(mut fluid: Vec<Particle>) -> Vec<Particle> {
    for (first, speed) in [(-2.5 * DX, 0.0), (1.0 + 0.5 * DX, SLOW)] {
        let rows = lattice(Vector2::new(0.5 * DX, first), DX, N, 3);
        let at = |x| Particle::fluid(x, Vector2::x() * speed, 1.0, DX * DX).with_role(Role::Wall);
        fluid.extend(rows.map(at));
    }
    fluid
}

/// Walls whose images move, curve and extrapolate keep their part in each stage.
#[test]
fn a_steady_flow_between_moving_walls_is_that_of_the_plain_leapfrog() {
    fn check<W: Walls<()>>(walls: W, start: &[Particle]) {
        let domain = Domain::channel(1.0);
        let steady = |dt: f64| {
            speeds(&advance(split((domain, walls.clone()), 8.0 * SLOW, start.to_vec()), 4.0, dt))
        };
        let forces = (others(8.0 * SLOW), viscosity());
        let particles = start.to_vec();
        let plain = Scene::<Plain<W>>::new(H, domain, particles, forces, Continuity, walls.clone());
        let plain = speeds(&advance(plain, 4.0, EXPLICIT));
        assert!(plain.iter().any(|u| *u > 1.2), "it flows");
        for ratio in [2.0, 20.0] {
            let apart = farthest(&steady(ratio * EXPLICIT), &plain);
            assert!(apart < 1e-12, "{}: {apart:e}", std::any::type_name::<W>());
        }
    }
    let rest = || particles(|_| 0.0);
    let walls = vec![plate(0.0, 1.0, 0.0, -8.0), plate(1.0, -1.0, 1.0, -8.0)];
    check(Ghosts { walls }, &rest());
    let eos = Tait::new(1.0, 1.0);
    check(ExtrapolatingWall::<_, NoSlip>::new(eos, Vector2::zeros()), &with_plates(rest()));
}

/// Every velocity after a kick is a mean of velocities before it, at any dt.
#[test]
fn velocities_do_not_overshoot_their_neighbours() {
    let step = |x: Vector2<f64>| if (0.3..0.7).contains(&x.y) { SLOW } else { 0.0 };
    for ratio in [1.0, 2.5, 6.9, 13.5, 100.0, 1000.0] {
        let dt = ratio * EXPLICIT;
        let end = advance(split(torus(), 0.0, particles(step)), 2.0 * dt, dt);
        let all = speeds(&end);
        let bounded = all.iter().all(|u| (-1e-13..=1.0 + 1e-13).contains(u));
        assert!(bounded, "dt {ratio} limits: {all:?}");
    }
}

/// Particles out of order with random velocities.
fn disordered() -> Vec<Particle> {
    let number = |k: usize| (k as f64 * 0.618_033_988_749_895).fract() - 0.5;
    let mut all = particles(|_| 0.0);
    for (k, p) in all.iter_mut().enumerate() {
        p.position += Vector2::new(number(3 * k), number(7 * k)) * (0.3 * DX);
        p.velocity = Vector2::new(number(5 * k), number(11 * k)) * 0.1;
        p.density += 0.02 * number(13 * k);
    }
    all
}

fn momentum(simulation: &impl Stepper<()>) -> Vector2<f64> {
    simulation.particles().iter().map(|p| p.velocity * p.mass).sum()
}

#[test]
fn momentum_is_kept_to_round_off() {
    let scene = split(torus(), 0.0, disordered());
    let scale: f64 = scene.setting.particles.iter().map(|p| p.mass * p.velocity.norm()).sum();
    let mut simulation = scene.build().expect("a scene");
    let before = momentum(&simulation);
    let dt = 30.0 * EXPLICIT;
    assert_eq!(simulation.advance(20.0 * dt, dt, &mut ()), Outcome::Reached);
    let error = (momentum(&simulation) - before).norm() / scale;
    assert!(error < 1e-14, "the momentum changed by {error:e} of itself, expected below 1e-14");
}

fn bits(simulation: &impl Stepper<()>) -> Vec<u64> {
    let numbers = |p: Particle| {
        [p.position.x, p.position.y, p.velocity.x, p.velocity.y, p.density].map(f64::to_bits)
    };
    simulation.particles().into_iter().flat_map(numbers).collect()
}

/// Disordered fluid between plates of boundary particles that extrapolate, and dt.
fn mixed() -> (Scene<Super<ExtrapolatingWall<Tait, NoSlip>>>, f64) {
    let walls = ExtrapolatingWall::new(Tait::new(1.0, 1.0), Vector2::zeros());
    (split((Domain::channel(1.0), walls), 0.1, with_plates(disordered())), 8.0 * EXPLICIT)
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let run = |threads: usize| {
        let (mut scene, dt) = mixed();
        scene.setting.parallel_from = if threads == 0 { usize::MAX } else { 0 };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.max(1)).build();
        pool.expect("threads").install(|| bits(&advance(scene, 20.0 * dt, dt)))
    };
    let serial = run(0);
    for threads in [1, 2, 3] {
        assert!(run(threads) == serial, "{threads} threads");
    }
}

/// Stops after this number of steps.
struct After(u64);

impl Observer<()> for After {
    fn after_step(&mut self, simulation: &dyn Stepper<()>) -> ControlFlow<()> {
        if simulation.work().steps == self.0 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

#[test]
fn a_run_goes_on_from_a_checkpoint_with_the_same_bits() {
    let (scene, dt) = mixed();
    let whole = advance(scene, 20.0 * dt, dt);
    for steps in [1, 7, 19] {
        let mut first = mixed().0.build().expect("a scene");
        assert_eq!(first.advance(20.0 * dt, dt, &mut After(steps)), Outcome::Stopped);
        let mut second = mixed().0.build().expect("a scene");
        second.restore(&first.checkpoint()).expect("a checkpoint");
        assert_eq!(second.advance(20.0 * dt, dt, &mut ()), Outcome::Reached);
        assert!(bits(&second) == bits(&whole), "from step {steps}");
    }
}

/// With an overestimated explicit limit there are too few stages, and the run diverges.
#[test]
fn a_limit_that_is_stated_too_long_ends_as_a_divergence() {
    let run = |stated: f64| {
        let mut scene = split(torus(), 0.0, disordered());
        scene.forces.2 = stated * EXPLICIT;
        scene.setting.limits.speed = 10.0;
        let dt = 7.0 * stated * EXPLICIT;
        scene.build().expect("a scene").advance(400.0 * dt, dt, &mut ())
    };
    assert_eq!(run(1.0), Outcome::Reached);
    assert!(matches!(run(1.5), Outcome::Diverged(_)), "{:?}", run(1.5));
}

/// A viscosity of 10⁹ ν once kept the theory of the time step busy without end.
#[test]
fn a_step_of_any_length_has_a_bounded_number_of_stages() {
    let most = (999.0 * 999.0 + 999.0 - 2.0) / 4.0;
    assert_eq!([0.0, most, 1.01 * most, 1e30, f64::INFINITY].map(stages), [3, 999, 999, 999, 999]);
}
