//! Total Lagrangian solids, which have no scheme.

use std::collections::BTreeMap;
use std::sync::Mutex;

use nalgebra::Vector2;
use touchstone_base::lock;
use touchstone_harness::method::{Medium, Parts, Properties, mutate};
use touchstone_harness::size::Storage;
use touchstone_maths::theory::bending;
use touchstone_maths::theory::lagrangian::{HOURGLASS, fastest_of_block};
use touchstone_solver::lagrangian::{
    BetweenFaces, Hencky, Law, Moduli, SaintVenantKirchhoff, SolidScene, Weight, contact_stiffness,
};
use touchstone_solver::{
    Compose, DivergenceBounds, Ghosts, Leapfrog, Particle, Role, SceneError, Stepper, Symmetric,
    WendlandC2, scene::PARALLEL_FROM,
};

use crate::methods;

type Method = crate::Method<Symmetric>;

/// h/dx: with a support of two spacings a particle has eight neighbours, the fewest that include all
/// neighbours along both axes and diagonals. Gradients at free surfaces are one-sided, and their error grows
/// with the support.
pub const H_OVER_DX: f64 = 1.0;

/// Densities over that without stress beyond which a run has diverged. Energy grows without bound as a body
/// is compressed, so that no compression is wrong; but the frequencies of compressed matter grow as its
/// density, and at five times the density no usual step is stable.
const DENSITIES: [f64; 2] = [0.2, 5.0];

/// Memory \[bytes\]: of a neighbour its number, its weight and two products, and lists while they are made.
const STORAGE: Storage = Storage { particle: 600.0, neighbour: 33.0 };

/// The parts of the method by name.
type Named = Compose<WendlandC2, (), (), Ghosts, Leapfrog, Symmetric>;

methods! { bodies => Method:
    /// Bodies with the stored energy of Hencky.
    hencky: Hencky;
    /// Bodies with the stored energy of Saint Venant and Kirchhoff.
    saint_venant_kirchhoff: SaintVenantKirchhoff;
}

/// A simulation, or why there is none.
type Built = Result<Box<dyn Stepper<Symmetric>>, SceneError>;

/// The method with the stored energy `L`: of one body with the weight of its medium, if that has any, or of
/// several without weight and with contact between them. Particles of the scene that are held are left out:
/// the planes of its parts hold the body instead.
fn bodies<L: Law>() -> Method {
    fn build<L: Law>(mut parts: Parts<Symmetric>) -> Built {
        mutate(&mut parts);
        let (weight, moduli) = (parts.medium.acceleration, moduli(&parts.medium));
        if !parts.bodies.is_empty() {
            let contact = BetweenFaces::new(contact_stiffness(&moduli));
            return Ok(Box::new(scene(parts, contact).build::<WendlandC2, L>()?));
        }
        if weight != Vector2::zeros() {
            return Ok(Box::new(scene(parts, Weight(weight)).build::<WendlandC2, L>()?));
        }
        Ok(Box::new(scene(parts, ()).build::<WendlandC2, L>()?))
    }
    let mut properties = Properties::of::<Named>();
    (properties.integrator, properties.walls) = ("velocity Verlet", "planes that hold");
    properties.law = Some(L::ENERGY);
    properties.limit = Some(step_limit);
    properties.storage = STORAGE;
    properties.uses.clear();
    properties.terms = vec![
        "sums over the neighbours of the configuration without stress; ∂x/∂X exact for linear fields; forces \
         are the derivative of Σ V w by the places",
    ];
    Method { properties, build: build::<L> }
}

/// The bending stiffness of a plate of these layers over the stiffness of an elastic plate, with the support
/// and hourglass modulus of the method: below 1, because the gradient at a face is the gradient a little
/// inside.
pub fn bending(layers: usize, poisson: f64) -> f64 {
    bending::stiffness::<WendlandC2>(H_OVER_DX, layers, poisson)
}

fn scene<C>(parts: Parts<Symmetric>, loads: C) -> SolidScene<Ghosts, C> {
    let Parts { medium, domain, particles, mirrors, bodies, limits, threads, .. } = parts;
    let without_stress = |p: Particle<Symmetric>| Particle {
        density: medium.density,
        extra: Symmetric::default(),
        ..p
    };
    let free = particles.into_iter().filter(|p| p.role == Role::Fluid).map(without_stress);
    SolidScene {
        h: medium.h,
        domain,
        particles: free.collect(),
        bodies,
        walls: Ghosts { walls: mirrors },
        moduli: moduli(&medium),
        hourglass: HOURGLASS,
        loads,
        limits: DivergenceBounds {
            density: DENSITIES.map(|ratio| ratio * medium.density),
            ..limits
        },
        parallel_from: if threads > 1 { PARALLEL_FROM } else { usize::MAX },
    }
}

fn moduli(medium: &Medium) -> Moduli {
    let bulk = medium.density * medium.sound_speed * medium.sound_speed;
    Moduli { bulk, shear: medium.shear_modulus }
}

/// The largest stable step of a body with faces and corners, without stress and without contact \[s\]: with
/// Poisson's ratio 0.4 about 1.05 dx/c_p. Waves inside would allow 1.4 times as much.
fn step_limit(medium: &Medium) -> f64 {
    let moduli = moduli(medium);
    let stiffness = stiffness(medium.h / medium.dx, &moduli);
    2.0 * medium.dx * (medium.density / stiffness).sqrt()
}

/// [`fastest_of_block`] for h/dx and moduli \[Pa\], cached: it takes as long as hundreds of steps of a small
/// body, and runs of many settings need equal values.
fn stiffness(h_over_dx: f64, moduli: &Moduli) -> f64 {
    static FOUND: Mutex<BTreeMap<[u64; 3], f64>> = Mutex::new(BTreeMap::new());
    let key = [h_over_dx, moduli.bulk, moduli.shear].map(f64::to_bits);
    if let Some(known) = lock(&FOUND).get(&key) {
        return *known;
    }
    let stiffness = fastest_of_block::<WendlandC2>(h_over_dx, moduli);
    lock(&FOUND).insert(key, stiffness);
    stiffness
}

/// The time-step limit of bodies that press against each other with this pressure \[Pa\], from the limit of
/// the compressed lattice \[s\].
pub fn limit_in_contact(lattice: f64, medium: &Medium, pressure: f64) -> f64 {
    let contact = BetweenFaces::new(contact_stiffness(&moduli(medium)));
    contact.step_limit(lattice, medium.density, medium.dx, pressure)
}

/// Displaces the particles from their reference.
pub fn displace(
    simulation: &mut dyn Stepper<Symmetric>,
    by: impl Fn(Vector2<f64>) -> Vector2<f64>,
) {
    let mut start = simulation.checkpoint();
    for (_, particle) in &mut start.particles {
        particle.position += by(particle.position);
    }
    let _is_of_the_same_scene = simulation.restore(&start);
}
