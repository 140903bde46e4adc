//! The error budget: the same run with one thing changed at a time.

use report::{Block, Cell, percent};

use crate::{
    columns::Columns,
    declare::{Budget, Budgets, Change},
    runs::Runs,
    study::Study,
};

pub fn study(budgets: &Budgets, runs: &Runs) -> Study {
    let caption = format!(
        "Error budget with one thing changed at a time: {}. {} The largest fall names what to spend on. \
         Where the error rises as dt falls, errors of time and spacing cancel at the default dt, and the row \
         with the least dt is the better measure of the spacing.",
        budgets.label, budgets.about
    );
    let (mut rows, mut findings) = (Vec::new(), Vec::new());
    for budget in &budgets.of {
        let error = |change: &Change| {
            let record = runs.record(&change.spec);
            record.and_then(|record| budgets.error.value(record, runs)).unwrap_or(f64::NAN)
        };
        let errors: Vec<f64> = budget.changes.iter().map(error).collect();
        for (change, error) in budget.changes.iter().zip(&errors) {
            rows.push((budget.variant, change, *error, error - errors[change.against]));
        }
        findings.extend(in_words(budget, &errors));
    }
    let table = Columns::<(&str, &Change, f64, f64)>::default()
        .code("variant", |(variant, ..)| *variant)
        .text("change", |(_, change, ..)| &change.what)
        .text("part of the error", |(_, change, ..)| change.part)
        .num(["error", "-"], |(.., error, _)| Cell::percent(*error, 3))
        .num(["change of error", "-"], |(.., change)| Cell::percent(*change, 2))
        .table(caption, rows);
    Study::new(&budgets.id, "Error budget").block(Block::List(findings)).block(table)
}

/// What the budget of one variant says.
fn in_words(Budget { variant, changes }: &Budget, errors: &[f64]) -> Vec<String> {
    let Some(&base) = errors.first() else { return Vec::new() };
    let mut findings = Vec::new();
    // A run that failed has no error, and NaN would be the highest.
    let known = || changes.iter().zip(errors).filter(|(_, error)| error.is_finite());
    let highest =
        known().filter(|(change, _)| change.part == "time").max_by(|a, b| a.1.total_cmp(b.1));
    let cancels = highest.filter(|(_, error)| **error > 1.1 * base);
    if let Some((change, error)) = cancels {
        findings.push(format!(
            "`{variant}`: errors of time and spacing cancel, from {} at dt to {} at {}.",
            percent(base, 3),
            percent(*error, 3),
            change.what
        ));
    }
    let single = changes.iter().zip(errors).skip(1).filter(|(change, _)| change.against == 0);
    let single = single.filter(|(change, _)| !(cancels.is_some() && change.part == "time"));
    let smallest = single.min_by(|a, b| a.1.total_cmp(b.1));
    findings.push(match smallest.filter(|(_, error)| **error < 0.9 * base) {
        Some((change, error)) => format!(
            "`{variant}`: {} falls most with *{}*, to {} ({}).",
            percent(base, 2),
            change.what,
            percent(*error, 2),
            change.part
        ),
        None => format!("`{variant}`: no single change takes a tenth off {}.", percent(base, 2)),
    });
    findings
}

#[cfg(test)]
mod tests {
    use base::spec::RunSpec;

    use super::*;
    use crate::{
        declare::ErrorOf,
        studies::made_up::{ERROR, column, runs, spec, tables},
    };

    /// Changes of the run at n = 0, 1, and so on: their names, parts, what they are compared with, errors.
    fn study_of(changes: &[(&str, &'static str, usize, f64)]) -> Study {
        let of = |n: usize| -> RunSpec { spec("seed", n) };
        let change =
            |(n, &(what, part, against, _)): (usize, &(&str, &'static str, usize, f64))| Change {
                against,
                ..Change::new(what, part, of(n))
            };
        let budgets = Budgets {
            id: "case-error-budget".into(),
            error: ErrorOf::Metric(ERROR.into()),
            label: "error".into(),
            about: "Made up.".into(),
            of: vec![Budget {
                variant: "seed",
                changes: changes.iter().enumerate().map(change).collect(),
            }],
        };
        let errors = changes.iter().enumerate().map(|(n, (.., error))| (of(n), *error));
        let runs = runs(errors.filter(|(_, error)| error.is_finite()));
        study(&budgets, &runs)
    }

    fn said(study: &Study) -> String {
        let list = |block: &Block| match block {
            Block::List(items) => Some(items.join(" ").replace('\u{a0}', " ")),
            _ => None,
        };
        study.blocks.iter().find_map(list).expect("a list of findings")
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
            "error less that of its reference"
        );
        // The smallest error is that of a change of two things, which is no single change.
        assert_eq!(said(&study), "`seed`: 20 % falls most with *dt/4*, to 8.0 % (time).");
    }

    #[test]
    fn a_fall_counts_from_a_tenth_on_and_a_rise_with_dt_says_that_errors_cancel() {
        let base = ("none", "–", 0, 0.10);
        let little = study_of(&[base, ("dt/2", "time", 0, 0.098), ("h/dx", "kernel", 0, 0.091)]);
        assert_eq!(said(&little), "`seed`: no single change takes a tenth off 10 %.");
        let enough = study_of(&[base, ("dt/2", "time", 0, 0.098), ("h/dx", "kernel", 0, 0.089)]);
        assert_eq!(said(&enough), "`seed`: 10 % falls most with *h/dx*, to 8.9 % (kernel).");
        let cancels = study_of(&[
            base,
            ("dt/2", "time", 0, 0.115),
            ("dt/4", "time", 0, 0.05),
            ("h/dx", "kernel", 0, 0.08),
        ]);
        assert_eq!(
            said(&cancels),
            "`seed`: errors of time and spacing cancel, from 10.0 % at dt to 11.5 % at dt/2. `seed`: 10 % \
             falls most with *h/dx*, to 8.0 % (kernel)."
        );
    }

    /// A run that failed has no error, which counted as the largest of all and hid that the others cancel.
    #[test]
    fn a_run_that_failed_hides_no_finding() {
        let study = study_of(&[
            ("none", "–", 0, 0.10),
            ("dt/2", "time", 0, 0.15),
            ("dt/4", "time", 0, f64::NAN),
        ]);
        assert!(said(&study).contains("to 15.0 % at dt/2"), "{}", said(&study));
        assert_eq!(column(tables(&study)[0], "error"), ["10.0 %", "15.0 %", "NaN %"]);
    }
}
