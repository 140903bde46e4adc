//! The row-reduced matrix of a channel and the factors of a lattice, against the tables of the design notes.

#[path = "../../validation/maths/src/theory/tests.rs"]
mod printed;

use nalgebra::{DVector, Vector2};
use touchstone_base::functions::log2;
use touchstone_maths::exact::StartUp;
use touchstone_maths::theory::lattice::SquareLattice;
use touchstone_solver::kernel::{CubicSpline, Kernel, QuinticSpline, WendlandC2};
use touchstone_tests::row_matrix::{
    Alignment, Channel, ChannelError, RowModel, Sums, WallRule, laplacian_factor,
    sheared_laplacian_factor,
};

use approx::assert_relative_eq;
use printed::assert_rounds_to;

const START_UP: StartUp = StartUp { v: 1.0, l: 1.0, nu: 1.0 };
/// F = 8νV/L² of Poiseuille flow.
const FORCE: f64 = 8.0;

/// The velocity of Poiseuille flow for t → ∞.
fn parabola(y: f64) -> f64 {
    4.0 * y * (1.0 - y)
}

fn reduced<K: Kernel>(
    wall_rule: WallRule,
    (h, eta2): (f64, f64),
    rows: usize,
    wall_velocity: [f64; 2],
    force: f64,
) -> RowModel {
    let (alignment, sums) = (Alignment::Aligned, Sums::Pairs);
    let channel =
        Channel { rows, width: 1.0, nu: 1.0, wall_velocity, force, wall_rule, alignment, sums };
    channel.reduce::<K>(h, eta2).expect("a wide channel")
}

fn poiseuille_error<K: Kernel>(rule: WallRule, kernel: (f64, f64), rows: usize) -> f64 {
    let model = reduced::<K>(rule, kernel, rows, [0.0; 2], FORCE);
    model.relative_error(&model.steady().expect("regular"), parabola)
}

fn couette_error<K: Kernel>(rule: WallRule, kernel: (f64, f64), rows: usize) -> f64 {
    let model = reduced::<K>(rule, kernel, rows, [0.0, 1.0], 0.0);
    model.relative_error(&model.at(0.1).expect("regular"), |y| START_UP.couette(y, 0.1))
}

/// Steady Poiseuille at N = 10, 20, 40, 80, then start-up Couette at νt/L² = 0.1, N = 20, 40.
fn check<K: Kernel>(rule: WallRule, kernel: (f64, f64), printed: [&str; 6]) {
    let steady = [10, 20, 40, 80].map(|n| poiseuille_error::<K>(rule, kernel, n));
    let start = [20, 40].map(|n| couette_error::<K>(rule, kernel, n));
    let row = format!("{} {kernel:?} {rule:?}", K::NAME);
    assert_rounds_to(&row, &printed, &[steady.as_slice(), &start].concat());
}

const UNCAPPED: WallRule = WallRule::Takeda { cap: f64::INFINITY };

/// Table 1.1 of the design notes, quintic h/dx = 1, η = 0, to its two digits, except the row
/// "quad": printed 8.0e-4, computed 1 - 1/L₁ = 7.948e-4 with the printed L₁ - 1 = 8.0e-4
/// (7.954e-4), so the printed number is the lattice factor rounded up.
#[test]
fn quintic_errors_match_the_design_table() {
    let check = check::<QuinticSpline>;
    let k = (1.0, 0.0);
    check(WallRule::Ghosts, k, ["1.7e-2", "3.7e-3", "5.1e-4", "5.5e-4", "1.3e-3", "1.2e-4"]);
    check(UNCAPPED, k, ["1.7e-2", "3.7e-3", "5.0e-4", "5.5e-4", "1.3e-3", "1.2e-4"]);
    check(WallRule::Adami, k, ["1.9e-2", "4.6e-3", "8.9e-4", "4.0e-4", "1.6e-3", "3.1e-4"]);
    check(WallRule::InterfaceWall, k, ["2.2e-2", "1.0e-2", "4.7e-3", "2.0e-3", "5.0e-3", "2.2e-3"]);
    check(
        WallRule::Takeda { cap: 0.5 },
        k,
        ["1.2e-1", "5.3e-2", "2.5e-2", "1.2e-2", "2.3e-2", "1.1e-2"],
    );
    check(WallRule::Constant, k, ["3.1e-1", "1.5e-1", "7.4e-2", "3.6e-2", "6.4e-2", "3.2e-2"]);
    check(WallRule::Quadratic, k, ["7.9e-4", "7.9e-4", "7.9e-4", "7.9e-4", "4.3e-4", "3.0e-4"]);
}

