//! Steps a simulation through the times of interest: the only main loop of the crate. It measures
//! cost, shows progress, writes frames and obeys an interrupt; cases hold only what differs.

use std::cell::{Cell, RefCell};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use cpu_time::{ProcessTime, ThreadTime};
use solver::{EquationOfState, Flow, Observer, Outcome, Scheme, Simulation};

use crate::case::RunError;
use base::{
    files::OutputFolder,
    record::{Cost, Status},
    vtk::{Collection, Particles, VtkError},
};

/// What a progress bar shows.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Simulated time \[s\].
    pub time: f64,
    /// Time of the end \[s\].
    pub end: f64,
    /// Time step \[s\].
    pub dt: f64,
    /// Particle steps done.
    pub particle_steps: u64,
}

/// How a run is to be done, apart from what it computes.
#[derive(Default)]
pub struct Context<'a> {
    /// Run even with a time step beyond the theoretical limit.
    pub allow_unstable: bool,
    /// Threads inside the run, 1 for serial; 0 counts as 1.
    pub threads: usize,
    /// Frames for ParaView: the folder, and how many.
    pub frames: Option<(PathBuf, usize)>,
    /// Keep the particles of the last time in the record.
    pub keep_particles: bool,
    /// How many pictures, at equal intervals from the start, a case keeps in place of its own.
    pub pictures: Option<usize>,
    /// Told how far the run is.
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
    /// Set from outside to stop.
    pub interrupt: Option<&'a AtomicBool>,
}

/// Steps between looks at the interrupt and the progress bar.
const LOOK_EVERY: u64 = 64;

struct Watch<'a> {
    context: &'a Context<'a>,
    end: f64,
    until_look: Cell<u64>,
}

impl<S: Scheme> Observer<S> for Watch<'_> {
    #[inline]
    fn after_step(&mut self, simulation: &Simulation<S>) -> Flow {
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

/// Steps through `times` \[s\], ascending; `at(simulation, k)` is called at the k-th. Returns how the
/// run ended, and what the stepping alone cost.
///
/// `observer` watches every step beside the runner's own. What `at` does to the simulation is no part of
/// the cost.
pub fn drive<S: Scheme>(
    simulation: &mut Simulation<S>,
    dt: f64,
    times: &[f64],
    context: &Context,
    observer: &mut impl Observer<S>,
    at: &mut dyn FnMut(&mut Simulation<S>, usize),
) -> (Status, Cost) {
    let mut cost = Cost { threads: context.threads.max(1), ..Cost::default() };
    let end = times.last().copied().unwrap_or_default();
    let mut watch = Watch { context, end, until_look: Cell::new(LOOK_EVERY) };
    let mut status = Status::Completed;
    for (k, &until) in times.iter().enumerate() {
        let (wall, cpu, process) = (Instant::now(), ThreadTime::now(), ProcessTime::now());
        let outcome = simulation.advance(until, dt, &mut (&mut watch, &mut *observer));
        cost.wall_s += wall.elapsed().as_secs_f64();
        // Runs side by side share a process, so the process's clock is only right for a run that
        // itself has threads.
        let elapsed = if cost.threads > 1 { process.elapsed() } else { cpu.elapsed() };
        cost.cpu_s += elapsed.as_secs_f64();
        match outcome {
            Outcome::Reached => at(simulation, k),
            Outcome::Diverged(divergence) => {
                status = Status::Diverged {
                    step: divergence.step,
                    time: divergence.time,
                    particle: divergence.fault.particle as usize,
                    field: divergence.fault.field.into(),
                    value_text: format!("{:.6e}", divergence.fault.value),
                };
                break;
            }
            Outcome::Stopped => {
                let (step, time) = (simulation.work().steps, simulation.time());
                status = Status::Interrupted { step, time };
                break;
            }
        }
    }
    let work = simulation.work();
    cost.steps = work.steps;
    cost.pair_interactions = work.pair_interactions;
    cost.particle_rhs = work.right_hand_sides;
    cost.particles = simulation.fluid_count();
    cost.solver_bytes = simulation.bytes() as u64;
    cost.peak_rss_bytes = base::manifest::peak_rss_bytes();
    (status, cost)
}

/// Writes particles for ParaView.
pub struct Frames {
    folder: OutputFolder,
    written: RefCell<(usize, Collection)>,
}

impl Frames {
    /// Frames in the folder of the context, if it asks for any.
    pub fn of(context: &Context) -> Result<Option<Self>, RunError> {
        let Some((path, _)) = &context.frames else { return Ok(None) };
        let folder = OutputFolder::create(path)?;
        Ok(Some(Self { folder, written: RefCell::default() }))
    }

    /// Writes one frame and the collection that lists all so far.
    pub fn write<S: Scheme>(
        &self,
        simulation: &Simulation<S>,
        eos: &impl EquationOfState,
    ) -> Result<(), FrameError> {
        let particles = simulation.particles();
        let column = |f: &dyn Fn(&solver::Particle<S::Extra>) -> f64| -> Vec<f64> {
            particles.iter().map(f).collect()
        };
        let xy = |v: nalgebra::Vector2<f64>| [v.x, v.y];
        let positions: Vec<_> = particles.iter().map(|p| xy(p.position)).collect();
        let velocities: Vec<_> = particles.iter().map(|p| xy(p.velocity)).collect();
        let frame = Particles::new(simulation.time(), &positions)?
            .vector("velocity", &velocities)?
            .scalar("density", &column(&|p| p.density))?
            .scalar("pressure", &column(&|p| eos.pressure(p.density)))?
            .scalar("mass", &column(&|p| p.mass))?
            .scalar("role", &column(&|p| f64::from(p.role as u8)))?;
        let (count, collection) = &mut *self.written.borrow_mut();
        let name = format!("particles_{count:04}.vtp");
        *count += 1;
        self.folder.write(&name, frame.to_xml().as_bytes())?;
        collection.push(simulation.time(), &name);
        self.folder.write("particles.pvd", collection.to_xml().as_bytes())?;
        Ok(())
    }
}

/// Why a frame was not written.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// Its numbers.
    #[error(transparent)]
    Vtk(#[from] VtkError),
    /// Its file.
    #[error(transparent)]
    File(#[from] base::files::FileError),
}
