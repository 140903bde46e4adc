//! Common parts of clamped plates.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use touchstone_solver::PlaneWall;

use super::SolidScales;

/// k L of the first mode of a cantilever: cos kL cosh kL = −1.
pub const FIRST_MODE: f64 = 1.875_104_068_711_961;

/// 2π/ω of a thin plate of this length and thickness \[m\], Young's modulus \[Pa\], Poisson's ratio and
/// density \[kg/m³\], with ω² = E H² k⁴/(12 ρ (1 − ν²)) (Landau & Lifshitz) \[s\].
pub fn thin_plate_period(
    [length, thickness]: [f64; 2],
    [young, poisson, density]: [f64; 3],
) -> f64 {
    let k = FIRST_MODE / length;
    let stiffness = young * thickness * thickness / (12.0 * (1.0 - poisson * poisson));
    TAU / (k * k * (stiffness / density).sqrt())
}

/// Scales of a plate of `n` layers, of this length and thickness \[m\].
pub fn of_layers(n: usize, [length, thickness]: [f64; 2]) -> SolidScales {
    let (dx, decisive) = (thickness / n as f64, "end, dt, n, length or thickness");
    SolidScales { dx, length, count: length / dx * n as f64, decisive, ..SolidScales::default() }
}

/// The plane at x = 0 that holds a plate without held particles.
pub fn clamp() -> PlaneWall {
    PlaneWall::new(Vector2::zeros(), Vector2::x(), Vector2::zeros())
}