/// The rest of table 1.1, the seed's kernel first.
#[test]
fn cubic_and_wendland_errors_match_the_design_table() {
    let seed = (1.2, 0.01);
    let cubic = check::<CubicSpline>;
    cubic(WallRule::Ghosts, seed, ["3.6e-2", "2.4e-2", "2.1e-2", "2.0e-2", "8.6e-3", "7.5e-3"]);
    cubic(WallRule::Constant, seed, ["3.3e-1", "1.7e-1", "9.3e-2", "5.6e-2", "7.0e-2", "3.8e-2"]);
    cubic(
        WallRule::InterfaceWall,
        seed,
        ["3.7e-2", "2.8e-2", "2.4e-2", "2.2e-2", "1.1e-2", "8.9e-3"],
    );
    cubic(
        WallRule::Ghosts,
        (1.2, 0.0),
        ["2.6e-2", "1.3e-2", "1.0e-2", "9.5e-3", "4.8e-3", "3.7e-3"],
    );
    cubic(
        WallRule::Ghosts,
        (1.3, 0.01),
        ["2.0e-2", "5.1e-3", "1.4e-3", "4.6e-4", "1.8e-3", "4.8e-4"],
    );
    check::<WendlandC2>(
        WallRule::Ghosts,
        (2.0, 0.0),
        ["3.8e-2", "9.7e-3", "3.0e-3", "1.3e-3", "3.4e-3", "1.1e-3"],
    );
}

/// Wall curvature leaves the lattice factor 1 - 1/L₁ and nothing else, at every resolution.
#[test]
fn curved_ghosts_reach_the_lattice_floor() {
    fn check<K: Kernel>(kernel: (f64, f64), printed: [&str; 3]) {
        let floor = (1.0 - 1.0 / laplacian_factor::<K>(kernel.0, kernel.1)).abs();
        let errors = [10, 20, 40].map(|n| poiseuille_error::<K>(WallRule::CurvedGhosts, kernel, n));
        assert_rounds_to(&format!("{} {kernel:?}", K::NAME), &printed, &errors);
        for error in errors {
            assert!((error / floor - 1.0).abs() < 0.035, "{error} against a floor of {floor}");
        }
    }
    check::<QuinticSpline>((1.0, 0.0), ["8.08e-4", "7.98e-4", "7.96e-4"]);
    check::<CubicSpline>((1.2, 0.01), ["2.00e-2", "1.98e-2", "1.97e-2"]);
    check::<CubicSpline>((1.2, 0.0), ["9.44e-3", "9.33e-3", "9.30e-3"]);
    check::<WendlandC2>((2.0, 0.0), ["8.28e-4", "8.08e-4", "8.03e-4"]);
}

/// Linear extrapolation is exact for steady Couette flow, a constant wall velocity is not.
#[test]
fn steady_couette_is_exact_for_linear_rules() {
    let error = |rule| {
        let model = reduced::<QuinticSpline>(rule, (1.0, 0.0), 20, [0.0, 1.0], 0.0);
        model.relative_error(&model.steady().expect("regular"), |y| y)
    };
    for rule in [WallRule::Ghosts, WallRule::CurvedGhosts, UNCAPPED, WallRule::Quadratic] {
        assert!(error(rule) < 1e-13, "{rule:?}: {:.1e}", error(rule));
    }
    let others = [WallRule::Adami, WallRule::InterfaceWall, WallRule::Constant].map(error);
    assert_rounds_to("steady Couette", &["1.9e-4", "1.9e-3", "2.6e-2"], &others);
}

/// Once the rows have slid, the floor is the factor of sheared rows.
#[test]
fn slid_rows_have_the_sheared_floor() {
    for (h, eta2) in [(1.3, 0.01), (1.2, 0.0)] {
        let channel = Channel {
            rows: 20,
            width: 1.0,
            nu: 1.0,
            wall_velocity: [0.0; 2],
            force: FORCE,
            wall_rule: WallRule::Quadratic,
            alignment: Alignment::Slid,
            sums: Sums::Pairs,
        };
        let model = channel.reduce::<CubicSpline>(h, eta2).expect("a wide channel");
        let steady = model.steady().expect("regular");
        let factor = sheared_laplacian_factor::<CubicSpline>(h, eta2);
        let error = model.relative_error(&steady, |y| parabola(y) / factor);
        assert!(error < 1e-7, "h/dx {h}: {error:.1e}");
    }
}

/// Forward Euler is of first, midpoint of second order towards the exponential.
#[test]
fn time_stepping_converges_with_its_order() {
    let model = reduced::<CubicSpline>(WallRule::Ghosts, (1.2, 0.01), 10, [0.0; 2], 8.0);
    let exact = model.at(0.1).expect("regular");
    let order = |step: &dyn Fn(f64, usize) -> DVector<f64>| {
        let error = |n: usize| (step(0.1 / n as f64, n) - &exact).norm();
        log2(error(200) / error(400))
    };
    assert!((order(&|dt, n| model.euler(dt, n)) - 1.0).abs() < 0.02);
    assert!((order(&|dt, n| model.midpoint(dt, n)) - 2.0).abs() < 0.02);
}

