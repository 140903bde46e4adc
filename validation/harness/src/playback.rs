//! Frames of a run that another code made, played back: particles are put where a frame has them, all that
//! pair sweeps read is derived from them, and the case measures them as it measures its own.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector2;
use touchstone_base::{
    absent::Absent,
    record::{Record, Status},
};
use touchstone_solver::{
    Checkpoint, Divergence, Domain, InvalidState, Numbers, Outcome, Particle, Role, Stepper,
};

use crate::error::RunError;

/// A particle of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Number of the particle in the problem.
    pub id: u32,
    /// \[m\].
    pub position: Vector2<f64>,
    /// \[m/s\].
    pub velocity: Vector2<f64>,
    /// \[kg/m³\], if it was handed in.
    pub density: Option<f64>,
}

/// The particles at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// \[s\].
    pub time: f64,
    /// The particles that moved; the others are where they were.
    pub particles: Vec<Placed>,
}

impl Frame {
    /// Does it count for this time of a run to this end?
    pub(crate) fn is_at(&self, time: f64, end: f64) -> bool {
        (self.time - time).abs() <= SAME_TIME * end
    }
}

/// A particle that another code chose itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Own {
    /// Role in the scene.
    pub role: Role,
    /// Mass per unit depth \[kg/m\].
    pub mass: f64,
    /// Where it starts.
    pub start: Placed,
}

/// Frames, ascending in time.
#[derive(Clone, Debug, Default)]
pub struct Playback<'a> {
    /// The frames.
    pub frames: &'a [Frame],
    /// The code's own particles in place of the problem's; empty for a code that used the problem's.
    pub own: Vec<Own>,
    /// Where particles are put inside the period before anything is measured.
    pub domain: Domain,
    /// A coordinate beyond this is of a particle that the code has lost \[m\].
    pub reach: f64,
    /// Densities and speeds beyond these belong to a diverged run, whatever its case measures.
    pub limits: touchstone_solver::Limits,
    /// Placeholders of numbers that were not submitted.
    pub fill: Fill,
}

/// Placeholders of numbers that were not submitted. A result must not depend on them, so values that differ
/// between two fills are not measured: see [`leave_out`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Fill {
    /// Density \[kg/m³\].
    pub density: f64,
    /// The share of it by which a density is higher at most; each particle has some of it.
    pub spread: f64,
    /// Extra fields that a method integrates in addition to position, velocity and density, such as stress.
    pub extra: f64,
}

impl Fill {
    /// The density of a particle without a submitted one.
    fn density(&self, id: u32) -> f64 {
        self.density * (1.0 + self.spread * f64::from(1 + id % 7) / 7.0)
    }
}

/// Removes from a record the values that depend on a missing column: values that differ from `other`,
/// measured with another [`Fill`] of this column.
pub fn leave_out(record: &mut Record, column: &str, other: &Record) {
    let bits = |value: f64| value.to_bits();
    let names: BTreeSet<&String> = record.metrics.keys().chain(other.metrics.keys()).collect();
    let of = |of: &Record, name: &str| of.metric(name).map(bits);
    let rests = names.into_iter().filter(|name| of(record, name) != of(other, name));
    for name in rests.cloned().collect::<Vec<_>>() {
        record.metrics.remove(&name);
        record.absent.insert(name, Absent::NotGiven(column.into()));
    }
    for (name, profile) in &mut record.profiles {
        profile.columns.retain(|column| {
            let other = other.column(name, &column.name).iter().copied().map(bits);
            column.values.iter().copied().map(bits).eq(other)
        });
    }
    record.profiles.retain(|_, profile| !profile.columns.is_empty());
    record.state = record.state.take().filter(|state| Some(state) == other.state.as_ref());
}

/// A frame counts for a time that differs from its own by at most this share of the end of the run.
const SAME_TIME: f64 = 1e-6;

impl Playback<'_> {
    /// The particles of a scene: its own ones unless the other code chose others.
    pub fn particles<X: Numbers>(&self, of_scene: Vec<Particle<X>>) -> Vec<Particle<X>> {
        if self.own.is_empty() {
            return of_scene;
        }
        let particle = |own: &Own| {
            let Own { role, mass, start: Placed { id, position, velocity, density } } = *own;
            let density = density.unwrap_or_else(|| self.fill.density(id));
            let position = self.domain.wrap(position);
            Particle { role, position, velocity, density, mass, extra: X::default() }
        };
        self.own.iter().map(particle).collect()
    }

    /// The first particle of a frame that no measure can take, before it is put in place.
    fn lost(&self, frame: &Frame) -> Option<InvalidState> {
        frame.particles.iter().find_map(|placed| {
            let fault = |field, value| Some(InvalidState { particle: placed.id, field, value });
            let (far, speed) = (placed.position.amax(), placed.velocity.norm());
            let [least, most] = self.limits.density;
            match placed.density {
                _ if far > self.reach => fault("position", far),
                Some(density) if !(least <= density && density <= most) => {
                    fault("density", density)
                }
                _ if speed > self.limits.speed => fault("velocity", speed),
                _ => None,
            }
        })
    }
}

