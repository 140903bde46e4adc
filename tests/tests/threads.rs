//! Equal bits on any number of threads, and without threads.
//!
//! Rows are gathered, each by one thread in its own order; blocks are fixed; maxima are exact. That
//! is the mechanism under test. 2,500 particles are five blocks, so that pools share them unevenly. The strip
//! has so many wall particles and images that cheap loops over these use threads too.

use nalgebra::Vector2;
use touchstone_solver::{
    Compose, Continuity, CubicSpline, Domain, Euler, ExtrapolatingWall, Ghosts, Integrator,
    InterfaceWall, Leapfrog, NoSlip, Open, Outcome, Particle, PlaneWall, PredictorCorrector,
    Pressure, Role, Scene, Scheme, Shifting, Smoothing, Stepper, Tait, Viscosity,
    integrator::SingleSweep,
    lattice,
    walls::{SlipGhosts, Walls},
};
use touchstone_tests::{Random, V2, bits, patch};

const N: usize = 50;
const DX: f64 = 1.0 / N as f64;
const H: f64 = 1.3 * DX;

type Forces = (Pressure<Tait>, Viscosity);
type Drift = (Continuity, Shifting);
type Method<W, I> = Compose<CubicSpline, Forces, Drift, W, I>;

fn scene<W: Walls<()>, I: Integrator<Method<W, ()>>>(
    domain: Domain,
    particles: Vec<Particle>,
    walls: W,
) -> Scene<Method<W, I>> {
    let pressure = Pressure::new(Tait { background: 0.3, ..Tait::new(1.0, 1.0) });
    let forces = (pressure, Viscosity { mu: 1e-3, eta2: 1e-4 * H * H });
    let w = Smoothing::<CubicSpline>::new(H).w(DX * DX);
    let drift = (Continuity, Shifting::new(0.5, H, w));
    Scene::new(H, domain, particles, forces, drift, walls)
}

/// Runs the scene serially, then on 1, 2 and 4 threads.
fn check<S: Scheme<Extra = ()>>(name: &str, scene: impl Fn() -> Scene<S> + Sync) {
    let run = |parallel_from: usize| {
        let mut scene = scene();
        scene.setting.parallel_from = parallel_from;
        let mut simulation = scene.build().unwrap();
        // What is synchronised after 10 steps is taken back in the next one.
        for steps in [10_u32, 30] {
            let until = f64::from(steps) * 0.3 * DX;
            let outcome = simulation.advance(until, 0.3 * DX, &mut ());
            assert_eq!((outcome, simulation.work().steps), (Outcome::Reached, steps.into()));
        }
        assert!(simulation.work().list_builds > 2, "{name}: rows were rebuilt on the way");
        (bits(&simulation.particles()), simulation.work())
    };
    let serial = run(usize::MAX);
    for threads in [1, 2, 4] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let parallel = pool.install(|| run(0));
        assert!(parallel == serial, "{name} differs on {threads} threads");
    }
    let mut scene = scene();
    scene.setting.parallel_from = usize::MAX;
    let start = scene.build().unwrap();
    assert_ne!(bits(&start.particles()), serial.0, "{name}: something happened");
}

fn periodic<I: Integrator<Method<Open, ()>>>() -> Scene<Method<Open, I>> {
    scene(Domain::torus(1.0, 1.0), patch(N, 0.1, 2), Open)
}

#[test]
fn a_periodic_box_has_the_same_bits_on_any_number_of_threads() {
    check("leapfrog", periodic::<Leapfrog>);
    check("predictor-corrector", periodic::<PredictorCorrector>);
}

#[test]
fn a_channel_of_ghosts_has_the_same_bits_on_any_number_of_threads() {
    let wall = |y, up, u| {
        PlaneWall::new(Vector2::new(0.0, y), Vector2::new(0.0, up), Vector2::new(u, 0.0))
    };
    check("ghosts", || {
        let walls = Ghosts { walls: vec![wall(0.0, 1.0, 0.0), wall(1.0, -1.0, 0.2)] };
        scene::<_, Leapfrog>(Domain::channel(1.0), channel_fluid(), walls)
    });
}

/// The patch without motion through the walls.
fn channel_fluid() -> Vec<Particle> {
    let along = |p: Particle| Particle { velocity: Vector2::new(p.velocity.x, 0.0), ..p };
    patch(N, 0.05, 2).into_iter().map(along).collect()
}

/// Interface particles at y = 0 and 1, and behind them wall rows up to the support of the kernel: 700 wall
/// particles, in blocks of their own.
fn walled() -> Vec<Particle> {
    let row = |y: f64, role: Role, u: f64| {
        let points = lattice(Vector2::new(0.5 * DX, y), DX, N, 1);
        points.map(move |p: V2| {
            Particle::fluid(p, Vector2::new(u, 0.0), 1.0, DX * DX).with_role(role)
        })
    };
    let mut all = channel_fluid();
    for (y, out, u) in [(0.0, -1.0, 0.0), (1.0, 1.0, 0.2)] {
        all.extend(row(y, Role::Interface, u));
        for k in 1..=7 {
            all.extend(row(y + out * f64::from(k) * DX, Role::Wall, u));
        }
    }
    // Roles mixed: the solver sorts them.
    Random::new(4).shuffle(&mut all);
    all
}

