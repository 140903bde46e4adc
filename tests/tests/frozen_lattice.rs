//! Channel flow on a lattice that does not move, against the same sums reduced to one unknown a row
//! (`row_matrix` of this crate): independent code for the same equations, so no error of the
//! method stands between them, and a weight or a wall that is off in the sixth digit is seen. Stepped
//! alike they agree to 1e-13 of the speed of the plate, and without the error of dt to 1e-8.
//!
//! At Re = 1e-9 the plate moves by 2e-8 spacings in the time L²/ν: the rows stay where they are, and
//! the density keeps its bits.

use base::record::{Record, Status};
use fluids::channel::{COUETTE, ChannelSettings, Flow, POISEUILLE, Setup, TIMES};
use harness::{
    case::{self, Case},
    context::Context,
    method::{self, Boundary, Method, Standard},
    simulate::{INTEGRATOR, KERNEL, WALLS},
};
use maths::theory::time_step::Integrator;
use nalgebra::DVector;
use schemes::flow::{self, Fluid};
use solver::{
    BodyForce, Compose, Continuity, CubicSpline, Euler, ExtrapolatingWall, Ghosts, InterfaceWall,
    Kernel, Leapfrog, NoSlip, Outcome, PredictorCorrector, QuinticSpline, Simulation, SingleSweep,
    Stepper, Tait, WendlandC2, integrator::stages, walls::Walls,
};
use touchstone_tests::row_matrix::{Alignment, Channel, RowModel, WallRule};

/// A channel flow in the kernel K, the walls W and the integrator I, and no stabiliser.
type Channels<K, W, I> = Compose<K, Fluid<BodyForce>, Continuity, W, I>;

/// Against the matrix stepped alike \[V\]: round-off of some thousand steps.
const ROUND_OFF: f64 = 1e-12;
/// Against the matrix alone \[V\].
const ALLOWED: f64 = 1e-6;
const FLOWS: [Flow; 2] = [Flow::Couette, Flow::Poiseuille];

/// h/dx and η²/h² of the kernels, the first as in the paper.
const CUBIC: (f64, f64) = (1.2, 0.01);
const QUINTIC: (f64, f64) = (1.0, 1e-6);
const WENDLAND: (f64, f64) = (2.0, 1e-6);

fn settings(rows: usize, (h_over_dx, eta2_over_h2): (f64, f64)) -> ChannelSettings {
    ChannelSettings { re: 1e-9, rows, h_over_dx, eta2_over_h2, ..ChannelSettings::default() }
}

/// The method of a scheme and the setup of its flow.
fn setup<S: Standard<Extra = ()>>(s: &ChannelSettings, flow: Flow) -> (Method, Setup) {
    let method = Method::of::<S>();
    let setup = Setup::new(flow, s, &method, &Context::default()).expect("settings");
    (method, setup)
}

fn simulation<S: Standard<Extra = ()>>(method: &Method, setup: &Setup) -> Simulation<S> {
    let parts = setup.parts(method, &Context::default());
    method::scene::<S>(parts).build().expect("a scene")
}

/// What the matrix calls the walls of a setup.
fn rule(setup: &Setup, walls: &str) -> WallRule {
    match (walls, setup.settings.wall_curvature) {
        ("interface-wall", _) => WallRule::InterfaceWall,
        ("ghosts", true) => WallRule::CurvedGhosts,
        ("ghosts", false) => WallRule::Ghosts,
        ("extrapolating-wall", _) => WallRule::Adami,
        _ => panic!("no rule for {walls}"),
    }
}

fn reduced<K: Kernel>(setup: &Setup, wall_rule: WallRule) -> RowModel {
    let (s, wall_velocity) = (&setup.settings, [0.0, setup.plate_speed()]);
    let (rows, width, nu, force) = (s.rows, s.width, s.nu, setup.force);
    let alignment = Alignment::Aligned;
    let channel = Channel { rows, width, nu, wall_velocity, force, wall_rule, alignment };
    channel.reduce::<K>(s.h_over_dx, s.eta2_over_h2).expect("a wide channel")
}

/// RKL2 over dt in the form of its authors, where the solver steps differences.
fn super_step(model: &RowModel, u: &mut DVector<f64>, dt: f64, explicit: f64) {
    let count = stages(dt / explicit);
    let b = |j: u32| {
        let j = f64::from(j.max(2));
        (j * j + j - 2.0) / (2.0 * j * (j + 1.0))
    };
    let s = f64::from(count);
    let w = 4.0 / (s * s + s - 2.0);
    let (start, rate) = (u.clone(), model.rate(u) * dt);
    let (mut before, mut last) = (start.clone(), &start + &rate * (b(1) * w));
    for j in 2..=count {
        let x = f64::from(j);
        let mu = (2.0 * x - 1.0) / x * b(j) / b(j - 1);
        let nu = -(x - 1.0) / x * b(j) / b(j - 2);
        let next =
            &last * mu + before * nu + &start * (1.0 - mu - nu) + model.rate(&last) * (mu * w * dt)
                - &rate * ((1.0 - b(j - 1)) * mu * w);
        (before, last) = (last, next);
    }
    *u = last;
}

