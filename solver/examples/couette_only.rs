//! The solver as a library: start-up Couette flow between two plates until it is steady, then its
//! distance from the straight line.
//!
//! `cargo run --release -p touchstone-solver --example couette_only`
//!
//! The program contains the code of `Couette` and of no other term, wall or integrator.

use std::error::Error;

use nalgebra::Vector2;
use touchstone_solver::{
    Compose, Continuity, Domain, Ghosts, Leapfrog, Outcome, Particle, PlaneWall, Pressure,
    QuinticSpline, Scene, Stepper, Tait, Viscosity, lattice,
};

/// Kernel, forces, drift, walls, integrator.
type Couette = Compose<QuinticSpline, (Pressure<Tait>, Viscosity), Continuity, Ghosts, Leapfrog>;

/// Runs the flow and prints its distance from the straight line.
fn main() -> Result<(), Box<dyn Error>> {
    // Water between plates 1 mm apart, the upper one moving; SI units.
    let (width, speed, nu, rho) = (1e-3, 1e-4, 1e-6, 1000.0);
    let (rows, columns) = (20, 7);
    let dx = width / rows as f64;
    let h = dx;
    let c0 = 2.2 * nu / h;

    let particles: Vec<Particle> = lattice(Vector2::repeat(0.5 * dx), dx, columns, rows)
        .map(|place| Particle::fluid(place, Vector2::zeros(), rho, dx * dx))
        .collect();
    let lower = PlaneWall::new(Vector2::zeros(), Vector2::y(), Vector2::zeros());
    let upper = PlaneWall::new(Vector2::y() * width, -Vector2::y(), Vector2::x() * speed);
    let forces =
        (Pressure::new(Tait::new(rho, c0)), Viscosity { mu: rho * nu, eta2: 1e-6 * h * h });
    let domain = Domain::channel(columns as f64 * dx);
    let walls = Ghosts { walls: vec![lower, upper] };
    let mut flow =
        Scene::<Couette>::new(h, domain, particles, forces, Continuity, walls).build()?;

    let (end, dt) = (2.0 * width * width / nu, 0.4 * h * h / nu);
    if let Outcome::Diverged(divergence) = flow.advance(end, dt, &mut ()) {
        return Err(divergence.into());
    }
    let error =
        |(_, p): (f64, &touchstone_solver::State<()>)| p.velocity.x / speed - p.position.y / width;
    let largest = flow.data().fluid().map(error).fold(0.0, |a: f64, e| a.max(e.abs()));
    println!("{} particles, {} steps", flow.data().fluid_count(), flow.work().steps);
    println!("largest error {largest:.1e} of the speed of the plate");
    println!("{} bytes a particle", flow.bytes() / flow.data().fluid_count());
    Ok(())
}

#[cfg(test)]
#[path = "../tests/couette_only.rs"]
mod tests;
