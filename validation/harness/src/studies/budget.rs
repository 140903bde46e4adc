//! The error budget: one run with one thing changed at a time.

use touchstone_base::{record::MetricName, spec::RunSpec};
use touchstone_report::Cell;

use super::{Accuracy, cost::error_of};
use crate::{
    columns::TableColumns,
    runs::{Planned, Runs},
    section::Section,
    study::Study,
};

/// Error budgets: one run with one thing changed at a time.
pub struct Budgets {
    /// Anchor of its section in the report.
    id: String,
    /// The error.
    error: MetricName,
    /// Name of the error with its unit.
    label: String,
    /// The runs in words, one or two sentences.
    about: String,
    /// Changes of each variant; the first is the unchanged run.
    pub of: Vec<Vec<Change>>,
}

impl Budgets {
    /// Budgets of the error of ladders: the runs in one or two sentences, and the changes of each variant;
    /// the first is the unchanged run.
    pub fn new(accuracy: &Accuracy, about: impl Into<String>, of: Vec<Vec<Change>>) -> Self {
        let (id, error) = (format!("{}-error-budget", accuracy.id), accuracy.error.clone());
        Self { id, error, label: accuracy.label.clone(), about: about.into(), of }
    }
}

/// A run with one thing changed.
pub struct Change {
    /// The change, such as `dt/2`.
    pub what: String,
    /// The part of the error that this changes; `time` is the time step.
    pub part: &'static str,
    /// The run.
    pub spec: RunSpec,
    /// Index of the change that it is compared with; mostly 0.
    pub against: usize,
}

impl Change {
    /// A change that is compared with the unchanged run.
    pub fn new(what: impl Into<String>, part: &'static str, spec: RunSpec) -> Self {
        Self { what: what.into(), part, spec, against: 0 }
    }
}

/// How to read a budget.
pub const READING: &str = "Where the error of a budget rises as dt falls, errors of time and spacing cancel \
    at the default dt, and the row with the least dt is the better measure of the spacing.";

impl Study for Budgets {
    fn runs(&self) -> Vec<Planned> {
        self.of.iter().flatten().map(|change| Planned::new(change.spec.clone())).collect()
    }

    fn evaluate(&self, _: &str, runs: &Runs) -> Option<Section> {
        let caption = format!("One thing changed at a time: {}. {}", self.label, self.about);
        let mut rows = Vec::new();
        for changes in &self.of {
            let error = |change: &Change| {
                let record = runs.record(&change.spec);
                record.and_then(|record| error_of(&self.error, record)).unwrap_or(f64::NAN)
            };
            let errors: Vec<f64> = changes.iter().map(error).collect();
            for (change, error) in changes.iter().zip(&errors) {
                let variant = &*changes[0].spec.variant;
                rows.push((variant, change, *error, error - errors[change.against]));
            }
        }
        let table = TableColumns::<(&str, &Change, f64, f64)>::default()
            .code("variant", |(variant, ..)| *variant)
            .text("change", |(_, change, ..)| &change.what)
            .text("part of the error", |(_, change, ..)| change.part)
            .num(["error", "-"], |(.., error, _)| Cell::percent(*error, 3))
            .num(["change of error", "-"], |(.., change)| Cell::percent(*change, 2))
            .table(caption, rows);
        (!self.of.is_empty()).then(|| Section::new(&self.id, "Error budget").block(table))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::tests::{ERROR, column, evaluate, runs, spec, tables};

    /// Changes of the run at n = 0, 1, and so on: their names, parts, runs of comparison, and errors.
    fn study_of(changes: &[(&str, &'static str, usize, f64)]) -> Section {
        let change =
            |(n, &(what, part, against, _)): (usize, &(&str, &'static str, usize, f64))| Change {
                against,
                ..Change::new(what, part, spec("seed", n))
            };
        let of = vec![changes.iter().enumerate().map(change).collect()];
        let budgets = Budgets::new(&Accuracy::new("case", ERROR, "error"), "Made up.", of);
        let errors = changes.iter().enumerate().map(|(n, (.., error))| (spec("seed", n), *error));
        evaluate(&budgets, runs(errors.filter(|(_, error)| error.is_finite())))
    }

    /// 8 % less 5 % are 3 %: compared with the unchanged run it would be 15 %.
    #[test]
    fn a_change_is_compared_with_the_run_that_it_names() {
        let study = study_of(&[
            ("none", "–", 0, 0.20),
            ("dt/4", "time", 0, 0.08),
            ("c0 × 2 and dt/4, against dt/4", "compressibility", 1, 0.05),
            ("40 rows", "spacing", 0, 0.11),
        ]);
        let table = tables(&study)[0];
        assert_eq!(column(table, "error"), ["20.0 %", "8.00 %", "5.00 %", "11.0 %"]);
        let changes = column(table, "change of error");
        assert_eq!(
            changes,
            ["0 %", "−12 %", "−3.0 %", "−9.0 %"],
            "error minus the error of its reference"
        );
    }

    #[test]
    fn a_run_that_failed_has_no_error() {
        let study = study_of(&[("none", "–", 0, 0.10), ("dt/4", "time", 0, f64::NAN)]);
        assert_eq!(column(tables(&study)[0], "error"), ["10.0 %", "–"]);
    }
}
