//! Checkpoints: all that a run has come to, as bytes from which it goes on with the same bits.
//!
//! A run is one or several simulations, one after another. A checkpoint holds each that has ended, with what
//! was observed of it, and the one that is under way. Going on, a case begins as always: it makes its scene
//! and its observers, and each simulation then takes over its state and theirs, so that no case knows whether
//! it goes on.

use std::collections::VecDeque;
use std::sync::Mutex;
use std::time::Duration;

use nalgebra::Vector2;
use touchstone_base::{
    bits::{self, Bits},
    files::FileError,
    lock,
    record::{Cost, Status},
};
use touchstone_solver::{
    Checkpoint, Interval, Numbers, Particle, PreviousStep, Progress, Stepper, Symmetric, Work,
};

use crate::{error::RunError, outline};

/// How far a simulation is, apart from its particles and from what is observed of it.
#[derive(Default)]
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

touchstone_base::observed! { Stage: changes(reached, cost, frames, ended), stays() }

/// Id and role of a particle, its position, its velocity and where it was when the neighbour lists were
/// built, and then density and mass.
type Stored = (u32, u8, [Vector2<f64>; 3], [f64; 2]);

/// Times and steps, then the particles, the densities that an integrator keeps of earlier steps with their
/// rates, and the deviatoric stresses of both, none of a fluid.
type State = ([f64; 7], [u64; 5], bool, (Vec<Stored>, Vec<[f64; 2]>, Vec<[f64; 3]>));

/// The state of a simulation.
fn state<X: Numbers>(of: &Checkpoint<X>) -> State {
    let Checkpoint { progress, lag, particles, built_at, past } = of;
    let &Progress { time, dt, work, last_approach, built_inside_a_step, call, made } = progress;
    let Work { steps, pair_interactions, right_hand_sides, list_builds } = work;
    let stress = |extra: &X| extra.stress().map(Symmetric::components);
    let (mut stored, mut earlier, mut stresses) = (Vec::new(), Vec::new(), Vec::new());
    for ((id, p), at) in particles.iter().zip(built_at) {
        stored.push((*id, p.role as u8, [p.position, p.velocity, *at], [p.density, p.mass]));
        stresses.extend(stress(&p.extra));
    }
    for PreviousStep { drifted, rate } in past {
        earlier.push([drifted.0, rate.0]);
        stresses.extend(stress(&drifted.1).into_iter().chain(stress(&rate.1)));
    }
    let Interval { start, until, dt_max } = call;
    let times = [time, dt, last_approach, *lag, start, until, dt_max];
    let counts = [steps, pair_interactions, right_hand_sides, list_builds, made];
    (times, counts, built_inside_a_step, (stored, earlier, stresses))
}

fn restore_state<X: Numbers>(from: &mut &[u8]) -> Result<Checkpoint<X>, RunError> {
    let (times, counts, built_inside_a_step, (stored, earlier, stresses)) =
        bits::read::<State>(from)?;
    let [time, dt, last_approach, lag, start, until, dt_max] = times;
    let call = Interval { start, until, dt_max };
    let [steps, pair_interactions, right_hand_sides, list_builds, made] = counts;
    let work = Work { steps, pair_interactions, right_hand_sides, list_builds };
    let progress = Progress { time, dt, work, last_approach, built_inside_a_step, call, made };
    let mut stresses = stresses.into_iter();
    let of_stress = |[xx, yy, xy]: [f64; 3]| X::of_stress(Symmetric { xx, yy, xy });
    let mut extra = || stresses.next().map_or_else(X::default, of_stress);
    let (mut particles, mut built_at, mut past) = (Vec::new(), Vec::new(), Vec::new());
    for (id, role, [position, velocity, at], [density, mass]) in stored {
        let role = outline::role(role.into());
        let role = role.ok_or(RunError::Checkpoint("a particle of an unknown role"))?;
        particles.push((id, Particle { role, position, velocity, density, mass, extra: extra() }));
        built_at.push(at);
    }
    for [drifted, rate] in earlier {
        past.push(PreviousStep { drifted: (drifted, extra()), rate: (rate, extra()) });
    }
    Ok(Checkpoint { progress, lag, particles, built_at, past })
}

/// A simulation as bytes.
pub(crate) fn save<X: Numbers>(
    simulation: &dyn Stepper<X>,
    stage: &Stage,
    seen: &dyn Bits,
) -> Result<Vec<u8>, RunError> {
    if size_of::<X>() > 0 && X::default().stress().is_none() {
        return Err(RunError::Checkpoint(
            "particles with other extra fields than a deviatoric stress",
        ));
    }
    let mut to = Vec::new();
    state(&simulation.checkpoint()).save(&mut to);
    stage.save(&mut to);
    seen.save(&mut to);
    Ok(to)
}

/// Gives a simulation of the same scene, and what was observed of it, their state from bytes.
pub(crate) fn restore<X: Numbers>(
    mut bytes: &[u8],
    simulation: &mut dyn Stepper<X>,
    seen: &mut dyn Bits,
) -> Result<Stage, RunError> {
    let from = &mut bytes;
    simulation.restore(&restore_state(from)?).map_err(RunError::Checkpoint)?;
    let stage = bits::read(from)?;
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

    /// What the simulation that begins now goes on from, if it does.
    pub(crate) fn next(&self) -> Option<Vec<u8>> {
        lock(&self.simulations).earlier.pop_front()
    }

    /// Keeps a simulation that has ended for the checkpoints of those that follow it.
    pub(crate) fn keep(&self, ended: Vec<u8>) {
        lock(&self.simulations).ended.push(ended);
    }

    /// Writes a checkpoint: the simulations that have ended, and the one that is under way. After the last
    /// one, that of an interrupt, none is written.
    pub(crate) fn write(&self, under_way: Vec<u8>, is_last: bool) -> Result<(), RunError> {
        let mut simulations = lock(&self.simulations);
        if simulations.is_over {
            return Ok(());
        }
        simulations.is_over = is_last;
        Ok((self.write)(&[&simulations.ended[..], &[under_way]].concat())?)
    }
}
