//! A battery of exact symmetries: the particles that another observer has after a few steps are those that we
//! have, but for round-off. It needs no reference, and judges our own runs and those of other codes alike.

use std::sync::{Mutex, PoisonError};

use base::{record::Profile, spec::RunSpec};
use nalgebra::Vector2;

use crate::{
    case::{Case, RunError},
    context::Context,
    outline::{Outline, Sink},
    playback::{Frame, Placed},
    relation::Relation,
};

/// The largest difference between the particles of two observers at a time.
#[derive(Clone, Debug)]
pub struct Difference {
    /// The time as the first of them has it \[s\].
    pub time: f64,
    /// The difference, of a place \[h\], a velocity \[c0\] or a density \[ρ0\]; NaN if one is not a number.
    pub value: f64,
    /// What round-off explains.
    pub floor: f64,
    /// What differs.
    pub quantity: &'static str,
    /// The number of the particle, as the first observer has it.
    pub particle: u32,
}

impl Difference {
    /// Is it no more than round-off?
    pub fn is_round_off(&self) -> bool {
        self.value <= self.floor
    }
}

/// What one of the observers has.
pub struct Seen<'a> {
    /// The problem as it sees it.
    pub outline: &'a Outline,
    /// The particles at the times of the problem, or at more.
    pub frames: &'a [Frame],
}

/// What an observer has that compares with the first one in the units h, c0 and ρ0 at the k-th of the times
/// of its problem, by the number that the first one gives a particle.
fn told(seen: &Seen, k: usize) -> Vec<Placed> {
    let Outline { view, times, particles, .. } = seen.outline;
    let moves: Vec<bool> = particles.column("role").iter().map(|role| *role == 0.0).collect();
    let numbers = view.numbers(&moves);
    let apart = |frame: &&Frame| (frame.time - times[k]).abs();
    let nearest = seen.frames.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
    let back = |placed: &Placed| {
        let time = times[k] / view.time(1.0);
        let (of, density) = view.back(time, [placed.position, placed.velocity], placed.density);
        let (position, velocity) = (of[0], of[1]);
        let id = numbers.get(placed.id as usize).copied().unwrap_or_default() as u32;
        Placed { id, position, velocity, density }
    };
    let moving = |placed: &&Placed| moves.get(placed.id as usize) == Some(&true);
    let mut all: Vec<_> =
        nearest.into_iter().flat_map(|frame| &frame.particles).filter(moving).map(back).collect();
    all.sort_by_key(|placed| placed.id);
    all
}

