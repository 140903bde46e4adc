//! A run that continues from a checkpoint has the bits of one that was never interrupted.

use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::{
    Mutex,
    atomic::{AtomicBool, AtomicU64, Ordering},
};
use std::time::Duration;

use nalgebra::Vector2;
use rayon::prelude::*;
use serde_json::Value;
use touchstone_base::{
    record::{Cost, Metric, Profile, Record},
    spec::RunSpec,
};
use touchstone_harness::{
    case::{Case, Planned, Tier, changed},
    checkpoint::Checkpoints,
    context::Context,
    plan,
};
use touchstone_solver::{
    Checkpoint, Compose, Continuity, CubicSpline, Domain, ExtrapolatingWall, Integrator, Leapfrog,
    NoSlip, Numbers, Observer, Open, Outcome, Particle, PredictorCorrector, Pressure, Role, Scene,
    Scheme, Shifting, Simulation, SingleSweep, Smoothing, Stepper, Tait, Viscosity, lattice,
    walls::Walls,
};
use touchstone_tests::{bits, patch};

use crate::damaged::shortest_first;

type Method<I, W = Open> =
    Compose<CubicSpline, (Pressure<Tait>, Viscosity), (Continuity, Shifting), W, I>;

type Plates = ExtrapolatingWall<Tait, NoSlip>;

const H: f64 = 0.08;
const DT: f64 = 1.0 / 64.3;

fn scene<I: Integrator<Method<()>>>() -> Scene<Method<I>> {
    scene_of(Domain::torus(1.0, 1.0), patch(16, 0.15, 7), Open)
}

/// Fluid between extrapolating walls.
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
    let mut scene = Scene::new(H, domain, particles, forces, drift, walls);
    scene.setting.skin = 0.06 * H;
    scene
}

/// Stops after this number of steps.
struct After(u64);

impl<X: Numbers> Observer<X> for After {
    fn after_step(&mut self, simulation: &dyn Stepper<X>) -> ControlFlow<()> {
        if simulation.work().steps == self.0 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
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
        // The second simulation has a state of its own, which the checkpoint must replace.
        let mut second = scene().build().unwrap();
        assert_eq!(second.advance(5.0 * DT, DT, &mut ()), Outcome::Reached);
        second.restore(&checkpoint).unwrap();
        assert_eq!(second.checkpoint(), checkpoint, "nothing is lost on the way");
        assert_eq!(second.advance(until, DT, &mut ()), Outcome::Reached);
        assert_eq!(bits(&second.particles()), bits(&whole.particles()), "from step {steps}");
        assert_eq!(second.checkpoint().progress, whole.checkpoint().progress);
        assert_eq!(second.work().steps, 40);
    }
    assert!(between_builds > 5, "rows were older than the state in {between_builds} checkpoints");
    let builds = whole.work().list_builds;
    assert!(
        builds > 8,
        "expected more than 8 builds of lists in 40 steps, and there were {builds}"
    );
}

#[test]
fn leapfrog_goes_on_with_the_same_bits() {
    check(scene::<Leapfrog>);
    check(channel::<Leapfrog>);
}

#[test]
fn the_single_sweep_goes_on_with_the_same_bits() {
    check(scene::<SingleSweep>);
    check(channel::<SingleSweep>);
}

#[test]
fn the_predictor_corrector_goes_on_with_the_same_bits() {
    check(scene::<PredictorCorrector>);
    check(channel::<PredictorCorrector>);
}

/// Leaves velocities where steps left them.
struct PositionsOnly;

