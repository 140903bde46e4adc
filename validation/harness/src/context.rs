//! How a run is executed, apart from its settings.

use std::path::PathBuf;
use std::sync::{
    Mutex,
    atomic::{AtomicBool, Ordering},
};

use touchstone_base::{record::Profile, spec::RunSpec};

use crate::{
    checkpoint::Checkpoints,
    clock::{self, Reading},
    error::RunError,
    size::Size,
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

/// How a run is executed, apart from what it computes.
#[derive(Clone, Default)]
pub struct Context<'a> {
    /// The run: what may be wrong with its time step and its scene, and what is measured of it and kept.
    pub spec: RunSpec,
    /// Run even if it is estimated to take more time or memory than a run may.
    pub allow_long: bool,
    /// Threads inside the run, 1 for serial; 0 counts as 1.
    pub threads: usize,
    /// Frames for ParaView: the folder, and how many.
    pub frames: Option<(PathBuf, usize)>,
    /// Where all fields of the particles at the end are put.
    pub at_the_end: Option<&'a Mutex<Option<Profile>>>,
    /// Told what the run is estimated to take, before its first step.
    pub estimate: Option<&'a (dyn Fn(&Size) + Sync)>,
    /// Called with the progress of the run.
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
    /// Find out where the time goes.
    pub profile: bool,
    /// Told of a frame or a checkpoint that could not be written; the run goes on.
    pub lost: Option<&'a (dyn Fn(&RunError) + Sync)>,
    /// Tells the time of a run with so many threads, by default [`clock::system`].
    pub clock: Option<&'a (dyn Fn(usize) -> Reading + Sync)>,
    /// Told of the particles at each time at which the run is measured, when every quantity is at that time.
    pub at_times: Option<&'a (dyn Fn(f64, Profile) + Sync)>,
    /// Where checkpoints go, and what the run goes on from; the last one is made at an interrupt.
    pub checkpoints: Option<&'a Checkpoints<'a>>,
    /// Set by another thread to stop the run.
    pub interrupt: Option<&'a AtomicBool>,
}

impl Context<'_> {
    /// What time it is by the clocks of the run.
    pub fn now(&self) -> Reading {
        self.clock.unwrap_or(&clock::system)(self.threads)
    }

    /// Is the run to stop?
    pub fn is_interrupted(&self) -> bool {
        self.interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// A frame or a checkpoint could not be written.
    pub(crate) fn lose(&self, error: &RunError) {
        self.lost.iter().for_each(|lost| lost(error));
    }
}
