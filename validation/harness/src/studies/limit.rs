//! The largest stable time step compared with theory.

use report::{Cell, Column, Table};

use crate::{
    bisect::STABLE,
    declare::{StepLimit, StepLimits},
    runs::{Judged, Runs},
    study::Study,
};

pub fn study(case: &str, limits: &StepLimits, runs: &Runs) -> Study {
    let columns = vec![
        Column::text("variant"),
        Column::text("scene"),
        Column::num("theory", "s"),
        Column::num("measured", "s"),
        Column::num("measured/theory", "-"),
        Column::num("default/theory", "-"),
        Column::num("measured/default", "-"),
    ];
    let caption = format!("Largest stable time step of `{case}` by bisection. {}", limits.about);
    let mut table = Table::new(caption, columns);
    let mut study = Study::new(&limits.id, "Largest stable time step");
    for limit in &limits.of {
        let StepLimit { variant, scene, theory, theory_at, default_at, .. } = limit;
        let of_theory = of_theory(limit, runs);
        let of_default = stable(limit, runs).map(|x| x / default_at);
        let shown = |ratio: Option<f64>| ratio.unwrap_or(f64::NAN);
        table = table.row(vec![
            Cell::text(format!("`{variant}`")),
            Cell::text(scene),
            Cell::sci(*theory, 3),
            Cell::sci(shown(of_theory) * theory, 3),
            Cell::num(shown(of_theory), 3),
            Cell::num(default_at / theory_at, 3),
            Cell::num(shown(of_default), 3),
        ]);
        let judge = |value: Option<f64>| move |gate: &_| Judged::new(Clone::clone(gate), value);
        study.judged.extend(limit.of_theory.iter().map(judge(of_theory)));
        study.judged.extend(limit.of_default.iter().map(judge(of_default)));
    }
    study.block(table)
}

/// The largest stable step over the theoretical limit, if one was found.
pub fn of_theory(limit: &StepLimit, runs: &Runs) -> Option<f64> {
    stable(limit, runs).map(|x| x / limit.theory_at)
}

/// The largest stable x of the bisection.
fn stable(limit: &StepLimit, runs: &Runs) -> Option<f64> {
    runs.completed(&limit.spec)?.metric(STABLE)
}
