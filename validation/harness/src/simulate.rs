//! From a scene to a record, for cases without further needs: build, step to the end, record the cost.

use base::{number, record::Record};
use nalgebra::Vector2;
use solver::{Particle, Role, Stepper};

use crate::{
    context::Context,
    error::RunError,
    method::{Medium, Method, Parts, Properties},
    rules::Rules,
    runner::{Drive, check_size},
    size::Size,
};

/// Name of the kernel among what a run chose.
pub const KERNEL: &str = "kernel";
/// Name of the integrator.
pub const INTEGRATOR: &str = "integrator";
/// Name of the walls.
pub const WALLS: &str = "walls";

/// A record of the run of a context, with what its rules chose: numbers by name, a kernel, an integrator,
/// walls. It is begun before the first step: the outline of a run has its method from here.
pub fn begin(method: &Properties, numbers: &[(&str, f64)], context: &Context) -> Record {
    if let Some(outline) = &context.outline {
        outline.method(method.clone());
    }
    let mut record = Record::of(&context.spec, context.threads.max(1));
    let words = [(KERNEL, method.kernel), (INTEGRATOR, method.integrator), (WALLS, method.walls)];
    let numerics = &mut record.numerics;
    numerics.extend(numbers.iter().map(|(name, value)| (name.to_string(), number::json(*value))));
    numerics.extend(words.map(|(name, word)| (name.to_string(), word.into())));
    record
}

/// Refuses a step beyond its theoretical limit, unless the context allows it.
///
/// # Errors
/// The step, its limit, and the integrator.
pub fn check_step(
    integrator: &'static str,
    rules: &Rules,
    context: &Context,
) -> Result<(), RunError> {
    let (dt, limit) = (rules.dt(), rules.dt_limit());
    if dt > limit && !context.spec.allow_unstable {
        return Err(RunError::TimeStep { dt, limit, integrator });
    }
    Ok(())
}

/// The size of a run of so many steps and particles, before these are made.
pub fn size(method: &Properties, medium: &Medium, steps_and_particles: [f64; 2]) -> Size {
    Size::new(steps_and_particles, method.support * medium.h / medium.dx)
}

/// Refuses a step as [`check_step`] does, and a run with so many particles as
/// [`check_size`] does, before the particles are made. `settings` are those on which its size depends.
///
/// # Errors
/// What is too large, by how much, and which settings to change.
pub fn check(
    method: &Properties,
    medium: &Medium,
    rules: &Rules,
    particles: f64,
    settings: &'static str,
    context: &Context,
) -> Result<(), RunError> {
    check_step(method.integrator, rules, context)?;
    let size = size(method, medium, [rules.end / rules.dt(), particles]);
    check_size(Size { sweeps: rules.sweeps(), ..size }, settings, context)
}

/// Steps a scene to `end` \[s\] by `dt` \[s\] and completes its record: how it ended, what it took, and the
/// digest of its state. The case puts its metrics.
///
/// # Errors
/// If the scene is refused, or a frame cannot be written.
pub fn simulate(
    method: &Method,
    parts: Parts,
    [dt, end]: [f64; 2],
    context: &Context,
    record: &mut Record,
) -> Result<Box<dyn Stepper<()>>, RunError> {
    let eos = parts.medium.eos;
    let mut simulation = (method.build)(parts)?;
    Drive::new(&mut *simulation, dt, &[end], eos, &mut ()).run(context)?.put(record);
    Ok(simulation)
}

/// Total momentum of the fluid per unit depth \[kg/s\], summed in the order given.
pub fn momentum<X>(particles: &[Particle<X>]) -> Vector2<f64> {
    let fluid = particles.iter().filter(|p| p.role == Role::Fluid);
    fluid.fold(Vector2::zeros(), |sum, p| sum + p.velocity * p.mass)
}
