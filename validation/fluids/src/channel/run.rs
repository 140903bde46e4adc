//! One run of a channel flow: stepping, record.

use base::record::{self, Record};
use harness::{
    case::{Rules, RunError},
    composed::Program,
    context::Context,
    method::Method,
    runner::Drive,
    simulate,
};
use solver::{EquationOfState, Observer};

use super::{
    ChannelSettings, Flow, Setup,
    measure::{self, Sample, Series},
};

/// Runs of the flow that a plate drives.
pub const COUETTE: Program<ChannelSettings, Method> = Program {
    run: |method, variant, s, context| run(Flow::Couette, method, variant, s, context),
    rules: |method, s| rules(Flow::Couette, method, s),
};

/// Runs of the flow that a body force drives.
pub const POISEUILLE: Program<ChannelSettings, Method> = Program {
    run: |method, variant, s, context| run(Flow::Poiseuille, method, variant, s, context),
    rules: |method, s| rules(Flow::Poiseuille, method, s),
};

fn rules(flow: Flow, method: &Method, settings: &ChannelSettings) -> Result<Rules, RunError> {
    Ok(Setup::new(flow, settings, method, &Context::of_rules())?.rules)
}

fn run(
    flow: Flow,
    method: &Method,
    variant: &str,
    settings: &ChannelSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let setup = &Setup::new(flow, settings, method, context)?;
    let mut simulation = (method.build)(setup.parts(method, context))?;
    let (settings, eos) = (&setup.settings, setup.medium.eos);
    let name = (setup.flow.name(), variant);
    let mut record = simulate::begin(name, settings, method, &numbers(setup), context);
    record.numerics.insert("columns".into(), setup.columns.into());
    let compared = settings.compared();
    let times: Vec<f64> = compared.iter().map(|tau| setup.time(*tau)).collect();
    let mut series = Series::new(setup, &*simulation);
    let pressure = |density| eos.pressure(density);
    let mut seen = (&mut series, &mut record);
    let (status, cost) = Drive::new(&mut *simulation, setup.dt(), &times, &pressure, &mut seen)
        .at_least(settings.least_steps)
        .sweeps(setup.rules.sweeps())
        .after_step("series", &|(series, _), simulation| series.after_step(simulation))
        .at("profiles and errors", &|(_, record), simulation, k| {
            measure::compare(setup, &Sample::of(setup, simulation), compared[k], record);
        })
        .run(context)?;
    (record.status, record.cost) = (status, cost);
    if record.status == record::Status::Completed {
        measure::at_the_end(setup, &Sample::of(setup, &*simulation), &mut record);
    }
    let mode = series.mode_until(simulation.time());
    record.profiles.extend(mode.map(|mode| (measure::MODE.into(), mode)));
    record.profiles.insert("series".into(), series.into_profile());
    record.state = Some(simulate::state(&simulation.particles()));
    Ok(record)
}

/// What the run chose.
fn numbers(setup: &Setup) -> Vec<(&'static str, f64)> {
    let (s, medium) = (&setup.settings, &setup.medium);
    let c0 = medium.eos.sound_speed;
    let own = [("V [m/s]", setup.v), ("c0/V", c0 / setup.v), ("c0 h/nu", c0 * medium.h / s.nu)];
    [&setup.rules.numbers([s.h_over_dx, medium.dx])[..], &own].concat()
}
