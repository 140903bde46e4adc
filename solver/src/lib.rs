//! A compact solver for weakly compressible SPH in two dimensions, composed at compile time.
//!
//! The model is from a paper on fluids and elastic solids by SPH; numbers in parentheses are equations of
//! this paper. All quantities are in SI units; masses and volumes are per unit depth.
//!
//! | Symbol | Meaning |
//! |---|---|
//! | i, j | a particle and its neighbour |
//! | rᵢⱼ = rᵢ − rⱼ, vᵢⱼ = vᵢ − vⱼ, dᵢⱼ = \|rᵢⱼ\| | differences of position \[m\] and velocity \[m/s\] |
//! | W, F = −W'/r | kernel \[1/m²\] and its gradient factor \[1/m⁴\]: ∇ᵢWᵢⱼ = −F rᵢⱼ |
//! | h, η², ⁰r | smoothing length \[m\], guard against 0/0 \[m²\], initial spacing \[m\] |
//! | m, ρ, V = m/ρ, p, c | mass, density, volume, pressure, sound speed |
//! | σ = −p δ + S, μ | stress and its deviator \[Pa\], shear modulus \[Pa\] |
//!
//! Reading order: [`kernel`] and [`lane`] (number types of the pair sweep), [`terms`] (the equations),
//! [`physics`] (terms, kernel and walls as one type), [`scene`] (the initial state),
//! [`integrator`], then [`simulation`]. `sweep.rs` contains the pair sweep, `engine.rs` the right-hand side
//! that integrators evaluate. [`lagrangian`] contains total Lagrangian solids; no other module imports it.
//! Imports between modules go in one direction:
//!
//! ```text
//! lane, numbers, inverse, kernel, eos, domain <- particles <- terms <- walls <- neighbours
//!     <- physics, sweep, particle_data <- engine <- integrator <- simulation <- scene <- lagrangian
//! ```
//!
//! The crate does no I/O and contains no reference data. After [`Scene::build`] it returns no error; a
//! divergence is the regular result [`Outcome::Diverged`].

pub mod domain;
mod engine;
pub mod eos;
pub mod integrator;
pub mod inverse;
pub mod kernel;
pub mod lagrangian;
pub mod lane;
mod neighbours;
pub mod numbers;
pub mod parallel;
mod particle_data;
pub mod particles;
pub mod physics;
#[cfg(test)]
mod random;
pub mod scene;
pub mod simulation;
mod sweep;
pub mod terms;
pub mod walls;

pub use domain::Domain;
pub use engine::Engine;
pub use eos::{EquationOfState, Linear, Tait};
pub use integrator::{
    Euler, ForwardKick, Integrator, Leapfrog, Memory, PredictorCorrector, Scheme, SingleSweep,
    SuperSteps,
};
pub use kernel::{CubicSpline, Kernel, QuinticSpline, Smoothing, WendlandC2};
pub use neighbours::GROUP;
pub use numbers::{In, Numbers, Symmetric};
pub use particle_data::{
    Checkpoint, DivergenceBounds, Interval, InvalidState, ParticleData, Phase, PhaseWatch,
    PreviousStep, Progress, Work,
};
pub use particles::{Particle, Rate, Role, State};
pub use physics::{Compose, Physics};
pub use scene::{Scene, SceneError, lattice};
pub use simulation::{Divergence, Observer, Outcome, Potential, Simulation, Stepper};
pub use terms::*;
pub use walls::*;
