//! The kinds of studies that any case may have, each in one file: the type that a case declares, the runs
//! that it needs, and its section as a pure function of their records.

pub mod budget;
pub mod card;
pub mod causes;
pub mod cost;
mod curves;
mod ensemble;
mod ladder;
pub mod limit;
mod map;
pub mod sensitivity;
pub mod submissions;
pub mod sweep;
#[cfg(test)]
mod tests;
pub mod validation;

pub use budget::{Budgets, Change};
pub use card::{Breaks, Card, Stated};
pub use cost::Accuracy;
pub use curves::{CurveOf, CurvePanel, Curves, PointsOf};
pub use ensemble::{Ensemble, Ensembles, History, MemberNumber};
pub use ladder::{FINER, Ladder, Level, ORDER, Refine, Resolution, Spacing};
pub use limit::{OF_THEORY, StepLimit, StepLimits};
pub use map::{Map, MapOutcome, MapPanel, STARTS};
pub use sensitivity::{Blind, Sensitivity, Watched};
pub use validation::{Comparison, Comparisons};

pub use crate::{
    pictures::{Film, Heading, Picture, PicturePanel},
    study::{CustomStudy, Studies, Study},
};

/// The anchor of a section of a case in the report.
pub(crate) fn anchor(case: &str, section: &str) -> String {
    format!("{}-{section}", case.replace('_', "-"))
}
