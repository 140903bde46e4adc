//! A step allocates nothing, once the buffers have found their size.
//!
//! The one place of the project that needs `unsafe`: a global allocator cannot be written without.
#![allow(unsafe_code)]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
};

use solver::{
    Compose, Continuity, CubicSpline, Domain, Flow, Integrator, Leapfrog, Observer, Open, Outcome,
    PredictorCorrector, Pressure, Scene, Simulation, Tait, Viscosity,
};
use touchstone_tests::patch;

thread_local! {
    /// Allocations of this thread; tests run on one each.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: hands every request to the system's allocator unchanged; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

type Method<I> = Compose<CubicSpline, (Pressure<Tait>, Viscosity), Continuity, Open, I>;

/// Stops when rows have been built this often.
struct Builds(u64);

impl<I: Integrator<()>> Observer<Method<I>> for Builds {
    fn after_step(&mut self, simulation: &Simulation<Method<I>>) -> Flow {
        if simulation.work().list_builds < self.0 { Flow::Continue } else { Flow::Stop }
    }
}

fn check<I: Integrator<()>>() {
    let h = 1.3 / 24.0;
    let pressure = Pressure::new(Tait { background: 0.3, ..Tait::new(1.0, 1.0) });
    let forces = (pressure, Viscosity { mu: 0.01, eta2: 1e-4 * h * h });
    let domain = Domain::torus(1.0, 1.0);
    let scene = Scene::<Method<I>>::new(h, domain, patch(24, 0.3, 3), forces, Continuity, Open);
    let mut simulation = scene.build().unwrap();
    // The patch orders itself while it warms up, so rows and images grow no more after it.
    assert_eq!(simulation.advance(1e3, 0.2 * h, &mut Builds(40)), Outcome::Stopped);
    let (work, before) = (simulation.work(), ALLOCATIONS.get());
    assert!(before > 0, "the counter counts");
    assert_eq!(simulation.advance(2e3, 0.2 * h, &mut Builds(60)), Outcome::Stopped);
    let allocations = ALLOCATIONS.get() - before;
    let steps = simulation.work().steps - work.steps;
    assert!(steps > 20, "{steps} steps with 20 builds");
    assert_eq!(allocations, 0, "{} allocated in {steps} steps", I::NAME);
}

#[test]
fn a_step_of_leapfrog_allocates_nothing_even_when_rows_are_rebuilt() {
    check::<Leapfrog>();
}

#[test]
fn a_step_of_the_predictor_corrector_allocates_nothing_even_when_rows_are_rebuilt() {
    check::<PredictorCorrector>();
}