/// Velocities, and the time by which those of a leapfrog lag behind \[s\].
type Lagging = (DVector<f64>, f64);

/// `steps` steps for u' = A u + b, and u at the time of the last, to which a leapfrog kicks a copy by half a
/// step. `explicit` is the limit from which stages are counted.
fn stepped(
    model: &RowModel,
    (by, explicit): (Integrator, f64),
    (u, lag): &mut Lagging,
    dt: f64,
    steps: usize,
) -> DVector<f64> {
    let kick = |u: &mut DVector<f64>, dt: f64| match by {
        Integrator::Euler => *u += model.rate(u) * dt,
        Integrator::PredictorCorrector => {
            let half = &*u + model.rate(u) * (0.5 * dt);
            *u += model.rate(&half) * dt;
        }
        Integrator::Leapfrog | Integrator::SingleSweep => *u += model.rate(u) * dt,
        Integrator::SuperLeapfrog => super_step(model, u, dt, explicit),
    };
    let is_staggered = !matches!(by, Integrator::Euler | Integrator::PredictorCorrector);
    for _ in 0..steps {
        kick(u, if is_staggered { *lag + 0.5 * dt } else { dt });
        *lag = if is_staggered { 0.5 * dt } else { 0.0 };
    }
    let mut there = u.clone();
    if is_staggered {
        kick(&mut there, *lag);
    }
    there
}

/// Steps and their length, as `Stepper::advance` divides a span.
fn division(span: f64, dt_max: f64) -> (usize, f64) {
    let steps = (span / dt_max * (1.0 - 1e-12)).ceil();
    (steps as usize, span / steps)
}

/// y and u of every particle of the fluid.
fn fluid<S: Standard<Extra = ()>>(simulation: &Simulation<S>) -> Vec<(f64, f64)> {
    simulation.fluid().map(|(_, e)| (e.position.y, e.velocity.x)).collect()
}

/// Largest difference \[V\] of any particle from its row.
fn apart(setup: &Setup, fluid: &[(f64, f64)], model: &RowModel, u: &DVector<f64>) -> f64 {
    assert!(fluid.len() >= u.len() && fluid.len().is_multiple_of(u.len()));
    let first = model.y[0] / setup.medium.dx;
    let mut largest = 0.0_f64;
    for (y, velocity) in fluid {
        let row = (y / setup.medium.dx - first).round() as usize;
        assert!((y - model.y[row]).abs() < 1e-9 * setup.medium.dx, "row {row} is at {y} m");
        let apart = (velocity - u[row]).abs() / setup.v;
        // A NaN must not hide behind a maximum.
        largest = if apart > largest || apart.is_nan() { apart } else { largest };
    }
    largest
}

/// From rest to each νt/L² in turn, against the matrix stepped alike; at the last one against the
/// steady state too.
fn check_steps<S: Standard<Extra = ()>>(settings: &ChannelSettings, flow: Flow) {
    let (method, setup) = setup::<S>(settings, flow);
    let mut simulation = simulation::<S>(&method, &setup);
    let model = reduced::<S::Kernel>(&setup, rule(&setup, method.walls));
    let name = format!("{flow:?}, {}, {settings:?}", std::any::type_name::<S>());
    let (mut lagging, mut before) = ((DVector::zeros(model.y.len()), 0.0), 0.0);
    for tau in [0.005, 0.02, 0.1, 0.5, 2.0] {
        let until = setup.time(tau);
        assert_eq!(simulation.advance(until, setup.rules.dt(), &mut ()), Outcome::Reached);
        let (steps, dt) = division(until - before, setup.rules.dt());
        assert_eq!(simulation.dt(), dt, "{name}");
        let by = (method.theory, setup.medium.explicit_limit());
        let u = stepped(&model, by, &mut lagging, dt, steps);
        let apart = apart(&setup, &fluid(&simulation), &model, &u);
        assert!(apart < ROUND_OFF, "{tau}: {apart:e} V from the matrix, {name}");
        before = until;
    }
    let steady = model.steady().expect("regular");
    let apart = apart(&setup, &fluid(&simulation), &model, &steady);
    assert!(apart < ALLOWED, "{apart:e} V from the steady state, {name}");
}

