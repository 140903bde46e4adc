//! Steps a simulation through the times of interest: the only main loop of the program. It measures
//! cost, shows progress, writes frames and obeys an interrupt; cases hold only what differs.

use std::cell::Cell;
use std::sync::atomic::Ordering;
use std::time::Instant;

use base::record::{Cost, Status};
use cpu_time::{ProcessTime, ThreadTime};
use solver::{Flow, Numbers, Observer, Outcome, Stepper};

pub use crate::context::{Context, Progress};
use crate::{error::RunError, frames::Frames};

/// Steps between looks at the interrupt and the progress bar.
const LOOK_EVERY: u64 = 64;

/// Shows how far a run is and obeys an interrupt.
struct Watch<'a> {
    context: &'a Context<'a>,
    end: f64,
    until_look: Cell<u64>,
}

impl<X: Numbers> Observer<X> for Watch<'_> {
    #[inline]
    fn after_step(&mut self, simulation: &dyn Stepper<X>) -> Flow {
        let left = self.until_look.get();
        if left > 0 {
            self.until_look.set(left - 1);
            return Flow::Continue;
        }
        self.until_look.set(LOOK_EVERY - 1);
        if let Some(show) = self.context.progress {
            let (time, dt) = (simulation.time(), simulation.dt());
            let particle_steps = simulation.work().steps * simulation.fluid_count() as u64;
            show(Progress { time, end: self.end, dt, particle_steps });
        }
        match self.context.interrupt {
            Some(flag) if flag.load(Ordering::Relaxed) => Flow::Stop,
            _ => Flow::Continue,
        }
    }
}

/// Sums the time that observers and frames take.
struct Timed<'a, 'f, X> {
    observer: &'a mut dyn Observer<X>,
    frames: &'a mut Option<Frames<'f>>,
    seconds: f64,
}

impl<X: Numbers> Observer<X> for Timed<'_, '_, X> {
    fn after_step(&mut self, simulation: &dyn Stepper<X>) -> Flow {
        let start = Instant::now();
        let mut flow = self.observer.after_step(simulation);
        if let Some(frames) = self.frames
            && frames.after_step(simulation) == Flow::Stop
        {
            flow = Flow::Stop;
        }
        self.seconds += start.elapsed().as_secs_f64();
        flow
    }
}

/// What all schemes with the same extra fields share of [`drive`].
struct Run<'a, X> {
    context: &'a Context<'a>,
    dt: f64,
    watch: Watch<'a>,
    observer: &'a mut dyn Observer<X>,
    frames: Option<Frames<'a>>,
    cost: Cost,
}

impl<X: Numbers> Run<'_, X> {
    /// Steps to a time; how the run ended, if it did not get there.
    fn step_to<D>(&mut self, simulation: &mut D, until: f64) -> Option<Status>
    where
        D: Stepper<X> + ?Sized,
    {
        let Self { dt, watch, observer, frames, cost, .. } = self;
        let mut timed = Timed { observer: &mut **observer, frames, seconds: 0.0 };
        let (wall, cpu, process) = (Instant::now(), ThreadTime::now(), ProcessTime::now());
        let outcome = simulation.advance(until, *dt, &mut (watch, &mut timed));
        // Runs side by side share a process, so the process's clock is only right for a run that
        // itself has threads.
        let elapsed = if cost.threads > 1 { process.elapsed() } else { cpu.elapsed() };
        cost.wall_s += wall.elapsed().as_secs_f64() - timed.seconds;
        cost.cpu_s += (elapsed.as_secs_f64() - timed.seconds).max(0.0);
        cost.observing_s += timed.seconds;
        match outcome {
            Outcome::Reached => None,
            Outcome::Diverged(divergence) => Some(Status::Diverged {
                step: divergence.step,
                time: divergence.time,
                particle: divergence.fault.particle as usize,
                field: divergence.fault.field.into(),
                value_text: format!("{:.6e}", divergence.fault.value),
            }),
            Outcome::Stopped => {
                let (step, time) = (simulation.work().steps, simulation.time());
                Some(Status::Interrupted { step, time })
            }
        }
    }

    /// The last frame of a run that reached its end, and what was counted.
    fn finish<D>(self, simulation: &D, status: &Status) -> Result<Cost, RunError>
    where
        D: Stepper<X> + ?Sized,
    {
        if let Some(frames) = self.frames {
            let has_ended = *status == Status::Completed;
            frames.finish(has_ended.then_some(simulation))?;
        }
        let work = simulation.work();
        Ok(Cost {
            threads: self.context.threads.max(1),
            steps: work.steps,
            pair_interactions: work.pair_interactions,
            particle_rhs: work.right_hand_sides,
            particles: simulation.fluid_count(),
            solver_bytes: simulation.bytes() as u64,
            ..self.cost
        })
    }
}

/// Steps through `times` \[s\], ascending; `at(simulation, k)` is called at the k-th. Returns how the
/// run ended, and what it cost: the stepping, and beside it the observers and `at`.
///
/// `observer` sees every step. `pressure` \[Pa\] of a density \[kg/m³\] is what frames show.
///
/// # Errors
/// If a frame cannot be written: the run stops at once.
pub fn drive<X: Numbers, D: Stepper<X> + ?Sized>(
    simulation: &mut D,
    dt: f64,
    times: &[f64],
    context: &Context,
    observer: &mut dyn Observer<X>,
    pressure: &dyn Fn(f64) -> f64,
    at: &mut dyn FnMut(&mut D, usize),
) -> Result<(Status, Cost), RunError> {
    let end = times.last().copied().unwrap_or_default();
    let watch = Watch { context, end, until_look: Cell::new(LOOK_EVERY) };
    let frames = context.frames.as_ref().map(|frames| Frames::new(frames, end, pressure));
    let cost = Cost { threads: context.threads.max(1), ..Cost::default() };
    let mut run = Run { context, dt, watch, observer, frames: frames.transpose()?, cost };
    let mut status = Status::Completed;
    for (k, &until) in times.iter().enumerate() {
        if let Some(ended) = run.step_to(simulation, until) {
            status = ended;
            break;
        }
        let start = Instant::now();
        at(simulation, k);
        run.cost.observing_s += start.elapsed().as_secs_f64();
    }
    let cost = run.finish(simulation, &status)?;
    Ok((status, cost))
}
