//! `stability`: the largest stable time step of every variant, measured and by theory.

use rayon::prelude::*;
use serde_json::{Value, json};
use validation::case::{Case, RunError};
use validation::record::Status;
use validation::report;
use validation::runner::Context;

use super::{Exit, Failure, Outcome, World, arguments, on_threads, output, progress::Bar};

/// What was found for one variant.
struct Found {
    case: &'static str,
    variant: &'static str,
    /// By theory \[s\].
    limit: f64,
    /// Largest stable and smallest unstable step, over the limit.
    between: [f64; 2],
}

/// How closely to look.
struct Effort {
    /// Steps that a run must survive.
    steps: f64,
    /// Halvings of the interval.
    halvings: u32,
}

/// Settings that a case must have.
const NEEDED: [&str; 3] = ["dt", "end", "jitter"];

fn is_bisected(case: &dyn Case) -> bool {
    NEEDED.iter().all(|name| case.fields().iter().any(|field| field.name == *name))
}

/// Steps over the theoretical limit that are tried; the ends are assumed stable and unstable.
const FROM: f64 = 0.25;
const TO: f64 = 8.0;

pub fn stability(arguments: &arguments::Stability, world: &World) -> Outcome {
    let (cases, rest): (Vec<_>, Vec<_>) =
        world.choose(&arguments.cases)?.into_iter().partition(|&case| is_bisected(case));
    if !arguments.cases.is_empty() && !rest.is_empty() {
        let names: Vec<&str> = rest.iter().map(|case| case.name()).collect();
        return Err(Failure::usage(anyhow::anyhow!(
            "{} cannot be bisected here, which takes the settings {}; the limits of other cases are in the \
             report",
            names.join(", "),
            NEEDED.join(", ")
        )));
    }
    let effort = match arguments.tier {
        arguments::Tier::Quick => Effort { steps: 400.0, halvings: 7 },
        arguments::Tier::Full => Effort { steps: 4000.0, halvings: 10 },
    };
    let all: Vec<_> = cases
        .iter()
        .flat_map(|&case| case.variants().into_iter().map(move |variant| (case, variant.name)))
        .collect();
    let bar = Bar::new(all.len() as u64);
    let done = std::sync::atomic::AtomicUsize::new(0);
    let found: Result<Vec<Found>, Failure> = on_threads(arguments.threads, || {
        let find = |&(case, variant): &(&'static dyn Case, &'static str)| {
            let found = find(case, variant, &effort, world)?;
            let count = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            bar.show_runs(count, all.len(), &format!("{} {variant}", case.name()));
            Ok(found)
        };
        all.par_iter().map(find).collect()
    });
    bar.clear();
    let found = found?;
    if world.is_interrupted() {
        return Err(Failure::interrupted("no limit is known"));
    }
    if arguments.json {
        output::print(&format!("{:#}\n", Value::Array(found.iter().map(json).collect())))?;
    } else {
        output::say(&table(&found, &effort));
    }
    Ok(Exit::Pass)
}

fn json(found: &Found) -> Value {
    let Found { case, variant, limit, between: [stable, unstable] } = found;
    json!({
        "case": case, "variant": variant, "theory_s": limit,
        "stable_s": stable * limit, "unstable_s": unstable * limit,
    })
}

fn table(found: &[Found], effort: &Effort) -> String {
    let rows: Vec<Vec<String>> = found
        .iter()
        .map(|Found { case, variant, limit, between: [stable, unstable] }| {
            let measured = (stable * unstable).sqrt();
            vec![
                format!("{case} {variant}"),
                report::sig(*limit, 4),
                report::sig(measured * limit, 4),
                report::sig(measured, 3),
            ]
        })
        .collect();
    let heads = ["variant", "theory [s]", "measured [s]", "measured/theory"];
    format!(
        "{}\nTheory: sound and viscosity on the lattice. Measured: the largest dt with which a flow \
         whose lattice\nis disturbed by 1 % of dx survives {} steps; between {:?} and {:?} of the \
         theory, to {}.",
        output::table(&heads, &rows),
        effort.steps,
        FROM,
        TO,
        report::percent(precision(effort), 2)
    )
}

/// Half the width of the last interval, as a fraction.
fn precision(effort: &Effort) -> f64 {
    0.5 * ((TO / FROM).ln() / f64::from(1_u32 << effort.halvings)).exp_m1()
}

/// Bisects on the logarithm of dt.
fn find(
    case: &'static dyn Case,
    variant: &'static str,
    effort: &Effort,
    world: &World,
) -> Result<Found, RunError> {
    let context =
        || Context { allow_unstable: true, interrupt: Some(world.interrupt), ..Context::default() };
    let first = case.run(variant, &["end=1e-6".to_string()], &context())?;
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let limit = number(&first.numerics["dt [s]"]) / number(&first.numerics["dt/limit"]);
    let unit = number(&first.settings["width"]).powi(2) / number(&first.settings["nu"]);
    let is_stable = |factor: f64| -> Result<bool, RunError> {
        let dt = factor * limit;
        let end = (effort.steps * dt / unit).clamp(1e-6, 100.0);
        let set = [format!("dt={dt:e}"), format!("end={end:e}"), "jitter=0.01".to_string()];
        Ok(case.run(variant, &set, &context())?.status == Status::Completed)
    };
    let mut between = [FROM, TO];
    for _ in 0..effort.halvings {
        let middle = (between[0] * between[1]).sqrt();
        between[usize::from(!is_stable(middle)?)] = middle;
    }
    Ok(Found { case: case.name(), variant, limit, between })
}
