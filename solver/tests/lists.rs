//! Neighbour lists that are kept while particles move together: they lose no pair, and last longer.

use nalgebra::Vector2;
use solver::{
    Compose, Continuity, CubicSpline, Domain, Ghosts, Leapfrog, Open, Outcome, Particle, PlaneWall,
    Pressure, Scene, Stepper, Tait, lattice, walls::Walls,
};

type Method<W> = Compose<CubicSpline, Pressure<Tait>, Continuity, W, Leapfrog>;
type V2 = Vector2<f64>;

const DX: f64 = 0.05;
const H: f64 = 1.2 * DX;
const STEPS: f64 = 40.0;
/// A tenth of h at the speed of 1 m/s \[s\].
const DT: f64 = 0.1 * H;

/// Disordered water that moves at about this velocity, upper and lower half against each other by two
/// fifths of it; how often lists with this skin \[h\] and share were built, and where the particles end.
fn run<W: Walls<()>>(
    domain: Domain,
    walls: W,
    velocity: V2,
    skin: f64,
    share: f64,
) -> (f64, Vec<V2>) {
    let number = |k: usize| (k as f64 * 0.618_033_988_749_895).fract() - 0.5;
    let place = |(k, x): (usize, V2)| {
        let slide = if x.y > 0.5 { 1.2 } else { 0.8 };
        let disorder = Vector2::new(number(3 * k), number(7 * k)) * (0.3 * DX);
        Particle::fluid(x + disorder, velocity * slide, 1.0, DX * DX)
    };
    let water = lattice(V2::repeat(0.5 * DX), DX, 20, 20).enumerate().map(place).collect();
    let pressure = Pressure::new(Tait { background: 0.2, ..Tait::new(1.0, 3.0) });
    let mut scene = Scene::<Method<W>>::new(H, domain, water, pressure, Continuity, walls);
    (scene.skin, scene.skin_share) = (skin * H, share);
    let mut simulation = scene.build().expect("a sound scene");
    assert_eq!(simulation.advance(STEPS * DT, DT, &mut ()), Outcome::Reached);
    let places = simulation.particles().into_iter().map(|p| p.position).collect();
    (simulation.work().list_builds as f64, places)
}

/// The builds of lists with a skin, after they were found to lose no pair: particles end where they do with
/// lists that are built for every sweep, and elsewhere if lists are kept for too long.
fn builds<W: Walls<()>>(domain: Domain, walls: W, velocity: V2) -> f64 {
    let run = |skin, share| run(domain, walls.clone(), velocity, skin, share);
    let (_, exact) = run(0.0, 0.5);
    let off = |places: &[V2]| {
        let pairs = places.iter().zip(&exact);
        // Whole periods are no difference.
        let gap = |(a, b): (&V2, &V2)| (a - b).map(|x| x - x.round()).norm();
        pairs.map(gap).fold(0.0, f64::max) / DX
    };
    let (builds, kept) = run(0.4, 0.5);
    assert!(off(&kept) < 1e-9, "{:e} dx", off(&kept));
    let (_, stale) = run(0.4, 4.0);
    assert!(off(&stale) > 1e-6, "lists kept for eight times too long: {:e} dx", off(&stale));
    builds
}

#[test]
fn lists_of_water_that_moves_as_a_whole_last_longer() {
    let velocity = Vector2::new(0.8, 0.6);
    let found = builds(Domain::torus(1.0, 1.0), Open, velocity);
    // Each particle crosses half of the skin in two steps.
    assert!((10.0..=0.4 * STEPS).contains(&found), "{found} builds");
}

/// A mirror turns the motion: an image comes nearer twice as fast as its particle moves.
#[test]
fn lists_of_water_that_falls_on_a_mirror_are_built_in_time() {
    let floor = PlaneWall::new(Vector2::zeros(), Vector2::y(), Vector2::zeros());
    builds(Domain::channel(1.0), Ghosts { walls: vec![floor] }, Vector2::new(0.0, -0.4));
}
