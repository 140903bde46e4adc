//! The solver as a library: two small rubber rings that collide head-on and part.
//!
//! `cargo run --release -p touchstone-solver --example rings_only`
//!
//! The program contains the code of `Rubber` only: no wall, no exponent of an equation of state, no viscosity
//! of a fluid. Nothing is periodic, so no column is an image.

use std::{error::Error, f64::consts::TAU};

use nalgebra::Vector2;
use touchstone_solver::{
    ArtificialViscosity, CauchyStress, Compose, Continuity, CubicSpline, Domain, JaumannRate,
    Leapfrog, Linear, Open, Outcome, Particle, PrincipalStress, Scene, Smoothing, Stepper,
    Symmetric, Xsph,
};

/// Kernel, forces, drift, walls, integrator, extra fields.
type Rubber = Compose<
    CubicSpline,
    (CauchyStress<Linear, PrincipalStress>, ArtificialViscosity<Linear>),
    (Continuity, JaumannRate, Xsph),
    Open,
    Leapfrog,
    Symmetric,
>;

/// Collides the rings and prints how fast they part.
fn main() -> Result<(), Box<dyn Error>> {
    // Units of length, density and bulk sound speed; the paper's rubber.
    let (radius, layers, dx, speed) = (3.0, 3, 1.0 / 3.0, 0.059);
    let (h, mu) = (1.5 * dx, 0.22);
    let mut particles: Vec<Particle<Symmetric>> = Vec::new();
    for side in [-1.0, 1.0] {
        for r in (0..layers).map(|k| radius + (f64::from(k) + 0.5) * dx) {
            let count = (TAU * r / dx).round();
            #[allow(clippy::disallowed_methods, reason = "an example without digests")]
            let turn = |k: f64| Vector2::new((TAU * k / count).cos(), (TAU * k / count).sin()) * r;
            let centre = Vector2::new(5.0 * side, 0.0);
            let velocity = Vector2::new(-speed * side, 0.0);
            let volume = TAU * r * dx / count;
            let place = |k: u32| centre + turn(f64::from(k) + 0.5);
            let ring = (0..count as u32).map(|k| Particle::fluid(place(k), velocity, 1.0, volume));
            particles.extend(ring);
        }
    }
    let half = particles.len() / 2;

    let eos = Linear { density: 1.0, sound_speed: 1.0 };
    let tensile = PrincipalStress::new(0.3, 4, Smoothing::<CubicSpline>::new(h).w(dx * dx));
    let forces = (CauchyStress { eos, tensile }, ArtificialViscosity::new(1.0, 2.0, h, eos));
    let drift = (Continuity, JaumannRate { shear_modulus: mu }, Xsph { epsilon: 0.5 });
    let mut rings =
        Scene::<Rubber>::new(h, Domain::open(), particles, forces, drift, Open).build()?;

    let dt = 0.4 * h / ((1.0 + 4.0 / 3.0 * mu).sqrt() + speed);
    if let Outcome::Diverged(divergence) = rings.advance(200.0, dt, &mut ()) {
        return Err(divergence.to_string().into());
    }
    let after = rings.particles();
    let (momentum, mass) = after[half..].iter().fold((0.0, 0.0), |(p, m), particle| {
        (p + particle.mass * particle.velocity.x, m + particle.mass)
    });
    assert_eq!(rings.columns().len(), after.len(), "nothing is periodic and nothing is mirrored");
    println!("{} particles, {} steps", after.len(), rings.work().steps);
    println!("the rings part at {:.2} of their speed", momentum / mass / speed);
    println!("{} bytes a particle", rings.bytes() / after.len());
    Ok(())
}

#[cfg(test)]
#[path = "../tests/rings_only.rs"]
mod tests;