impl<X: Numbers> Observer<X> for PositionsOnly {
    fn after_step(&mut self, _: &dyn Stepper<X>) -> ControlFlow<()> {
        ControlFlow::Continue(())
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
    assert!(
        lagging == saved && lagging <= looked[0].min(looked[1]),
        "pair interactions: with lagging velocities {lagging}, and as many with checkpoints, {saved}; no \
         more than {looked:?} of runs whose velocities are brought to each time"
    );
    let [one, two] = looked.map(|pairs| pairs as f64 / lagging as f64);
    assert!(
        (one, two) == (1.0, 1.0) || one > 1.1,
        "looking costs a tenth of the pair interactions at least, or none: {one}, with checkpoints {two}"
    );
}

#[test]
fn looking_at_a_run_does_not_change_it() {
    check_looks(scene::<Leapfrog>);
    check_looks(channel::<Leapfrog>);
    check_looks(scene::<SingleSweep>);
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

/// Part of the state would be ignored, or missing.
#[test]
fn a_checkpoint_of_another_integrator_is_refused() {
    fn after_steps<I: Integrator<Method<()>>>() -> Simulation<Method<I>> {
        let mut simulation = scene::<I>().build().unwrap();
        assert_eq!(simulation.advance(20.0 * DT, DT, &mut ()), Outcome::Reached);
        simulation
    }
    let mut all: [Box<dyn Stepper<()>>; 3] = [
        Box::new(after_steps::<PredictorCorrector>()),
        Box::new(after_steps::<Leapfrog>()),
        Box::new(after_steps::<SingleSweep>()),
    ];
    let checkpoints = all.each_ref().map(|simulation| simulation.checkpoint());
    for (k, simulation) in all.iter_mut().enumerate() {
        for (j, checkpoint) in checkpoints.iter().enumerate() {
            // Particles with all quantities at one time start a run of any integrator.
            let is_sound = j == k || j == 0;
            let restored = simulation.restore(checkpoint);
            assert_eq!(restored.is_ok(), is_sound, "{j} to {k}: {restored:?}");
            let holds = if is_sound { j } else { k };
            assert_eq!(simulation.checkpoint(), checkpoints[holds], "{j} to {k}");
            simulation.restore(&checkpoints[k]).unwrap();
        }
    }
}

/// The last checkpoint of a run interrupted after `steps` steps; none if it made no step.
fn interrupted_after(steps: u64, case: &dyn Case, spec: &RunSpec) -> Option<Vec<u8>> {
    let (interrupt, made, last) = (AtomicBool::new(false), AtomicU64::new(0), Mutex::default());
    let write = |state: &[u8]| {
        if made.fetch_add(1, Ordering::Relaxed) + 1 >= steps {
            interrupt.store(true, Ordering::Relaxed);
        }
        *last.lock().unwrap() = Some(state.to_vec());
        Ok(())
    };
    let checkpoints = Checkpoints { every: Duration::ZERO, earlier: None, write: &write };
    let context = Context {
        checkpoints: Some(&checkpoints),
        interrupt: Some(&interrupt),
        ..Context::default()
    };
    case.run(spec, &context).unwrap();
    last.into_inner().unwrap()
}

/// The record without time and memory, which depend on the machine.
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

/// Settings of cases with long planned runs: all metrics, from fewer particles and steps. A plate of three
/// rows oscillates more slowly, so it needs a longer run for its period.
const COARSE: [(&str, &[&str]); 6] = [
    ("cantilever", &["n=3"]),
    ("dam_break", &["n=7"]),
    ("extremes", &["steps=2000"]),
    ("oscillating_plate", &["n=3", "end=1"]),
    ("rubber_rings", &["spacing=0.3333333333333333"]),
    ("spinning_disk", &["n=4", "end=1"]),
];

/// The shortest simulation of a variant in the quick tier, made coarser if its case is in [`COARSE`], of
/// which all is measured.
fn short(case: &dyn Case, runs: &[Planned], variant: &str) -> Option<RunSpec> {
    let planned = runs.iter().find(|run| run.spec.variant == variant)?;
    let coarse = COARSE.iter().find(|(name, _)| *name == case.name()).map_or(&[][..], |of| of.1);
    let key = |set: &str| set.split('=').next().map(String::from);
    let is_kept = |set: &String| coarse.iter().all(|other| key(other) != key(set));
    let mut set = changed(case, &planned.spec);
    set.retain(is_kept);
    set.extend(coarse.iter().map(|set| set.to_string()));
    // An experiment that does not read a setting is run as it is planned.
    let settings = case.settings(variant, &set).unwrap_or(planned.spec.settings.clone());
    let spec = RunSpec { settings, ..planned.spec.clone() };
    Some(spec.keep_particles().measure_all())
}

/// The name of a variant if a run of it, continued from a checkpoint, has the record of the whole run; `None`
/// if the quick tier has no run of it that makes a step.
fn gone_on(case: &dyn Case, spec: &RunSpec) -> Option<String> {
    let whole = case.run(spec, &Context::default()).ok()?;
    let name = format!("{} {}", case.name(), spec.variant);
    let earlier = interrupted_after((whole.cost.steps / 2).clamp(1, 150), case, spec)?;
    let (every, nowhere) = (Duration::MAX, |_: &[u8]| Ok(()));
    let checkpoints = Checkpoints { every, earlier: Some(earlier), write: &nowhere };
    let context = Context { checkpoints: Some(&checkpoints), ..Context::default() };
    let resumed = case.run(spec, &context).unwrap();
    assert_eq!(resumed.cost.resumed, 1, "{name} began anew");
    let [whole, resumed] = [whole, resumed].map(without_times);
    let apart = differences(&whole, &resumed);
    assert!(apart.is_empty(), "{name}, gone on from a checkpoint, has another record: {apart}");
    Some(name)
}

/// The differences of two records by name, with both values where they are short.
fn differences(whole: &Record, resumed: &Record) -> String {
    let json = |record: &Record| -> Value {
        serde_json::from_str(&record.to_json().expect("a record")).expect("JSON")
    };
    let mut apart = Vec::new();
    compare("", &json(whole), &json(resumed), &mut apart);
    let more = apart.len().saturating_sub(10);
    apart.truncate(10);
    let more = if more > 0 { format!("; and {more} more") } else { String::new() };
    apart.join("; ") + &more
}

fn compare(path: &str, whole: &Value, resumed: &Value, apart: &mut Vec<String>) {
    match (whole, resumed) {
        (Value::Object(a), Value::Object(b)) => {
            let keys: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
            for key in keys {
                compare(&format!("{path}/{key}"), &whole[key], &resumed[key], apart);
            }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            for (k, (a, b)) in a.iter().zip(b).enumerate() {
                compare(&format!("{path}/{k}"), a, b, apart);
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            apart.push(format!("{path} has {} items and should have {}", b.len(), a.len()));
        }
        _ if whole != resumed => apart.push(format!("{path} is {resumed} and should be {whole}")),
        _ => {}
    }
}

#[test]
fn two_records_are_compared_to_the_last_bit() {
    let record = |value: f64, points: &[f64]| {
        let mut record = Record::new("case", "seed", serde_json::json!({"n": 3}), 1);
        record.metrics.insert("period".into(), Metric::new(value, "s", "made up"));
        let profile = Profile::default().with("t", "s", points.to_vec());
        record.profiles.insert("series".into(), profile);
        record
    };
    let whole = record(0.3, &[1.0, 2.0]);
    assert_eq!(differences(&whole, &whole.clone()), "");
    let found = differences(&whole, &record(0.1 + 0.2, &[1.0, 2.5]));
    for part in [
        "/metrics/period/value is 0.30000000000000004 and should be 0.3",
        "/profiles/series/columns/0/values/1 is 2.5 and should be 2.0",
    ] {
        assert!(found.contains(part), "expected {part} among {found}");
    }
    let shorter = differences(&whole, &record(0.3, &[1.0]));
    assert!(shorter.ends_with("values has 1 items and should have 2"), "{shorter}");
    let none = differences(&record(f64::NAN, &[]), &record(f64::NAN, &[]));
    assert_eq!(none, "", "a metric that is not finite in both");
}

/// Every variant of every case: a run that continues from a checkpoint has the record of one that was not
/// interrupted, with every metric, curve and series.
#[test]
fn every_case_goes_on_with_an_equal_record() {
    let of_case = |case: &&'static dyn Case| {
        let mut runs = plan::of_case(*case, Tier::Quick);
        runs.retain(|run| run.spec.is_simulation());
        let runs = shortest_first(*case, runs);
        let specs = case.variants().into_iter().filter_map(|v| short(*case, &runs, v.name));
        specs.map(|spec| (*case, spec)).collect::<Vec<_>>()
    };
    let runs: Vec<(&dyn Case, RunSpec)> =
        touchstone_cases::CASES.iter().flat_map(of_case).collect();
    let variants: Vec<String> =
        runs.par_iter().filter_map(|(case, spec)| gone_on(*case, spec)).collect();
    let lacks = |case: &&&dyn Case| !variants.iter().any(|name| name.starts_with(case.name()));
    let lacking: Vec<&str> =
        touchstone_cases::CASES.iter().filter(lacks).map(|case| case.name()).collect();
    assert!(lacking.is_empty(), "no run of {lacking:?} went on; of others {variants:?} did");
    // The others make no step: experiments that are refused or look at a start alone.
    let (went, all) = (variants.len(), runs.len());
    assert!(10 * went > 9 * all, "only {went} of {all} variants went on");
    for (case, _) in COARSE {
        assert!(touchstone_cases::find(case).is_ok(), "{case} has coarser settings and is no case");
    }
}
