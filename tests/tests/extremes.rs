//! Extreme runs end with a value, and runs that cannot start are refused with their numbers.

use nalgebra::Vector2;
use touchstone_solver::{
    Compose, Continuity, CubicSpline, DivergenceBounds, Domain, Euler, Ghosts, Integrator,
    Leapfrog, Open, Outcome, Particle, PlaneWall, PredictorCorrector, Pressure, Role, Scene,
    SceneError, Simulation, Stepper, Tait, Viscosity, scene::Setting,
};
use touchstone_tests::{Random, assert_near, assert_small, difference, patch};

type Forces = (Pressure<Tait>, Viscosity);
type Scheme<I, W = Open> = Compose<CubicSpline, Forces, Continuity, W, I>;

const H: f64 = 0.08;
const C: f64 = 10.0;

fn forces() -> Forces {
    (Pressure::new(Tait::new(1.0, C)), Viscosity { mu: 0.01, eta2: 1e-4 * H * H })
}

fn scene<I: Integrator<Scheme<()>>>(domain: Domain, particles: Vec<Particle>) -> Scene<Scheme<I>> {
    Scene::new(H, domain, particles, forces(), Continuity, Open)
}

fn torus<I: Integrator<Scheme<()>>>() -> Scene<Scheme<I>> {
    scene(Domain::torus(1.0, 1.0), patch(16, 0.1, 1))
}

/// The limits of sound (1.87 h/c with leapfrog) and of viscosity (0.35 h²/ν) are 0.015 and 0.22 s.
fn check_divergence<I: Integrator<Scheme<()>>>(dt: f64) {
    let limits = DivergenceBounds { density: [0.5, 2.0], speed: 5.0 * C };
    let mut scene = torus::<I>();
    scene.setting.limits = limits;
    let mut simulation = scene.build().unwrap();
    let Outcome::Diverged(divergence) = simulation.advance(1000.0 * dt, dt, &mut ()) else {
        panic!("{} went through at {dt} s", I::NAME);
    };
    let step = divergence.step;
    let steps = simulation.work().steps;
    assert!(
        step < 1000 && step == steps,
        "diverged at step {step} of at most 1000, and made {steps}"
    );
    assert_near("the time of the divergence", divergence.time, step as f64 * dt, 1e-12);
    assert_eq!(divergence.time, simulation.time());
    let fault = divergence.fault;
    assert!(fault.particle < 256 && ["position", "velocity", "density"].contains(&fault.field));
    // The fault names a particle of the state that was left, and the number that is there.
    let particle = simulation.particles()[fault.particle as usize];
    if fault.field == "density" {
        let density = particle.density;
        let is_sound = density > 0.5 && density < 2.0;
        assert!(!is_sound, "the density {density} is named as the fault, and is between 0.5 and 2");
    } else {
        let speed = particle.velocity.norm();
        assert!(
            !(speed <= 5.0 * C),
            "the speed {speed} is named as the fault, and is at most 5 c0"
        );
    }
    let text = divergence.to_string();
    for part in [fault.field, &format!("step {step}"), &format!("particle {}", fault.particle)] {
        assert!(text.contains(part), "{text}");
    }
}

/// Σ m v of all particles \[kg/s\].
fn momentum(particles: &[Particle]) -> Vector2<f64> {
    particles.iter().fold(Vector2::zeros(), |sum, p| sum + p.velocity * p.mass)
}

#[test]
fn steps_of_three_times_the_limit_end_in_a_divergence_with_its_place() {
    check_divergence::<Leapfrog>(3.0 * 1.87 * H / C);
    check_divergence::<PredictorCorrector>(3.0 * 1.87 * H / C);
}

#[test]
fn without_limits_a_run_that_overflows_still_diverges() {
    for dt in [1.0, 1e100, 1e200] {
        let mut simulation = torus::<Leapfrog>().build().unwrap();
        let outcome = simulation.advance(100.0 * dt, dt, &mut ());
        assert!(matches!(outcome, Outcome::Diverged(_)), "dt = {dt}: {outcome:?}");
    }
}

/// One particle whose speed overflows in the last step while its place does not.
#[test]
fn a_speed_that_overflows_at_the_end_is_a_divergence() {
    type Falling = Compose<CubicSpline, touchstone_solver::BodyForce, (), Open, Leapfrog>;
    let fall = |force| {
        let particle = Particle::fluid(Vector2::zeros(), Vector2::zeros(), 1.0, 1.0);
        let force = touchstone_solver::BodyForce(Vector2::new(0.0, force));
        let scene = Scene::<Falling>::new(H, Domain::open(), vec![particle], force, (), Open);
        scene.build().unwrap().advance(1e-140, 1e-140, &mut ())
    };
    assert_eq!(fall(1e280), Outcome::Reached);
    let Outcome::Diverged(divergence) = fall(1e300) else {
        panic!("a speed whose square is infinite went through");
    };
    assert_eq!((divergence.fault.particle, divergence.fault.field), (0, "velocity"));
}

