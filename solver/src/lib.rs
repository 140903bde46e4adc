//! A compact engine for weakly compressible SPH in two dimensions, composed at compile time.
//!
//! The model is that of a paper on fluids and elastic solids by SPH; equation numbers in
//! parentheses are the paper's. SI units throughout, per unit depth where a mass or volume is meant.
//!
//! | Symbol | Meaning |
//! |---|---|
//! | i, j | a particle and its neighbour |
//! | rᵢⱼ = rᵢ − rⱼ, vᵢⱼ = vᵢ − vⱼ, dᵢⱼ = \|rᵢⱼ\| | differences of place \[m\] and velocity \[m/s\] |
//! | W, F = −W'/r | kernel \[1/m²\] and its gradient factor \[1/m⁴\]: ∇ᵢWᵢⱼ = −F rᵢⱼ |
//! | h, η², ⁰r | smoothing length \[m\], guard against 0/0 \[m²\], initial spacing \[m\] |
//! | m, ρ, V = m/ρ, p, c | mass, density, volume, pressure, sound speed |
//! | σ = −p δ + S, μ | stress and its deviator \[Pa\], shear modulus \[Pa\] |
//!
//! Reading order: [`kernel`] and [`lane`] (numbers of the pair loop), [`terms`] (the equations),
//! [`scene`] (what a simulation starts from), [`integrator`], then [`simulation`]. The row loop is in
//! `sweep.rs`; `engine.rs` is the right-hand side that integrators see.
//!
//! The crate does no I/O, knows no reference and cannot fail after [`Scene::build`], except by
//! divergence, which is a value: [`Outcome::Diverged`].

pub mod domain;
pub mod engine;
pub mod eos;
pub mod integrator;
pub mod kernel;
pub mod lane;
mod neighbours;
pub mod numbers;
mod parallel;
pub mod particles;
pub mod scene;
pub mod simulation;
pub mod sweep;
pub mod terms;
pub mod walls;
#[cfg(target_arch = "x86_64")]
mod ymm;

pub use domain::Domain;
pub use engine::{Engine, Fault, Limits};
pub use eos::{EquationOfState, Linear, Tait};
pub use integrator::{Euler, Integrator, Leapfrog, PredictorCorrector};
pub use kernel::{CubicSpline, Kernel, QuinticSpline, Smoothing, WendlandC2};
pub use numbers::{Numbers, Symmetric};
pub use particles::{Evolved, Particle, Rate, Role};
pub use scene::{Compose, Scene, SceneError, Scheme, lattice};
pub use simulation::{Checkpoint, Divergence, Flow, Observer, Outcome, Simulation, Work};
pub use terms::{
    ArtificialStress, ArtificialViscosity, BodyForce, CauchyStress, ComponentStress,
    ConsistentContinuity, ConsistentPressure, ConsistentViscosity, Continuity, DensityDiffusion,
    Hydrostatic, JaumannRate, Pressure, PrincipalStress, ShiftAdvection, Shifting, Term, Viscosity,
    Xsph,
};
pub use walls::{ExtrapolatingWall, Ghosts, InterfaceWall, NoSlip, Open, PlaneWall, SlipGhosts};