/// Start-up Poiseuille flow at 20 rows: errors of plain ghosts, of curved ones and of the parabola through
/// the wall, which bounds the possible gain of a wall rule.
#[test]
fn curved_ghosts_help_during_start_up() {
    for (t, printed) in [
        (0.02, ["8.8e-3", "3.3e-3", "2.4e-3"]),
        (0.1, ["3.6e-3", "2.1e-3", "1.8e-3"]),
        (0.5, ["3.7e-3", "8.8e-4", "8.6e-4"]),
    ] {
        let error = |rule| {
            let model = reduced::<QuinticSpline>(rule, (1.0, 0.0), 20, [0.0; 2], 8.0);
            model.relative_error(&model.at(t).expect("regular"), |y| START_UP.poiseuille(y, t))
        };
        let rules = [WallRule::Ghosts, WallRule::CurvedGhosts, WallRule::Quadratic];
        assert_rounds_to(&format!("t = {t}"), &printed, &rules.map(error));
    }
}

#[test]
fn bad_channels_are_refused() {
    let channel = Channel {
        rows: 2,
        width: 1.0,
        nu: 1.0,
        wall_velocity: [0.0; 2],
        force: 0.0,
        wall_rule: WallRule::Ghosts,
        alignment: Alignment::Aligned,
        sums: Sums::Pairs,
    };
    let narrow = channel.reduce::<QuinticSpline>(1.3, 0.0);
    assert_eq!(narrow.unwrap_err(), ChannelError::TooNarrow { rows: 2, reach: 3 });
    let frozen = Channel { nu: 0.0, rows: 20, ..channel }.reduce::<CubicSpline>(1.2, 0.0);
    assert_eq!(frozen.unwrap_err(), ChannelError::NotPositive { name: "nu", value: 0.0 });
}

/// h/dx, neighbours, G₁-1, L₁-1 at η² = 0.01 h², L₁-1 of sheared rows at η² = 0.01 h² and 0,
/// as printed; "" where the design notes have none.
type Factors = (f64, usize, [&'static str; 4]);

fn check_factors<K: Kernel>(rows: &[Factors]) {
    for (ratio, neighbours, printed) in rows {
        let bare = SquareLattice::of::<K>(*ratio, 0.0);
        let computed = [
            bare.gradient_factor() - 1.0,
            laplacian_factor::<K>(*ratio, 0.01) - 1.0,
            sheared_laplacian_factor::<K>(*ratio, 0.01) - 1.0,
            sheared_laplacian_factor::<K>(*ratio, 0.0) - 1.0,
        ];
        assert_eq!(bare.neighbours(), *neighbours, "{} {ratio}", K::NAME);
        assert_rounds_to(&format!("{} {ratio}", K::NAME), printed, &computed);
    }
}

/// Table 1.0 of the design notes, to its printed digits. Wendland C4 is not a kernel here.
#[test]
fn lattice_factors_match_the_design_table() {
    check_factors::<CubicSpline>(&[
        (1.0, 8, ["+1.3e-2", "+4.7e-3", "-1.2e-2", "-3.9e-3"]),
        (1.1, 12, ["-3.4e-3", "-1.3e-2", "-1.5e-2", "-5.9e-3"]),
        (1.2, 20, ["-9.2e-3", "-1.9e-2", "-4.1e-3", "+5.9e-3"]),
        (1.25, 20, ["+1.0e-3", "-9.4e-3", "+1.7e-3", "+1.2e-2"]),
        (1.3, 20, ["+1.05e-2", "-1.6e-4", "+5.7e-3", "+1.6e-2"]),
        (1.5, 24, ["+6.7e-3", "-4.8e-3", "-7.0e-3", "+4.4e-3"]),
        (2.0, 44, ["-9.0e-4", "-1.3e-2", "-1.3e-2", "-5.2e-4"]),
    ]);
    check_factors::<QuinticSpline>(&[
        (0.9, 20, ["-1.4e-4", "-6.3e-3", "-6.6e-3", "-5.4e-4"]),
        (1.0, 24, ["+8.0e-4", "-6.0e-3", "-6.8e-3", "-9.0e-5"]),
        (1.3, 44, ["+6.1e-4", "-7.3e-3", "-7.2e-3", "+6.9e-4"]),
    ]);
    check_factors::<WendlandC2>(&[
        (1.5, 24, ["-2.6e-3", "-1.5e-2", "-1.6e-2", "-3.4e-3"]),
        (2.0, 44, ["-8.0e-4", "-1.5e-2", "-1.5e-2", "-7.1e-4"]),
    ]);
}

/// The symbols of long waves are g = G₁ k, λ = L₁ k².
#[test]
fn symbols_tend_to_the_factors() {
    let lattice = SquareLattice::of::<CubicSpline>(1.2, 0.01);
    let theta = Vector2::new(1e-4, 0.0);
    let kh = theta.x * 1.2;
    assert_relative_eq!(
        lattice.gradient(theta).x / kh,
        lattice.gradient_factor(),
        max_relative = 1e-7
    );
    assert_relative_eq!(
        lattice.laplacian(theta) / (kh * kh),
        laplacian_factor::<CubicSpline>(1.2, 0.01),
        max_relative = 1e-7
    );
    let p = lattice.artificial(theta);
    let trace = 0.5 * lattice.laplacian(theta) - p.trace();
    assert!(trace.abs() < 1e-16, "the trace of P is half of the Laplacian");
}
