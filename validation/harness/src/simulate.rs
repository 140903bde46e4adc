//! From a scene to a record, for cases without further needs: build, step to the end, record the cost.

use base::{
    number,
    record::{Record, digest},
    settings::Settings,
};
use solver::{EquationOfState as _, Numbers, Particle, Stepper};

use crate::{
    context::Context,
    error::RunError,
    method::{Method, Parts},
    rules::Rules,
    runner::drive,
};

/// Name of the kernel among what a run chose.
pub const KERNEL: &str = "kernel";
/// Name of the integrator.
pub const INTEGRATOR: &str = "integrator";
/// Name of the walls.
pub const WALLS: &str = "walls";

/// A record with the settings of a run and what its rules chose: numbers by name, a kernel, an integrator,
/// walls.
pub fn begin<X, D: ?Sized>(
    (case, variant): (&str, &str),
    settings: &impl Settings,
    method: &Method<X, D>,
    numbers: &[(&str, f64)],
    context: &Context,
) -> Record {
    let json = serde_json::to_value(settings).unwrap_or_default();
    let mut record = Record::new(case, variant, json, context.threads.max(1));
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
    Rules { dt, dt_limit: limit, .. }: Rules,
    context: &Context,
) -> Result<(), RunError> {
    if dt > limit && !context.allow_unstable {
        return Err(RunError::TimeStep { dt, limit, integrator });
    }
    Ok(())
}

/// Refuses a step as [`check_step`] does, and more steps to the end
/// \[s\] or more particles than anyone waits for: `most` of each, and the settings that decide on them.
///
/// # Errors
/// What is too large, by how much, and which settings to change.
pub fn check(
    integrator: &'static str,
    rules: Rules,
    end: f64,
    particles: f64,
    most: [(f64, &'static str); 2],
    context: &Context,
) -> Result<(), RunError> {
    check_step(integrator, rules, context)?;
    let steps = end / rules.dt;
    let counts = [("the number of time steps", steps), ("the number of particles", particles)];
    match counts.into_iter().zip(most).find(|((_, value), (most, _))| value > most) {
        Some(((what, value), (most, setting))) => {
            Err(RunError::TooMuch { what, value, most, setting })
        }
        None => Ok(()),
    }
}

/// Steps a scene to `end` \[s\] by `dt` \[s\] and completes its record: how it ended, what it took, and the
/// digest of its state. The case puts its metrics.
///
/// # Errors
/// If the scene is refused, or a frame cannot be written.
pub fn simulate<X: Numbers>(
    method: &Method<X>,
    parts: Parts<X>,
    [dt, end]: [f64; 2],
    context: &Context,
    record: &mut Record,
) -> Result<Box<dyn Stepper<X>>, RunError> {
    let eos = parts.medium.eos;
    let mut simulation = (method.build)(parts)?;
    let pressure = |density| eos.pressure(density);
    (record.status, record.cost) =
        drive(&mut *simulation, dt, &[end], context, &mut (), &pressure, &mut |_, _| {})?;
    record.state = Some(state(&simulation.particles()));
    Ok(simulation)
}

/// Digest of positions, velocities and densities, in the order of the scene.
pub fn state<X>(particles: &[Particle<X>]) -> String {
    let numbers =
        |p: &Particle<X>| [p.position.x, p.position.y, p.velocity.x, p.velocity.y, p.density];
    digest(&particles.iter().flat_map(numbers).collect::<Vec<f64>>())
}