/// Both flows at two resolutions with every kernel and integrator.
fn check_walls<W: Boundary + Walls<()>>(wall_curvature: bool) {
    fn check_kernel<K: Kernel, W: Boundary + Walls<()>>(kernel: (f64, f64), wall_curvature: bool) {
        for (flow, rows) in FLOWS.into_iter().flat_map(|flow| [(flow, 10), (flow, 20)]) {
            let s = ChannelSettings { wall_curvature, ..settings(rows, kernel) };
            check_steps::<Channels<K, W, PredictorCorrector>>(&s, flow);
            check_steps::<Channels<K, W, Leapfrog>>(&s, flow);
            check_steps::<Channels<K, W, SingleSweep>>(&s, flow);
        }
        let s = ChannelSettings { wall_curvature, ..settings(10, kernel) };
        check_steps::<Channels<K, W, Euler>>(&s, Flow::Couette);
    }
    check_kernel::<CubicSpline, W>(CUBIC, wall_curvature);
    check_kernel::<QuinticSpline, W>(QUINTIC, wall_curvature);
    check_kernel::<WendlandC2, W>(WENDLAND, wall_curvature);
}

#[test]
fn ghosts_are_the_matrix_to_round_off() {
    check_walls::<Ghosts>(false);
}

#[test]
fn curved_ghosts_are_the_matrix_to_round_off() {
    check_walls::<Ghosts>(true);
}

#[test]
fn interface_walls_are_the_matrix_to_round_off() {
    check_walls::<InterfaceWall>(false);
}

#[test]
fn extrapolating_walls_are_the_matrix_to_round_off() {
    check_walls::<ExtrapolatingWall<Tait, NoSlip>>(false);
}

/// u of every particle at νt/L² = `tau`, from runs with dt, dt/2, dt/4 and dt/8: their errors of the
/// `order` of the integrator and of the next two are taken out.
fn extrapolated<S: Standard<Extra = ()>>(
    settings: &ChannelSettings,
    flow: Flow,
    tau: f64,
    mut order: i32,
) -> Vec<(f64, f64)> {
    let (method, setup) = setup::<S>(settings, flow);
    // A whole number of steps at the coarsest level: the next ones halve it exactly.
    let (_, dt) = division(setup.time(tau), setup.rules.dt());
    let run = |finer: f64| {
        let mut simulation = simulation::<S>(&method, &setup);
        let outcome = simulation.advance(setup.time(tau), dt / finer, &mut ());
        assert_eq!(outcome, Outcome::Reached);
        fluid(&simulation)
    };
    let mut runs = [1.0, 2.0, 4.0, 8.0].map(run).to_vec();
    while runs.len() > 1 {
        let finer = |(a, b): (&(f64, f64), &(f64, f64))| {
            (b.0, b.1 + (b.1 - a.1) / (2_f64.powi(order) - 1.0))
        };
        let pair = |two: &[Vec<_>]| two[0].iter().zip(&two[1]).map(finer).collect();
        runs = runs.windows(2).map(pair).collect();
        order += 1;
    }
    runs.remove(0)
}

/// Without the integrator: dt extrapolated away, against the exponential of the matrix.
fn check_exponential<K: Kernel, W: Boundary + Walls<()>>(kernel: (f64, f64), wall_curvature: bool) {
    for (flow, tau) in FLOWS.into_iter().flat_map(|flow| [(flow, 0.03), (flow, 0.1)]) {
        let s = ChannelSettings { wall_curvature, ..settings(20, kernel) };
        let (_, setup) = setup::<Channels<K, W, Leapfrog>>(&s, flow);
        let model = reduced::<K>(&setup, rule(&setup, W::NAME));
        let exact = model.at(setup.time(tau)).expect("regular");
        let leapfrog = extrapolated::<Channels<K, W, Leapfrog>>(&s, flow, tau, 1);
        let midpoint = extrapolated::<Channels<K, W, PredictorCorrector>>(&s, flow, tau, 2);
        let found = [leapfrog, midpoint].map(|run| apart(&setup, &run, &model, &exact));
        let name = format!("{} {} {wall_curvature} {flow:?} at {tau}", K::NAME, W::NAME);
        assert!(found.iter().all(|apart| *apart < ALLOWED), "{name}: {found:?} V");
    }
}

#[test]
fn with_dt_extrapolated_away_runs_are_the_exponential_of_the_matrix() {
    check_exponential::<CubicSpline, Ghosts>(CUBIC, false);
    check_exponential::<QuinticSpline, Ghosts>(QUINTIC, true);
    check_exponential::<WendlandC2, InterfaceWall>(WENDLAND, false);
    check_exponential::<QuinticSpline, InterfaceWall>(QUINTIC, false);
    check_exponential::<QuinticSpline, ExtrapolatingWall<Tait, NoSlip>>(QUINTIC, false);
}

