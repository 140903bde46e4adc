//! How far the default time step of each channel variant is from where its run blows up.

use super::baseline;
use crate::cases;
use base::{
    gate::{Bound, Evidence, Gate},
    record::{Record, Status},
};
use harness::bisect::largest_stable;
use harness::{
    case::{Case, Tier},
    runner::Context,
    suite::Study,
};
use report::{Cell, Column, Table};

/// Steps of a run; growth of 1 % a step fills the eight decades from the disturbance to V.
const STEPS: f64 = 1500.0;
/// Resolution of the bisection, relative to the theoretical limit.
const RESOLUTION: f64 = 0.01;
/// Variants of the quick tier.
const QUICK: [&str; 4] = ["seed", "interface-wall", "plain", "modern"];

/// The default step of a variant beside its limits.
#[derive(Clone, Debug)]
pub struct DefaultStep {
    /// Name of the variant.
    pub variant: &'static str,
    /// The default \[s\].
    pub dt: f64,
    /// The longest stable step seen \[s\], NaN if there is none near the theory.
    pub measured: f64,
    /// Theory of the periodic lattice with sound and viscosity alone \[s\].
    pub theory: f64,
}

impl DefaultStep {
    /// Measured limit over the default step.
    pub fn margin(&self) -> f64 {
        self.measured / self.dt
    }

    /// Measured over theoretical limit.
    pub fn ratio(&self) -> f64 {
        self.measured / self.theory
    }
}

/// Channel variants that a tier measures.
pub fn variants(tier: Tier) -> Vec<&'static str> {
    let all = cases::find("couette").map(|case| case.variants()).unwrap_or_default();
    let names = all.into_iter().map(|variant| variant.name);
    names.filter(|name| tier == Tier::Full || QUICK.contains(name)).collect()
}

/// Runs Couette flow with `set`, whatever its step; `None` if it is refused.
fn run(case: &dyn Case, variant: &str, set: &[String]) -> Option<Record> {
    let context = Context { allow_unstable: true, threads: 1, ..Context::default() };
    case.run(variant, set, &context).ok()
}

/// Bisects the longest stable step of a variant of Couette flow.
pub fn measure_default(variant: &'static str) -> DefaultStep {
    let mut step = DefaultStep { variant, dt: f64::NAN, measured: f64::NAN, theory: f64::NAN };
    let Ok(case) = cases::find("couette") else { return step };
    let Some(record) = run(case, variant, &["end=1e-6".into()]) else { return step };
    step.dt = record.chose("dt [s]");
    step.theory = step.dt / record.chose("dt/limit");
    // Of the default settings: L = 1 mm, ν = 1e-6 m²/s, so L²/ν = 1 s.
    let unit = record.setting("width").powi(2) / record.setting("nu");
    let found = largest_stable(step.theory, RESOLUTION, |dt| {
        let set = [
            format!("dt={dt:e}"),
            format!("end={:e}", STEPS * dt / unit),
            "jitter=1e-6".to_string(),
        ];
        run(case, variant, &set).is_some_and(|record| is_quiet(&record))
    });
    step.measured = found.map_or(f64::NAN, |bracket| bracket.stable);
    step
}

/// Completed, and neither cross-flow nor error is as large as the flow itself.
fn is_quiet(record: &Record) -> bool {
    let is_small = |value: f64| value < 1.0;
    let mut errors = record.metrics.iter().filter(|(name, _)| name.starts_with("l2@"));
    record.status == Status::Completed
        && record.metric("v_rms").is_some_and(is_small)
        && errors.all(|(_, metric)| is_small(metric.value))
}

/// The table of the study.
pub fn table(steps: &[DefaultStep]) -> Table {
    let columns = vec![
        Column::text("variant"),
        Column::num("default dt", "µs"),
        Column::num("longest stable dt", "µs"),
        Column::num("lattice theory", "µs"),
        Column::num("measured/theory", ""),
        Column::num("safety margin: measured/default", ""),
    ];
    let caption = "Default step of the variants of Couette flow at 20 rows, and its margin.";
    steps.iter().fold(Table::new(caption, columns), |table, step| {
        table.row(vec![
            Cell::text(format!("`{}`", step.variant)),
            Cell::num(1e6 * step.dt, 3),
            Cell::num(1e6 * step.measured, 3),
            Cell::num(1e6 * step.theory, 3),
            Cell::num(step.ratio(), 3),
            Cell::num(step.margin(), 3),
        ])
    })
}

/// The study with a gate a variant on the margin itself, and one on its not shrinking.
pub fn judge(mut study: Study, steps: &[DefaultStep]) -> Study {
    for step in steps {
        let name = format!("stability.default.{}", step.variant);
        let gate = Gate::new(
            format!("{name}.stable"),
            "longest stable dt/default dt",
            Bound::Above(1.0),
            Evidence::Theory,
            "a default step beyond the stability limit is no default",
        );
        study = study.judge(gate, step.margin());
        for (what, value) in [("margin", step.margin()), ("ratio", step.ratio())] {
            if let Some(gate) = baseline::default_gate(&name, step.variant, what) {
                study = study.judge(gate, value);
            }
        }
    }
    study
}