fn refused(change: impl Fn(&mut Setting)) -> SceneError {
    let mut scene = torus::<Leapfrog>();
    change(&mut scene.setting);
    let refused = scene.build().err();
    refused.expect("a scene that cannot be simulated was built")
}

fn check_message(error: &SceneError, parts: &[&str]) {
    let text = error.to_string();
    for part in parts {
        assert!(text.contains(part), "\"{part}\" is not in \"{text}\"");
    }
}

#[test]
fn lengths_that_make_no_sense_are_refused_with_their_value() {
    for h in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        check_message(&refused(|s| s.h = h), &["smoothing length", &h.to_string()]);
    }
    for skin in [-1e-9, f64::NAN, f64::INFINITY] {
        check_message(&refused(|s| s.skin = skin), &["skin", &skin.to_string()]);
    }
    for period in [3.99 * H, 0.0, -1.0, f64::NAN, f64::INFINITY] {
        for (axis, name) in [(0, "along x"), (1, "along y")] {
            let error = refused(|s| s.domain.period[axis] = Some(period));
            check_message(&error, &[name, &period.to_string(), &(4.0 * H).to_string()]);
        }
    }
    // The skin makes rows longer than the period, which is itself long enough.
    let error = refused(|s| s.skin = 1.5);
    check_message(&error, &["in m is 1,", &(2.0 * H + 1.5).to_string()]);
    check_message(&refused(|s| s.domain.low.y = f64::NAN), &["lower corner", "NaN"]);
}

#[test]
fn particles_that_make_no_sense_are_refused_with_number_and_value() {
    let nan = f64::NAN;
    for bad in [0.0, -2.5, nan, f64::INFINITY] {
        let error = refused(|s| s.particles[7].mass = bad);
        check_message(&error, &["particle 7", "mass", &bad.to_string()]);
        let error = refused(|s| s.particles[9].density = bad);
        check_message(&error, &["particle 9", "density", &bad.to_string()]);
    }
    check_message(
        &refused(|s| s.particles[3].position.y = nan),
        &["particle 3", "position", "NaN"],
    );
    let error = refused(|s| s.particles[4].velocity.x = f64::INFINITY);
    check_message(&error, &["particle 4", "velocity", "inf"]);
    let none = ["scene", "number of fluid particles is 0", "above 0"];
    check_message(&refused(|s| s.particles.clear()), &none);
    let walls_only = refused(|s| s.particles.iter_mut().for_each(|p| p.role = Role::Wall));
    check_message(&walls_only, &none);
}

#[test]
fn mirrors_that_are_none_are_refused() {
    let wall = |normal, velocity| PlaneWall::new(Vector2::zeros(), normal, velocity);
    let (up, along) = (Vector2::y(), Vector2::x());
    for (wall, part) in [
        (wall(up * 2.0, along), "length of its normal is 2"),
        (wall(up * f64::NAN, along), "NaN"),
        (wall(up, up + along), "along its normal is 1"),
        (wall(up, along * f64::NAN), "NaN"),
    ] {
        let walls = Ghosts { walls: vec![PlaneWall::new(Vector2::zeros(), up, along), wall] };
        let domain = Domain::channel(1.0);
        let particles = patch(8, 0.0, 1);
        let scene = Scene::<Scheme<Leapfrog, Ghosts>>::new(
            H,
            domain,
            particles,
            forces(),
            Continuity,
            walls,
        );
        check_message(&scene.build().err().unwrap(), &["wall 1", part]);
    }
}

#[test]
fn times_that_make_no_sense_panic_and_do_not_hang() {
    for (until, dt) in [
        (f64::NAN, 0.1),
        (-1.0, 0.1),
        (f64::INFINITY, 0.1),
        (1.0, 0.0),
        (1.0, -0.1),
        (1.0, f64::NAN),
        (1.0, 1e-300),
    ] {
        let attempt = std::panic::catch_unwind(|| {
            let mut simulation = torus::<Leapfrog>().build().unwrap();
            simulation.advance(until, dt, &mut ())
        });
        let message = *attempt.expect_err("not refused").downcast::<String>().unwrap();
        assert!(
            message.contains("reach"),
            "expected a refusal that says `reach`, and it says: {message}"
        );
    }
}

/// Steps an open scene and returns the state.
fn run<I: Integrator<Scheme<()>>>(
    particles: Vec<Particle>,
    dt: f64,
    steps: u32,
) -> Simulation<Scheme<I>> {
    let mut simulation = scene::<I>(Domain::open(), particles).build().unwrap();
    assert_eq!(simulation.advance(dt * f64::from(steps), dt, &mut ()), Outcome::Reached);
    simulation
}

