//! Errors that channel flows have by their row-reduced matrices ([`maths::theory::channel`]), which bounds
//! are made from. Tests compute them again.

use super::Flow;

/// Of ghost walls with the quintic spline, h = dx, at the time of the comparison: rows of a flow, the lesser
/// and the larger one of rows in columns and of rows that slid past each other, Couette flow with the steps
/// of the leapfrog.
pub const GHOSTS: [(Flow, usize, [f64; 2]); 5] = [
    (Flow::Couette, 10, [1.2712e-3, 1.5453e-3]),
    (Flow::Couette, 20, [3.8402e-4, 6.7664e-4]),
    (Flow::Poiseuille, 10, [1.712e-2, 1.794e-2]),
    (Flow::Poiseuille, 20, [3.744e-3, 4.540e-3]),
    (Flow::Poiseuille, 40, [5.064e-4, 1.196e-3]),
];

/// The same of 20 rows of Couette flow in columns, exact in time.
pub const IN_COLUMNS: f64 = 1.2618e-3;

/// Of walls that extrapolate, at νt/L² = 1: rows, and the errors of Couette and of Poiseuille flow.
pub const EXTRAPOLATED: [(usize, [f64; 2]); 4] = [
    (10, [4.2e-4, 1.87e-2]),
    (20, [1.9e-4, 4.6e-3]),
    (40, [8.9e-5, 8.9e-4]),
    (80, [4.3e-5, 4.0e-4]),
];

/// Of 20 rows of Couette flow at νt/L² = 0.1 with the steps of the leapfrog, the larger one of rows in
/// columns and of rows that slid past each other: h/dx, and the errors with the quintic spline and with
/// Wendland C2.
pub const SMOOTHED: [(f64, [f64; 2]); 9] = [
    (0.9, [7.5582e-4, 3.3900e-2]),
    (1.0, [6.1280e-4, 1.0793e-2]),
    (1.1, [8.2244e-4, 1.2646e-2]),
    (1.2, [9.0504e-4, 1.3791e-2]),
    (1.3, [5.2672e-4, 9.6362e-3]),
    (1.5, [8.3755e-4, 1.0717e-3]),
    (2.0, [1.2292e-3, 5.5003e-4]),
    (2.5, [1.9169e-3, 1.2247e-3]),
    (3.0, [3.0649e-3, 1.4993e-3]),
];

#[cfg(test)]
mod tests {
    use base::spec::RunSpec;
    use harness::case::{Case, Tier};
    use maths::{
        exact::{couette::Couette, poiseuille::Poiseuille},
        theory::channel::{Alignment, Channel as Section, RowModel, WallRule},
    };
    use nalgebra::DVector;
    use solver::{Kernel, QuinticSpline, WendlandC2};

    use super::*;
    use crate::{
        channel::{Channel, TIMES, plan, runs::For},
        couette::COUETTE as CASE,
    };

    const COUETTE: Couette = Couette { v0: 1.0, l: 1.0, nu: 1.0 };
    const POISEUILLE: Poiseuille = Poiseuille { v: 1.0, l: 1.0, nu: 1.0 };
    const ALIGNMENTS: [Alignment; 2] = [Alignment::Aligned, Alignment::Slid];

    fn model<K: Kernel>(
        (flow, rows, h_over_dx): (Flow, usize, f64),
        wall_rule: WallRule,
        alignment: Alignment,
    ) -> RowModel {
        let (wall_velocity, force) = match flow {
            Flow::Couette => ([0.0, 1.0], 0.0),
            Flow::Poiseuille => ([0.0; 2], POISEUILLE.force()),
        };
        let section =
            Section { rows, width: 1.0, nu: 1.0, wall_velocity, force, wall_rule, alignment };
        section.reduce::<K>(h_over_dx, 1e-6).expect("a wide channel")
    }

