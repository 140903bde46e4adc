//! A run that goes on from a checkpoint has the bits of one that was never interrupted.

use std::sync::{
    Mutex,
    atomic::{AtomicBool, AtomicU64, Ordering},
};
use std::time::Duration;

use base::{
    record::{Cost, Record},
    spec::{RunSpec, Task},
};
use harness::{
    case::{Case, Tier},
    checkpoint::Checkpoints,
    context::Context,
    plan,
};
use nalgebra::Vector2;
use rayon::prelude::*;
use solver::{
    Checkpoint, Compose, Continuity, CubicSpline, Domain, ExtrapolatingWall, Flow, Integrator,
    Leapfrog, NoSlip, Numbers, Observer, Open, Outcome, Particle, PredictorCorrector, Pressure,
    Role, Scene, Scheme, Shifting, Simulation, Smoothing, Stepper, Tait, Viscosity, lattice,
    walls::Walls,
};
use touchstone_tests::{bits, patch};
use validation::cases;

type Method<I, W = Open> =
    Compose<CubicSpline, (Pressure<Tait>, Viscosity), (Continuity, Shifting), W, I>;

type Plates = ExtrapolatingWall<Tait, NoSlip>;

const H: f64 = 0.08;
const DT: f64 = 1.0 / 64.3;

fn scene<I: Integrator<Method<()>>>() -> Scene<Method<I>> {
    scene_of(Domain::torus(1.0, 1.0), patch(16, 0.15, 7), Open)
}

/// The same fluid between walls that extrapolate.
fn channel<I: Integrator<Method<(), Plates>>>() -> Scene<Method<I, Plates>> {
    let dx = 1.0 / 16.0;
    let mut particles = patch(16, 0.05, 7);
    for first in [-2.5 * dx, 1.0 + 0.5 * dx] {
        let rows = lattice(Vector2::new(0.5 * dx, first), dx, 16, 3);
        particles.extend(
            rows.map(|x| Particle::fluid(x, Vector2::zeros(), 1.0, dx * dx).with_role(Role::Wall)),
        );
    }
    let walls = ExtrapolatingWall::new(Tait::new(1.0, 1.0), Vector2::new(0.1, 0.0));
    scene_of(Domain::channel(1.0), particles, walls)
}

fn scene_of<I: Integrator<Method<(), W>>, W: Walls<()>>(
    domain: Domain,
    particles: Vec<Particle>,
    walls: W,
) -> Scene<Method<I, W>> {
    let pressure = Pressure::new(Tait { background: 0.3, ..Tait::new(1.0, 1.0) });
    let forces = (pressure, Viscosity { mu: 0.01, eta2: 1e-4 * H * H });
    let w = Smoothing::<CubicSpline>::new(H).w(1.0 / 256.0);
    let drift = (Continuity, Shifting::new(0.5, H, w));
    // So that lists are built often.
    Scene { skin: 0.06 * H, ..Scene::new(H, domain, particles, forces, drift, walls) }
}

/// Stops after so many steps of the run.
struct After(u64);

impl<X: Numbers> Observer<X> for After {
    fn after_step(&mut self, simulation: &dyn Stepper<X>) -> Flow {
        if simulation.work().steps == self.0 { Flow::Stop } else { Flow::Continue }
    }
}

/// A checkpoint after each of 12 steps, between builds of the rows and just after them.
fn check<S: Scheme<Extra = ()>>(scene: impl Fn() -> Scene<S>) {
    let until = 40.0 * DT;
    let mut whole = scene().build().unwrap();
    assert_eq!(whole.advance(until, DT, &mut ()), Outcome::Reached);
    let mut between_builds = 0;
    for steps in (9..=20).chain([40]) {
        let mut first = scene().build().unwrap();
        assert_eq!(first.advance(until, DT, &mut After(steps)), Outcome::Stopped);
        let checkpoint = first.checkpoint();
        drop(first);
        let moved = checkpoint.particles.iter().zip(&checkpoint.built_at);
        between_builds += u32::from(moved.clone().any(|((_, p), at)| p.position != *at));
        let mut second = scene().build().unwrap();
        second.restore(&checkpoint).unwrap();
        assert_eq!(second.checkpoint(), checkpoint, "nothing is lost on the way");
        assert_eq!(second.advance(until, DT, &mut ()), Outcome::Reached);
        assert_eq!(bits(&second.particles()), bits(&whole.particles()), "from step {steps}");
        assert_eq!(second.checkpoint().progress, whole.checkpoint().progress);
        assert_eq!(second.work().steps, 40);
    }
    assert!(between_builds > 5, "rows were older than the state in {between_builds} checkpoints");
    assert!(whole.work().list_builds > 8);
}

