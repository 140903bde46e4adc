//! Writes a problem into a folder, with the files that another code reads.

mod lammps;

use thiserror::Error;
use touchstone_base::vtk;

use crate::problem::{ExportedProblem, PARTICLES, PROBLEM};

/// A script that reads `particles.csv` and `problem.json`, runs the scheme of its name with PySPH, and writes
/// `results.csv` and `system.json` as `touchstone submit` reads them.
///
/// EDAC, with a transport velocity, is for flows that fill their domain, whose walls extrapolate; the weakly
/// compressible scheme is for free surfaces, too.
const PYSPH: &str = include_str!("run_pysph.py");

/// The code for which a problem is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Tables alone.
    Csv,
    /// ParaView's unstructured grid.
    Vtu,
    /// LAMMPS with its package SPH: a data file and an input script.
    Lammps,
    /// PySPH: a script of Python.
    Pysph,
}

/// Why a problem was not written.
#[derive(Debug, Error)]
pub enum WriteError {
    /// Particles that ParaView cannot show.
    #[error(transparent)]
    Grid(#[from] std::io::Error),
    /// The other code cannot do it.
    #[error("{code} cannot run {case}, variant {variant}: {why}")]
    Cannot {
        /// The code.
        code: &'static str,
        /// The case.
        case: String,
        /// The variant.
        variant: String,
        /// The reason.
        why: &'static str,
    },
}

/// A file by its name.
pub type File = (&'static str, Vec<u8>);

/// The names of all files that a problem may have.
pub const NAMES: [&str; 8] = [
    PARTICLES,
    README,
    PROBLEM,
    "particles.vtu",
    "data.lmp",
    "in.lmp",
    "run_lammps.py",
    "run_pysph.py",
];
const README: &str = "README.md";

/// The files of a problem, its document last.
///
/// # Errors
/// If the code of the format cannot run it.
pub fn files(problem: &ExportedProblem, format: Format) -> Result<Vec<File>, WriteError> {
    let own: Vec<(&str, String)> = match format {
        Format::Csv => Vec::new(),
        Format::Vtu => vec![("particles.vtu", vtk::particles(0.0, &problem.particles())?)],
        Format::Lammps => lammps::files(problem)?,
        Format::Pysph => {
            check_fluid("PySPH", problem)?;
            vec![("run_pysph.py", PYSPH.to_string())]
        }
    };
    let document = format!("{:#}\n", problem.to_json());
    let mut files = vec![
        (PARTICLES, problem.particles().to_csv()),
        (README, problem.page()),
        (PROBLEM, document),
    ];
    files.splice(2..2, own);
    Ok(files.into_iter().map(|(name, text)| (name, text.into_bytes())).collect())
}

/// Refuses problems beyond a code of weakly compressible fluids with walls of particles.
fn check_fluid(code: &'static str, problem: &ExportedProblem) -> Result<(), WriteError> {
    let refused = |why| {
        let (case, variant) = (problem.spec.case.clone(), problem.spec.variant.clone());
        Err(WriteError::Cannot { code, case, variant, why })
    };
    if problem.is_solid() {
        return refused("this format is for fluids; use --format csv for solids");
    }
    if !problem.outline.mirrors.is_empty() {
        return refused(
            "its walls are planes that mirror the fluid; choose a variant whose walls are particles \
             (`touchstone list CASE` describes the variants)",
        );
    }
    Ok(())
}
