//! Code that schemes share, counted in the symbols of this test's program, which runs one physics with three
//! integrators, and with one of these two more kinds of walls.

#[cfg(all(target_os = "linux", target_pointer_width = "64", target_endian = "little"))]
mod symbols;

use std::any::TypeId;

use nalgebra::Vector2;
use touchstone_solver::{
    Compose, Continuity, CubicSpline, Domain, Euler, Ghosts, InterfaceWall, Leapfrog, Open,
    Outcome, Particle, PlaneWall, PredictorCorrector, Pressure, Role, Scene, Scheme, Stepper, Tait,
    integrator::PhysicsOf, lattice, walls::Walls,
};

type Method<W, I> = Compose<CubicSpline, Pressure<Tait>, Continuity, W, I>;

/// Two steps of a few particles, some of them behind a wall.
fn run<W: Walls<()>, I>(walls: W) -> Vec<Particle>
where
    Method<W, I>: Scheme<Forces = Pressure<Tait>, Drift = Continuity, Walls = W, Extra = ()>,
{
    let (dx, n) = (0.1, 8);
    let particle = |place: Vector2<f64>| {
        let particle = Particle::fluid(place, Vector2::new(0.1, 0.0), 1.0, dx * dx);
        particle.with_role(if place.y < 0.2 { Role::Wall } else { Role::Fluid })
    };
    let particles = lattice(Vector2::repeat(0.05), dx, n, n).map(particle).collect();
    let (pressure, domain) = (Pressure::new(Tait::new(1.1, 1.0)), Domain::channel(0.8));
    let scene =
        Scene::<Method<W, I>>::new(1.2 * dx, domain, particles, pressure, Continuity, walls);
    let mut simulation = scene.build().expect("a scene");
    assert_eq!(simulation.advance(0.02, 0.01, &mut ()), Outcome::Reached);
    simulation.particles()
}

/// Density \[kg/m³\] of the first wall particle.
fn wall_density(particles: &[Particle]) -> f64 {
    particles.iter().find(|p| p.role == Role::Wall).expect("a wall particle").density
}

#[test]
fn schemes_share_what_does_not_depend_on_their_integrator_and_walls() {
    let mirror = PlaneWall::new(Vector2::zeros(), Vector2::y(), Vector2::zeros());
    let mirrored = Ghosts { walls: vec![mirror] };
    let physics = [
        TypeId::of::<PhysicsOf<Method<Open, Leapfrog>>>(),
        TypeId::of::<PhysicsOf<Method<Open, Euler>>>(),
    ];
    assert_eq!(physics[0], physics[1], "one type, whatever the integrator, and so one engine");
    for still in [
        run::<_, Leapfrog>(Open),
        run::<_, Euler>(Open),
        run::<_, PredictorCorrector>(Open),
        run::<_, Leapfrog>(mirrored),
    ] {
        assert_eq!(wall_density(&still), 1.0, "no terms of their own, no change");
    }
    assert_ne!(wall_density(&run::<_, Leapfrog>(InterfaceWall)), 1.0);
    #[cfg(all(target_os = "linux", target_pointer_width = "64", target_endian = "little"))]
    {
        // The search of neighbours; the sweeps of forces, of drift and of both, for all schemes; and the
        // wall sweep of the one wall whose particles have terms of their own.
        assert_eq!(symbols::held("on_widest"), 1 + 3 + 1, "hot loops");
    }
}
