//! `symmetry` and `relate`: what observers of one problem have, of our own runs and of another code's.

use std::collections::BTreeSet;
use std::path::Path;

use ::exchange::{problem::Problem, submission::Entry};
use ::report::sig;
use harness::{
    case::{self, Case, RunError},
    relation::Relation,
    symmetry::{self, Difference, Seen},
};
use rayon::prelude::*;
use validation::cases;

use super::{Exit, Failure, Outcome, World, arguments, exchange, on_threads, output};

/// A difference and where it is.
fn words(difference: &Difference) -> Vec<String> {
    let Difference { time, value, floor, quantity, particle } = difference;
    let verdict = if difference.is_round_off() { "round-off" } else { "not the same" };
    let where_it_is = format!("{quantity} of particle {particle}");
    vec![sig(*time, 5), where_it_is, sig(*value, 3), sig(*floor, 3), verdict.into()]
}

const HEADS: [&str; 5] = ["t [s]", "largest difference", "[h, c0, rho0]", "round-off", "verdict"];

/// The difference that is worst against its floor.
fn worst(all: &[Difference]) -> Option<&Difference> {
    let over = |difference: &Difference| difference.value / difference.floor;
    let place = |a: &&Difference, b: &&Difference| over(a).total_cmp(&over(b));
    all.iter().find(|d| d.value.is_nan()).or_else(|| all.iter().max_by(place))
}

pub fn symmetry(arguments: &arguments::Symmetry, world: &World) -> Outcome {
    let mut specs = Vec::new();
    for case in world.choose(&arguments.cases)? {
        for variant in case.variants() {
            if arguments.variant.as_deref().is_none_or(|name| name == variant.name) {
                specs.push((case, case::spec(case, variant.name, &arguments.set)?));
            }
        }
    }
    if specs.is_empty() {
        return Err(Failure::usage(
            "no case has a variant of that name; see `touchstone list CASE`",
        ));
    }
    let relations = &Relation::ALL[1..];
    let all: Vec<_> = on_threads(None, || {
        let run = |(case, spec): &(&'static dyn Case, _)| match world.is_interrupted() {
            true => Err(Failure::interrupted("nothing was told")),
            false => Ok(symmetry::battery(*case, spec, relations)),
        };
        specs.par_iter().map(run).collect()
    })?;
    let (mut rows, mut failed, mut reasons) = (Vec::new(), Vec::new(), BTreeSet::new());
    for ((case, spec), found) in specs.iter().zip(all) {
        let name = [case.name().to_string(), spec.variant.clone()];
        let found = match found {
            Err(RunError::NoSymmetry { reason, .. }) => {
                reasons.insert(format!("{}: {reason}", case.name()));
                continue;
            }
            found => found?,
        };
        let mut row = name.to_vec();
        for (relation, differences) in found {
            match differences {
                Ok(all) => {
                    row.extend(worst(&all).map(|worst| sig(worst.value, 2)));
                    let wrong = all.iter().filter(|difference| !difference.is_round_off());
                    let of = [&name[..], &[relation.to_string()]].concat();
                    failed.extend(wrong.map(|wrong| [of.clone(), words(wrong)].concat()));
                }
                Err(RunError::NoSymmetry { relation, reason }) => {
                    row.push("–".into());
                    reasons.insert(format!("{relation}: {reason}"));
                }
                Err(error) => return Err(error.into()),
            }
        }
        rows.push(row);
    }
    let heads: Vec<&str> =
        ["case", "variant"].into_iter().chain(relations.iter().map(|r| r.name())).collect();
    let mut text = output::table(&heads, &rows);
    text +=
        "\nLargest differences of place [h], velocity [c0] and density [rho0]. –: does not hold,\n";
    text.extend(reasons.iter().map(|reason| format!("  {reason}\n")));
    if !failed.is_empty() {
        let heads = [&["case", "variant", "relation"][..], &HEADS].concat();
        text += &format!("\nNot the same:\n\n{}", output::table(&heads, &failed));
    }
    output::print(&text)?;
    Ok(if failed.is_empty() { Exit::Pass } else { Exit::GateFailed })
}

/// Results of another code, and the problem of the observer for whom they are.
fn observed(
    case: &dyn Case,
    folder: &Path,
    map: &[(String, String)],
) -> Result<(Entry, Problem, Relation), Failure> {
    let entry = exchange::read(folder, map)?;
    let usage = |what: String| Failure::usage(format!("{}: {what}", folder.display()));
    let asked = entry.asked.as_ref().filter(|asked| asked.relation.is_some());
    let asked =
        asked.ok_or_else(|| usage("expected a problem.json of `export --relation`".into()))?;
    let relation = Relation::named(asked.relation.as_deref().unwrap_or_default()).map_err(usage)?;
    let problem = Problem::seen(case, exchange::asked(case, asked)?, Some(relation))?;
    let flaws = entry.check(&problem);
    match flaws.is_empty() {
        true => Ok((entry, problem, relation)),
        false => Err(exchange::refused(&flaws)),
    }
}

pub fn relate(arguments: &arguments::Relate, world: &World) -> Outcome {
    let case = cases::find_in(world.cases, &arguments.case)?;
    let (ours, same, relation) = observed(case, &arguments.same, &arguments.map)?;
    let (theirs, other, by) = observed(case, &arguments.other, &arguments.map)?;
    if relation != Relation::Same || same.spec.key() != other.spec.key() {
        return Err(Failure::usage(format!(
            "expected two problems of the same settings, the first of relation same; the first is of \
             relation {relation}, variant {}, the second of relation {by}, variant {}",
            same.spec.variant, other.spec.variant
        )));
    }
    let end = same.outline.times.last().copied().unwrap_or_default();
    let steps = ours.system.steps.number().unwrap_or(end / same.outline.dt);
    let [ours, theirs] = [(&ours, &same), (&theirs, &other)]
        .map(|(entry, of)| Seen { outline: &of.outline, frames: &entry.results.frames });
    let all = symmetry::differences(&ours, &theirs, steps);
    let rows: Vec<_> = all.iter().map(words).collect();
    let text = output::table(&HEADS, &rows);
    output::print(&format!("{}, {}, {by}:\n\n{text}", case.name(), same.spec.variant))?;
    let is_same = all.iter().all(Difference::is_round_off);
    Ok(if is_same { Exit::Pass } else { Exit::GateFailed })
}
