//! Calls a solver as a library instead of reading its result files.

use touchstone_base::{record::Record, reference::sha256, spec::RunSpec};
use touchstone_harness::{
    case::{Case, RunError},
    foreign::{ForeignParticle, Frame},
};

use crate::{
    flaw,
    problem::ExportedProblem,
    read::Results,
    submission::{Entry, Method, System},
};

/// A solver that moves the particles of a problem.
pub trait Solver {
    /// Its method.
    fn method(&self) -> Method;
    /// Solves the problem, and passes the moving particles at each of its times, ascending, to `frame`;
    /// returns the machine and the cost.
    fn solve(
        &self,
        problem: &ExportedProblem,
        frame: &mut dyn FnMut(f64, Vec<ForeignParticle>),
    ) -> System;
}

/// The record of a solver for a run of a case. Put into
/// [`touchstone_harness::make::BatchResult::submissions`] it has a section of the report.
///
/// # Errors
/// If the case refuses the run, or the results of the solver do not fit: each flaw in a line.
pub fn record(case: &dyn Case, spec: &RunSpec, solver: &dyn Solver) -> Result<Record, RunError> {
    let problem = ExportedProblem::of(case, spec.clone())?;
    let mut results = Results::default();
    let system = solver.solve(&problem, &mut |time, particles| {
        results.places.push((format!("frame at t = {time} s"), 0));
        results.frames.push(Frame { time, particles });
    });
    let method = solver.method();
    let digest = sha256(format!("{method:?}").as_bytes());
    let entry = Entry { method, digest, system, asked: None, results, curve: None };
    entry.check(&problem).map_err(|flaws| RunError::Foreign(flaw::lines(&flaws).join("\n")))?;
    entry.measure(case, spec, &problem)
}
