//! A method: a scheme of the solver without its type, so that the code of a case is compiled only once for
//! all schemes.
//!
//! The type parameters of a scheme determine its terms and walls; [`FromMedium`] and [`Boundary`] construct
//! their values from the parameters in a [`Medium`]. Only [`Method::of`] is compiled for each scheme.

mod mutate;
mod terms;
#[cfg(test)]
mod tests;

use std::ops::Deref;

use base::mutation::{Constant, Disorder, Mutation};
use maths::theory::{Stepping, lattice::SquareLattice, time_step};
use nalgebra::Vector2;
use solver::{
    Domain, Integrator as _, Kernel, Numbers, Particle, PlaneWall, Role, Scene, SceneError, Scheme,
    Smoothing, Stepper, Tait, Term, scene::Setting, walls::Walls as _,
};

pub use crate::medium::{Knob, Medium};
use crate::{context::Context, limits::Limits, outline::Sink};
pub use mutate::mutate;
pub use terms::{Boundary, FirstRow, FromMedium};

/// A scheme whose terms and walls can be constructed from a medium.
pub trait Standard:
    Scheme<Forces: FromMedium, Drift: FromMedium, Walls: Boundary, Integrator: Stepping>
{
}

impl<S> Standard for S where
    S: Scheme<Forces: FromMedium, Drift: FromMedium, Walls: Boundary, Integrator: Stepping>
{
}

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
    pub limits: solver::Limits,
    /// Threads inside the run.
    pub threads: usize,
    /// A deliberate error.
    pub mutation: Option<Mutation>,
    /// A small disorder of the start.
    pub disorder: Option<Disorder>,
    /// Where these parts are told, if another code wants to know them.
    pub outline: Option<Sink>,
}

impl<X: Numbers> Parts<X> {
    /// Parts without walls, with the usual skin and limits and the threads of a context; of another code's
    /// run with its particles.
    pub fn new(
        medium: Medium,
        domain: Domain,
        particles: Vec<Particle<X>>,
        context: &Context,
    ) -> Self {
        Self {
            medium,
            domain,
            particles: match context.playback {
                Some(playback) => playback.particles(particles),
                None => particles,
            },
            mirrors: Vec::new(),
            surface: Vec::new(),
            bodies: Vec::new(),
            skin: None,
            limits: solver::Limits::default(),
            threads: context.threads,
            mutation: context.spec.mutation,
            disorder: context.spec.disorder,
            outline: context.outline.clone(),
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

/// What no scheme needs to know: parts with their errors and their disorder.
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

/// A scheme without its type: its properties, to which it dereferences, and how it is built. `D` is what a
/// case needs of a simulation beyond [`Stepper`].
pub struct Method<X = (), D: ?Sized = dyn Stepper<X>> {
    /// What is known of it.
    pub properties: Properties,
    /// The simulation of a scene with these parts.
    pub build: fn(Parts<X>) -> Result<Box<D>, SceneError>,
}

impl<X, D: ?Sized> Deref for Method<X, D> {
    type Target = Properties;

    fn deref(&self) -> &Properties {
        &self.properties
    }
}

/// What is known of a method before anything is built.
#[derive(Clone, Debug)]
pub struct Properties {
    /// Name of the kernel.
    pub kernel: &'static str,
    /// Name of the integrator.
    pub integrator: &'static str,
    /// Name of the walls.
    pub walls: &'static str,
    /// Where the first row of boundary particles lies.
    pub first_row: FirstRow,
    /// Do its walls read [`Parts::surface`]?
    pub has_feet: bool,
    /// The stored energy as an equation, of a method whose forces derive from one.
    pub law: Option<&'static str>,
    /// Support radius \[h\].
    pub support: f64,
    /// The theory of its time step.
    pub theory: time_step::Integrator,
    /// The largest stable step in a medium at rest \[s\], of a method whose waves are not those of terms.
    pub limit: Option<fn(&Medium) -> f64>,
    /// The settings that only its terms and walls read.
    pub uses: Vec<Knob>,
    /// W from h and r².
    weight: fn(f64, f64) -> f64,
    /// The square lattice as its kernel sees it, from h/dx and η²/h².
    lattice: fn(f64, f64) -> SquareLattice,
    /// Are gradients corrected by the inverse of the moments?
    pub is_corrected: bool,
}

impl Properties {
    /// Those of a scheme.
    pub fn of<S: Standard>() -> Self {
        let mut uses = Vec::new();
        S::Forces::uses(&mut uses);
        S::Drift::uses(&mut uses);
        uses.extend(S::Walls::USES);
        Self {
            kernel: S::Kernel::NAME,
            integrator: S::Integrator::NAME,
            walls: S::Walls::NAME,
            first_row: S::Walls::FIRST_ROW,
            has_feet: S::Walls::FEET,
            law: None,
            support: S::Kernel::SUPPORT,
            theory: S::Integrator::THEORY,
            limit: None,
            uses,
            weight: |h, r2| Smoothing::<S::Kernel>::new(h).w(r2),
            lattice: SquareLattice::of::<S::Kernel>,
            is_corrected: S::Forces::NORMALISES,
        }
    }

    /// A medium with this equation of state, spacing \[m\] and smoothing length \[m\], and nothing else.
    pub fn medium(&self, eos: Tait, [dx, h]: [f64; 2]) -> Medium {
        Medium {
            eos,
            density: eos.density,
            sound_speed: eos.sound_speed,
            dx,
            h,
            w_at_spacing: (self.weight)(h, dx * dx),
            stiffest: self.square([h / dx, 0.0]).stiffest(),
            nu: 0.0,
            shear_modulus: 0.0,
            acceleration: Vector2::zeros(),
            wall_acceleration: Vector2::zeros(),
            eta2_over_h2: 0.0,
            alpha: 0.0,
            beta: 0.0,
            xsph: 0.0,
            xi: 0.0,
            exponent: 1,
            diffusion: 0.0,
            shift: 0.0,
        }
    }

    /// The square lattice with these h/dx and η²/h², as its forces see it.
    pub fn square(&self, [h_over_dx, eta2_over_h2]: [f64; 2]) -> SquareLattice {
        let lattice = (self.lattice)(h_over_dx, eta2_over_h2);
        if self.is_corrected { lattice.corrected() } else { lattice }
    }

    /// The limits of a step by the waves of a periodic square lattice of n × n particles with these h/dx and
    /// η²/h².
    pub fn limits(&self, lattice: [f64; 2], n: usize, medium: &time_step::Medium) -> Limits {
        Limits::of(&time_step::modes(&self.square(lattice), n, medium), self.theory)
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
