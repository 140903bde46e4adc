//! Why a run was refused before its first step.

use thiserror::Error;
use touchstone_base::{
    files::FileError,
    settings::{SettingError, hint},
    spec::SpecError,
    text::short,
};
use touchstone_report::sig;

use crate::{
    limits::ADVISED_SHARE,
    relation::{NoSymmetry, Relation},
    size::{MOST_BYTES, MOST_SECONDS, Size},
};

/// Why a run was refused before its first step.
#[derive(Debug, Error)]
pub enum RunError {
    /// No case, or no variant of a case, of that name.
    #[error(
        "no {what} is called {:?}{}; there are {}",
        short(.name), hint(.known, .name), .known.join(", ")
    )]
    Unknown {
        /// Kind of the missing item.
        what: String,
        /// As given.
        name: String,
        /// All names.
        known: Vec<&'static str>,
    },
    /// A setting that does not exist or is out of range.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// A field of a spec that is out of range.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// A setting of a term that the variant does not contain.
    #[error("setting {key:?} has no effect in variant {variant}, which lacks that term")]
    Unused {
        /// The setting.
        key: String,
        /// The variant.
        variant: String,
    },
    /// The settings in a JSON document do not match the case's.
    #[error("the settings of {case} cannot be read: {reason}")]
    Settings {
        /// The case.
        case: String,
        /// The fault.
        reason: String,
    },
    /// A setting whose value is in its range and has no meaning with the other settings.
    #[error("setting {key} is {value}, which is allowed only with {allowed}")]
    Combination {
        /// The setting.
        key: &'static str,
        /// Its value.
        value: String,
        /// The other settings with which it may have that value.
        allowed: String,
    },
    /// A case that states no rules for the choice of its time step.
    #[error("case {0} states no rules for its time step")]
    NoRules(String),
    /// A time step beyond the theoretical limit.
    #[error(
        "dt is {dt:.4e} s, but must be at most {limit:.4e} s, the theoretical limit of {integrator} for \
         this run on a lattice at rest; where particles move, at most {:.4e} s is advised; change dt, \
         courant or another setting of the step (--allow-unstable permits more)",
        ADVISED_SHARE * limit
    )]
    TimeStep {
        /// The step \[s\].
        dt: f64,
        /// The limit \[s\].
        limit: f64,
        /// Name of the integrator.
        integrator: &'static str,
    },
    /// Something that a case does not allow to be so large.
    #[error("{what} would be {}, but must be at most {}; change {setting}", sig(*value, 4), sig(*most, 2))]
    TooMuch {
        /// Its kind.
        what: &'static str,
        /// How many.
        value: f64,
        /// How many are allowed.
        most: f64,
        /// The settings on which this number depends.
        setting: &'static str,
    },
    /// A scene that no file can state for another code.
    #[error("the case has no scene to export: {0}")]
    NoScene(&'static str),
    /// A relation that is not a symmetry of the scene.
    #[error("relation {} does not hold here: {reason}", .relation.name())]
    NoSymmetry {
        /// The relation.
        relation: Relation,
        /// The reason.
        reason: NoSymmetry,
    },
    /// Frames of another code that do not fit the run.
    #[error("{0}")]
    Foreign(String),
    /// More time or memory than a run may take.
    #[error(
        "the run would be {size}; without --allow-long at most {} and {} MB are allowed; change {settings}",
        touchstone_report::seconds(MOST_SECONDS), touchstone_report::sig(1e-6 * MOST_BYTES, 2)
    )]
    TooLong {
        /// Its cost.
        size: Size,
        /// The settings on which this depends.
        settings: &'static str,
    },
    /// The solver refuses the scene.
    #[error("the scene is impossible: {0}")]
    Scene(#[from] touchstone_solver::SceneError),
    /// An invalid scene of a run, with the settings that differ from the variant's, as `key=value`.
    #[error("with {set} the scene is impossible: {scene}")]
    SceneOf {
        /// The settings.
        set: String,
        /// The fault of the scene.
        scene: touchstone_solver::SceneError,
    },
    /// A reference that the case needs could not be loaded.
    #[error("a reference that the case needs cannot be loaded: {0}")]
    Reference(String),
    /// A panic, which the hook of panics has reported.
    #[error("it ended by the bug reported above")]
    Bug,
    /// The bytes of a checkpoint do not belong to the run.
    #[error("the checkpoint is not one of this run: {0}")]
    OtherBytes(#[from] postcard::Error),
    /// No checkpoint can be made of these particles, or no simulation can have its state.
    #[error("the checkpoint has {0}")]
    Checkpoint(&'static str),
    /// A folder or file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
}

impl RunError {
    /// Was the run refused because of its settings? Otherwise a file, a reference or a bug is the reason,
    /// which is not a property of the run.
    pub fn is_refusal(&self) -> bool {
        use RunError::{Bug, Checkpoint, File, OtherBytes, Reference};
        !matches!(self, File(_) | OtherBytes(_) | Checkpoint(_) | Reference(_) | Bug)
    }
}
