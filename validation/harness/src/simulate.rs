//! The plain way from a scene to a record: build, step to the end, state what it took.

use base::{
    record::{Record, digest},
    settings::Settings,
};
use solver::{Particle, Scene, Scheme, Simulation};

use crate::{context::Context, error::RunError, runner::drive};

/// Steps a scene to `end` \[s\] by `dt` \[s\] and begins its record: settings, how it ended, what it took,
/// and the digest of places, velocities and densities. The case puts its metrics. `pressure` \[Pa\] of a
/// density \[kg/m³\] is what frames show.
///
/// # Errors
/// If the scene is none, or a frame cannot be written.
pub fn simulate<S: Scheme>(
    (case, variant): (&str, &str),
    settings: &impl Settings,
    mut scene: Scene<S>,
    [dt, end]: [f64; 2],
    pressure: &dyn Fn(f64) -> f64,
    context: &Context,
) -> Result<(Simulation<S>, Record), RunError> {
    if context.threads <= 1 {
        scene.parallel_from = usize::MAX;
    }
    let mut simulation = scene.build()?;
    let json = serde_json::to_value(settings).unwrap_or_default();
    let mut record = Record::new(case, variant, json, context.threads.max(1));
    let (status, cost) =
        drive(&mut simulation, dt, &[end], context, &mut (), pressure, &mut |_, _| {})?;
    record.state = Some(state(&simulation.particles()));
    (record.status, record.cost) = (status, cost);
    Ok((simulation, record))
}

/// Digest of places, velocities and densities, in the order of the scene.
pub fn state<X>(particles: &[Particle<X>]) -> String {
    let numbers =
        |p: &Particle<X>| [p.position.x, p.position.y, p.velocity.x, p.velocity.y, p.density];
    digest(&particles.iter().flat_map(numbers).collect::<Vec<f64>>())
}
