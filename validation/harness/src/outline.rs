//! The problem of a run as data, for other codes: what its scene and its drive are made of before the first
//! step. A run whose context asks for it is built and not stepped.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use base::record::Profile;
use solver::{Domain, Numbers, Particle, PlaneWall, Role, Stepper};

use crate::{
    frames,
    method::{Medium, Parts},
};

/// What a scene and its drive are made of.
#[derive(Clone, Debug)]
pub struct Outline {
    /// The parameters of the material.
    pub medium: Medium,
    /// Periodic or open.
    pub domain: Domain,
    /// Planes that bound the material; empty if particles do.
    pub mirrors: Vec<PlaneWall>,
    /// The body of each particle; empty if there is one.
    pub bodies: Vec<u32>,
    /// Density \[kg/m³\] and speed \[m/s\] beyond which a run of ours counts as diverged.
    pub limits: solver::Limits,
    /// All particles at the start, in the order of the scene: the columns of [`frames::columns`] and `mass`.
    pub particles: Profile,
    /// The times at which it is measured \[s\].
    pub times: Vec<f64>,
    /// Time step that our method takes \[s\].
    pub dt: f64,
    /// Kernel, integrator and walls of the method by name, and the support radius of the kernel \[h\].
    pub method: ([&'static str; 3], f64),
}

/// Where the outline of a run is put; clones share it.
#[derive(Clone, Debug, Default)]
pub struct Sink(Arc<Mutex<Inside>>);

#[derive(Debug, Default)]
struct Inside {
    outline: Option<Outline>,
    method: ([&'static str; 3], f64),
}

impl Sink {
    /// Puts what a scene is made of, with its particles.
    pub fn scene<X: Numbers>(&self, parts: &Parts<X>) {
        let Parts { medium, domain, mirrors, bodies, limits, particles, .. } = parts;
        let outline = Outline {
            medium: *medium,
            domain: *domain,
            // Walls of particles need no planes.
            mirrors: if particles.iter().all(|p| p.role == Role::Fluid) {
                mirrors.clone()
            } else {
                Vec::new()
            },
            bodies: bodies.clone(),
            limits: *limits,
            particles: columns(particles, &|_| 0.0),
            times: Vec::new(),
            dt: 0.0,
            method: Default::default(),
        };
        // Of a run of several simulations the first one counts.
        self.inside().outline.get_or_insert(outline);
    }

    /// Adds what the drive of the scene is made of.
    pub fn drive<X: Numbers>(
        &self,
        simulation: &(impl Stepper<X> + ?Sized),
        times: &[f64],
        dt: f64,
        pressure: &dyn Fn(f64) -> f64,
    ) {
        let mut inside = self.inside();
        let first = inside.outline.as_mut().filter(|outline| outline.times.is_empty());
        if let Some(outline) = first {
            outline.particles = columns(&simulation.particles(), pressure);
            (outline.times, outline.dt) = (times.to_vec(), dt);
        }
    }

    /// The outline, if the run got so far.
    pub fn take(&self) -> Option<Outline> {
        let mut inside = self.inside();
        let method = inside.method;
        inside.outline.take().map(|outline| Outline { method, ..outline })
    }

    /// Adds the names of kernel, integrator and walls, and the support radius of the kernel \[h\].
    pub fn method(&self, names: [&'static str; 3], support: f64) {
        self.inside().method = (names, support);
    }

    fn inside(&self) -> MutexGuard<'_, Inside> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn columns<X: Numbers>(particles: &[Particle<X>], pressure: &dyn Fn(f64) -> f64) -> Profile {
    let mass = particles.iter().map(|p| p.mass).collect();
    frames::columns(particles, pressure).with("mass", "kg/m", mass)
}

/// The number that stands for a role in files.
pub fn role(number: f64) -> Option<Role> {
    [Role::Fluid, Role::Wall, Role::Interface].into_iter().find(|r| f64::from(*r as u8) == number)
}