#[test]
fn a_particle_alone_moves_straight_on() {
    let start = Particle::fluid(Vector2::zeros(), Vector2::new(3.0, -1.0), 1.1, 1e-3);
    let apart = Particle { position: Vector2::new(1e6 * H, 0.0), ..start };
    let expected = |p: &Particle| Particle { position: p.position + p.velocity, ..*p };
    for particles in [vec![start], vec![start, apart]] {
        let expected: Vec<_> = particles.iter().map(expected).collect();
        for end in [
            run::<Leapfrog>(particles.clone(), 1.0 / 64.0, 64).particles(),
            run::<PredictorCorrector>(particles.clone(), 1.0 / 64.0, 64).particles(),
        ] {
            let apart = difference(&end, &expected, [None, None]);
            assert_small("the end of the run less where it should be [m]", apart, 1e-15 * 1e6 * H);
            assert_eq!((end[0].velocity, end[0].density), (start.velocity, start.density));
        }
    }
}

#[test]
fn coincident_particles_stay_together_or_part_with_their_momentum() {
    let one = Particle::fluid(Vector2::zeros(), Vector2::zeros(), 1.2, 1e-3);
    let end = run::<Leapfrog>(vec![one, one, one], 1e-3, 50).particles();
    assert!(end.iter().all(|p| *p == one), "no direction to be pushed in: {end:?}");
    let other = Particle { velocity: Vector2::new(0.3, 0.1), mass: 2.0 * one.mass, ..one };
    let simulation = run::<Leapfrog>(vec![one, other], 1e-3, 50);
    let exact = other.velocity * other.mass;
    let off = (momentum(&simulation.particles()) - exact).norm() / exact.norm();
    assert_small("the change of momentum over the momentum", off, 5e-14);
}

#[test]
fn a_thousand_times_the_speed_of_sound_conserves_momentum_or_is_reported() {
    let mut particles = patch(12, 0.2, 4);
    let mut random = Random::new(6);
    particles.iter_mut().for_each(|p| p.velocity = random.vector(-1e3 * C, 1e3 * C));
    let size: f64 = particles.iter().map(|p| p.mass * p.velocity.norm()).sum();
    let dt = 0.1 * H / (1e3 * C);
    let scene = |limits| {
        let mut scene = scene::<Leapfrog>(Domain::open(), particles.clone());
        (scene.forces.1.mu, scene.setting.limits) = (0.0, limits);
        scene.build().unwrap()
    };
    let mut simulation =
        scene(DivergenceBounds { density: [-f64::MAX, f64::MAX], speed: f64::MAX });
    let outcome = simulation.advance(200.0 * dt, dt, &mut ());
    assert_eq!(outcome, Outcome::Reached);
    let lost = (momentum(&simulation.particles()) - momentum(&particles)).norm();
    assert!(lost < 1e-12 * size, "momentum changed by {:e}", lost / size);
    let mut simulation =
        scene(DivergenceBounds { speed: 500.0 * C, ..DivergenceBounds::default() });
    let Outcome::Diverged(divergence) = simulation.advance(200.0 * dt, dt, &mut ()) else {
        panic!("faster than allowed, and not reported");
    };
    assert_eq!((divergence.step, divergence.time, divergence.fault.field), (0, 0.0, "velocity"));
}

/// In a period of 1 m, 0.51 m a step is not motion: an image is as near as the particle.
#[test]
fn half_a_period_in_a_step_is_a_divergence_and_in_two_steps_is_not() {
    let particle = Particle::fluid(Vector2::new(0.7, 0.2), Vector2::new(0.51, 0.0), 1.0, 1e-3);
    let advance = |dt| {
        let scene = scene::<Euler>(Domain::torus(1.0, 1.0), vec![particle]);
        scene.build().unwrap().advance(1.0, dt, &mut ())
    };
    assert_eq!(advance(0.5), Outcome::Reached);
    let Outcome::Diverged(divergence) = advance(1.0) else { panic!("not noticed") };
    assert_eq!((divergence.fault.particle, divergence.fault.field), (0, "position"));
}

#[test]
fn each_limit_is_kept_from_the_first_step_on() {
    let limits = DivergenceBounds { density: [0.5, 2.0], speed: 3.0 };
    let start = |change: fn(&mut Particle)| {
        let mut scene = torus::<Leapfrog>();
        scene.setting.limits = limits;
        change(&mut scene.setting.particles[40]);
        match scene.build().unwrap().advance(1e-3, 1e-3, &mut ()) {
            Outcome::Diverged(d) => Some((d.step, d.fault.particle, d.fault.field, d.fault.value)),
            _ => None,
        }
    };
    assert_eq!(start(|p| p.density = 1.1), None);
    assert_eq!(start(|p| p.density = 2.5), Some((0, 40, "density", 2.5)));
    assert_eq!(start(|p| p.density = 0.25), Some((0, 40, "density", 0.25)));
    assert_eq!(start(|p| p.velocity = -4.0 * Vector2::y()), Some((0, 40, "velocity", 4.0)));
}
