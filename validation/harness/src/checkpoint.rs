//! Checkpoints: all that a run has come to, as bytes from which it goes on with the same bits.
//!
//! A run is one or several simulations, one after another. A checkpoint holds each that has ended, with what
//! was observed of it, and the one that is under way. Going on, a case begins as always: it makes its scene
//! and its observers, and each simulation then takes over its state and theirs, so that no case knows whether
//! it goes on.

use std::any::{Any, TypeId};
use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use base::{
    bits::{Bits, OtherBits},
    files::FileError,
    record::{Cost, Record, Status},
};
use nalgebra::Vector2;
use solver::{Checkpoint, Numbers, Particle, Past, Progress, Role, Stepper, Symmetric, Work};
use thiserror::Error;

/// Why there is no checkpoint, or why a run does not go on from one.
#[derive(Debug, Error)]
pub enum CheckpointError {
    /// The bytes are not those of the run.
    #[error("the checkpoint is not one of this run: {0}")]
    Read(#[from] OtherBits),
    /// The particles have other extra fields than those of the cases, none or a deviatoric stress.
    #[error("particles with these extra fields have no checkpoint")]
    Extra,
    /// No simulation can have that state.
    #[error("the checkpoint has {0}")]
    State(&'static str),
    /// The file was not written.
    #[error(transparent)]
    File(#[from] FileError),
}

/// What is observed of a run: it can save what has changed since the start, and take it over again.
/// [`observed!`](crate::observed!) implements it for a struct of observations.
pub trait Observed {
    /// Appends all that has changed.
    fn save(&self, to: &mut Vec<u8>);

    /// Takes it over.
    ///
    /// # Errors
    /// If the bytes are not those of this observation.
    fn restore(&mut self, from: &mut &[u8]) -> Result<(), OtherBits>;
}

/// Implements [`Observed`] for a struct: which of its fields change during a run and are [`Bits`], and which
/// stay as they were at the start. Every field must be named, so that a new one cannot be forgotten.
#[macro_export]
macro_rules! observed {
    ($Struct:ty: changes($($change:ident),*), stays($($stay:ident),*)) => {
        impl $crate::checkpoint::Observed for $Struct {
            fn save(&self, to: &mut Vec<u8>) {
                let Self { $($change,)* $($stay: _,)* } = self;
                $(base::bits::Bits::write_to($change, to);)*
            }
            fn restore(&mut self, from: &mut &[u8]) -> Result<(), base::bits::OtherBits> {
                let Self { $($change,)* $($stay: _,)* } = self;
                $(*$change = base::bits::Bits::read_from(from)?;)*
                Ok(())
            }
        }
    };
}

/// Implements [`Observed`] for values that change as a whole.
macro_rules! values {
    ($($Value:ty $(, $T:ident)?;)+) => {$(
        impl$(<$T: Bits>)? Observed for $Value {
            fn save(&self, to: &mut Vec<u8>) {
                self.write_to(to);
            }
            fn restore(&mut self, from: &mut &[u8]) -> Result<(), OtherBits> {
                *self = Bits::read_from(from)?;
                Ok(())
            }
        }
    )+};
}

values! { f64; Vec<T>, T; Record; }

impl<O: Observed + ?Sized> Observed for &mut O {
    fn save(&self, to: &mut Vec<u8>) {
        (**self).save(to);
    }
    fn restore(&mut self, from: &mut &[u8]) -> Result<(), OtherBits> {
        (**self).restore(from)
    }
}

/// Implements [`Observed`] for a tuple, member by member.
macro_rules! tuple {
    ($($Member:ident $index:tt),*) => {
        impl<$($Member: Observed),*> Observed for ($($Member,)*) {
            fn save(&self, _to: &mut Vec<u8>) {
                $(self.$index.save(_to);)*
            }
            fn restore(&mut self, _from: &mut &[u8]) -> Result<(), OtherBits> {
                $(self.$index.restore(_from)?;)*
                Ok(())
            }
        }
    };
}

tuple!();
tuple!(A 0, B 1);
tuple!(A 0, B 1, C 2, D 3);

/// How far a simulation is, apart from its particles and from what is observed of it.
pub(crate) struct Stage {
    /// How many of its times were reached.
    pub reached: usize,
    /// What it took so far.
    pub cost: Cost,
    /// The frames of it by time \[s\], and how many were tried.
    pub frames: Option<(Vec<(f64, String)>, usize)>,
    /// How it ended, if it did.
    pub ended: Option<Status>,
}

base::bits! { Stage { reached, cost, frames, ended } }

/// The extra fields of a particle: none, or those of a deviatoric stress.
struct Extra<X>(X);

impl<X: Numbers> Bits for Extra<X> {
    fn write_to(&self, to: &mut Vec<u8>) {
        let extra: &dyn Any = &self.0;
        if let Some(s) = extra.downcast_ref::<Symmetric>() {
            [s.xx, s.yy, s.xy].write_to(to);
        }
    }
    fn read_from(from: &mut &[u8]) -> Result<Self, OtherBits> {
        let mut read = Self(X::default());
        let extra: &mut dyn Any = &mut read.0;
        if let Some(s) = extra.downcast_mut::<Symmetric>() {
            let [xx, yy, xy] = Bits::read_from(from)?;
            *s = Symmetric { xx, yy, xy };
        }
        Ok(read)
    }
}

/// Id and role of a particle, its position, its velocity and where it was when the neighbour lists were
/// built, and then density, mass and extra fields.
type Stored<X> = (u32, u8, [Vector2<f64>; 3], ([f64; 2], Extra<X>));

/// What an integrator keeps of earlier steps: density and extra fields, and their rates.
type Earlier<X> = [(f64, Extra<X>); 2];

/// Times and steps, and then the particles.
type State<X> = ([f64; 7], [u64; 5], bool, (Vec<Stored<X>>, Vec<Earlier<X>>));

/// The state of a simulation.
fn state<X: Numbers>(of: &Checkpoint<X>) -> State<X> {
    let Checkpoint { progress, lag, particles, built_at, past } = of;
    let &Progress { time, dt, work, last_approach, built_inside_a_step, call, made } = progress;
    let Work { steps, pair_interactions, right_hand_sides, list_builds } = work;
    let stored = particles.iter().zip(built_at).map(|((id, p), at)| {
        let moved = [p.position, p.velocity, *at];
        (*id, p.role as u8, moved, ([p.density, p.mass], Extra(p.extra)))
    });
    let earlier = |past: &Past<X>| [past.drifted, past.rate].map(|(of, extra)| (of, Extra(extra)));
    let times = [time, dt, last_approach, *lag, call[0], call[1], call[2]];
    let counts = [steps, pair_interactions, right_hand_sides, list_builds, made];
    let particles = (stored.collect(), past.iter().map(earlier).collect());
    (times, counts, built_inside_a_step, particles)
}

fn restore_state<X: Numbers>(from: &mut &[u8]) -> Result<Checkpoint<X>, CheckpointError> {
    let (times, counts, built_inside_a_step, (stored, past)) = State::read_from(from)?;
    let [time, dt, last_approach, lag, call @ ..] = times;
    let [steps, pair_interactions, right_hand_sides, list_builds, made] = counts;
    let work = Work { steps, pair_interactions, right_hand_sides, list_builds };
    let progress = Progress { time, dt, work, last_approach, built_inside_a_step, call, made };
    let (mut particles, mut built_at) = (Vec::new(), Vec::new());
    for (id, role, [position, velocity, at], ([density, mass], Extra(extra))) in stored {
        let roles = [Role::Fluid, Role::Wall, Role::Interface];
        let role = roles.into_iter().find(|known| *known as u8 == role);
        let role = role.ok_or(CheckpointError::State("a particle of an unknown role"))?;
        particles.push((id, Particle { role, position, velocity, density, mass, extra }));
        built_at.push(at);
    }
    let earlier = |earlier: Earlier<X>| {
        let [drifted, rate] = earlier.map(|(density, Extra(extra))| (density, extra));
        Past { drifted, rate }
    };
    let past = past.into_iter().map(earlier).collect();
    Ok(Checkpoint { progress, lag, particles, built_at, past })
}

/// A simulation as bytes.
pub(crate) fn save<X: Numbers>(
    simulation: &(impl Stepper<X> + ?Sized),
    stage: &Stage,
    seen: &impl Observed,
) -> Result<Vec<u8>, CheckpointError> {
    if size_of::<X>() > 0 && TypeId::of::<X>() != TypeId::of::<Symmetric>() {
        return Err(CheckpointError::Extra);
    }
    let mut to = Vec::new();
    state(&simulation.checkpoint()).write_to(&mut to);
    stage.write_to(&mut to);
    seen.save(&mut to);
    Ok(to)
}

/// Gives a simulation of the same scene, and what was observed of it, their state from bytes.
pub(crate) fn restore<X: Numbers>(
    mut bytes: &[u8],
    simulation: &mut (impl Stepper<X> + ?Sized),
    seen: &mut impl Observed,
) -> Result<Stage, CheckpointError> {
    let from = &mut bytes;
    simulation.restore(&restore_state(from)?).map_err(CheckpointError::State)?;
    let stage = Stage::read_from(from)?;
    seen.restore(from)?;
    Ok(stage)
}

/// Writes a checkpoint: the simulations of the run as bytes, one after another.
pub type Write<'a> = &'a (dyn Fn(&[Vec<u8>]) -> Result<(), FileError> + Sync);

/// The checkpoints of one run.
pub struct Checkpoints<'a> {
    /// Wall time from one to the next.
    pub(crate) every: Duration,
    write: Write<'a>,
    simulations: Mutex<Simulations>,
}

struct Simulations {
    /// Of the checkpoint that the run goes on from, as far as it has not come to them.
    earlier: VecDeque<Vec<u8>>,
    /// Those that have ended, in their order.
    ended: Vec<Vec<u8>>,
    /// Was the last checkpoint written?
    is_over: bool,
}

impl<'a> Checkpoints<'a> {
    /// Checkpoints every so often, of a run that goes on from the simulations of an earlier one, or that
    /// begins if there are none.
    pub fn new(every: Duration, earlier: Vec<Vec<u8>>, write: Write<'a>) -> Self {
        let simulations =
            Simulations { earlier: earlier.into(), ended: Vec::new(), is_over: false };
        Self { every, write, simulations: Mutex::new(simulations) }
    }

    fn simulations(&self) -> MutexGuard<'_, Simulations> {
        self.simulations.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What the simulation that begins now goes on from, if it does.
    pub(crate) fn next(&self) -> Option<Vec<u8>> {
        self.simulations().earlier.pop_front()
    }

    /// Keeps a simulation that has ended for the checkpoints of those that follow it.
    pub(crate) fn keep(&self, ended: Vec<u8>) {
        self.simulations().ended.push(ended);
    }

    /// Writes a checkpoint: the simulations that have ended, and the one that is under way. After the last
    /// one, that of an interrupt, none is written.
    pub(crate) fn write(&self, under_way: Vec<u8>, is_last: bool) -> Result<(), CheckpointError> {
        let mut simulations = self.simulations();
        if simulations.is_over {
            return Ok(());
        }
        simulations.is_over = is_last;
        Ok((self.write)(&[&simulations.ended[..], &[under_way]].concat())?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Seen {
        numbers: Vec<f64>,
        record: Record,
        width: f64,
    }

    observed! { Seen: changes(numbers, record), stays(width) }

    fn seen(numbers: Vec<f64>) -> Seen {
        let record = Record::new("case", "variant", serde_json::json!({"n": 8, "x": 1.0}), 1);
        Seen { numbers, record, width: 3.0 }
    }

    #[test]
    fn what_was_observed_is_taken_over_and_what_stays_is_not() {
        let mut before = seen(vec![0.1, f64::NAN]);
        before.record.put(base::record::MetricKey::new("m", "-", "1/3"), 1.0 / 3.0);
        let mut saved = Vec::new();
        before.save(&mut saved);
        let mut after = Seen { width: 5.0, ..seen(Vec::new()) };
        after.restore(&mut &saved[..]).unwrap();
        let bits = |seen: &Seen| seen.numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&after), bits(&before));
        assert_eq!(after.record, before.record);
        assert_eq!(after.width, 5.0, "what stays is not saved");
    }
}
