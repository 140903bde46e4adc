//! The problem of a run as data, for other codes: what its scene and its drive are made of before the first
//! step. A run whose context asks for it is built and not stepped.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use base::record::Profile;
use solver::{Domain, Numbers, PlaneWall, Role, Stepper};

use crate::{frames, medium::Medium};

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
    /// All particles at the start, in the order of the scene: the columns of [`frames::columns`] and `mass`.
    pub particles: Profile,
    /// The times at which it is measured \[s\].
    pub times: Vec<f64>,
    /// Time step that our method takes \[s\].
    pub dt: f64,
    /// What our own method is.
    pub method: MethodWords,
}

/// A method by the names of its parts.
#[derive(Clone, Copy, Debug, Default)]
pub struct MethodWords {
    /// Name of the kernel.
    pub kernel: &'static str,
    /// Support radius of the kernel \[h\].
    pub support: f64,
    /// Name of the integrator.
    pub integrator: &'static str,
    /// Name of the walls.
    pub walls: &'static str,
    /// The stored energy as an equation, of a method whose forces derive from one.
    pub law: Option<&'static str>,
}

/// Where the outline of a run is put; clones share it.
#[derive(Clone, Debug, Default)]
pub struct Sink(Arc<Mutex<Inside>>);

#[derive(Debug, Default)]
struct Inside {
    outline: Option<Outline>,
    method: MethodWords,
}

impl Sink {
    /// Puts what a scene is made of; its particles come with its drive. Of a run of several simulations the
    /// first one counts.
    pub fn scene(&self, medium: Medium, domain: Domain, mirrors: &[PlaneWall], bodies: &[u32]) {
        self.inside().outline.get_or_insert_with(|| Outline {
            medium,
            domain,
            mirrors: mirrors.into(),
            bodies: bodies.into(),
            particles: Profile::default(),
            times: Vec::new(),
            dt: 0.0,
            method: MethodWords::default(),
        });
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
            let particles = simulation.particles();
            let mass = particles.iter().map(|p| p.mass).collect();
            outline.particles = frames::columns(&particles, pressure).with("mass", "kg/m", mass);
            (outline.times, outline.dt) = (times.to_vec(), dt);
            // Walls of particles need no planes.
            if particles.iter().any(|p| p.role != Role::Fluid) {
                outline.mirrors.clear();
            }
        }
    }

    /// The outline, if the run got so far.
    pub fn take(&self) -> Option<Outline> {
        let mut inside = self.inside();
        let method = inside.method;
        inside.outline.take().map(|outline| Outline { method, ..outline })
    }

    /// Adds what the method is.
    pub fn method(&self, method: MethodWords) {
        self.inside().method = method;
    }

    fn inside(&self) -> MutexGuard<'_, Inside> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The number that stands for a role in files.
pub fn role(number: f64) -> Option<Role> {
    [Role::Fluid, Role::Wall, Role::Interface].into_iter().find(|r| f64::from(*r as u8) == number)
}
