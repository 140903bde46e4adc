//! Time: order of the integrators, reversibility, and the book-keeping of steps.

use nalgebra::Vector2;
use std::ops::ControlFlow;
use touchstone_base::functions::log2;
use touchstone_solver::{
    Compose, Continuity, CubicSpline, Domain, Euler, Integrator, Kernel, Leapfrog, Observer, Open,
    Outcome, Particle, PredictorCorrector, Pressure, Rate, Scene, Simulation, SingleSweep, Stepper,
    Tait, Term, Viscosity, lane::Lane, particles::Common, terms::Pair,
};
use touchstone_tests::{bits, difference, patch};

type Forces = (Pressure<Tait>, Viscosity);
type Scheme<I> = Compose<CubicSpline, Forces, Continuity, Open, I>;

const H: f64 = 0.1;
const TORUS: [Option<f64>; 2] = [Some(1.0), Some(1.0)];

/// A jittered patch in motion. The quintic spline is smooth enough for second order in time.
fn simulation<I: Integrator<Scheme<()>>>(
    particles: Vec<Particle>,
    mu: f64,
) -> Simulation<Scheme<I>> {
    let pressure = Pressure::new(Tait { background: 0.3, ..Tait::new(1.0, 1.0) });
    let forces = (pressure, Viscosity { mu, eta2: 1e-4 * H * H });
    Scene::new(H, Domain::torus(1.0, 1.0), particles, forces, Continuity, Open).build().unwrap()
}

fn end<I: Integrator<Scheme<()>>>(mu: f64, time: f64, steps: u32) -> Vec<Particle> {
    let mut simulation = simulation::<I>(patch(10, 0.1, 5), mu);
    let outcome = simulation.advance(time, time / f64::from(steps), &mut ());
    assert_eq!((outcome, simulation.work().steps), (Outcome::Reached, u64::from(steps)));
    simulation.particles()
}

/// log₂ of the ratio of successive differences over dt, dt/2, dt/4, dt/8, finest last.
fn orders<I: Integrator<Scheme<()>>>(mu: f64) -> [f64; 2] {
    let (time, steps) = (0.4, 64);
    let [a, b, c, d] = [1, 2, 4, 8].map(|k| end::<I>(mu, time, steps * k));
    let [e1, e2, e3] = [(&a, &b), (&b, &c), (&c, &d)].map(|(p, q)| difference(p, q, TORUS));
    println!("{} mu {mu}: differences {e1:.3e} {e2:.3e} {e3:.3e}", I::NAME);
    [log2(e1 / e2), log2(e2 / e3)]
}

/// For forces that do not depend on the velocity, and for forces that do.
fn check_order<I: Integrator<Scheme<()>>>(expected: [f64; 2]) {
    for (mu, expected) in [0.0, 0.02].into_iter().zip(expected) {
        for order in orders::<I>(mu) {
            let apart = (order - expected).abs();
            assert!(apart < 0.15, "{}, mu = {mu}: order {order:.3}", I::NAME);
        }
    }
}

#[test]
fn predictor_corrector_has_its_order() {
    check_order::<PredictorCorrector>([2.0, 2.0]);
}

#[test]
fn leapfrog_has_its_order() {
    check_order::<Leapfrog>([2.0, 1.0]);
}

#[test]
fn the_single_sweep_has_its_order() {
    check_order::<SingleSweep>([1.0, 1.0]);
}

#[test]
fn euler_has_its_order() {
    check_order::<Euler>([1.0, 1.0]);
}

/// A force that gives each particle the acceleration \[m/s²\] of its mass \[kg/m\], along x.
#[derive(Clone, Copy, Debug)]
struct ByMass;

impl Term<()> for ByMass {
    type Derived = ();
    type Sum = ();

    fn pair<V: Lane, K: Kernel>(&self, _: &Pair<V, K>, _: &mut ()) {}

    fn finish(&self, own: &Common, _: (), _: (), rate: &mut Rate<()>) {
        rate.velocity.x += own.mass;
    }
}

/// dρᵢ/dt = Σⱼ mⱼ (uᵢ − uⱼ).
#[derive(Clone, Copy, Debug)]
struct Parting;

