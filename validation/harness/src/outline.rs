//! The problem of a run as data, for other codes: what its scene and its drive are made of before the first
//! step. A run whose context asks for it is built and not stepped, or makes a few steps that another observer
//! sees.

use std::sync::{Arc, Mutex};

use base::{
    lock,
    record::{Profile, Record},
};
use solver::{Domain, Numbers, PlaneWall, Role, Stepper};

use crate::{
    error::RunError,
    frames,
    medium::{Knob, Medium},
    method::properties::Properties,
    relation::{NoSymmetry, Relation, TIME, View},
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
    /// All particles at the start, in the order of the scene: the columns of [`frames::columns`].
    pub particles: Profile,
    /// The times at which it is measured \[s\].
    pub times: Vec<f64>,
    /// Time step that our method takes \[s\].
    pub dt: f64,
    /// How all of it is seen.
    pub view: View,
}

/// Steps of ours after which observers are compared: early, before the motion amplifies round-off. Strong
/// shifting in vortices does by 1.8 a step from the twelfth on, and after 28 steps by more than any floor.
const COMPARED: [usize; 3] = [4, 8, 16];

/// Where the outline of a run is put; clones share it.
#[derive(Clone, Debug, Default)]
pub struct Sink {
    inside: Arc<Mutex<Inside>>,
    /// By what an observer differs, if observers are compared.
    pub relation: Option<Relation>,
    /// Is the run stepped, though its outline is asked for?
    pub steps: bool,
}

#[derive(Debug, Default)]
struct Inside {
    outline: Option<Outline>,
    method: Option<Properties>,
    refused: Option<NoSymmetry>,
}

impl Sink {
    /// The problem that an observer sees, at a few early times; a run that is `stepped` reaches these and
    /// measures nothing.
    pub fn of(relation: Option<Relation>, stepped: bool) -> Self {
        Self { relation, steps: stepped, inside: Arc::default() }
    }

    /// The most steps that are made.
    pub(crate) fn most_steps(&self) -> f64 {
        if self.steps { COMPARED[COMPARED.len() - 1] as f64 } else { 0.0 }
    }

    /// How the scene is seen.
    pub fn view(&self) -> View {
        lock(&self.inside).outline.as_ref().map_or_else(View::default, |outline| outline.view)
    }

    /// Step \[s\] and times \[s\] of a run whose observers are compared.
    ///
    /// # Errors
    /// Why they cannot be.
    pub fn early(&self, dt: f64) -> Result<Option<(f64, Vec<f64>)>, RunError> {
        let (Some(relation), inside) = (self.relation, lock(&self.inside)) else { return Ok(None) };
        let shifts = inside.method.as_ref().is_some_and(|of| of.uses.contains(&Knob::Shift));
        let reason = match &inside.outline {
            None => Some("the case does not tell what its scene is made of"),
            Some(of)
                if relation == Relation::Boosted
                    && (self.steps && shifts && of.medium.shift > 0.0) =>
            {
                Some("its shifting takes the largest speed of the scene")
            }
            Some(_) => inside.refused,
        };
        let dt = dt * inside.outline.as_ref().map_or(1.0, |of| of.view.scale(TIME));
        match reason {
            Some(reason) => Err(RunError::NoSymmetry { relation, reason }),
            None => Ok(Some((dt, COMPARED.map(|steps| steps as f64 * dt).to_vec()))),
        }
    }

    /// Puts what a scene is made of; its particles come with its drive. Of a run of several simulations the
    /// first one counts.
    pub fn scene(
        &self,
        medium: Medium,
        domain: Domain,
        mirrors: &[PlaneWall],
        bodies: &[u32],
        view: Result<View, NoSymmetry>,
    ) {
        let mut inside = lock(&self.inside);
        inside.refused = view.err();
        inside.outline.get_or_insert_with(|| Outline {
            medium,
            domain,
            mirrors: mirrors.into(),
            bodies: bodies.into(),
            particles: Profile::default(),
            times: Vec::new(),
            dt: 0.0,
            view: view.unwrap_or_default(),
        });
    }

    /// Adds what the drive of the scene is made of.
    pub fn drive<X: Numbers>(
        &self,
        simulation: &dyn Stepper<X>,
        times: &[f64],
        dt: f64,
        pressure: &dyn Fn(f64) -> f64,
    ) {
        let mut inside = lock(&self.inside);
        let first = inside.outline.as_mut().filter(|outline| outline.times.is_empty());
        if let Some(outline) = first {
            let particles = simulation.particles();
            let view = outline.view;
            let pressure = |density| view.pressure_of(pressure, density);
            outline.particles = frames::columns(&particles, &pressure);
            (outline.times, outline.dt) = (times.to_vec(), dt);
            // Walls of particles need no planes.
            if particles.iter().any(|p| p.role != Role::Fluid) {
                outline.mirrors.clear();
            }
        }
    }

    /// The outline of a run of a case that ended so, and what our own method is.
    ///
    /// # Errors
    /// If the run was refused, or is none of a scene.
    pub fn of_run(
        &self,
        ended: Result<Record, RunError>,
        case: &str,
    ) -> Result<(Outline, Properties), RunError> {
        match ended {
            Err(RunError::Told) | Ok(_) => {}
            Err(error) => return Err(error),
        }
        let mut inside = lock(&self.inside);
        let method = inside.method.take();
        let outline = inside.outline.take().filter(|of| !of.times.is_empty());
        let none = || {
            RunError::Playback(format!(
                "case {case} has no scene to export, because its force depends on the place, which no format \
                 states"
            ))
        };
        outline.zip(method).ok_or_else(none)
    }

    /// Adds what the method is.
    pub fn method(&self, method: Properties) {
        lock(&self.inside).method = Some(method);
    }
}

/// The number that stands for a role in files.
pub fn role(number: f64) -> Option<Role> {
    [Role::Fluid, Role::Wall, Role::Interface].into_iter().find(|r| f64::from(*r as u8) == number)
}