/// Side of the squares in which particles are counted, in spacings, and the most of the density that may be
/// in the square of the median particle: a lattice has 1.4 at most, particles at random 1.2.
const SQUARE: f64 = 2.5;
const MOST_CROWDED: f64 = 2.0;

/// The particle of a frame with the most mass in its square compared with the median, if this exceeds any
/// density: particles of any densities on one line or in one corner.
fn crowded<X: Numbers>(
    playback: &Playback,
    frame: &Frame,
    all: &[(u32, Particle<X>)],
) -> Option<InvalidState> {
    let ids: BTreeSet<u32> = frame.particles.iter().map(|placed| placed.id).collect();
    let moving: Vec<_> = all.iter().filter(|(id, _)| ids.contains(id)).collect();
    let mass = moving.iter().fold(0.0, |sum, (_, p)| sum + p.mass) / moving.len() as f64;
    let side = SQUARE * (mass / playback.fill.density).sqrt();
    let square = |p: &Particle<X>| [p.position.x, p.position.y].map(|x| (x / side).floor() as i64);
    let mut masses: BTreeMap<[i64; 2], f64> = BTreeMap::new();
    moving.iter().for_each(|(_, p)| *masses.entry(square(p)).or_default() += p.mass);
    let density = |p: &Particle<X>| masses[&square(p)] / (side * side);
    let mut found: Vec<(f64, u32)> = moving.iter().map(|(id, p)| (density(p), *id)).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (value, particle) = *found.get(found.len() / 2)?;
    let is_crowded = value > MOST_CROWDED * playback.fill.density;
    is_crowded.then_some(InvalidState { particle, field: "density of the places", value })
}

/// The times that have no frame \[s\], of a run that ends with the last of them.
pub fn missing(frames: &[Frame], times: &[f64]) -> Vec<f64> {
    let end = times.last().copied().unwrap_or_default();
    let has = |time: &&f64| frames.iter().any(|frame| frame.is_at(**time, end));
    times.iter().filter(|time| !has(time)).copied().collect()
}

/// The first frame that is before the start, after the end, or at the time of the one before it, and why.
pub fn misplaced(frames: &[Frame], times: &[f64]) -> Option<(usize, &'static str)> {
    let end = times.last().copied().unwrap_or_default();
    let why = |k: usize| match &frames[k] {
        frame if frame.time < 0.0 => Some("it is before the start; expected times from 0 on"),
        frame if frame.time > end && !frame.is_at(end, end) => {
            Some("it is after the end; expected no later times than those of the problem")
        }
        frame if k > 0 && frame.is_at(frames[k - 1].time, 2.0 * end) => Some(
            "it is the time of the frame before it but for round-off; expected one frame a time",
        ),
        _ => None,
    };
    (0..frames.len()).find_map(|k| Some(k).zip(why(k)))
}

