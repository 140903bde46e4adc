//! Why a run was refused before its first step.

use base::{
    files::FileError,
    settings::{SettingError, hint},
};
use thiserror::Error;

use crate::frames::FrameError;

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
    /// Settings of a document that are not those of the case.
    #[error("the settings of {case} cannot be read: {reason}")]
    Settings {
        /// The case.
        case: String,
        /// What is wrong with them.
        reason: String,
    },
    /// A case without a time step to choose.
    #[error("case {case} states no rules for its time step")]
    NoRules {
        /// The case.
        case: String,
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

impl RunError {
    /// Was the run refused for what it asks? Else a file or a reference is in the way, which is no property
    /// of the run.
    pub fn is_refusal(&self) -> bool {
        !matches!(self, Self::File(_) | Self::Frame(_) | Self::Reference(_))
    }
}
