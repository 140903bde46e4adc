//! One run of a channel flow: stepping, record.

use base::record::{Record, Status};
use harness::{case::*, context::Context, method::*, runner::Drive, simulate};
use solver::{Flow as Going, Particle, Role};

use super::measure::{self, MODE};
use super::{ChannelSettings, Flow, Setup};

/// One run of a flow.
pub fn run(
    flow: Flow,
    method: &Method,
    settings: &ChannelSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let setup = &Setup::new(flow, settings, method, context)?;
    let mut simulation = (method.build)(setup.parts(method, context))?;
    let (s, Medium { eos, h, dx, .. }) = (&setup.settings, setup.medium);
    let c0 = eos.sound_speed;
    let own = [("V [m/s]", setup.v), ("c0/V", c0 / setup.v), ("c0 h/nu", c0 * h / s.nu)];
    let numbers = [&setup.rules.numbers([s.h_over_dx, dx])[..], &own].concat();
    let mut record = simulate::begin(method, &numbers, context);
    record.numerics.insert("columns".into(), setup.columns.into());
    let compared = s.compared();
    let times: Vec<f64> = compared.iter().map(|tau| setup.time(*tau)).collect();
    let mut mode: Vec<[f64; 2]> = Vec::new();
    let fluid = |mut all: Vec<Particle>| {
        all.retain(|p| p.role == Role::Fluid);
        all
    };
    let mut seen = (&mut mode, &mut record);
    Drive::new(&mut *simulation, setup.rules.dt(), &times, eos, &mut seen)
        .steps(s.least_steps, setup.rules.sweeps())
        .after_step_if(s.watch_mode, "pressure mode", &|(mode, _), simulation| {
            mode.push([simulation.time(), measure::pressure_mode(setup, simulation)]);
            Going::Continue
        })
        .at("profiles and errors", &|(_, record), simulation, k| {
            measure::compare(setup, &fluid(simulation.particles()), compared[k], record);
        })
        .run(context)?
        .put(&mut record);
    let all = simulation.particles();
    if record.status == Status::Completed {
        measure::at_the_end(setup, &fluid(all), &mut record);
    }
    if s.watch_mode {
        let last = measure::last_of_mode(setup, &mode, simulation.time());
        record.profiles.extend(last.map(|last| (MODE.into(), last)));
    }
    Ok(record)
}
