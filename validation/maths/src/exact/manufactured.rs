//! A manufactured flow between two walls: steady, by a force that depends on the place.
//!
//! u = U (½ sin 2πy cos 2πx, sin² πy sin 2πx), p = 2 ρνU/L sin⁴ πy cos² 2πx between the walls y = 0 and
//! y = L, with x and y in units of L.
//!
//! u is 0 at the walls and has no divergence; p is constant along streamlines and has no gradient at the
//! walls. So the flow satisfies the equations of a weakly compressible fluid with any sound speed, with the
//! force f = (u·∇)u + ∇p/ρ − ν∇²u and no source of mass.

use std::f64::consts::{PI, TAU};
use touchstone_base::functions::{cos, sin};

use nalgebra::Vector2;

/// u \[U\].
pub fn velocity(x: Vector2<f64>) -> Vector2<f64> {
    let ([s, c], [sx, cx]) = waves(x);
    Vector2::new(s * c * cx, s * s * sx)
}

/// p \[ρνU/L\].
pub fn pressure(x: Vector2<f64>) -> f64 {
    let ([s, _], [_, cx]) = waves(x);
    2.0 * s.powi(4) * cx * cx
}

/// (u·∇)u \[U²/L\].
pub fn advection(x: Vector2<f64>) -> Vector2<f64> {
    let ([s, c], [sx, cx]) = waves(x);
    Vector2::new(-sx * cx, 2.0 * s * c) * (PI * s * s)
}

/// ∇p/ρ − ν∇²u \[νU/L²\].
pub fn viscous(x: Vector2<f64>) -> Vector2<f64> {
    let ([s, c], [sx, cx]) = waves(x);
    let pressure = Vector2::new(-s * sx * cx, c * cx * cx) * (8.0 * PI * s.powi(3));
    let laplacian = Vector2::new(-4.0 * s * c * cx, (1.0 - 4.0 * s * s) * sx);
    pressure - laplacian * (2.0 * PI * PI)
}

/// Sine and cosine of πy and of 2πx.
fn waves(x: Vector2<f64>) -> ([f64; 2], [f64; 2]) {
    let ([y, x], both) = ([PI * x.y, TAU * x.x], |angle| [sin(angle), cos(angle)]);
    (both(y), both(x))
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: [[f64; 2]; 4] = [[0.11, 0.23], [0.5, 0.9], [1.2, 0.05], [0.3, 0.0]];
    const E: f64 = 2e-3;

    /// Value, gradient and Laplacian by central differences of fourth order.
    fn differences(f: &dyn Fn(Vector2<f64>) -> f64, x: Vector2<f64>) -> (Vector2<f64>, f64) {
        let (mut gradient, mut laplacian) = (Vector2::zeros(), 0.0);
        for (k, axis) in [Vector2::x(), Vector2::y()].into_iter().enumerate() {
            let at = |by: f64| f(x + axis * by);
            gradient[k] = (8.0 * (at(E) - at(-E)) - at(2.0 * E) + at(-2.0 * E)) / (12.0 * E);
            let sum = 16.0 * (at(E) + at(-E)) - at(2.0 * E) - at(-2.0 * E) - 30.0 * at(0.0);
            laplacian += sum / (12.0 * E * E);
        }
        (gradient, laplacian)
    }

    /// ∇·u = 0, u·∇p = 0, and the two parts of the force.
    #[test]
    fn it_satisfies_the_equations_with_its_force() {
        for x in AT.map(Vector2::from) {
            let parts = [0, 1].map(|k| differences(&|x| velocity(x)[k], x));
            let (pressure, u) = (differences(&super::pressure, x).0, velocity(x));
            let divergence = parts[0].0.x + parts[1].0.y;
            assert!(divergence.abs() < 1e-7 && u.dot(&pressure).abs() < 1e-6);
            for (k, (gradient, laplacian)) in parts.into_iter().enumerate() {
                let advection = u.dot(&gradient) - super::advection(x)[k];
                let viscous = pressure[k] - laplacian - super::viscous(x)[k];
                assert!(
                    advection.abs() < 1e-7 && viscous.abs() < 1e-5,
                    "{advection:e} {viscous:e}"
                );
            }
        }
    }

    #[test]
    fn it_sticks_to_the_walls_and_does_not_push_them() {
        for x in [0.0, 0.3, 0.77] {
            for y in [0.0, 1.0] {
                let at = Vector2::new(x, y);
                assert!(velocity(at).norm() < 1e-15);
                assert!(differences(&pressure, at).0.norm() < 1e-9);
            }
        }
    }
}
