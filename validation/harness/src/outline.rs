//! The scene of a run as data, for other codes: its particles, walls, medium and times before the first step.

use touchstone_base::record::Profile;
use touchstone_solver::{Domain, PlaneWall, Role};

use crate::{medium::Medium, method::properties::Properties, relation::View};

/// The scene of a run before its first step.
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
    /// All particles at the start, in the order of the scene: the columns of [`crate::frames::columns`].
    pub particles: Profile,
    /// The times at which it is measured \[s\].
    pub times: Vec<f64>,
    /// Time step that our method takes \[s\].
    pub dt: f64,
    /// The frame of the outline.
    pub view: View,
    /// The method of our run.
    pub method: Properties,
}

/// The role of a number in files.
pub fn role(number: f64) -> Option<Role> {
    [Role::Fluid, Role::Wall, Role::Interface].into_iter().find(|r| f64::from(*r as u8) == number)
}