    /// Error at a νt/L², exact in time.
    fn error_at(flow: Flow, model: &RowModel, tau: f64) -> f64 {
        let u = model.at(tau).expect("regular");
        match flow {
            Flow::Couette => model.relative_error(&u, |y| COUETTE.velocity(y, tau)),
            Flow::Poiseuille => model.relative_error(&u, |y| POISEUILLE.velocity(y, tau)),
        }
    }

    /// Error of Couette flow at νt/L² = 0.1 with the steps of a leapfrog of at most `dt` \[L²/ν\], equal
    /// between the times at which a run pauses: half a kick first, whole ones, half a kick last.
    fn error_of_leapfrog(model: &RowModel, dt: f64) -> f64 {
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
        model.relative_error(&u, |y| COUETTE.velocity(y, 0.1))
    }

    fn assert_near(found: f64, printed: f64, tolerance: f64) {
        assert!((found / printed - 1.0).abs() < tolerance, "{found} is not {printed}");
    }

    #[test]
    fn the_errors_of_walls_that_extrapolate_are_those_of_the_matrix() {
        for (rows, printed) in EXTRAPOLATED {
            for (flow, printed) in [Flow::Couette, Flow::Poiseuille].into_iter().zip(printed) {
                let wall = WallRule::Adami;
                let model = model::<QuinticSpline>((flow, rows, 1.0), wall, Alignment::Aligned);
                assert_near(error_at(flow, &model, 1.0), printed, 0.02);
            }
        }
    }

    #[test]
    fn the_errors_of_ghost_walls_are_those_of_the_matrices() {
        for (flow, rows, printed) in GHOSTS {
            let error = |alignment| {
                let of = (flow, rows, 1.0);
                let model = model::<QuinticSpline>(of, WallRule::Ghosts, alignment);
                match flow {
                    // Viscous number 0.4 of the default step.
                    Flow::Couette => error_of_leapfrog(&model, 0.4 / (rows * rows) as f64),
                    Flow::Poiseuille => error_at(flow, &model, 1.0),
                }
            };
            let [a, b] = ALIGNMENTS.map(error);
            assert_near(a.min(b), printed[0], 1e-3);
            assert_near(a.max(b), printed[1], 1e-3);
        }
        let of = (Flow::Couette, 20, 1.0);
        let model = model::<QuinticSpline>(of, WallRule::Ghosts, Alignment::Aligned);
        let exact = error_at(Flow::Couette, &model, 0.1);
        assert_near(exact, IN_COLUMNS, 1e-4);
        assert!(IN_COLUMNS <= exact, "{exact}");
        // With 40 rows and more the bound of `stiff` is the goal of 0.1 %.
        let of = (Flow::Couette, 40, 1.0);
        let model = self::model::<QuinticSpline>(of, WallRule::Ghosts, Alignment::Aligned);
        assert!(error_at(Flow::Couette, &model, 0.1) < 8e-4);
    }

    /// The bounds of all smoothing lengths are made from these errors, with the steps of the runs.
    #[test]
    fn the_errors_of_smoothing_lengths_are_those_of_the_matrices() {
        let channel = Channel { flow: Flow::Couette, case: &CASE };
        let table = plan::table(channel, Tier::Full);
        let mut seen = 0;
        for row in table.of(For::Smoothing) {
            let spec: &RunSpec = &row.run.spec;
            let dt = CASE.rules(spec).expect("a run").dt();
            let ratio = row.settings.h_over_dx;
            let (k, model): (usize, fn(_, _, _) -> _) = match row.variant {
                "plain" => (0, model::<QuinticSpline>),
                _ => (1, model::<WendlandC2>),
            };
            let of = (Flow::Couette, 20, ratio);
            let error = |alignment| error_of_leapfrog(&model(of, WallRule::Ghosts, alignment), dt);
            let [a, b] = ALIGNMENTS.map(error);
            let (_, printed) = SMOOTHED.into_iter().find(|(of, _)| *of == ratio).expect("one");
            assert_near(a.max(b), printed[k], 1e-4);
            assert!(printed[k] <= a.max(b), "a bound that is rounded up is looser");
            seen += 1;
        }
        assert_eq!(seen, 2 * SMOOTHED.len());
    }
}
