//! A watch is called at the start of each phase of a step; the neighbour lists are the lists of the sweeps.

use std::sync::{Arc, Mutex};

use nalgebra::Vector2;
use touchstone_solver::{
    Compose, Continuity, CubicSpline, Domain, ExtrapolatingWall, Integrator, InterfaceWall,
    Leapfrog, Open, Outcome, Particle, Phase, PredictorCorrector, Pressure, Role, Scene,
    Simulation, Stepper, Tait, lattice, walls::Walls,
};

type Method<W, I> = Compose<CubicSpline, Pressure<Tait>, Continuity, W, I>;

const DX: f64 = 0.1;
const H: f64 = 1.2 * DX;

/// A periodic lattice whose rows move at a speed, each against the next; the first `rows` are wall particles.
fn simulation<W: Walls<()>, I: Integrator<Method<W, ()>>>(
    (walls, rows): (W, usize),
    speed: f64,
) -> Simulation<Method<W, I>> {
    let particle = |(k, place): (usize, Vector2<f64>)| {
        let velocity = Vector2::new(if k / 8 % 2 == 0 { speed } else { -speed }, 0.0);
        let fluid = Particle::fluid(place, velocity, 1.0, DX * DX);
        fluid.with_role(if k < 8 * rows { Role::Wall } else { Role::Fluid })
    };
    let places = lattice(Vector2::repeat(0.5 * DX), DX, 8, 8);
    let particles = places.enumerate().map(particle).collect();
    let pressure = Pressure::new(Tait::new(1.0, 1.0));
    let domain = Domain::torus(0.8, 0.8);
    Scene::new(H, domain, particles, pressure, Continuity, walls).build().expect("a scene")
}

/// The phases of one step, without repetitions, and the phases of a synchronisation.
fn phases<W: Walls<()>, I: Integrator<Method<W, ()>>>(
    simulation: &mut Simulation<Method<W, I>>,
) -> Vec<Phase> {
    let told: Arc<Mutex<Vec<Phase>>> = Arc::default();
    let log = Arc::clone(&told);
    let push = move |phase| log.lock().expect("one thread").push(phase);
    simulation.data_mut().watch = Some(Box::new(push));
    assert_eq!(simulation.advance(1e-3, 1e-3, &mut ()), Outcome::Reached);
    simulation.data_mut().watch = None;
    assert_eq!(simulation.advance(2e-3, 1e-3, &mut ()), Outcome::Reached);
    let mut phases = told.lock().expect("one thread").clone();
    phases.dedup();
    phases
}

#[test]
fn each_phase_of_a_step_is_told_in_turn() {
    use Phase::{Both, Drift, Forces, Refresh, Rest, Walls};
    let at_a_time = [Refresh, Rest, Forces, Rest, Refresh, Rest];
    let leapfrog = phases(&mut simulation::<_, Leapfrog>((Open, 0), 0.0));
    let step = [Refresh, Rest, Forces, Rest, Refresh, Rest, Drift, Rest];
    assert_eq!(leapfrog, [&step[..], &at_a_time].concat());

    let open = phases(&mut simulation::<_, PredictorCorrector>((Open, 0), 0.0));
    let step = [Refresh, Rest, Both, Rest, Refresh, Rest, Both, Rest, Refresh, Rest];
    assert_eq!(open, step);

    let walled = phases(&mut simulation::<_, PredictorCorrector>((InterfaceWall, 2), 0.0));
    let step = [Refresh, Rest, Both, Walls, Rest, Refresh, Rest, Both, Walls, Rest, Refresh, Rest];
    assert_eq!(walled, step);

    let wall: ExtrapolatingWall<Tait> =
        ExtrapolatingWall::new(Tait::new(1.0, 1.0), Vector2::zeros());
    let walled = phases(&mut simulation::<_, PredictorCorrector>((wall, 2), 0.0));
    let sweep = [Refresh, Walls, Refresh, Rest, Both, Rest];
    assert_eq!(walled, [&sweep[..], &sweep, &sweep[..4]].concat());
}

#[test]
fn sorting_and_search_are_told_when_lists_are_built() {
    use Phase::{Forces, Refresh, Rest, Search, Sorting};
    // A step moves rows against each other by more than the skin of 0.4 h.
    let phases = phases(&mut simulation::<_, Leapfrog>((Open, 0), 70.0));
    let inside = [Refresh, Search, Refresh, Rest];
    let built = [Refresh, Sorting, Search, Refresh, Rest, Forces];
    let first = &phases[..phases.len().min(24)];
    let has =
        |phases: &[Phase], part: &[Phase]| phases.windows(part.len()).any(|told| told == part);
    assert!(
        has(&phases, &inside),
        "expected {inside:?} among the phases, which begin with {first:?}"
    );
    assert!(
        has(&phases, &built),
        "expected {built:?} among the phases, which begin with {first:?}"
    );
}

#[test]
fn lists_are_those_that_sweeps_count() {
    let mut simulation = simulation::<_, PredictorCorrector>((Open, 0), 0.0);
    assert_eq!(simulation.advance(1e-3, 1e-3, &mut ()), Outcome::Reached);
    let columns = simulation.plain_columns();
    let mut inside = 0;
    for (own, list) in columns.iter().zip(simulation.data().lists()) {
        let distance = |place: usize| (own.position - columns[place].position).norm();
        let near = list.map(distance).filter(|distance| *distance < 2.0 * H).count();
        assert!(near >= 20, "expected 20 neighbours or more, not {near}");
        inside += near as u64;
    }
    assert_eq!(2 * inside, simulation.work().pair_interactions);
    assert_eq!(simulation.data().lists().count(), 64);
    assert_eq!(simulation.data().column_bytes, (columns.len() + 1) * 64);
}
