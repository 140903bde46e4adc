//! The error budget: one run with one thing changed at a time.

use touchstone_report::Cell;

use crate::{
    columns::Columns,
    declare::{Accuracy, Budgets, Change, error_of},
    runs::Runs,
    study::Study,
};

pub fn study(accuracy: &Accuracy, budgets: &Budgets, runs: &Runs) -> Study {
    let caption = format!(
        "Error budget with one thing changed at a time: {}. {} \
         Where the error rises as dt falls, errors of time and spacing cancel at the default dt, and the row \
         with the least dt is the better measure of the spacing.",
        accuracy.label, budgets.about
    );
    let mut rows = Vec::new();
    for changes in &budgets.of {
        let error = |change: &Change| {
            let record = runs.record(&change.spec);
            record.and_then(|record| error_of(&accuracy.error, record)).unwrap_or(f64::NAN)
        };
        let errors: Vec<f64> = changes.iter().map(error).collect();
        for (change, error) in changes.iter().zip(&errors) {
            rows.push((&*changes[0].spec.variant, change, *error, error - errors[change.against]));
        }
    }
    let table = Columns::<(&str, &Change, f64, f64)>::default()
        .code("variant", |(variant, ..)| *variant)
        .text("change", |(_, change, ..)| &change.what)
        .text("part of the error", |(_, change, ..)| change.part)
        .num(["error", "-"], |(.., error, _)| Cell::percent(*error, 3))
        .num(["change of error", "-"], |(.., change)| Cell::percent(*change, 2))
        .table(caption, rows);
    Study::new(&format!("{}-error-budget", accuracy.id), "Error budget").block(table)
}

#[cfg(test)]
mod tests {
    use touchstone_base::spec::RunSpec;

    use super::*;
    use crate::studies::tests::{ERROR, column, runs, spec, tables};

    /// Changes of the run at n = 0, 1, and so on: their names, parts, runs of comparison, and errors.
    fn study_of(changes: &[(&str, &'static str, usize, f64)]) -> Study {
        let of = |n: usize| -> RunSpec { spec("seed", n) };
        let change =
            |(n, &(what, part, against, _)): (usize, &(&str, &'static str, usize, f64))| Change {
                against,
                ..Change::new(what, part, of(n))
            };
        let budgets = Budgets {
            about: "Made up.".into(),
            of: vec![changes.iter().enumerate().map(change).collect()],
        };
        let errors = changes.iter().enumerate().map(|(n, (.., error))| (of(n), *error));
        let runs = runs(errors.filter(|(_, error)| error.is_finite()));
        study(&Accuracy::new("case", ERROR, "error"), &budgets, &runs)
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