#[test]
fn leapfrog_goes_on_with_the_same_bits() {
    check(scene::<Leapfrog>);
    check(channel::<Leapfrog>);
}

#[test]
fn the_predictor_corrector_goes_on_with_the_same_bits() {
    check(scene::<PredictorCorrector>);
    check(channel::<PredictorCorrector>);
}

/// Leaves velocities where steps left them.
struct PositionsOnly;

impl<X> Observer<X> for PositionsOnly {
    fn after_step(&mut self, _: &dyn Stepper<X>) -> Flow {
        Flow::Continue
    }
    fn synchronises(&self) -> bool {
        false
    }
}

/// Ten looks at a run of 40 steps of a length whose multiples are exact: with velocities of the very time, of
/// half a step before, and with a checkpoint at each.
fn check_looks<S: Scheme<Extra = ()>>(scene: impl Fn() -> Scene<S>) {
    const DT: f64 = 1.0 / 64.0;
    let mut whole = scene().build().unwrap();
    assert_eq!(whole.advance(40.0 * DT, DT, &mut ()), Outcome::Reached);
    let time = |look: u32| f64::from(4 * look) * DT;
    let run = |observer: &mut dyn Observer<()>, save: bool| {
        let mut simulation = scene().build().unwrap();
        for look in 1..=10 {
            assert_eq!(simulation.advance(time(look), DT, observer), Outcome::Reached);
            if save {
                let checkpoint = simulation.checkpoint();
                simulation = scene().build().unwrap();
                simulation.restore(&checkpoint).unwrap();
            }
        }
        // No step: velocities of the very time.
        assert_eq!(simulation.advance(time(10), DT, &mut ()), Outcome::Reached);
        assert_eq!(bits(&simulation.particles()), bits(&whole.particles()), "saved: {save}");
        assert_eq!(simulation.work().list_builds, whole.work().list_builds);
        simulation.work().pair_interactions
    };
    let looked = [run(&mut (), false), run(&mut (), true)];
    let [lagging, saved] = [run(&mut PositionsOnly, false), run(&mut PositionsOnly, true)];
    assert!(lagging == saved && lagging <= looked[0].min(looked[1]));
    let [one, two] = looked.map(|pairs| pairs as f64 / lagging as f64);
    assert!((one, two) == (1.0, 1.0) || one > 1.1, "{one}, {two}");
}

#[test]
fn looking_at_a_run_does_not_change_it() {
    check_looks(scene::<Leapfrog>);
    check_looks(channel::<Leapfrog>);
    check_looks(scene::<PredictorCorrector>);
}

/// Why a checkpoint is more than the particles: without the rows' age, the order and the lag the
/// bits change.
#[test]
fn particles_alone_do_not_restart_with_the_same_bits() {
    let mut first = scene::<Leapfrog>().build().unwrap();
    assert_eq!(first.advance(40.0 * DT, DT, &mut After(20)), Outcome::Stopped);
    let rest = |mut simulation: Simulation<Method<Leapfrog>>| {
        assert_eq!(simulation.advance(40.0 * DT, DT, &mut ()), Outcome::Reached);
        bits(&simulation.particles())
    };
    let exact = first.checkpoint();
    let with = |checkpoint: Checkpoint| {
        let mut simulation = scene().build().unwrap();
        simulation.restore(&checkpoint).unwrap();
        rest(simulation)
    };
    let expected = with(exact.clone());
    assert_ne!(with(Checkpoint { lag: 0.0, ..exact.clone() }), expected);
    let mut particles = exact.particles.clone();
    particles.sort_by_key(|(id, _)| *id);
    let built_at = particles.iter().map(|(_, p)| p.position).collect();
    assert_ne!(with(Checkpoint { particles, built_at, ..exact.clone() }), expected);
}

