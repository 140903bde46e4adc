//! Fields of one wave of the unit square, on which operators are tried: φ = sin Kx cos Ky and ψ = cos Kx sin
//! Ky, K = 2π.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use touchstone_base::functions::{cos, sin};

/// Wave number along each axis \[1/m\].
pub const K: f64 = TAU;
/// Amplitude of the pressure 10⁻⁶ φ \[ρ₀c₀²\]: linear in the equation of state, up to round-off.
pub const PRESSURE: f64 = 1e-6;
/// Amplitude of the velocity 0.1 (φ, ψ) \[c₀\].
pub const SPEED: f64 = 0.1;

/// φ \[-\] at a place \[m\].
pub fn scalar(x: Vector2<f64>) -> f64 {
    sin(K * x.x) * cos(K * x.y)
}

/// (φ, ψ) \[-\]; ∇²(φ, ψ) = −2K² (φ, ψ).
pub fn vector(x: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(scalar(x), cos(K * x.x) * sin(K * x.y))
}

/// ∇φ/K \[-\].
pub fn slope(x: Vector2<f64>) -> Vector2<f64> {
    let [x, y] = [K * x.x, K * x.y];
    Vector2::new(cos(x) * cos(y), -sin(x) * sin(y))
}
