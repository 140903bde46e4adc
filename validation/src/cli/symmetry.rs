//! `symmetry`: differences between observers of one problem in our own runs.

use rayon::prelude::*;
use touchstone_base::spec::RunSpec;
use touchstone_harness::{
    case::{self, Case, RunError},
    relation::Relation,
    symmetry::{self, Difference},
};
use touchstone_report::sig;

use super::{Exit, Failure, Outcome, Session, arguments, on_threads, output};

/// A relation, the largest difference and where it is.
pub fn row(case: &dyn Case, spec: &RunSpec, by: Relation, found: &Difference) -> Vec<String> {
    let Difference { time, value, floor, quantity, particle } = found;
    let verdict = if found.is_round_off() { "round-off" } else { "not the same" };
    let place = format!("{quantity} of particle {particle} at {} s", sig(*time, 4));
    let names = [case.name(), &spec.variant, by.name(), verdict].map(String::from);
    [names.to_vec(), vec![sig(*value, 3), sig(*floor, 3), place]].concat()
}

/// Rows under their heads, and their units.
pub fn show(rows: Vec<Vec<String>>) -> Result<(), Failure> {
    let heads = ["case", "variant", "relation", "observers", "difference", "round-off", "where"];
    let units = "\nDifferences of places [h], velocities [c0] and densities [rho0].\n";
    output::print(&(output::table(&heads, rows) + units))
}

pub fn symmetry(arguments: &arguments::Symmetry, session: &Session) -> Outcome {
    let mut specs = Vec::new();
    for case in session.choose(&arguments.cases)? {
        for variant in case.variants() {
            specs.push((case, case::spec(case, variant.name, &arguments.set)?));
        }
    }
    let size = symmetry::size(&specs);
    if size.is_too_much() && !arguments.allow_long {
        let settings = "the settings, or name fewer cases";
        return Err(RunError::TooLong { size, settings }.into());
    }
    let mut all = Vec::new();
    let battery = |(case, spec): &(&dyn Case, _)| {
        session.go_on("nothing is told").map(|()| symmetry::battery(*case, spec))
    };
    on_threads(None, || {
        specs.par_iter().map(battery).collect_into_vec(&mut all);
        Ok(())
    })?;
    let (mut rows, mut exit) = (Vec::new(), Exit::Pass);
    for ((case, spec), found) in specs.iter().zip(all) {
        let none = |why: RunError| {
            let names = [case.name(), &spec.variant, "", "–", "", ""].map(String::from);
            [names.to_vec(), vec![why.to_string()]].concat()
        };
        match found? {
            Err(why) => rows.push(none(why)),
            Ok(found) => rows.extend(found.into_iter().map(|(by, found)| match found {
                Err(why) => none(why),
                Ok(found) => {
                    exit = if found.is_round_off() { exit } else { Exit::GateFailed };
                    row(*case, spec, by, &found)
                }
            })),
        }
    }
    show(rows)?;
    Ok(exit)
}
