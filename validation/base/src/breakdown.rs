//! Breakdown of the time of a run: an optional part of the cost in its record.

use serde::{Deserialize, Serialize};

/// Breakdown of the time of a run. Seconds are wall seconds of the thread that steps: work shared by several
/// threads is counted once, from its start until the last thread has finished.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Breakdown {
    /// parts of the stepping
    pub stepping: Vec<Part>,
    /// observers, frames, checkpoints
    pub observing: Vec<Part>,
    /// time steps that were watched
    pub steps: u64,
    /// builds of neighbour lists
    pub list_builds: u64,
    /// neighbours visited for a fluid particle: the list of its group of particles; mean over samples
    #[serde(with = "crate::number")]
    pub neighbours: f64,
    /// share of these that is inside the support of the kernel; the others are within the skin or
    /// neighbours of the group's other particles
    #[serde(with = "crate::number")]
    pub inside: f64,
    /// bytes that a time step moves: each pair sweep over the fluid reads its lists and the columns of
    /// particles and images once and updates the state, and the refresh before it reads the state and writes
    /// the columns. Building lists is not counted; data in caches is
    #[serde(with = "crate::number")]
    pub bytes_a_step: f64,
}

/// Time of one activity.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// name of the work
    pub name: String,
    /// how long it took in seconds
    #[serde(with = "crate::number")]
    pub seconds: f64,
    /// how often it began
    pub times: u64,
}

impl Breakdown {
    /// Seconds of the stepping \[s\].
    pub fn stepping_seconds(&self) -> f64 {
        self.stepping.iter().map(|part| part.seconds).sum()
    }

    /// Seconds of observing \[s\].
    pub fn observing_seconds(&self) -> f64 {
        self.observing.iter().map(|part| part.seconds).sum()
    }

    /// The share of the stepping that these parts have together.
    pub fn share(&self, names: &[&str]) -> f64 {
        let named = self.stepping.iter().filter(|part| names.contains(&&*part.name));
        named.map(|part| part.seconds).sum::<f64>() / self.stepping_seconds()
    }
}
