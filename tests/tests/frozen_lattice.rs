//! Channel flow on a fixed lattice, against the same sums reduced to one unknown a row (`row_matrix` of this
//! crate): independent code for the same equations, so the comparison has no error of the method and shows a
//! weight or a wall that is off in the sixth digit. With equal steps they agree to 1e-13 of the speed of the
//! plate, and without the error of dt to 1e-8.
//!
//! At Re = 1e-9 the plate moves by 2e-8 spacings in the time L²/ν: the rows stay where they are, and
//! the density keeps its bits.

use nalgebra::DVector;
use touchstone_base::record::{Record, Status};
use touchstone_cases::fluids::channel::{ChannelSettings, ChannelSetup, Flow, TIMES};
use touchstone_harness::{
    case::{self, Case},
    context::Context,
    method::{Method, Properties},
    problem::{INTEGRATOR, KERNEL, Problem, WALLS},
};
use touchstone_maths::theory::time_step::Integrator;
use touchstone_schemes::flow::{self, Fluid};
use touchstone_solver::{
    BodyForce, Compose, Continuity, CubicSpline, Euler, ExtrapolatingWall, Ghosts, InterfaceWall,
    Kernel, Leapfrog, NoSlip, Outcome, PredictorCorrector, QuinticSpline, SingleSweep, Stepper,
    Tait, WendlandC2, integrator::stages,
};
use touchstone_tests::row_matrix::{Alignment, Channel, RowModel, Sums, WallRule};

/// A channel flow with the kernel K, the walls W and the integrator I, without stabiliser: a combination that
/// no variant has.
type Channels<K, W, I> = Compose<K, Fluid<BodyForce>, Continuity, W, I>;

/// Against the matrix stepped alike \[V\]: round-off of some thousand steps.
const ROUND_OFF: f64 = 1e-12;
/// Against the matrix alone \[V\].
const ALLOWED: f64 = 1e-6;
const FLOWS: [Flow; 2] = [Flow::Couette, Flow::Poiseuille];

/// h/dx and η²/h² with which a kernel is used, the cubic one as in the paper.
fn smoothing(kernel: &str) -> [f64; 2] {
    match kernel {
        CubicSpline::NAME => [1.2, 0.01],
        QuinticSpline::NAME => [1.0, 1e-6],
        _ => [2.0, 1e-6],
    }
}

/// The setup of a flow by this method.
fn setup(method: &Method, rows: usize, wall_curvature: bool, flow: Flow) -> ChannelSetup {
    let [h_over_dx, eta2_over_h2] = smoothing(method.properties.kernel);
    let s = ChannelSettings { re: 1e-9, rows, h_over_dx, eta2_over_h2, ..Default::default() };
    let s = ChannelSettings { wall_curvature, ..s };
    ChannelSetup::new(flow, &s, method).expect("settings")
}

fn simulation(method: &Method, setup: &ChannelSetup) -> Box<dyn Stepper<()>> {
    (method.build)(setup.scene().expect("a scene")).expect("a scene")
}

/// The wall rule of the matrix for a setup.
fn rule(setup: &ChannelSetup, walls: &str) -> WallRule {
    match (walls, setup.settings.wall_curvature) {
        ("interface-wall", _) => WallRule::InterfaceWall,
        ("ghosts", true) => WallRule::CurvedGhosts,
        ("ghosts", false) => WallRule::Ghosts,
        ("extrapolating-wall", _) => WallRule::Adami,
        _ => panic!("no rule for {walls}"),
    }
}