impl Term<()> for Parting {
    type Derived = ();
    type Sum = f64;

    fn pair<V: Lane, K: Kernel>(&self, pair: &Pair<V, K>, sum: &mut V) {
        *sum += pair.v.x * pair.other.mass;
    }

    fn finish(&self, _: &Common, _: (), sum: f64, rate: &mut Rate<()>) {
        rate.density += sum;
    }
}

/// Two particles with constant accelerations, so that the rate of each density is linear in time: midpoint
/// rules are exact, and so is the density that a single sweep extrapolates where the two steps before were
/// equally long. Steps that are all of one length hide by which times velocities are advanced and rates
/// extrapolated.
fn check_uneven_steps<I: Integrator<Compose<CubicSpline, ByMass, Parting, Open, ()>>>(
    is_swept_once: bool,
) {
    const MASSES: [f64; 2] = [0.01, 0.03];
    let at = |k: usize| Vector2::new(0.05 * k as f64, 0.0);
    let particle = |k: usize| Particle::fluid(at(k), Vector2::zeros(), 1.0, 1.0);
    let particles = [0, 1].map(|k| Particle { mass: MASSES[k], ..particle(k) }).to_vec();
    let scene = Scene::<Compose<CubicSpline, ByMass, Parting, Open, I>>::new(
        H,
        Domain::open(),
        particles,
        ByMass,
        Parting,
        Open,
    );
    let (mut simulation, mut time) = (scene.build().unwrap(), 0.0);
    let lengths = [0.1, 0.05, 0.2, 0.02, 0.1, 0.3].into_iter().flat_map(|dt| [dt, dt]);
    for (k, dt) in lengths.enumerate() {
        time += dt;
        assert_eq!(simulation.advance(time, 1.0, &mut ()), Outcome::Reached);
        assert_eq!(simulation.work().steps, k as u64 + 1);
        let apart = MASSES[0] - MASSES[1];
        for (i, p) in simulation.particles().iter().enumerate() {
            let parting = if i == 0 { MASSES[1] * apart } else { -MASSES[0] * apart };
            let exact = [
                at(i).x + 0.5 * MASSES[i] * time * time,
                MASSES[i] * time,
                1.0 + 0.5 * parting * time * time,
            ];
            let found = [p.position.x, p.velocity.x, p.density];
            for (name, (found, exact)) in
                ["x", "u", "density"].into_iter().zip(found.into_iter().zip(exact))
            {
                let is_known = name != "density" || !is_swept_once || k >= 2 && k.is_multiple_of(2);
                let error = (found - exact).abs();
                assert!(
                    !is_known || error < 1e-14,
                    "{} step {k}, {name}: {found}, not {exact}",
                    I::NAME
                );
            }
        }
    }
}

#[test]
fn steps_of_any_length_are_exact_for_constant_accelerations() {
    check_uneven_steps::<Leapfrog>(false);
    check_uneven_steps::<PredictorCorrector>(false);
    check_uneven_steps::<SingleSweep>(true);
}

/// Error of going there and back.
fn irreversibility<I: Integrator<Scheme<()>>>(mu: f64, steps: u32) -> f64 {
    let start = patch(10, 0.1, 5);
    let mut there = simulation::<I>(start.clone(), mu);
    let dt = 0.4 / f64::from(steps);
    assert_eq!(there.advance(0.4, dt, &mut ()), Outcome::Reached);
    let turn = |p: Particle| Particle { velocity: -p.velocity, ..p };
    let turned: Vec<_> = there.particles().into_iter().map(turn).collect();
    assert!(difference(&there.particles(), &start, TORUS) > 1e-3, "nothing happened");
    let mut back = simulation::<I>(turned, mu);
    assert_eq!(back.advance(0.4, dt, &mut ()), Outcome::Reached);
    let returned: Vec<_> = back.particles().into_iter().map(turn).collect();
    difference(&returned, &start, TORUS)
}

