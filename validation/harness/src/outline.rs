//! The problem of a run as data, for other codes: what its scene and its drive are made of before the first
//! step. A run whose context asks for it is built and not stepped, or makes a few steps as another observer
//! sees them.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use base::record::Profile;
use solver::{Domain, Numbers, PlaneWall, Role, Stepper};

use crate::{
    error::RunError,
    frames,
    medium::Medium,
    relation::{NoSymmetry, Relation, View},
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
    /// All particles at the start, in the order of the scene: the columns of [`frames::columns`] and `mass`.
    pub particles: Profile,
    /// The times at which it is measured \[s\].
    pub times: Vec<f64>,
    /// Time step that our method takes \[s\].
    pub dt: f64,
    /// What our own method is.
    pub method: MethodWords,
    /// How it is seen.
    pub view: View,
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
    /// Does it shift particles in proportion to the largest speed of the scene?
    pub shifts: bool,
}

/// Steps of ours after which a relation is compared: early, before the motion amplifies round-off. Strong
/// shifting in vortices does by 1.8 a step from the twelfth on, and after 28 steps by more than any floor.
const COMPARED: [usize; 3] = [4, 8, 16];

/// Where the outline of a run is put; clones share it.
#[derive(Clone, Debug, Default)]
pub struct Sink {
    relation: Option<Relation>,
    /// Is the run stepped?
    steps: bool,
    inside: Arc<Mutex<Inside>>,
}

#[derive(Debug, Default)]
struct Inside {
    outline: Option<Outline>,
    method: MethodWords,
    refused: Option<NoSymmetry>,
}

impl Sink {
    /// The problem as seen by a relation, at a few early times; a run that is `stepped` reaches these, and
    /// measures nothing.
    pub fn of(relation: Option<Relation>, stepped: bool) -> Self {
        Self { relation, steps: stepped, inside: Arc::default() }
    }

    /// Puts what a scene is made of, and tells how it is seen; its particles come with its drive. Of a run of
    /// several simulations the first one counts.
    pub fn scene(
        &self,
        medium: &Medium,
        domain: Domain,
        (mirrors, bodies): (&[PlaneWall], &[u32]),
        moves: &[bool],
    ) -> View {
        let mut inside = self.inside();
        let of = |relation| View::of(relation, medium, &domain, mirrors, moves);
        let view = of(self.relation.unwrap_or(Relation::Same)).unwrap_or_else(|reason| {
            inside.refused = Some(reason);
            View::default()
        });
        inside.outline.get_or_insert_with(|| Outline {
            medium: view.medium(medium),
            domain: view.domain(domain),
            mirrors: mirrors.iter().map(|wall| view.wall(wall)).collect(),
            bodies: view.order(bodies, moves),
            particles: Profile::default(),
            times: Vec::new(),
            dt: 0.0,
            method: MethodWords::default(),
            view,
        });
        view
    }

    /// What a run under a relation is driven by, as the observer sees it: its step \[s\], and times at which
    /// it is compared \[s\].
    ///
    /// # Errors
    /// If the relation is no symmetry of the scene.
    pub fn early(&self, dt: f64) -> Result<Option<(f64, Vec<f64>)>, RunError> {
        let (Some(relation), inside) = (self.relation, self.inside()) else { return Ok(None) };
        let Some(Outline { view, medium, .. }) = &inside.outline else {
            let reason = "the case does not tell what its scene is made of";
            return Err(RunError::NoSymmetry { relation, reason });
        };
        let shifts = inside.method.shifts && medium.shift > 0.0 && self.steps;
        let reason = match relation {
            Relation::Boosted if shifts => {
                Some("its shifting takes the largest speed of the scene")
            }
            _ => inside.refused,
        };
        if let Some(reason) = reason {
            return Err(RunError::NoSymmetry { relation, reason });
        }
        let dt = view.time(dt);
        Ok(Some((dt, COMPARED.map(|steps| steps as f64 * dt).to_vec())))
    }

    /// How the scene is seen.
    pub fn view(&self) -> View {
        self.inside().outline.as_ref().map_or_else(View::default, |outline| outline.view)
    }

    /// Is the run stepped, though its outline is asked for?
    pub fn steps(&self) -> bool {
        self.steps
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
            let view = outline.view;
            let pressure = |density| view.pressure_of(pressure, density);
            outline.particles = frames::columns(&particles, &pressure).with("mass", "kg/m", mass);
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
        self.inside.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The number that stands for a role in files.
pub fn role(number: f64) -> Option<Role> {
    [Role::Fluid, Role::Wall, Role::Interface].into_iter().find(|r| f64::from(*r as u8) == number)
}
