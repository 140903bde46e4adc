//! Wall time of steps and of neighbour lists, 10³ to 10⁶ particles, one thread. Never a gate.
//!
//! The scenes are those of `touchstone doctor --bench`. Criterion's throughput is particles a second;
//! a predictor-corrector step has two right-hand sides, the others have one.

use std::time::{Duration, Instant};

use criterion::measurement::WallTime;
use criterion::{
    BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main,
};
use fluids::bench::{Rebuilding, SHORT, SIDES, scene, stale_distance};
use solver::{Euler, Integrator, Leapfrog, PredictorCorrector};

/// One call of `advance` a sample, so that what `advance` does at its end weighs little.
fn steps<I: Integrator<()>>(
    group: &mut BenchmarkGroup<WallTime>,
    name: &str,
    dt: impl Fn(usize) -> f64,
) {
    for side in SIDES {
        let mut simulation = scene::<I>(side, false).build().expect("a sound scene");
        group.throughput(Throughput::Elements(simulation.fluid_count() as u64));
        let id = BenchmarkId::new(name, simulation.fluid_count());
        group.bench_function(id, |bencher| {
            bencher.iter_custom(|count| {
                let until = simulation.time() + count as f64 * dt(side);
                let start = Instant::now();
                simulation.advance(until, dt(side), &mut ());
                start.elapsed()
            });
        });
    }
}

fn right_hand_side(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    steps::<Euler>(&mut group, "euler", |_| SHORT);
    steps::<Leapfrog>(&mut group, "leapfrog", |_| SHORT);
    steps::<PredictorCorrector>(&mut group, "predictor-corrector", |_| SHORT);
    steps::<Rebuilding>(&mut group, "sort and build rows", stale_distance);
    group.finish();
}

criterion_group!(benches, right_hand_side);
criterion_main!(benches);
