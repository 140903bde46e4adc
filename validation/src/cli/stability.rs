//! `stability`: the largest stable time steps that cases declare, measured and by theory, as tables of
//! reports.

use harness::{
    case::Case,
    make::Job,
    runs::{JudgedRun, Planned, Runs},
    studies::table_of_limits,
};
use report::Table;
use serde_json::Value;
use validation::stiffness::{self, Row};

use super::{Exit, Failure, Outcome, World, arguments, output, trouble};

pub fn stability(arguments: &arguments::Stability, world: &World) -> Outcome {
    let cases = world.choose(&arguments.cases)?;
    world.check_references(&cases)?;
    if arguments.theory {
        return theory(&cases, arguments.json).map(|()| Exit::Pass);
    }
    let mut declared = Vec::new();
    let mut jobs = Vec::new();
    for case in cases {
        let limits = case.declaration(arguments.tier).limits;
        if limits.of.is_empty() && !arguments.cases.is_empty() {
            let words = format!("{} declares no largest stable time step", case.name());
            return Err(Failure::usage(words));
        }
        let planned = |spec| Planned::new(Clone::clone(spec));
        jobs.extend(limits.of.iter().map(|of| Job { case, planned: planned(&of.spec) }));
        declared.push((case.name(), limits));
    }
    declared.retain(|(_, limits)| !limits.of.is_empty());
    let mut made = world.make(&jobs, world.making(arguments.tier), arguments.threads, None)?;
    if made.interrupted {
        return Err(Failure::interrupted("no limit was determined; the same command begins again"));
    }
    let found = jobs.into_iter().filter_map(|job| {
        let record = made.records.remove(&job.planned.spec.key())?;
        Some(JudgedRun::new(job.planned, record))
    });
    let runs = Runs::new(found.collect());
    let tables: Vec<(&str, Table)> =
        declared.iter().map(|(case, of)| (*case, table_of_limits(case, of, &runs))).collect();
    let json = |(case, table): &(&str, Table)| (case.to_string(), output::json_of(table));
    let all = || Value::Object(tables.iter().map(json).collect());
    let text = || {
        let texts: Vec<String> = tables.iter().map(|(_, table)| output::text_of(table)).collect();
        texts.join("\n")
    };
    output::answer(arguments.json, all, text)?;
    Ok(trouble(&made).unwrap_or(Exit::Pass))
}

/// What limits the step of each variant, without a run.
fn theory(cases: &[&'static dyn Case], as_json: bool) -> Result<(), Failure> {
    let mut rows = Vec::new();
    for case in cases {
        rows.extend(Row::of(*case)?);
    }
    if rows.is_empty() {
        let words = format!("{} has no rule for its time step", cases[0].name());
        return Err(Failure::usage(words));
    }
    let table = stiffness::table(&rows);
    let reading = || output::wrap(&stiffness::READING.replace('*', ""), "");
    let text = || format!("{}\n{}", output::text_of(&table), reading());
    output::answer(as_json, || output::json_of(&table), text)
}
