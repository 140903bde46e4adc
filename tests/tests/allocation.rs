//! A step allocates nothing, once the buffers have found their size; a run takes the memory that it was
//! estimated to take.
//!
//! The one place outside of the solver's lanes that needs `unsafe`: a global allocator cannot be written
//! without.
#![allow(unsafe_code)]

use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
};

use nalgebra::Vector2;
use touchstone_base::{
    settings::{Field, Value},
    spec::RunSpec,
};
use touchstone_harness::case::spec;
use touchstone_harness::{problem::Steps, runner::Context, size::Size};
use touchstone_solver::{
    Compose, Continuity, CubicSpline, DensityDiffusion, Domain, ExtrapolatingWall, Ghosts,
    Integrator, InterfaceWall, Leapfrog, Numbers, Observer, Open, Outcome, PlaneWall,
    PredictorCorrector, Pressure, Role, Scene, Scheme, Shifting, Smoothing, Split, Stepper,
    SuperSteps, Tait, Viscosity, Walls,
};
use touchstone_tests::patch;

thread_local! {
    /// Allocations of this thread; tests run on one each.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
    /// Bytes that this thread holds, and the most so far.
    static HELD: Cell<isize> = const { Cell::new(0) };
    static MOST: Cell<isize> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: hands every request to the system's allocator unchanged; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        HELD.with(|held| held.set(held.get() + layout.size() as isize));
        MOST.with(|most| most.set(most.get().max(HELD.get())));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        HELD.with(|held| held.set(held.get() - layout.size() as isize));
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

type Sums = (Pressure<Tait>, Viscosity);
type Method<I> = Compose<CubicSpline, Sums, Continuity, Open, I>;
type Stabilised = (Continuity, DensityDiffusion, Shifting);
type Channel = Compose<CubicSpline, Sums, Stabilised, Ghosts, Leapfrog>;

/// Stops when rows have been built this often.
struct Builds(u64);

impl<X: Numbers> Observer<X> for Builds {
    fn after_step(&mut self, simulation: &dyn Stepper<X>) -> ControlFlow<()> {
        if simulation.work().list_builds < self.0 {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }
}

const H: f64 = 1.3 / 24.0;

fn forces() -> Sums {
    let pressure = Pressure::new(Tait { background: 0.3, ..Tait::new(1.0, 1.0) });
    (pressure, Viscosity { mu: 0.01, eta2: 1e-4 * H * H })
}

/// After `builds` builds of lists, in which buffers reach their size, 20 more.
fn check<S: Scheme>(mut scene: Scene<S>, builds: u64) {
    // A small skin: lists are built often before the patch comes to rest.
    scene.setting.skin = 0.12 * H;
    let (h, mut simulation) = (H, scene.build().unwrap());
    // The patch orders itself while it warms up, so rows and images grow no more after it.
    assert_eq!(simulation.advance(1e3, 0.2 * h, &mut Builds(builds)), Outcome::Stopped);
    let (work, before) = (simulation.work(), ALLOCATIONS.get());
    assert!(before > 0, "the counter counts");
    assert_eq!(simulation.advance(2e3, 0.2 * h, &mut Builds(builds + 20)), Outcome::Stopped);
    let allocations = ALLOCATIONS.get() - before;
    let steps = simulation.work().steps - work.steps;
    assert!(steps > 20, "{steps} steps with 20 builds");
    assert_eq!(allocations, 0, "{} allocated in {steps} steps", S::Integrator::NAME);
}

fn periodic<I: Integrator<Method<()>>>() -> Scene<Method<I>> {
    let domain = Domain::torus(1.0, 1.0);
    Scene::new(H, domain, patch(24, 0.3, 3), forces(), Continuity, Open)
}

#[test]
fn a_step_of_leapfrog_allocates_nothing_even_when_rows_are_rebuilt() {
    check(periodic::<Leapfrog>(), 40);
}

#[test]
fn a_step_of_super_time_stepping_allocates_nothing_even_when_rows_are_rebuilt() {
    type Super = Compose<
        CubicSpline,
        Split<Pressure<Tait>, Viscosity>,
        Continuity,
        Open,
        Leapfrog<SuperSteps>,
    >;
    let (pressure, viscosity) = forces();
    // Seven stages.
    let forces = Split(pressure, viscosity, 0.02 * H);
    let domain = Domain::torus(1.0, 1.0);
    check(Scene::<Super>::new(H, domain, patch(24, 0.3, 3), forces, Continuity, Open), 40);
}

#[test]
fn a_step_of_the_predictor_corrector_allocates_nothing_even_when_rows_are_rebuilt() {
    check(periodic::<PredictorCorrector>(), 40);
}

/// Ghosts come and go with the particles near the walls, and every stabiliser is at work.
#[test]
fn a_step_between_ghost_walls_allocates_nothing_either() {
    let wall = |y, normal| PlaneWall::new(Vector2::new(0.0, y), normal, Vector2::zeros());
    let walls = Ghosts { walls: vec![wall(0.0, Vector2::y()), wall(1.0, -Vector2::y())] };
    let dx = 1.0 / 24.0;
    let w = Smoothing::<CubicSpline>::new(H).w(dx * dx);
    let drift = (Continuity, DensityDiffusion::new(0.1 * H), Shifting::new(0.5, H, w));
    let particles = patch(24, 0.3, 3);
    check(Scene::<Channel>::new(H, Domain::channel(1.0), particles, forces(), drift, walls), 40);
}

/// A third of the patch are wall particles, over which the walls' own terms are summed.
fn walled<W: Walls<()>>(walls: W) -> Scene<Compose<CubicSpline, Sums, Continuity, W, Leapfrog>> {
    let mut particles = patch(24, 0.3, 3);
    for particle in particles.iter_mut().filter(|particle| particle.position.y < 0.33) {
        (particle.role, particle.velocity) = (Role::Wall, Vector2::zeros());
    }
    Scene::new(H, Domain::torus(1.0, 1.0), particles, forces(), Continuity, walls)
}

#[test]
fn a_step_beside_wall_particles_allocates_nothing_either() {
    check(walled(InterfaceWall), 60);
    check(walled(ExtrapolatingWall::<Tait>::new(Tait::new(1.0, 1.0), Vector2::zeros())), 60);
}

/// The value of a setting that this factor makes of its default, inside of its limits, as `key=value`.
fn changed(field: &Field, factor: f64) -> Option<String> {
    let default =
        if field.default == Value::Auto { 1.0 } else { field.default.to_string().parse().ok()? };
    let value = (factor * f64::max(default, 1e-3)).clamp(field.limits[0], field.limits[1]);
    let is_count = matches!(field.default, Value::Count(_));
    Some(format!("{}={:?}", field.name, if is_count { value.round() } else { value }))
}

/// A tank of a few columns of water was built from a lattice of all its inside; the neighbours of a total
/// Lagrangian body and the series of a hill were not counted.
#[test]
fn a_run_takes_the_memory_that_is_estimated_before() {
    const FACTORS: [f64; 7] = [3e-5, 3e-4, 3e-3, 0.02, 0.1, 10.0, 100.0];
    const TIME: f64 = 8.0;
    const LEAST: f64 = 1e6; // tables of a case and of its references
    let mut checked = 0;
    for case in touchstone_cases::CASES {
        let variants = case.variants();
        let ends = [variants.first(), variants.last()].into_iter().flatten().map(|of| of.name);
        for variant in ends.chain([case.recommended().variant]) {
            let small = ["rows=5", "columns=0", "layers=6", "n=8", "spacing=0.5"].map(String::from);
            let is_known = |set: &String| case.settings(variant, std::slice::from_ref(set)).is_ok();
            let fields = case.fields().iter();
            for set in fields.flat_map(|of| FACTORS.map(|factor| changed(of, factor))).flatten() {
                let key = set.split('=').next();
                let others = small.iter().filter(|other| other.split('=').next() != key);
                let set: Vec<String> =
                    others.filter(|set| is_known(set)).chain([&set]).cloned().collect();
                let Ok(spec) = spec(*case, variant, &set) else { continue };
                let spec = RunSpec { allow_unstable: true, ..spec };
                let size = case.pose(&spec).and_then(|posed| posed.size(&spec, Steps::All, false));
                let Some(size) = size.ok().filter(|size| size.bytes() < 4e7) else { continue };
                let stop = AtomicBool::new(true);
                let context = Context { interrupt: Some(&stop), ..Context::default() };
                let before = HELD.get();
                MOST.set(before);
                let _may_be_refused = case.run(&spec, &context);
                let taken = (MOST.get() - before) as f64;
                let run = format!("{} {variant} {}", case.name(), set.join(" "));
                // The run ends before its first sample, for which there is a time.
                let estimated = Size { samples: 0.0, ..size }.bytes() + TIME * size.samples;
                assert!(taken < LEAST + 3.0 * estimated, "{run}: {taken} bytes, {size}");
                checked += 1;
            }
        }
    }
    assert!(checked > 1000, "{checked}");
}
