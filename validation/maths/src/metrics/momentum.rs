//! Momentum of particles.

use nalgebra::Vector2;
use touchstone_solver::{Particle, Role};

/// Total momentum of the fluid per unit depth \[kg/s\], summed in the order given.
pub fn momentum<X>(particles: &[Particle<X>]) -> Vector2<f64> {
    let fluid = particles.iter().filter(|p| p.role == Role::Fluid);
    fluid.fold(Vector2::zeros(), |sum, p| sum + p.velocity * p.mass)
}