#[test]
fn checkpoints_that_no_run_can_have_made_are_refused() {
    let checkpoint = scene::<Leapfrog>().build().unwrap().checkpoint();
    let refused = |change: &dyn Fn(&mut Checkpoint)| {
        let mut changed = checkpoint.clone();
        change(&mut changed);
        let mut simulation = scene::<Leapfrog>().build().unwrap();
        let refused = simulation.restore(&changed).expect_err("refused");
        assert_eq!(simulation.checkpoint(), checkpoint, "nothing has changed");
        refused
    };
    for (change, part) in [
        (&(|c: &mut Checkpoint| c.progress.time = f64::NAN) as &dyn Fn(&mut Checkpoint), "time"),
        (&|c| c.lag = f64::INFINITY, "lag"),
        (&|c| c.built_at.truncate(5), "places"),
        (&|c| c.built_at[3].x = f64::NAN, "place that is not finite"),
        (&|c| c.particles[0].1.role = Role::Wall, "roles"),
        (&|c| c.particles[7].0 = 8, "numbers"),
        (&|c| c.particles[2].1.density = -1.0, "density"),
    ] {
        let error = refused(change);
        assert!(error.to_string().contains(part), "{error}");
    }
}

/// The simulations of a run that was interrupted after so many steps.
fn interrupted_after(steps: u64, case: &dyn Case, spec: &RunSpec) -> Vec<Vec<u8>> {
    let (interrupt, made, last) = (AtomicBool::new(false), AtomicU64::new(0), Mutex::default());
    let write = |simulations: &[Vec<u8>]| {
        if made.fetch_add(1, Ordering::Relaxed) + 1 >= steps {
            interrupt.store(true, Ordering::Relaxed);
        }
        *last.lock().unwrap() = simulations.to_vec();
        Ok(())
    };
    let checkpoints = Checkpoints::new(Duration::ZERO, Vec::new(), &write);
    let context = Context {
        checkpoints: Some(&checkpoints),
        interrupt: Some(&interrupt),
        ..Context::default()
    };
    case.run(spec, &context).unwrap();
    last.into_inner().unwrap()
}

/// The record without what time and memory it took, which are of the machine.
fn without_times(record: Record) -> Record {
    let cost = Cost {
        wall_s: 0.0,
        cpu_s: 0.0,
        observing_s: 0.0,
        solver_bytes: 0,
        resumed: 0,
        ..record.cost
    };
    Record { cost, ..record }
}

/// The variants of a case of which a run went on from a checkpoint to the record of the whole run.
fn gone_on(case: &dyn Case) -> Vec<String> {
    let mut runs = plan::of_case(case, Tier::Quick);
    runs.retain(|run| run.spec.task == Task::Simulate);
    runs.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let mut variants = Vec::new();
    for variant in case.variants() {
        let Some(run) = runs.iter().find(|run| run.spec.variant == variant.name) else { continue };
        let spec = run.spec.clone().keep_particles().measure_all();
        let Ok(whole) = case.run(&spec, &Context::default()) else { continue };
        let name = format!("{} {}", case.name(), variant.name);
        let simulations = interrupted_after((whole.cost.steps / 2).clamp(1, 150), case, &spec);
        if simulations.is_empty() {
            continue; // no step was made
        }
        let nowhere = |_: &[Vec<u8>]| Ok(());
        let checkpoints = Checkpoints::new(Duration::MAX, simulations, &nowhere);
        let context = Context { checkpoints: Some(&checkpoints), ..Context::default() };
        let resumed = case.run(&spec, &context).unwrap();
        assert_eq!(resumed.cost.resumed, 1, "{name} began anew");
        let [whole, resumed] = [whole, resumed].map(|record| without_times(record).to_json());
        assert_eq!(resumed.unwrap(), whole.unwrap(), "{name}");
        variants.push(name);
    }
    variants
}

/// Every variant of every case: a run that goes on from a checkpoint has the record of one that was not
/// interrupted, with every metric, curve and series.
#[test]
fn every_case_goes_on_with_an_equal_record() {
    let variants: Vec<String> =
        cases::CASES.par_iter().flat_map_iter(|case| gone_on(*case)).collect();
    let lacks = |case: &&&dyn Case| !variants.iter().any(|name| name.starts_with(case.name()));
    let lacking: Vec<&str> = cases::CASES.iter().filter(lacks).map(|case| case.name()).collect();
    assert!(lacking.is_empty() && variants.len() > 60, "not {lacking:?}, only {variants:?}");
}
