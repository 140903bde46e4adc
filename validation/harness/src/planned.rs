//! A run of a plan and how it is judged.

use base::{
    gate::Gate,
    spec::{RunSpec, Task},
};

/// How much to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Tier {
    /// About half a minute on two cores.
    Quick,
    /// About twenty minutes.
    Full,
    /// About nine hours on one core, for clusters. Cases declare two tiers; the harness extends the full
    /// one, see [`crate::deep`].
    Deep,
}

impl Tier {
    /// The tier that cases declare for this one.
    pub fn declared(self) -> Tier {
        if self == Tier::Quick { Tier::Quick } else { Tier::Full }
    }
}

/// A run of the plan and how it is judged.
#[derive(Clone, Debug)]
pub struct Planned {
    /// What is run.
    pub spec: RunSpec,
    /// Judged on the record of this run.
    pub gates: Vec<Gate>,
    /// Are its seconds shown? Then it is made in the quiet phase, while this program does nothing else.
    pub timed: bool,
    /// Roughly how long it takes \[s\]; only the order counts: long runs start first, so that no core
    /// waits for the last one.
    pub seconds: f64,
}

impl Planned {
    /// A run without gates.
    pub fn new(spec: RunSpec) -> Self {
        // A search makes several simulations, one after another.
        let seconds = if spec.task == Task::Simulate { 1.0 } else { 10.0 };
        Self { spec, gates: Vec::new(), timed: false, seconds }
    }

    /// The same run, judged.
    pub fn judged(mut self, gates: Vec<Gate>) -> Self {
        self.gates.extend(gates);
        self
    }

    /// The same run, timed.
    pub fn timed(self) -> Self {
        Self { timed: true, ..self }
    }
}
