//! The largest stable time step compared with theory.

use report::Cell;

use crate::{
    bisect::STABLE,
    columns::Columns,
    declare::{StepLimit, StepLimits},
    runs::{Judged, Runs},
    study::Study,
};

pub fn study(case: &str, limits: &StepLimits, runs: &Runs) -> Study {
    let caption = format!("Largest stable time step of `{case}` by bisection. {}", limits.about);
    let of_theory = |limit: &StepLimit| of_theory(limit, runs);
    let of_default = |limit: &StepLimit| stable(limit, runs).map(|x| x / limit.default_at);
    let ratio = |value: Option<f64>| Cell::num(value.unwrap_or(f64::NAN), 3);
    let measured = |limit: &StepLimit| of_theory(limit).unwrap_or(f64::NAN) * limit.theory;
    let table = Columns::<StepLimit>::default()
        .code("variant", |limit| limit.variant)
        .text("scene", |limit| limit.scene.clone())
        .num(["theory", "s"], |limit| Cell::sci(limit.theory, 3))
        .num(["measured", "s"], |limit| Cell::sci(measured(limit), 3))
        .num(["measured/theory", "-"], |limit| ratio(of_theory(limit)))
        .num(["default/theory", "-"], |limit| Cell::num(limit.default_at / limit.theory_at, 3))
        .num(["measured/default", "-"], |limit| ratio(of_default(limit)))
        .table(caption, &limits.of);
    let mut study = Study::new(&limits.id, "Largest stable time step");
    for limit in &limits.of {
        let judge = |value: Option<f64>| move |gate: &_| Judged::new(Clone::clone(gate), value);
        study.judged.extend(limit.of_theory.iter().map(judge(of_theory(limit))));
        study.judged.extend(limit.of_default.iter().map(judge(of_default(limit))));
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
