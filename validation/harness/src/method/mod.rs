//! A method: a scheme of the solver without its type, so that the code of a case is compiled only once for
//! all schemes.
//!
//! The type parameters of a scheme determine its terms and walls; [`FromMedium`] and [`Boundary`] construct
//! their values from the parameters in a [`Medium`]. Only [`Method::of`] is compiled for each scheme.

mod mutate;
pub(crate) mod properties;
mod terms;
#[cfg(test)]
mod tests;

use nalgebra::Vector2;
use touchstone_base::mutation::{Constant, Disorder, Mutation};
use touchstone_solver::{
    Domain, Numbers, Particle, PlaneWall, Role, Scene, SceneError, Stepper, scene::Setting,
};

pub use crate::medium::{Medium, MediumSetting};
pub use mutate::mutate;
pub(crate) use mutate::see;
pub use properties::{Properties, Standard};
pub use terms::{Boundary, FirstRow, FromMedium};

/// The parts of a scene apart from the types of its scheme.
pub struct Parts<X = ()> {
    /// The parameters from which its terms and walls are constructed.
    pub medium: Medium,
    /// Periodic or open.
    pub domain: Domain,
    /// The particles; results keep their order.
    pub particles: Vec<Particle<X>>,
    /// Planes that mirror the fluid, if the walls are of mirror particles.
    pub mirrors: Vec<PlaneWall>,
    /// The point of the surface that is nearest to each particle, for walls that read it of wall particles
    /// ([`Setting::feet`]); else empty.
    pub surface: Vec<Vector2<f64>>,
    /// The number of the body of each particle, for methods of solids that keep bodies apart; empty if there
    /// is one body.
    pub bodies: Vec<u32>,
    /// Verlet skin \[m\], if not the usual one.
    pub skin: Option<f64>,
    /// Bounds beyond which the run counts as diverged.
    pub limits: touchstone_solver::DivergenceBounds,
    /// Threads inside the run, 1 for serial; 0 counts as 1.
    pub threads: usize,
    /// A deliberate error.
    pub mutation: Option<Mutation>,
    /// A small disorder of the start.
    pub disorder: Option<Disorder>,
}

impl<X: Numbers> Parts<X> {
    /// Parts without walls, with the usual skin and limits, for a serial run.
    pub fn new(medium: Medium, domain: Domain, particles: Vec<Particle<X>>) -> Self {
        Self {
            medium,
            domain,
            particles,
            mirrors: Vec::new(),
            surface: Vec::new(),
            bodies: Vec::new(),
            skin: None,
            limits: touchstone_solver::DivergenceBounds::default(),
            threads: 1,
            mutation: None,
            disorder: None,
        }
    }
}

/// The scene of a scheme with these parts.
pub fn scene<S: Standard>(parts: Parts<S::Extra>) -> Scene<S> {
    let (medium, mirrors, setting) = setting(parts);
    Scene {
        setting,
        forces: S::Forces::new(&medium),
        drift: S::Drift::new(&medium),
        walls: S::Walls::new(&medium, mirrors),
    }
}

/// The scheme-independent part: parts with deliberate errors and disorder.
fn setting<X: Numbers>(mut parts: Parts<X>) -> (Medium, Vec<PlaneWall>, Setting<X>) {
    mutate(&mut parts);
    let pairs = parts.particles.iter().zip(&parts.surface).filter(|(p, _)| p.role == Role::Wall);
    let feet = pairs.map(|(p, point)| point - p.position).collect();
    let Parts { medium, domain, particles, mirrors, skin, limits, threads, mutation, .. } = parts;
    let usual = Setting::new(medium.h, domain, particles);
    let skin_share =
        mutation.map_or(1.0, |m| m.factor_of(Constant::ListLifetime)) * usual.skin_share;
    let parallel_from = if threads <= 1 { usize::MAX } else { usual.parallel_from };
    let skin = skin.unwrap_or(usual.skin);
    (medium, mirrors, Setting { feet, skin, skin_share, limits, parallel_from, ..usual })
}

/// A scheme without its type: its properties and its constructor. `D` is the interface of its simulations,
/// [`Stepper`] or more.
pub struct Method<X = (), D: ?Sized = dyn Stepper<X>> {
    /// Properties.
    pub properties: Properties,
    /// The simulation of a scene with these parts.
    pub build: fn(Parts<X>) -> Result<Box<D>, SceneError>,
}

// Not derived, because a derived `Clone` would require clones of `X` and `D`.
impl<X, D: ?Sized> Clone for Method<X, D> {
    fn clone(&self) -> Self {
        Self { properties: self.properties.clone(), build: self.build }
    }
}

impl<X: Numbers, D: ?Sized> Method<X, D> {
    /// The method of a scheme; `build` is `|parts| Ok(Box::new(scene::<S>(parts).build()?))`.
    pub fn with<S: Standard<Extra = X>>(build: fn(Parts<X>) -> Result<Box<D>, SceneError>) -> Self {
        Self { properties: Properties::of::<S>(), build }
    }
}

impl<X: Numbers> Method<X> {
    /// The method of a scheme, for cases that need no more of a simulation than [`Stepper`].
    pub fn of<S: Standard<Extra = X>>() -> Self {
        Self::with::<S>(|parts| Ok(Box::new(scene::<S>(parts).build()?)))
    }
}
