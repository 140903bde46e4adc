//! Taylor-Green vortices: a periodic array of vortices that decays without changing its shape.

use std::f64::consts::TAU;
use touchstone_base::functions::{cos, exp, sin};

use nalgebra::Vector2;

/// u = −cos kx sin ky e^{−2νk²t}, v = sin kx cos ky e^{−2νk²t}, p = −¼ (cos 2kx + cos 2ky) e^{−4νk²t},
/// k = 2π, in units of the largest speed at the start U, the period L and the density ρ: exact for
/// incompressible flow.
#[derive(Clone, Copy, Debug)]
pub struct TaylorGreen {
    /// Kinematic viscosity ν \[UL\].
    pub nu: f64,
}

impl TaylorGreen {
    /// e^{−2νk²t}.
    pub fn decay(&self, t: f64) -> f64 {
        exp(-2.0 * self.nu * TAU * TAU * t)
    }

    /// Velocity at a place \[L\] and time \[L/U\], in units of U.
    pub fn velocity(&self, place: Vector2<f64>, t: f64) -> Vector2<f64> {
        let (x, y) = (place.x * TAU, place.y * TAU);
        Vector2::new(-cos(x) * sin(y), sin(x) * cos(y)) * self.decay(t)
    }

    /// Pressure, of mean 0 \[ρU²\].
    pub fn pressure(&self, place: Vector2<f64>, t: f64) -> f64 {
        let k = 2.0 * TAU;
        -0.25 * self.decay(t).powi(2) * (cos(k * place.x) + cos(k * place.y))
    }

    /// Kinetic energy of one period per unit depth \[ρU²L²\].
    pub fn kinetic_energy(&self, t: f64) -> f64 {
        0.25 * self.decay(t).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOW: TaylorGreen = TaylorGreen { nu: 0.011 };

    /// ∂v/∂t + v·∇v + ∇p/ρ − ν∇²v = 0 and ∇·v = 0, by central differences of fourth order.
    #[test]
    fn it_satisfies_the_equations_of_navier_and_stokes() {
        let (e, t) = (1e-3, 0.4);
        let shift = |axis: usize, by: f64| {
            let mut by_axis = Vector2::zeros();
            by_axis[axis] = by;
            by_axis
        };
        for place in [Vector2::new(0.11, 0.23), Vector2::new(0.5, 0.9), Vector2::new(1.2, 0.05)] {
            let v = FLOW.velocity(place, t);
            let slope = |f: &dyn Fn(f64) -> f64| {
                (8.0 * (f(e) - f(-e)) - (f(2.0 * e) - f(-2.0 * e))) / (12.0 * e)
            };
            let mut divergence = 0.0;
            for component in 0..2 {
                let at = |x: Vector2<f64>, t: f64| FLOW.velocity(x, t)[component];
                let change = slope(&|d| at(place, t + d));
                let (mut carried, mut laplacian) = (0.0, 0.0);
                for axis in 0..2 {
                    let along = |d: f64| at(place + shift(axis, d), t);
                    let gradient = slope(&along);
                    carried += v[axis] * gradient;
                    divergence += if axis == component { gradient } else { 0.0 };
                    laplacian += (16.0 * (along(e) + along(-e))
                        - (along(2.0 * e) + along(-2.0 * e))
                        - 30.0 * along(0.0))
                        / (12.0 * e * e);
                }
                let push = slope(&|d| FLOW.pressure(place + shift(component, d), t));
                let rest = change + carried + push - FLOW.nu * laplacian;
                assert!(rest.abs() < 1e-8, "{rest:e}");
            }
            assert!(divergence.abs() < 1e-9);
        }
    }

    #[test]
    fn its_energy_is_the_integral_and_falls_twice_as_fast() {
        let n = 40;
        let cell = 1.0 / f64::from(n);
        let mut sum = 0.0;
        for i in 0..n {
            for j in 0..n {
                let place = Vector2::new(f64::from(i), f64::from(j)) * cell;
                sum += 0.5 * FLOW.velocity(place, 0.3).norm_squared() * cell * cell;
            }
        }
        assert!((sum / FLOW.kinetic_energy(0.3) - 1.0).abs() < 1e-12);
        let ratio = FLOW.kinetic_energy(0.3) / FLOW.kinetic_energy(0.0);
        assert!((ratio / FLOW.decay(0.3).powi(2) - 1.0).abs() < 1e-12);
    }
}
