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

/// Content of a progress bar.
#[derive(Clone, Copy, Debug)]
pub struct RunProgress {
    /// Simulated time \[s\].
    pub time: f64,
    /// Time of the end \[s\].
    pub end: f64,
    /// Time step \[s\].
    pub dt: f64,
}

/// How a run is executed, apart from its physics.
#[derive(Clone, Default)]
pub struct Context<'a> {
    /// The run: deliberate errors of its time step and its scene, metrics to measure, data to keep.
    pub spec: RunSpec,
    /// Run even if it is estimated to take more time or memory than a run may.
    pub allow_long: bool,
    /// Threads inside the run, 1 for serial; 0 counts as 1.
    pub threads: usize,
    /// Frames for ParaView: the folder, and how many.
    pub frames: Option<(PathBuf, usize)>,
    /// Where all fields of the particles at the end are put.
    pub at_the_end: Option<&'a Mutex<Option<Profile>>>,
    /// Receives the estimated cost of the run before its first step.
    pub estimate: Option<&'a (dyn Fn(&Size) + Sync)>,
    /// Called with the progress of the run.
    pub progress: Option<&'a (dyn Fn(RunProgress) + Sync)>,
    /// Find out where the time goes.
    pub profile: bool,
    /// Called for a frame or a checkpoint that could not be written; the run continues.
    pub lost: Option<&'a (dyn Fn(&RunError) + Sync)>,
    /// Returns the time of a run on this number of threads, by default [`clock::system`].
    pub clock: Option<&'a (dyn Fn(usize) -> Reading + Sync)>,
    /// Receives the particles at each time of measurement, synchronised to this time.
    pub at_times: Option<&'a (dyn Fn(f64, Profile) + Sync)>,
    /// Destination of checkpoints, and the one from which the run continues; the last one is made at an
    /// interrupt.
    pub checkpoints: Option<&'a Checkpoints<'a>>,
    /// Set by another thread to stop the run.
    pub interrupt: Option<&'a AtomicBool>,
}

impl Context<'_> {
    /// The time by the clocks of the run.
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
