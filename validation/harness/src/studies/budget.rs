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
    let time = || changes.iter().zip(errors).filter(|(change, _)| change.part == "time");
    let highest = time().max_by(|a, b| a.1.total_cmp(b.1));
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
