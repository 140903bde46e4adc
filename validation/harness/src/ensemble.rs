//! Ensembles: runs that differ by a small disorder of their start alone. Until their horizon any of them says
//! what all say, and later each is one draw of a distribution.

use base::{gate::Gate, record::Record, spec::RunSpec};

use crate::{
    declare::{Comparison, PointsOf},
    horizon::Curve,
};

/// The ensembles of a case.
pub struct Ensembles {
    /// Anchor of the study: letters, digits, hyphens.
    pub id: String,
    /// What was run, one or two sentences.
    pub about: String,
    /// Name of the time, and its unit.
    pub time: [&'static str; 2],
    /// The ensembles.
    pub of: Vec<Ensemble>,
}

/// The runs of one variant that differ in the seed of their disorder.
pub struct Ensemble {
    /// Name with which its gates begin.
    pub id: String,
    /// Name of the variant.
    pub variant: &'static str,
    /// The resolution in words, such as `H/dx = 20`.
    pub label: String,
    /// Its runs.
    pub members: Vec<RunSpec>,
    /// What is followed over time.
    pub histories: Vec<History>,
    /// The numbers whose distribution is shown.
    pub numbers: Vec<Number>,
    /// Is it drawn?
    pub is_drawn: bool,
}

/// A history, by which members part.
pub struct History {
    /// Name with its unit, as for an axis.
    pub name: String,
    /// Its points.
    pub points: PointsOf,
    /// Members part where they differ by more than u_val of a comparison, times its unit in that of the
    /// history.
    pub tolerance: (Comparison, f64),
    /// The same of each experiment.
    pub measured: Vec<Curve>,
    /// Is it drawn?
    pub is_drawn: bool,
    /// A gate on the time until which all members agree.
    pub gate: Option<Gate>,
}

/// A number of a record.
pub type NumberOf = Box<dyn Fn(&Record) -> Option<f64> + Send + Sync>;

/// A number that each member gives, and which has a distribution.
pub struct Number {
    /// Name, and unit.
    pub name: [&'static str; 2],
    /// Of a record, if it was measured.
    pub value: NumberOf,
    /// The same of each experiment.
    pub measured: Vec<f64>,
    /// A gate on the median.
    pub gate: Option<Gate>,
}
