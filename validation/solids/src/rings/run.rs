//! One run of the rings: scene, stepping, record.

use solver::{EquationOfState, Observer, Particle, Stepper, Symmetric};

use super::{
    RingMethod, RingSettings, Rings,
    budget::{self, Budget},
    measure::{self, Series},
    metrics::{COURANT, MOMENTUM},
    reference::{self, Reference},
};
use crate::solid::{Energy, digest};
use base::functions::hypot;
use base::record::{Profile, Record, Status};
use harness::{
    case::{Rules, RunError},
    context::Context,
    runner::Drive,
    simulate,
};

/// Times at which particles are kept for pictures, shares of the run.
pub const PICTURES: [f64; 6] = [0.0, 0.16, 0.3, 0.4, 0.6, 1.0];

/// What the rules choose.
pub fn rules(method: &RingMethod, settings: &RingSettings) -> Result<Rules, RunError> {
    Ok(Rings::new(settings, method, &Context::of_rules())?.rules)
}

/// Runs and measures.
pub fn run(
    method: &RingMethod,
    variant: &str,
    settings: &RingSettings,
    context: &Context,
) -> Result<Record, RunError> {
    let rings = &Rings::new(settings, method, context)?;
    let mut simulation = (method.build)(rings.parts(context))?;
    let name = (super::NAME, variant);
    let mut record = simulate::begin(name, &rings.settings, method, &numbers(rings), context);
    let mut series = Series::new(rings);
    let mut budget = context.measures_all().then(Budget::default);
    simulation.advance(0.0, rings.rules.dt(), &mut ());
    let particles = measure::along_flight(rings, &*simulation);
    series.sample(0.0, &particles, Energy::known(&*simulation));
    budget.iter_mut().for_each(|budget| budget.sample(rings, &*simulation));
    if context.keep_particles {
        keep(rings, &*simulation, 0.0, &mut record);
    }
    let stops = stops(rings, context);
    let times: Vec<f64> = stops.iter().map(|(time, _)| *time).collect();
    let eos = rings.material.eos();
    let pressure = |density| eos.pressure(density);
    let has_budget = budget.is_some();
    let mut seen = (&mut series, &mut budget, &mut record);
    let (status, cost) =
        Drive::new(&mut *simulation, rings.rules.dt(), &times, &pressure, &mut seen)
            .after_step("series", &|(series, ..), simulation| series.after_step(simulation))
            .at_if(has_budget, "energy budget by term", &|(_, budget, _), s, k| {
                if let Some(budget) = budget.as_mut().filter(|_| stops[k].1.is_none()) {
                    budget.sample(rings, s);
                }
            })
            .at_positions("pictures", &|(.., record), s, k| {
                if let Some(share) = stops[k].1.filter(|_| context.keep_particles) {
                    keep(rings, s, share, record);
                }
            })
            .run(context)?;
    let particles = measure::along_flight(rings, &*simulation);
    if status == Status::Completed {
        if series.last_time() < Some(simulation.time() * rings.c0) {
            series.sample(simulation.time(), &particles, Energy::known(&*simulation));
        }
        series.measure(&mut record);
        budget.iter().for_each(|budget| budget.measure(rings, &mut record));
        match Reference::of(variant, &rings.settings) {
            Some(reference) => reference.compare(&series, &mut record),
            None => reference::leave_out(&mut record),
        }
        record.put(MOMENTUM, measure::momentum_error(rings, &particles));
        record.put(COURANT, rings.rules.dt() * (rings.cp + rings.v) / rings.medium.h);
    }
    if budget.is_none() {
        record.leave_unasked(&budget::METRICS);
    }
    record.profiles.insert("series".into(), series.profile());
    record.state = Some(digest(&simulation.particles()));
    (record.status, record.cost) = (status, cost);
    Ok(record)
}

/// What the run chose.
fn numbers(rings: &Rings) -> Vec<(&'static str, f64)> {
    let own = [("V [m/s]", rings.v), ("c_p [m/s]", rings.cp)];
    [&rings.rules.numbers([rings.settings.h_over_dx, rings.medium.dx])[..], &own].concat()
}

/// Where a run stops, ascending: times \[s\], each with the share of the run if a picture is kept; the others
/// are samples of the energy budget.
fn stops(rings: &Rings, context: &Context) -> Vec<(f64, Option<f64>)> {
    let (end, count) = (rings.settings.end / rings.c0, rings.settings.samples);
    let shares = match context.pictures {
        Some(count) => (0..count).map(|k| k as f64 / (count - 1).max(1) as f64).collect(),
        None => PICTURES.to_vec(),
    };
    let pictures = shares.into_iter().map(|share| (share * end, Some(share)));
    let samples = (1..=count).map(|k| (end * k as f64 / count as f64, None));
    let mut stops: Vec<_> = pictures.filter(|(time, _)| *time > 0.0).chain(samples).collect();
    stops.sort_by(|a, b| a.0.total_cmp(&b.0));
    stops
}

/// Keeps x, y and the largest principal stress at a share of the run.
fn keep(rings: &Rings, simulation: &dyn Stepper<Symmetric>, share: f64, record: &mut Record) {
    let all = measure::along_flight(rings, simulation);
    let column = |f: &dyn Fn(&Particle<Symmetric>) -> f64| all.iter().map(f).collect::<Vec<f64>>();
    let largest = |p: &Particle<Symmetric>| {
        let (m, d) = (0.5 * (p.extra.xx + p.extra.yy), 0.5 * (p.extra.xx - p.extra.yy));
        let pressure = rings.c0 * rings.c0 * (p.density - rings.settings.rho);
        m + hypot(d, p.extra.xy) - pressure
    };
    let profile = Profile::default()
        .with("x", "m", column(&|p| p.position.x))
        .with("y", "m", column(&|p| p.position.y))
        .with("stress", "Pa", column(&largest));
    record.profiles.insert(format!("particles@{share}"), profile);
}

#[cfg(test)]
mod tests {
    use super::super::RUBBER_RINGS;
    use super::*;
    use harness::case::Case;

    /// The series had no row at t = 0 and its last row twice.
    #[test]
    fn the_series_begins_at_the_start_and_has_each_time_once() {
        // With steps that meet the end and the times of samples, and with steps that do not.
        for dt in [None, Some(0.125)] {
            let set = |s: &mut RingSettings| (s.spacing, s.end, s.dt) = (0.5, 5.0, dt);
            let spec = RUBBER_RINGS.spec("leapfrog", set);
            let record = RUBBER_RINGS.run(&spec, &Context::default()).expect("a run");
            let times = record.column("series", "t");
            assert_eq!((times.first(), times.last()), (Some(&0.0), Some(&5.0)));
            assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
            assert_eq!(record.column("series", "x_c")[0], 5.0);
        }
    }
}
