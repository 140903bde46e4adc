//! Neighbour lists that are kept while particles move together: they lose no pair, and last longer.

use nalgebra::Vector2;
use touchstone_solver::{
    Compose, Continuity, CubicSpline, Domain, Ghosts, Leapfrog, Open, Outcome, Particle, PlaneWall,
    Pressure, Scene, Stepper, Tait, Work, lattice, walls::Walls,
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
    (scene.setting.skin, scene.setting.skin_share) = (skin * H, share);
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
        // Modulo whole periods.
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

/// Where blocks end \[dx\] that move along `axis` without forces until they meet, periodic across: faces
/// that are `gap` \[dx\] farther apart than the support at first, on lists with this skin \[h\] and share.
/// There is one block, which meets its mirror image, or two of different speeds.
fn met<W: Walls<()>>(walls: &W, count: usize, axis: usize, gap: f64, list: [f64; 2]) -> Vec<V2> {
    let along = |x: f64, y: f64| if axis == 0 { V2::new(y, x) } else { V2::new(x, y) };
    let speeds = if axis == 0 { [-1.0, 0.6] } else { [-0.6, 1.0] };
    let first = V2::new(0.5 * DX, H + 0.5 * gap * DX);
    let place = |k: usize| {
        let (side, x) = ([1.0, -1.0][k], lattice(first, DX, 8, 6));
        x.map(move |x| (along(x.x, side * x.y), along(0.0, speeds[k])))
    };
    let particle = |(x, v)| Particle::fluid(x, v, 1.0, DX * DX);
    let blocks = (0..count).flat_map(place).map(particle).collect();
    let mut domain = Domain::open();
    domain.period[1 - axis] = Some(8.0 * DX);
    let pressure = Pressure::new(Tait::new(1.0, 3.0));
    let mut scene = Scene::<Method<W>>::new(H, domain, blocks, pressure, Continuity, walls.clone());
    [scene.setting.skin, scene.setting.skin_share] = [list[0] * H, list[1]];
    let mut simulation = scene.build().expect("a sound scene");
    let dt = 0.02 * H;
    assert_eq!(simulation.advance(100.0 * dt, dt, &mut ()), Outcome::Reached);
    simulation.particles().into_iter().map(|p| p.position / DX).collect()
}

/// From twelve distances, so that blocks meet with lists of any age. Kept lists do not change the result
/// unless they are kept for four times too long, when members of one group miss neighbours.
fn check_meetings<W: Walls<()>>(walls: &W, count: usize, axis: usize) {
    let [mut kept, mut stale] = [0.0_f64; 2];
    for k in 0..12 {
        let end = |list| met(walls, count, axis, f64::from(k) / 12.0, list);
        let exact = end([0.0, 0.5]);
        let off = |ends: Vec<V2>| {
            ends.iter().zip(&exact).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
        };
        kept = kept.max(off(end([0.4, 0.5])));
        stale = stale.max(off(end([0.4, 2.0])));
    }
    let of = format!("{count} along axis {axis}: distance from where lists of every sweep lead");
    assert!(kept < 1e-12, "{of}: {kept:e} dx, expected round-off");
    assert!(stale > 1e-3, "{of}: {stale:e} dx with lists kept for too long, expected more");
}

/// An image moves against its particle, so they come nearer to each other by more than particles do: lists
/// kept by the displacements of particles relative to each other gave ends that were 1e-2 dx off.
#[test]
fn blocks_that_fall_on_a_mirror_from_twelve_heights_end_where_they_do_without_kept_lists() {
    for axis in [0, 1] {
        let normal = [V2::x(), V2::y()][axis];
        let wall = PlaneWall::new(V2::zeros(), normal, V2::zeros());
        check_meetings(&Ghosts { walls: vec![wall] }, 1, axis);
    }
}

/// The box of displacements is a line. With two of its sides swapped it had the smaller diagonal of a
/// rectangle.
#[test]
fn blocks_that_meet_along_one_axis_only_end_where_they_do_without_kept_lists() {
    for axis in [0, 1] {
        check_meetings(&Open, 2, axis);
    }
}

/// Its particles do not move relative to each other, so the bounding box of their displacements is a point
/// and lists stay valid. A displacement of half a period without new lists must not count as a divergence.
#[test]
fn water_that_moves_by_more_than_a_period_is_not_taken_for_lost() {
    let water = lattice(V2::repeat(0.5 * DX), DX, 8, 8);
    let water = water.map(|x| Particle::fluid(x, V2::new(0.8, 0.6), 1.0, DX * DX)).collect();
    let (domain, pressure) = (Domain::torus(0.4, 0.4), Pressure::new(Tait::new(1.0, 3.0)));
    let scene = Scene::<Method<Open>>::new(H, domain, water, pressure, Continuity, Open);
    let mut simulation = scene.build().expect("a sound scene");
    let outcome = simulation.advance(1.0, DT, &mut ());
    assert_eq!(outcome, Outcome::Reached, "after {} s of 1 s", simulation.time());
    // A particle crosses the skin, twice the allowed distance of lists, in 4 steps.
    let Work { steps, list_builds, .. } = simulation.work();
    let expected = steps / 4..=steps / 3 + 1;
    assert!(expected.contains(&list_builds), "{list_builds} builds, expected {expected:?}");
}
