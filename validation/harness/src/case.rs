//! What a benchmark is: a problem in words, settings, variants to compare, a plan of judged runs.

use thiserror::Error;

use crate::{
    runner::{Context, FrameError},
    suite::{JudgedRun, Study},
};
use base::{
    files::FileError,
    gate::Gate,
    record::Record,
    settings::{Field, SettingError, hint, nearest},
};

/// How much to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Tier {
    /// Under a minute on two cores.
    Quick,
    /// Under twenty minutes.
    Full,
}

/// One named composition of types with its default settings.
#[derive(Clone, Copy, Debug)]
pub struct Variant {
    /// Name on the command line.
    pub name: &'static str,
    /// What it stands for, one line.
    pub about: &'static str,
}

/// A run of the plan and how it is judged.
#[derive(Clone, Debug)]
pub struct Planned {
    /// Name of the variant.
    pub variant: &'static str,
    /// `key=value` texts.
    pub set: Vec<String>,
    /// Judged on the record of this run.
    pub gates: Vec<Gate>,
    /// Roughly how long it takes \[s\]; only the order counts: long runs start first, so that no core
    /// waits for the last one.
    pub seconds: f64,
}

impl Planned {
    /// A run without gates.
    pub fn new(variant: &'static str, set: &[String]) -> Self {
        Self { variant, set: set.to_vec(), gates: Vec::new(), seconds: 1.0 }
    }

    /// The same run, which takes roughly so long \[s\].
    pub fn taking(self, seconds: f64) -> Self {
        Self { seconds, ..self }
    }

    /// The same run, judged.
    pub fn judged(mut self, gates: Vec<Gate>) -> Self {
        self.gates.extend(gates);
        self
    }
}

/// Why a run was refused before its first step.
#[derive(Debug, Error)]
pub enum RunError {
    /// No case of that name.
    #[error("no case is called {name:?}{}; the cases are {}", hint(.nearest), .known.join(", "))]
    Case {
        /// As given.
        name: String,
        /// The most similar name, if one is similar.
        nearest: Option<&'static str>,
        /// All names.
        known: Vec<&'static str>,
    },
    /// No variant of that name.
    #[error(
        "case {case} has no variant {name:?}{}; its variants are {}",
        hint(.nearest), .known.join(", ")
    )]
    Variant {
        /// The case.
        case: &'static str,
        /// As given.
        name: String,
        /// The most similar name, if one is similar.
        nearest: Option<&'static str>,
        /// All names.
        known: Vec<&'static str>,
    },
    /// A setting that does not exist or is out of range.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// A setting of a term that the variant does not contain.
    #[error("setting {key:?} has no effect in variant {variant}, which lacks that term")]
    Unused {
        /// The setting.
        key: String,
        /// The variant.
        variant: String,
    },
    /// A time step beyond the theoretical limit.
    #[error(
        "dt is {dt:.4e} s, but must be at most {limit:.4e} s, the theoretical limit of {integrator} \
         here (--allow-unstable runs it all the same)"
    )]
    TimeStep {
        /// The step \[s\].
        dt: f64,
        /// The limit \[s\].
        limit: f64,
        /// Name of the integrator.
        integrator: &'static str,
    },
    /// More steps or particles than anyone waits for.
    #[error("{what} would be {value:.3e}, but must be at most {most:.1e}; change {setting}")]
    TooMuch {
        /// Steps or particles.
        what: &'static str,
        /// How many.
        value: f64,
        /// How many are allowed.
        most: f64,
        /// The settings that decide on it.
        setting: &'static str,
    },
    /// The scene is not one.
    #[error("the settings make an impossible scene: {0}")]
    Scene(#[from] solver::SceneError),
    /// The numbers that a case is built on could not be had.
    #[error("a reference that the case needs: {0}")]
    Reference(String),
    /// A folder or file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Frames could not be written.
    #[error(transparent)]
    Frame(#[from] FrameError),
}

/// A benchmark.
pub trait Case: Sync {
    /// Name on the command line.
    fn name(&self) -> &'static str;
    /// The problem in words, a paragraph.
    fn about(&self) -> &'static str;
    /// Compositions to compare.
    fn variants(&self) -> Vec<Variant>;
    /// The settings.
    fn fields(&self) -> &'static [Field];
    /// All settings of a variant with `key=value` texts applied, as the record states them.
    fn settings(&self, variant: &str, set: &[String]) -> Result<serde_json::Value, RunError>;
    /// Runs a variant with `key=value` settings.
    fn run(&self, variant: &str, set: &[String], context: &Context) -> Result<Record, RunError>;
    /// The runs of a tier and their gates.
    fn plan(&self, tier: Tier) -> Vec<Planned>;
    /// What the case has to say beyond single runs, given the runs of its plan in order.
    fn studies(&self, tier: Tier, runs: &[JudgedRun]) -> Vec<Study>;
}

/// The variant of that name, or an error that lists the names.
pub fn find<'a, V>(
    case: &'static str,
    variants: &'a [V],
    name: &str,
    name_of: impl Fn(&V) -> &'static str,
) -> Result<&'a V, RunError> {
    variants.iter().find(|v| name_of(v) == name).ok_or_else(|| {
        let known: Vec<_> = variants.iter().map(name_of).collect();
        RunError::Variant { case, name: name.into(), nearest: nearest(&known, name), known }
    })
}

/// The case of that name among these.
pub fn find_in(cases: &[&'static dyn Case], name: &str) -> Result<&'static dyn Case, RunError> {
    cases.iter().copied().find(|case| case.name() == name).ok_or_else(|| {
        let known: Vec<_> = cases.iter().map(|case| case.name()).collect();
        RunError::Case { name: name.into(), nearest: nearest(&known, name), known }
    })
}