/// The matrix of a record, which knows its kernel and its walls by name.
fn matrix_of(record: &Record, setup: &Setup) -> RowModel {
    let word = |key: &str| record.numerics[key].as_str().expect("a word");
    let wall_rule = rule(setup, word(WALLS));
    match word(KERNEL) {
        CubicSpline::NAME => reduced::<CubicSpline>(setup, wall_rule),
        QuinticSpline::NAME => reduced::<QuinticSpline>(setup, wall_rule),
        WendlandC2::NAME => reduced::<WendlandC2>(setup, wall_rule),
        kernel => panic!("no kernel {kernel}"),
    }
}

/// u of a record at the times of comparison against the matrix: settings, ingredients, runner and
/// profile have a part in it.
fn check_variant(case: &dyn Case, variant: &str, flow: Flow) {
    // c0 by Morris' rule alone: with sound as stiff as viscosity, round-off of the density would
    // push such slow flows about. It also leaves an artificial viscosity of 1e-7 nu.
    let set = ["re=1e-9", "end=0.2", "c0_viscous=0"].map(String::from);
    let name = format!("{flow:?}, {variant}");
    let spec = case::spec(case, variant, &set).expect("settings");
    let record = case.run(&spec, &Context::default()).expect(&name);
    let settings: ChannelSettings = record.settings_as();
    assert_eq!(record.status, Status::Completed, "{name}");
    // The kernel and the integrator decide on the limit of dt only, which is used for `stiff` alone.
    let plain = Method::of::<Channels<QuinticSpline, Ghosts, Leapfrog>>;
    let (by, method) = match record.numerics[INTEGRATOR].as_str() {
        Some("leapfrog") => (Integrator::Leapfrog, plain()),
        Some("single-sweep") => (Integrator::SingleSweep, plain()),
        Some("super-leapfrog") => (Integrator::SuperLeapfrog, flow::poiseuille().stiff),
        _ => (Integrator::PredictorCorrector, plain()),
    };
    let context = Context::of_rules();
    let setup = Setup::new(flow, &settings, &method, &context).expect(&name);
    let model = matrix_of(&record, &setup);
    let (mut lagging, mut before) = ((DVector::zeros(model.y.len()), 0.0), 0.0);
    for tau in TIMES.into_iter().filter(|tau| *tau <= settings.end) {
        let span = setup.time(tau) - before;
        let (steps, dt) = division(span, setup.rules.dt().min(span / settings.least_steps as f64));
        let by = (by, setup.medium.explicit_limit());
        let u = stepped(&model, by, &mut lagging, dt, steps);
        before = setup.time(tau);
        let columns = &record.profiles[&format!("u@{tau}")].columns;
        let rows: Vec<_> =
            columns[0].values.iter().copied().zip(columns[1].values.iter().copied()).collect();
        let apart = apart(&setup, &rows, &model, &u);
        assert!(apart < ALLOWED, "{name} at {tau}: {apart:e} V");
    }
}

#[test]
fn every_variant_is_its_matrix() {
    let flows: [(&dyn Case, Flow); 2] =
        [(&POISEUILLE, Flow::Poiseuille), (&COUETTE, Flow::Couette)];
    for (case, flow) in flows {
        for variant in case.variants() {
            check_variant(case, variant.name, flow);
        }
    }
}

/// A hundredth more η², and walls that differ in the second row behind them: each is far outside
/// what the tests above allow, so they would fail.
#[test]
fn a_slightly_different_method_is_another_matrix() {
    let of = |eta2: f64| {
        let s = settings(20, (CUBIC.0, CUBIC.1 * eta2));
        setup::<Channels<CubicSpline, Ghosts, Leapfrog>>(&s, Flow::Poiseuille).1
    };
    let at = |eta2: f64, wall: WallRule| {
        let setup = of(eta2);
        reduced::<CubicSpline>(&setup, wall).at(setup.time(0.1)).expect("regular") / setup.v
    };
    let as_it_is = at(1.0, WallRule::Ghosts);
    let takeda = WallRule::Takeda { cap: f64::INFINITY };
    for (name, other) in [
        ("1 % more eta^2", at(1.01, WallRule::Ghosts)),
        ("curved ghosts", at(1.0, WallRule::CurvedGhosts)),
        ("per pair", at(1.0, takeda)),
        ("Adami", at(1.0, WallRule::Adami)),
    ] {
        let apart = (&as_it_is - other).amax();
        assert!(apart > 10.0 * ALLOWED, "{name} differs by {apart:e} V only");
    }
}