/// The largest number, which is NaN if one of them is.
fn larger(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// What round-off explains after so many steps. A step rounds place, velocity and density, in the units h, c0
/// and ρ0 by ε times their size; no longer than h/c0, it makes of an error of a force no larger error of the
/// velocity. Velocities keep what steps add, so that places differ by the square of the number of steps at
/// most, as long as the motion itself does not amplify it.
fn floor(base: &Outline, other: &Outline, steps: f64) -> f64 {
    let largest = |outline: &Outline| {
        let size = |name: &str, unit: f64| {
            let all = outline.particles.column(name).iter();
            all.fold(1.0, |largest: f64, value| largest.max((value / unit).abs()))
        };
        let (h, c0) = (outline.medium.h, outline.medium.sound_speed);
        size("x", h).max(size("y", h)).max(size("u", c0)).max(size("v", c0))
    };
    f64::EPSILON * steps * steps * largest(base).max(largest(other))
}

/// Compares what two observers of one problem have, of which the first sees it as it is. `steps` are those to
/// the last time.
pub fn differences(base: &Seen, other: &Seen, steps: f64) -> Vec<Difference> {
    let Outline { medium, times, domain, .. } = base.outline;
    let end = times.last().copied().unwrap_or_default();
    let near = |mut apart: Vector2<f64>| {
        for axis in 0..2 {
            if let Some(period) = domain.period[axis] {
                apart[axis] -= (apart[axis] / period).round() * period;
            }
        }
        apart.amax() / medium.h
    };
    let at = |k: usize| {
        let floor = floor(base.outline, other.outline, steps * times[k] / end);
        let (quantity, particle) = ("place", 0);
        let mut most = Difference { time: times[k], value: 0.0, floor, quantity, particle };
        let (ours, theirs) = (told(base, k), told(other, k));
        // A run that diverged has no particles; other ones would be compared with the wrong ones.
        let same = |k: usize| ours[k].id == theirs[k].id;
        if ours.is_empty() || ours.len() != theirs.len() || !(0..ours.len()).all(same) {
            most.value = f64::NAN;
        }
        for (a, b) in ours.iter().zip(&theirs) {
            let density = a.density.zip(b.density).map_or(0.0, |(a, b)| (a - b).abs());
            for (quantity, value) in [
                ("place", near(a.position - b.position)),
                ("velocity", (a.velocity - b.velocity).amax() / medium.sound_speed),
                ("density", density / medium.density),
            ] {
                if larger(most.value, value).to_bits() != most.value.to_bits() {
                    (most.value, most.quantity, most.particle) = (value, quantity, a.id);
                }
            }
        }
        most
    };
    (0..times.len()).map(at).collect()
}

/// The problem and the particles of our own run of a spec as an observer sees them; no particles if it
/// diverged.
fn seen(
    case: &dyn Case,
    spec: &RunSpec,
    relation: Relation,
) -> Result<(Outline, Vec<Frame>), RunError> {
    let (sink, frames) = (Sink::of(Some(relation), true), Mutex::new(Vec::new()));
    let tell = |time: f64, particles: Profile| {
        let mut frames = frames.lock().unwrap_or_else(PoisonError::into_inner);
        frames.push(Frame { time, particles: placed(&particles) });
    };
    let outline = Some(sink.clone());
    let context =
        Context { outline, at_times: Some(&tell), allow_long: true, ..Context::default() };
    match case.run(spec, &context) {
        Err(RunError::Outlined) | Ok(_) => {}
        Err(error) => return Err(error),
    }
    let none = || RunError::Playback(format!("case {} has no scene to compare", case.name()));
    let outline = sink.take().filter(|of| !of.times.is_empty()).ok_or_else(none)?;
    Ok((outline, frames.into_inner().unwrap_or_else(PoisonError::into_inner)))
}

fn placed(particles: &Profile) -> Vec<Placed> {
    let [id, x, y, u, v, density] =
        ["id", "x", "y", "u", "v", "density"].map(|name| particles.column(name));
    let placed = |k: usize| Placed {
        id: id[k] as u32,
        position: Vector2::new(x[k], y[k]),
        velocity: Vector2::new(u[k], v[k]),
        density: Some(density[k]),
    };
    (0..id.len()).map(placed).collect()
}

/// What of a state is below this when squared \[-\] is lost, in one unit and not in another.
const UNDERFLOW: f64 = 1e-150;

/// What each of some relations comes to for our own run of a spec; `Err` where it does not hold, with the
/// reason. Those that round nothing must give the same bits, but for what underflows.
///
/// # Errors
/// If the run is refused, or is none of a scene.
pub fn battery(
    case: &dyn Case,
    spec: &RunSpec,
    relations: &[Relation],
) -> Result<Vec<(Relation, Result<Vec<Difference>, RunError>)>, RunError> {
    let (base, frames) = seen(case, spec, Relation::Same)?;
    let ours = Seen { outline: &base, frames: &frames };
    let steps = base.times.last().map_or(0.0, |end| (end / base.dt).round());
    let has_walls = base.particles.column("role").iter().any(|role| *role > 0.0);
    let of = |relation: Relation| {
        let (outline, frames) = seen(case, spec, relation)?;
        let mut all = differences(&ours, &Seen { outline: &outline, frames: &frames }, steps);
        if relation.is_bitwise(has_walls) {
            all.iter_mut().for_each(|difference| difference.floor = UNDERFLOW);
        }
        Ok(all)
    };
    Ok(relations.iter().map(|relation| (*relation, of(*relation))).collect())
}
