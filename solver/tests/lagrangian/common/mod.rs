//! Solids for tests.
#![allow(dead_code)] // each test uses some of it

use nalgebra::Vector2;
use touchstone_solver::lagrangian::{Hencky, Law, Load, Moduli, Solid, SolidScene};
use touchstone_solver::{
    DivergenceBounds, Domain, Open, Particle, Stepper, Symmetric, WendlandC2, walls::Walls,
};

pub const MODULI: Moduli = Moduli { bulk: 2.0, shear: 0.7 };
pub const DENSITY: f64 = 1.3;

/// The k-th of numbers in [-1/2, 1/2) without order.
pub fn number(k: usize) -> f64 {
    (k as f64 * 0.618_033_988_749_895).fract() - 0.5
}

/// Particles of a block, displaced from a lattice by up to this share of the spacing, with volumes to match.
pub fn block(columns: usize, rows: usize, disorder: f64) -> Vec<Particle<Symmetric>> {
    let at = |(k, x): (usize, Vector2<f64>)| {
        let shift = Vector2::new(number(3 * k + 1), number(5 * k + 2)) * (2.0 * disorder);
        let volume = 1.0 + 0.4 * disorder * number(7 * k + 3);
        Particle::fluid(x + shift, Vector2::zeros(), DENSITY, volume)
    };
    touchstone_solver::lattice(Vector2::repeat(0.5), 1.0, columns, rows)
        .enumerate()
        .map(at)
        .collect()
}

/// A scene of these particles with the kernel's h in spacings.
pub fn scene<W, C>(particles: Vec<Particle<Symmetric>>, walls: W, loads: C) -> SolidScene<W, C> {
    SolidScene {
        h: 1.2,
        domain: Domain::open(),
        particles,
        bodies: Vec::new(),
        walls,
        moduli: MODULI,
        hourglass: 1.0,
        loads,
        limits: DivergenceBounds::default(),
        parallel_from: usize::MAX,
    }
}

pub type Block<L = Hencky, C = ()> = Solid<WendlandC2, L, C>;

pub fn build<L: Law, W: Walls<Symmetric>, C: Load>(scene: SolidScene<W, C>) -> Block<L, C> {
    scene.build::<WendlandC2, L>().expect("a scene")
}

/// A free block with the law `L`.
pub fn free<L: Law>(particles: Vec<Particle<Symmetric>>) -> Block<L> {
    build(scene(particles, Open, ()))
}

/// Puts the particles at these places, by their numbers in the scene, with these velocities.
pub fn put<L: Law, C: Load>(
    solid: &mut Block<L, C>,
    place: impl Fn(usize, Vector2<f64>) -> Vector2<f64>,
    velocity: impl Fn(usize) -> Vector2<f64>,
) {
    let mut state = solid.checkpoint();
    for (id, particle) in &mut state.particles {
        particle.position = place(*id as usize, particle.position);
        particle.velocity = velocity(*id as usize);
    }
    solid.restore(&state).expect("the same particles");
}

/// Mass, position, velocity and force.
pub type StoredState = (f64, Vector2<f64>, Vector2<f64>, Vector2<f64>);

/// For all particles in the order of storage.
pub fn forces<L: Law, C: Load>(solid: &Block<L, C>) -> Vec<StoredState> {
    let rates = solid.total_rates();
    let all = solid.data().fluid().zip(&rates);
    all.map(|((m, e), r)| (m, e.position, e.velocity, r.velocity * m)).collect()
}

/// The energy that the forces derive from.
pub fn stored<L: Law, C: Load>(solid: &Block<L, C>) -> f64 {
    let all = solid.potential().expect("forces derive from it");
    all.compression + all.shear + all.hourglass + all.loads
}

/// The whole energy.
pub fn energy<L: Law, C: Load>(solid: &Block<L, C>) -> f64 {
    let kinetic =
        |(m, e): (f64, &touchstone_solver::State<Symmetric>)| 0.5 * m * e.velocity.norm_squared();
    stored(solid) + solid.data().fluid().map(kinetic).fold(0.0, |sum, one| sum + one)
}