#[test]
fn leapfrog_without_viscosity_retraces_its_steps() {
    for steps in [20, 200] {
        let error = irreversibility::<Leapfrog>(0.0, steps);
        println!("leapfrog {steps} steps and back: {error:e}");
        assert!(error < 1e-15 * f64::from(steps) * 10.0, "{steps} steps and back: {error:e}");
    }
    for error in
        [irreversibility::<PredictorCorrector>(0.0, 20), irreversibility::<Leapfrog>(0.02, 20)]
    {
        println!("others: {error:e}");
        assert!(error > 1e-8, "what must not be reversible is, up to {error:e}");
    }
}

/// Notes the time and the length of each step.
#[derive(Default)]
struct Clock {
    times: Vec<f64>,
    dts: Vec<f64>,
}

impl Observer<()> for Clock {
    fn after_step(&mut self, simulation: &dyn Stepper<()>) -> ControlFlow<()> {
        self.times.push(simulation.time());
        self.dts.push(simulation.dt());
        ControlFlow::Continue(())
    }
}

#[test]
fn advance_lands_on_the_time_with_equal_steps_of_at_most_the_length_asked_for() {
    for (until, dt, steps) in [
        (1.0, 0.1, 10),
        (0.1 + 0.2, 0.1, 3),
        (1.0, 0.3, 4),
        (0.7, 1.0, 1),
        (1e-9, 1e-10, 10),
        (1.0 + 1e-9, 0.1, 11),
        (7.0 / 3.0, 1.0 / 3.0, 7),
    ] {
        let mut simulation = simulation::<Euler>(vec![patch(1, 0.0, 1)[0]], 0.0);
        let mut clock = Clock::default();
        assert_eq!(simulation.advance(until, dt, &mut clock), Outcome::Reached);
        assert_eq!((simulation.time(), clock.times.len()), (until, steps), "{until} by {dt}");
        assert!(clock.dts.iter().all(|d| *d == clock.dts[0] && *d <= dt * (1.0 + 1e-11)));
        assert_eq!(*clock.times.last().unwrap(), until);
        // An interval of length 0 makes no step.
        assert_eq!(simulation.advance(until, dt, &mut ()), Outcome::Reached);
        assert_eq!((simulation.time(), simulation.work().steps), (until, steps as u64));
    }
}

#[test]
fn time_does_not_drift_over_a_hundred_thousand_steps() {
    let mut simulation = simulation::<Euler>(vec![patch(1, 0.0, 1)[0]], 0.0);
    let mut clock = Clock::default();
    // 0.1 is not a binary fraction: adding it 100,000 times would be off by 1e-8.
    assert_eq!(simulation.advance(10_000.0, 0.1, &mut clock), Outcome::Reached);
    assert_eq!(clock.times.len(), 100_000);
    for (k, time) in clock.times.iter().enumerate() {
        let exact = (k + 1) as f64 / 10.0;
        assert!((time - exact).abs() <= 2.0 * f64::EPSILON * exact, "step {k} is at {time}");
    }
    // Many advances end where one does.
    let mut often = self::simulation::<Euler>(vec![patch(1, 0.0, 1)[0]], 0.0);
    for k in 1..=1000 {
        assert_eq!(often.advance(f64::from(k) * 10.0, 0.1, &mut ()), Outcome::Reached);
    }
    assert_eq!((often.time(), often.work().steps), (10_000.0, 100_000));
}

/// dt = 1/128 is exact, so that both runs step with equal bits.
#[test]
fn two_advances_are_one() {
    fn both<I: Integrator<Scheme<()>>>() -> [Vec<Particle>; 2] {
        [vec![0.5], vec![0.25, 0.5]].map(|times| {
            let mut simulation = simulation::<I>(patch(10, 0.1, 5), 0.02);
            for time in times {
                assert_eq!(simulation.advance(time, 1.0 / 128.0, &mut ()), Outcome::Reached);
            }
            assert_eq!((simulation.time(), simulation.work().steps), (0.5, 64));
            simulation.particles()
        })
    }
    for [one, two] in [both::<PredictorCorrector>(), both::<Euler>(), both::<Leapfrog>()] {
        assert_eq!(bits(&one), bits(&two));
    }
}
