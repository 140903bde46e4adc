//! Bounds of gates that are made from the row-reduced matrix are computed again.

use nalgebra::DVector;
use touchstone_cases::fluids::channel::{CONSISTENT, Flow, GHOSTS, TIMES};
use touchstone_maths::exact::StartUp;
use touchstone_solver::{Kernel, QuinticSpline};
use touchstone_tests::row_matrix::{Alignment, Channel, RowModel, Sums, WallRule};

const START_UP: StartUp = StartUp { v: 1.0, l: 1.0, nu: 1.0 };
const ALIGNMENTS: [Alignment; 2] = [Alignment::Aligned, Alignment::Slid];

fn model<K: Kernel>(
    (flow, rows, h_over_dx): (Flow, usize, f64),
    wall_rule: WallRule,
    alignment: Alignment,
    sums: Sums,
) -> RowModel {
    let (wall_velocity, force) = match flow {
        Flow::Couette => ([0.0, 1.0], 0.0),
        Flow::Poiseuille => ([0.0; 2], 8.0), // F = 8νV/L²
    };
    let (width, nu) = (1.0, 1.0);
    let section = Channel { rows, width, nu, wall_velocity, force, wall_rule, alignment, sums };
    section.reduce::<K>(h_over_dx, 1e-6).expect("a wide channel")
}

/// Error at a νt/L², exact in time.
fn error_at(flow: Flow, model: &RowModel, tau: f64) -> f64 {
    relative_error(flow, model, &model.at(tau).expect("regular"), tau)
}

/// ‖u - u_exact‖₂ / ‖u_exact‖₂ at a νt/L².
fn relative_error(flow: Flow, model: &RowModel, u: &DVector<f64>, tau: f64) -> f64 {
    match flow {
        Flow::Couette => model.relative_error(u, |y| START_UP.couette(y, tau)),
        Flow::Poiseuille => model.relative_error(u, |y| START_UP.poiseuille(y, tau)),
    }
}

/// Error at νt/L² = 0.1 with the steps of a leapfrog of at most `dt` \[L²/ν\], equal
/// between the times at which a run pauses: half a kick first, whole ones, half a kick last.
fn error_of_leapfrog(flow: Flow, model: &RowModel, dt: f64) -> f64 {
    let (mut u, mut start, mut lag) = (DVector::zeros(model.y.len()), 0.0, 0.0);
    for until in TIMES.into_iter().filter(|tau| *tau <= 0.1) {
        let steps = ((until - start) / dt * (1.0 - 1e-12)).ceil();
        let half = 0.5 * (until - start) / steps;
        for _ in 0..steps as usize {
            u += model.rate(&u) * (lag + half);
            lag = half;
        }
        start = until;
    }
    u += model.rate(&u) * lag;
    relative_error(flow, model, &u, 0.1)
}

fn assert_near(found: f64, printed: f64, tolerance: f64) {
    assert!((found / printed - 1.0).abs() < tolerance, "{found} is not {printed}");
}

#[test]
fn the_errors_of_ghost_walls_are_those_of_the_matrices() {
    for (flow, rows, printed) in GHOSTS {
        let error = |alignment| {
            let of = (flow, rows, 1.0);
            let model = model::<QuinticSpline>(of, WallRule::Ghosts, alignment, Sums::Pairs);
            match flow {
                // Viscous number 0.4 of the default step.
                Flow::Couette => error_of_leapfrog(flow, &model, 0.4 / (rows * rows) as f64),
                Flow::Poiseuille => error_at(flow, &model, 1.0),
            }
        };
        let [a, b] = ALIGNMENTS.map(error);
        assert_near(a.min(b), printed[0], 1e-3);
        assert_near(a.max(b), printed[1], 1e-3);
    }
    // With 40 rows and more the bound of `stiff` is the goal of 0.1 %.
    let of = (Flow::Couette, 40, 1.0);
    let model = model::<QuinticSpline>(of, WallRule::Ghosts, Alignment::Aligned, Sums::Pairs);
    assert!(error_at(Flow::Couette, &model, 0.1) < 8e-4);
}

#[test]
fn the_errors_of_sums_that_are_exact_for_linear_fields_are_those_of_the_matrices() {
    for (flow, rows, printed) in CONSISTENT {
        let error = |alignment| {
            let of = (flow, rows, 1.0);
            let (walls, sums) = (WallRule::CurvedGhosts, Sums::Consistent);
            let model = model::<QuinticSpline>(of, walls, alignment, sums);
            error_of_leapfrog(flow, &model, 0.4 / (rows * rows) as f64)
        };
        let [a, b] = ALIGNMENTS.map(error);
        assert_near(a.min(b), printed[0], 1e-3);
        assert_near(a.max(b), printed[1], 1e-3);
    }
}

/// The length of which the bounds of orders with interface walls make use.
#[test]
fn fluid_slips_along_interface_particles_by_a_twenty_fifth_of_a_spacing() {
    let channel = Channel {
        rows: 40,
        width: 40.0,
        nu: 1.0,
        wall_velocity: [0.0, 40.0],
        force: 0.0,
        wall_rule: WallRule::InterfaceWall,
        alignment: Alignment::Aligned,
        sums: Sums::Pairs,
    };
    let rows = channel.reduce::<QuinticSpline>(1.0, 1e-6).expect("rows");
    let u = rows.steady().expect("a steady state");
    let slope = u[20] - u[19];
    assert!((20.0 / slope - 20.0 - 0.039).abs() < 1e-3, "{slope}");
}