#[test]
fn a_channel_of_wall_particles_has_the_same_bits_on_any_number_of_threads() {
    check("walls, leapfrog", || {
        scene::<_, Leapfrog>(Domain::channel(1.0), walled(), InterfaceWall)
    });
    check("walls, predictor-corrector", || {
        scene::<_, PredictorCorrector>(Domain::channel(1.0), walled(), InterfaceWall)
    });
}

#[test]
fn a_channel_of_extrapolating_walls_has_the_same_bits_on_any_number_of_threads() {
    let walls = || ExtrapolatingWall::new(Tait::new(1.0, 1.0), Vector2::new(0.1, -0.2));
    check("extrapolating walls, leapfrog", || {
        scene::<ExtrapolatingWall<Tait, NoSlip>, Leapfrog>(Domain::channel(1.0), walled(), walls())
    });
    check("extrapolating walls, predictor-corrector", || {
        scene::<_, PredictorCorrector>(Domain::channel(1.0), walled(), walls())
    });
}

/// Rows and columns of a strip.
const STRIP: [usize; 2] = [12, 400];

/// A strip between walls at y = 0 and the height of the strip, along which the fluid streams.
fn strip() -> Vec<Particle> {
    let mut random = Random::new(8);
    let points = lattice(Vector2::repeat(0.5 * DX), DX, STRIP[1], STRIP[0]);
    let particle = |point: V2| {
        let velocity = random.vector(-0.1, 0.1) + Vector2::new(0.3, 0.0);
        Particle::fluid(point + random.vector(-0.1, 0.1) * DX, velocity, 1.0, DX * DX)
    };
    points.map(particle).collect()
}

/// Six rows of wall particles below the strip and six above.
fn walled_strip() -> Vec<Particle> {
    let mut all = strip();
    for row in (-6..0).chain(STRIP[0] as i32..STRIP[0] as i32 + 6) {
        let first = Vector2::new(0.5, f64::from(row) + 0.5) * DX;
        let points = lattice(first, DX, STRIP[1], 1);
        let wall = |p: V2| Particle::fluid(p, Vector2::zeros(), 1.0, DX * DX).with_role(Role::Wall);
        all.extend(points.map(wall));
    }
    all
}

#[test]
fn a_strip_of_many_images_and_wall_particles_has_the_same_bits_on_any_number_of_threads() {
    let [height, length] = STRIP.map(|count| count as f64 * DX);
    let domain = Domain::channel(length);
    let walls = || {
        let wall = |y, up| PlaneWall::new(Vector2::new(0.0, y), up, Vector2::zeros());
        vec![wall(0.0, Vector2::y()), wall(height, -Vector2::y())]
    };
    check("ghosts", || scene::<_, Leapfrog>(domain, strip(), Ghosts { walls: walls() }));
    check("slip", || scene::<_, SingleSweep>(domain, strip(), SlipGhosts { walls: walls() }));
    check("walls", || scene::<_, PredictorCorrector>(domain, walled_strip(), InterfaceWall));
    let eos = Tait::new(1.0, 1.0);
    let extrapolating = || ExtrapolatingWall::<Tait, NoSlip>::new(eos, Vector2::new(0.1, -0.2));
    check("extrapolating walls", || scene::<_, Leapfrog>(domain, walled_strip(), extrapolating()));
}

#[test]
fn walls_stand_still_and_interfaces_keep_their_density() {
    let start = walled();
    let scene = scene::<_, Leapfrog>(Domain::channel(1.0), start.clone(), InterfaceWall);
    let mut simulation = scene.build().unwrap();
    assert_eq!(simulation.advance(30.0 * 0.3 * DX, 0.3 * DX, &mut ()), Outcome::Reached);
    let mut walls_changed = 0;
    for (before, after) in start.iter().zip(simulation.particles()) {
        assert_eq!((before.role, before.mass), (after.role, after.mass));
        match before.role {
            Role::Fluid => assert_ne!(before.position, after.position),
            Role::Interface => assert_eq!(*before, after),
            Role::Wall => {
                assert_eq!((before.position, before.velocity), (after.position, after.velocity));
                walls_changed += u32::from(before.density != after.density);
            }
        }
    }
    assert!(walls_changed > 80, "the density of {walls_changed} wall particles followed the fluid");
}

/// The rates reported to an observer are the rates of the step.
#[test]
fn a_step_goes_by_the_rates_of_its_terms() {
    let mut simulation = periodic::<Euler>().build().unwrap();
    let dt = 0.1 * DX;
    assert_eq!(simulation.advance(2.0 * dt, dt, &mut ()), Outcome::Reached);
    let forces = simulation.terms_mut().0;
    let rates = simulation.rates(&forces);
    let drift = simulation.rates(&Continuity);
    let before: Vec<_> = simulation.data().fluid().map(|(_, p)| *p).collect();
    let (builds, step) = (simulation.work().list_builds, 3.0 * dt - simulation.time());
    assert_eq!(simulation.advance(3.0 * dt, dt, &mut ()), Outcome::Reached);
    assert_eq!(simulation.work().list_builds, builds, "the particles kept their order");
    let mut changed = 0;
    for (k, (_, after)) in simulation.data().fluid().enumerate() {
        let velocity = before[k].velocity + rates[k].velocity * step;
        let density = before[k].density + drift[k].density * step;
        assert_eq!((after.velocity, after.density), (velocity, density), "particle {k}");
        changed += u32::from(after.velocity != before[k].velocity);
    }
    assert!(changed > 2000, "{changed} particles were accelerated");
}
