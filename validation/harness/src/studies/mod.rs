//! The studies common to all cases: pure functions of the [`Declaration`] of a case and of its records.

mod budget;
mod card;
pub mod causes;
mod cost;
mod curves;
pub mod ensemble;
mod limit;
mod map;
mod sensitivity;
mod submissions;
mod sweep;
#[cfg(test)]
mod tests;
pub mod validation;

pub use card::{columns, cost as cost_in_words, headline, row};
pub use cost::against_run_time;
pub use limit::of_theory as limit_of_theory;
pub use sweep::{Resolution, study as sweep};

use crate::{
    declare::{Accuracy, Declaration},
    pictures,
    runs::Runs,
    study::Study,
};

/// The anchor of a study of a case in the report.
pub(crate) fn anchor(case: &str, study: &str) -> String {
    format!("{}-{study}", case.replace('_', "-"))
}

/// All studies of a declaration, in the order of the report: studies of the case alone first.
pub fn of(case: &str, declared: &Declaration, runs: &Runs) -> Vec<Study> {
    let mut studies = declared.studies.as_ref().map_or_else(Vec::new, |own| own(runs));
    studies.extend(declared.curves.iter().map(|curves| curves::study(curves, runs)));
    studies.extend(declared.pictures.iter().map(|picture| pictures::study(picture, runs)));
    let has_ladder = |of: &&Accuracy| of.ladders.iter().any(|ladder| ladder.levels.len() > 1);
    let accuracy = declared.accuracy.iter().filter(has_ladder);
    studies.extend(accuracy.map(|accuracy| cost::study(accuracy, runs)));
    if !declared.comparisons.is_empty() {
        studies.push(validation::study(case, &declared.comparisons, runs));
    }
    studies.extend(declared.ensembles.iter().map(|of| ensemble::study(case, of, runs)));
    let accuracy = declared.accuracy.first().filter(|_| !declared.budgets.of.is_empty());
    studies.extend(accuracy.map(|accuracy| budget::study(accuracy, &declared.budgets, runs)));
    if !declared.limits.of.is_empty() {
        studies.push(limit::study(case, &declared.limits, runs));
    }
    let sensitivity = declared.sensitivity.iter().filter(|sensitivity| !sensitivity.of.is_empty());
    studies.extend(sensitivity.map(|of| sensitivity::study(case, of, runs)));
    studies.extend(declared.maps.iter().map(|map| map::study(map, runs)));
    studies.extend(submissions::study(case, declared, runs));
    studies
}