fn reduced(kernel: &str, setup: &ChannelSetup, (wall_rule, sums): (WallRule, Sums)) -> RowModel {
    let (s, wall_velocity) = (&setup.settings, [0.0, setup.plate_speed()]);
    let (rows, width, nu, force) = (s.rows, s.width, s.nu, setup.force);
    let alignment = Alignment::Aligned;
    let channel = Channel { rows, width, nu, wall_velocity, force, wall_rule, alignment, sums };
    let reduce = match kernel {
        CubicSpline::NAME => Channel::reduce::<CubicSpline>,
        QuinticSpline::NAME => Channel::reduce::<QuinticSpline>,
        WendlandC2::NAME => Channel::reduce::<WendlandC2>,
        kernel => panic!("no kernel {kernel}"),
    };
    reduce(&channel, s.h_over_dx, s.eta2_over_h2).expect("a wide channel")
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

/// Velocities, and the lag of a leapfrog's velocities \[s\].
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
fn fluid(simulation: &dyn Stepper<()>) -> Vec<(f64, f64)> {
    simulation.data().fluid().map(|(_, e)| (e.position.y, e.velocity.x)).collect()
}

/// Largest difference \[V\] of any particle from its row.
fn apart(setup: &ChannelSetup, fluid: &[(f64, f64)], model: &RowModel, u: &DVector<f64>) -> f64 {
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
fn check_steps(method: &Method, rows: usize, (wall_curvature, sums): (bool, Sums), flow: Flow) {
    let setup = setup(method, rows, wall_curvature, flow);
    let mut simulation = simulation(method, &setup);
    let walls = rule(&setup, method.properties.walls);
    let model = reduced(method.properties.kernel, &setup, (walls, sums));
    let Properties { kernel, walls, integrator, .. } = &method.properties;
    let name = format!("{flow:?}, {kernel}, {walls}, {integrator}, {:?}", setup.settings);
    let (mut lagging, mut before) = ((DVector::zeros(model.y.len()), 0.0), 0.0);
    for tau in [0.005, 0.02, 0.1, 0.5, 2.0] {
        let until = setup.time(tau);
        assert_eq!(simulation.advance(until, setup.rules.dt(), &mut ()), Outcome::Reached);
        let (steps, dt) = division(until - before, setup.rules.dt());
        assert_eq!(simulation.dt(), dt, "{name}");
        let by = (method.properties.theory, setup.medium.explicit_limit());
        let u = stepped(&model, by, &mut lagging, dt, steps);
        let apart = apart(&setup, &fluid(&*simulation), &model, &u);
        assert!(apart < ROUND_OFF, "{tau}: {apart:e} V from the matrix, {name}");
        before = until;
    }
    let steady = model.steady().expect("regular");
    let apart = apart(&setup, &fluid(&*simulation), &model, &steady);
    assert!(apart < ALLOWED, "{apart:e} V from the steady state, {name}");
}

/// Both flows at two resolutions by each method.
fn check_walls<const N: usize>(wall_curvature: bool, methods: [Method; N]) {
    check_sums((wall_curvature, Sums::Pairs), methods);
}

fn check_sums<const N: usize>(like: (bool, Sums), methods: [Method; N]) {
    for (method, flow) in methods.iter().flat_map(|method| FLOWS.map(|flow| (method, flow))) {
        check_steps(method, 10, like, flow);
        check_steps(method, 20, like, flow);
    }
}

/// Methods of variants as far as there are any: each kernel, each integrator and each wall, and each wall
/// with integrators that refresh it once a step and twice.
#[test]
fn ghosts_are_the_matrix_to_round_off() {
    let flow::OfChannels { seed, wendland, plain, .. } = flow::poiseuille();
    let euler = Method::of::<Channels<CubicSpline, Ghosts, Euler>>();
    let single_sweep = Method::of::<Channels<CubicSpline, Ghosts, SingleSweep>>();
    check_walls(false, [seed, wendland, plain, euler, single_sweep]);
}

#[test]
fn curved_ghosts_are_the_matrix_to_round_off() {
    let flow::OfChannels { seed, plain, .. } = flow::poiseuille();
    check_walls(true, [seed, plain]);
}

#[test]
fn sums_that_are_exact_for_linear_fields_are_the_matrix_to_round_off() {
    let consistent = flow::poiseuille().consistent;
    check_sums((true, Sums::Consistent), [consistent.clone()]);
    check_sums((false, Sums::Consistent), [consistent]);
}

/// The leapfrog with interface and wall particles.
fn leaping_interface() -> Method {
    Method::of::<Channels<WendlandC2, InterfaceWall, Leapfrog>>()
}

#[test]
fn interface_walls_are_the_matrix_to_round_off() {
    let single_sweep = Method::of::<Channels<WendlandC2, InterfaceWall, SingleSweep>>();
    check_walls(false, [flow::poiseuille().interface_wall, leaping_interface(), single_sweep]);
}

/// The predictor-corrector with walls that extrapolate.
fn corrected_extrapolating() -> Method {
    Method::of::<Channels<QuinticSpline, ExtrapolatingWall<Tait, NoSlip>, PredictorCorrector>>()
}

#[test]
fn extrapolating_walls_are_the_matrix_to_round_off() {
    check_walls(false, [flow::poiseuille().extrapolating, corrected_extrapolating()]);
}

/// u of every particle at νt/L² = `tau`, from runs with dt, dt/2, dt/4 and dt/8: their errors of the
/// order of the integrator and of the next two are taken out.
fn extrapolated(method: &Method, setup: &ChannelSetup, tau: f64) -> Vec<(f64, f64)> {
    // A whole number of steps at the coarsest level: the next ones halve it exactly.
    let (_, dt) = division(setup.time(tau), setup.rules.dt());
    let run = |finer: f64| {
        let mut simulation = simulation(method, setup);
        let outcome = simulation.advance(setup.time(tau), dt / finer, &mut ());
        assert_eq!(outcome, Outcome::Reached);
        fluid(&*simulation)
    };
    let mut order = if method.properties.theory == Integrator::PredictorCorrector { 2 } else { 1 };
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
fn check_exponential(method: &Method, wall_curvature: bool) {
    for (flow, tau) in FLOWS.into_iter().flat_map(|flow| [(flow, 0.03), (flow, 0.1)]) {
        let setup = setup(method, 20, wall_curvature, flow);
        let walls = rule(&setup, method.properties.walls);
        let model = reduced(method.properties.kernel, &setup, (walls, Sums::Pairs));
        let exact = model.at(setup.time(tau)).expect("regular");
        let apart = apart(&setup, &extrapolated(method, &setup, tau), &model, &exact);
        let Properties { kernel, walls, integrator, .. } = &method.properties;
        let name = format!("{kernel} {walls} {wall_curvature} {integrator} {flow:?} at {tau}");
        assert!(apart < ALLOWED, "{name}: {apart:e} V");
    }
}

#[test]
fn with_dt_extrapolated_away_runs_are_the_exponential_of_the_matrix() {
    let flow::OfChannels { seed, interface_wall, plain, extrapolating, .. } = flow::poiseuille();
    for (method, wall_curvature) in [
        (seed, false),
        (plain, true),
        (interface_wall, false),
        (leaping_interface(), false),
        (extrapolating, false),
        (corrected_extrapolating(), false),
    ] {
        check_exponential(&method, wall_curvature);
    }
}

/// The matrix of a record, which knows its kernel and its walls by name.
fn matrix_of(record: &Record, setup: &ChannelSetup) -> RowModel {
    let word = |key: &str| record.numerics[key].as_str().expect("a word");
    let is_consistent = record.run.variant == "consistent";
    let sums = if is_consistent { Sums::Consistent } else { Sums::Pairs };
    reduced(word(KERNEL), setup, (rule(setup, word(WALLS)), sums))
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
    let settings: ChannelSettings = record.run.settings_as();
    assert_eq!(record.status, Status::Completed, "{name}");
    // The kernel and the integrator decide on the limit of dt only, which is used for `stiff` alone.
    let flow::OfChannels { plain, stiff, .. } = flow::poiseuille();
    let (by, method) = match record.numerics[INTEGRATOR].as_str() {
        Some("leapfrog") => (Integrator::Leapfrog, plain),
        Some("single-sweep") => (Integrator::SingleSweep, plain),
        Some("super-leapfrog") => (Integrator::SuperLeapfrog, stiff),
        _ => (Integrator::PredictorCorrector, plain),
    };
    let setup = ChannelSetup::new(flow, &settings, &method).expect(&name);
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
    for (name, flow) in [("poiseuille", Flow::Poiseuille), ("couette", Flow::Couette)] {
        let case = touchstone_cases::find(name).expect("a case");
        for variant in case.variants() {
            check_variant(case, variant.name, flow);
        }
    }
}

/// η² enlarged by 1 %, and walls that differ in the second row: each result is far outside the tolerances
/// above.
#[test]
fn a_slightly_different_method_is_another_matrix() {
    let at = |eta2: f64, wall: WallRule| {
        let mut setup = setup(&flow::poiseuille().seed, 20, false, Flow::Poiseuille);
        setup.settings.eta2_over_h2 *= eta2;
        let model = reduced(CubicSpline::NAME, &setup, (wall, Sums::Pairs));
        model.at(setup.time(0.1)).expect("regular") / setup.v
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