/// Puts the particles of a frame in place; how the run counts as ended, if they are beyond its limits.
pub(crate) fn put<X: Numbers>(
    playback: &Playback,
    frame: &Frame,
    time: f64,
    simulation: &mut dyn Stepper<X>,
) -> Result<Option<Status>, RunError> {
    if let Some(fault) = playback.lost(frame) {
        return Ok(Some(diverged(Divergence { step: 0, time, fault })));
    }
    let refused = |reason: String| RunError::Playback(format!("frame at t = {time} s: {reason}"));
    let mut state = simulation.checkpoint();
    let mut places = vec![usize::MAX; state.particles.len()];
    for (place, (id, _)) in state.particles.iter().enumerate() {
        places[*id as usize] = place;
    }
    for placed in &frame.particles {
        let place = places.get(placed.id as usize).copied();
        let Some((_, particle)) = place.and_then(|place| state.particles.get_mut(place)) else {
            let most = places.len();
            return Err(refused(format!("id is {}; the problem has ids below {most}", placed.id)));
        };
        particle.position = playback.domain.wrap(placed.position);
        particle.velocity = placed.velocity;
        particle.density = placed.density.unwrap_or_else(|| playback.fill.density(placed.id));
        particle.extra = X::default().advanced(playback.fill.extra, X::default());
    }
    if let Some(fault) = crowded(playback, frame, &state.particles) {
        return Ok(Some(diverged(Divergence { step: 0, time, fault })));
    }
    let places = state.particles.iter().map(|(_, particle)| particle.position).collect();
    let reference = std::mem::replace(&mut state.built_at, places);
    state.lag = 0.0;
    state.past.clear();
    state.progress = touchstone_solver::Progress { time, ..touchstone_solver::Progress::default() };
    if simulation.restore(&state).is_err() {
        // A total Lagrangian solid keeps the lists of its reference.
        state.built_at = reference;
        simulation.restore(&state).map_err(|reason| refused(reason.into()))?;
    }
    match advanced(frame, time, state, simulation) {
        Outcome::Diverged(divergence) => {
            Ok(Some(diverged(Divergence { step: 0, time, ..divergence })))
        }
        Outcome::Reached | Outcome::Stopped => Ok(None),
    }
}

/// How a run that diverged has ended.
pub(crate) fn diverged(Divergence { step, time, fault }: Divergence) -> Status {
    Status::Diverged {
        step,
        time,
        particle: fault.particle as usize,
        field: fault.field.into(),
        value_text: format!("{:.6e}", fault.value),
    }
}

/// Derives the columns of pair sweeps. Extra fields of another code are NaN unless the positions determine
/// them: the other data is derived without them.
fn advanced<X: Numbers>(
    frame: &Frame,
    time: f64,
    mut state: Checkpoint<X>,
    simulation: &mut dyn Stepper<X>,
) -> Outcome {
    let outcome = simulation.advance(time, 1.0, &mut ());
    match &outcome {
        Outcome::Diverged(divergence) if divergence.fault.field == "extra" => {}
        _ => return outcome,
    }
    without_extra(frame, 0.0, &mut state);
    if simulation.restore(&state).is_err() {
        return outcome;
    }
    let outcome = simulation.advance(time, 1.0, &mut ());
    let mut derived = simulation.checkpoint();
    without_extra(frame, f64::NAN, &mut derived);
    // A state that was just taken is put back.
    let _ = simulation.restore(&derived);
    outcome
}

/// Puts a number in place of the extra fields of the particles of a frame.
fn without_extra<X: Numbers>(frame: &Frame, number: f64, state: &mut Checkpoint<X>) {
    let of_frame: BTreeSet<u32> = frame.particles.iter().map(|placed| placed.id).collect();
    for (_, particle) in state.particles.iter_mut().filter(|(id, _)| of_frame.contains(id)) {
        particle.extra = X::default().advanced(number, X::default());
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use touchstone_base::{record::Profile, spec::RunSpec};

    use super::*;

    touchstone_base::metrics! {
        FIXED = "fixed" ["-"] "as it was made up";
        RESTS = "rests" ["-"] "as it was made up";
    }

    /// Metrics, columns and the state that another density changes are left out, and a curve without columns.
    #[test]
    fn what_differs_by_a_column_that_was_not_given_is_left_out() {
        let of = |density: f64| {
            let mut record = Record::of(&RunSpec::new("case", "seed", json!({})), 1);
            record.put(FIXED, 1.0);
            record.put(RESTS, density);
            let both = Profile::default().with("y", "m", vec![0.0, 1.0]);
            record.profiles.insert("both".into(), both.with("p", "Pa", vec![0.0, density]));
            let one = Profile::default().with("p", "Pa", vec![density]);
            record.profiles.insert("one".into(), one);
            record.state = Some(density.to_string());
            record
        };
        let mut record = of(1.0);
        leave_out(&mut record, "density", &of(1.0));
        assert_eq!((record.metrics.len(), record.profiles.len()), (2, 2), "nothing rests on it");
        assert!(record.state.is_some());
        leave_out(&mut record, "density", &of(2.0));
        assert_eq!(record.metrics.keys().collect::<Vec<_>>(), ["fixed"]);
        assert_eq!(record.absent["rests"], Absent::NotGiven("density".into()));
        let names = |of: &Profile| of.columns.iter().map(|of| of.name.clone()).collect::<Vec<_>>();
        let curves: Vec<_> =
            record.profiles.iter().map(|(name, of)| (&**name, names(of))).collect();
        assert_eq!(curves, [("both", vec!["y".to_string()])]);
        assert!(record.state.is_none());
    }
}
