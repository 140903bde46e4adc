//! Errors that channel flows have by their row-reduced matrices, which bounds are made from. The matrices are
//! in `tests/src/row_matrix.rs`, and tests compute the errors again.

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
