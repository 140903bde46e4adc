//! The arguments of each command.

use std::ffi::OsString;
use std::ops::Range;
use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Args, Parser, Subcommand};
use touchstone_base::{gate::Verdict, mutation::Mutation, spec::Measure};
use touchstone_exchange::write::Format;
use touchstone_harness::{case::Tier, relation::Relation};

/// Measures how wrong a particle method (SPH) is, what smaller errors cost, and when it breaks.
#[derive(Debug, Parser)]
#[command(name = "touchstone", version, arg_required_else_help = true, after_help = AFTER_HELP)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

const AFTER_HELP: &str = "\
Start with:
  touchstone run couette       one run: its errors, its cost, and what to try next
  touchstone verify couette    the runs of one case, judged against bounds with reasons

Exit codes: 0 pass, 1 a gate failed, 2 invalid command or setting, or a file cannot be written, 3 the \
simulation diverged, 4 a bug in touchstone, 130 interrupted.";

#[derive(Debug, Subcommand)]
pub enum Command {
    /// List all cases, or the variants and settings of one case
    List(List),
    /// Run one variant of a case and measure its errors and cost, or make the runs of a plan
    Run(Run),
    /// Print the runs of a tier, or of a sweep over settings of one case, one JSON line per run
    Plan(Plan),
    /// Make every run that has no stored record, and judge every gate
    Verify(Verify),
    /// Earlier name of `verify --no-runs`
    #[command(hide = true)]
    Judge(Earlier),
    /// Run `verify` and write the report; with --store, write it from stored records without any run
    Report(Report),
    /// Write a problem into a folder for another code: particles, walls, material, times
    Export(Export),
    /// Earlier name of `export --sealed`
    #[command(hide = true)]
    Challenge(Earlier),
    /// Measure and judge particles that another code wrote, and keep their record in a store
    Submit(Submit),
    /// Ask a code plain questions, each with one short problem, and say what is wrong by which factor
    Probe(Probe),
    /// Solve an exported problem by the method that it was exported from, as another code would
    #[command(hide = true)]
    Solve(Solve),
    /// Test symmetry: compare results in rotated, mirrored, moving and other reference frames, of our own
    /// runs or of another code
    Symmetry(Symmetry),
    /// Earlier name of `symmetry --results`
    #[command(hide = true)]
    Relate(Earlier),
    /// Show the differences between two reports or stores
    Compare(Compare),
    /// Find the largest stable time steps by bisection and compare them with theory
    Stability(Stability),
    /// Show what a gate checks, its bound, and the reason for the bound
    Explain(Explain),
    /// Show the build, and check that the program works on this machine
    Doctor(Doctor),
    /// Print a completion script for a shell
    #[command(hide = true)]
    Completions(Completions),
    /// Print the manual page, or write the pages of all commands into a folder
    #[command(hide = true)]
    Man(Man),
}

#[derive(Debug, Args)]
pub struct List {
    /// Name of the case
    pub case: Option<String>,
    /// Print the list as JSON
    #[arg(long)]
    pub json: bool,
}

/// The largest allowed number of threads: more than the cores of present machines.
pub const MOST_THREADS: u16 = 1024;

fn threads() -> clap::builder::RangedI64ValueParser<u16> {
    clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS))
}

/// Name of a value, the value, and its help.
type Named<T> = (&'static str, T, &'static str);

/// A parser of the names of these values.
fn one_of<T: Copy + Send + Sync>(all: &'static [Named<T>]) -> impl TypedValueParser<Value = T> {
    let possible = all.iter().map(|(name, _, help)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(possible).map(|given| {
        let (_, value, _) = all.iter().find(|(name, ..)| *name == given).expect("a possible value");
        *value
    })
}

/// How much is measured of a run.
const METRICS: [Named<Measure>; 2] = [
    ("headline", Measure::Headline, "Metrics that cost little compared with the time steps"),
    (
        "all",
        Measure::All,
        "Also metrics that need extra pair sweeps, such as the energy of each term",
    ),
];

/// The options of `run` that apply to a single run and are refused with `--specs`.
const OF_ONE_RUN: &str = "case variant set rows out overwrite vtk json all profile \
     allow_unstable checkpoint_every resume";
/// The options of `run` that a checkpoint holds.
const OF_A_CHECKPOINT: &str =
    "case variant set rows metrics out overwrite vtk allow_unstable allow_long";

/// The three forms of `run`.
const USAGE: &str = "\
touchstone run [OPTIONS] CASE
       touchstone run --resume DIR, whose checkpoint holds case, variant and settings
       touchstone run --specs FILE --store DIR";

#[derive(Debug, Args)]
#[command(override_usage = USAGE)]
pub struct Run {
    /// Name of the case, as `touchstone list` shows it
    #[arg(required_unless_present_any = ["specs", "resume"])]
    pub case: Option<String>,
    /// Name of the variant; by default the recommended one of the case, which `touchstone list` names
    #[arg(long)]
    pub variant: Option<String>,
    /// Change a setting (repeatable), as in `--set re=0.1 --set end=0.5`
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Short for `--set rows=N`; giving both is an error
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub rows: Option<String>,
    /// Metrics to measure; with --specs, at least these in each run
    #[arg(long, value_name = "WHICH", value_parser = one_of(&METRICS), default_value = "headline")]
    pub metrics: Measure,
    /// Write into this folder record.json, the curves of the record (series.csv and others) and profile.csv,
    /// which holds the velocity across a channel, or else all fields of the particles at the end; without
    /// --out and --vtk no file is written
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write into the folder even if it holds the record of another case; the files of that case are removed
    #[arg(long)]
    pub overwrite: bool,
    /// Also write N frames for ParaView (folder without --out: reports/run-CASE-VARIANT)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=9999))]
    pub vtk: Option<u16>,
    /// Print only the record, as JSON, on standard output
    #[arg(long)]
    pub json: bool,
    /// Print every gate, not only those that did not pass
    #[arg(long, conflicts_with = "json")]
    pub all: bool,
    /// Also profile the run: seconds and share of each part of a step and of each measurement, neighbours
    /// visited, bytes moved; with --json as `cost.breakdown` of the record
    #[arg(long)]
    pub profile: bool,
    /// Number of threads inside the run, 1 to 1024, used from 10,000 particles on; with --specs, number
    /// of runs made in parallel. The default is one per core
    #[arg(long, value_name = "N", value_parser = threads())]
    pub threads: Option<u16>,
    /// Run even with a time step beyond the theoretical limit
    #[arg(long)]
    pub allow_unstable: bool,
    /// Run even if it is estimated to take more than 24 hours on one core or 4 GB of memory
    #[arg(long)]
    pub allow_long: bool,
    /// Write a checkpoint into the folder of --out after every SECONDS of wall time (at least 1), and
    /// at an interrupt; it is removed at the end of the run
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(1..))]
    pub checkpoint_every: Option<u32>,
    /// Continue the run whose checkpoint is in this folder, with the options of that run. Except for wall
    /// times, its record equals that of an uninterrupted run
    #[arg(long, value_name = "DIR", conflicts_with_all = OF_A_CHECKPOINT.split(' '))]
    pub resume: Option<PathBuf>,
    /// Make the runs of this file of JSON lines, as `touchstone plan` prints them; `-` is standard input
    #[arg(long, value_name = "FILE", requires = "store", conflicts_with_all = OF_ONE_RUN.split(' '))]
    pub specs: Option<PathBuf>,
    /// Folder for the records of --specs; runs that have a record there are skipped
    #[arg(long, value_name = "DIR", requires = "specs")]
    pub store: Option<PathBuf>,
    /// With --specs, make only the run with this key
    #[arg(long, value_name = "KEY", requires = "specs", conflicts_with = "index")]
    pub only: Option<String>,
    /// With --specs, make only the run of line N, counted from 0, or the runs of lines N to M - 1, as in a
    /// task of an array job; M may exceed the number of lines
    #[arg(long, value_name = "N or N..M", requires = "specs", value_parser = lines)]
    pub index: Option<Range<usize>>,
}

/// `N`, which is that line alone, or `N..M`.
fn lines(text: &str) -> Result<Range<usize>, String> {
    let number = |text: &str| text.parse::<usize>().ok();
    let range = match text.split_once("..") {
        Some((first, end)) => number(first).zip(number(end)),
        None => number(text).and_then(|first| Some((first, first.checked_add(1)?))),
    };
    let range = range.filter(|(first, end)| first < end).map(|(first, end)| first..end);
    range.ok_or_else(|| "expected N or N..M with N < M, whole numbers, as in 3 or 20..40".into())
}

/// How much to run.
const TIERS: [Named<Tier>; 3] = [
    ("quick", Tier::Quick, "About half a minute on two cores"),
    ("full", Tier::Full, "About twenty minutes"),
    (
        "deep",
        Tier::Deep,
        "About fifteen hours on one core, for clusters: finer ladders, more starts",
    ),
];

#[derive(Debug, Args)]
pub struct Plan {
    /// Names of the cases; by default all
    pub cases: Vec<String>,
    /// How much to plan
    #[arg(long, value_parser = one_of(&TIERS), default_value = "quick")]
    pub tier: Tier,
    /// In place of a tier: every combination of these values (repeatable), as in
    /// `--set re=0.5,1,2 --set rows=10,20`
    #[arg(long, value_name = "KEY=VALUE,…")]
    pub set: Vec<String>,
    /// Variants of the sweep, separated by commas; by default the one of `touchstone run`
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub variant: Vec<String>,
    /// Also write a table of the time and memory that each run is estimated to take, one row a line of the
    /// plan, and print their sum; the deep tier always prints the sum
    #[arg(long, value_name = "FILE")]
    pub estimates: Option<PathBuf>,
}

/// The code for which a problem is written.
const FORMATS: [Named<Format>; 4] = [
    ("csv", Format::Csv, "Tables of comma-separated values"),
    ("vtu", Format::Vtu, "Also an unstructured grid of ParaView"),
    ("lammps", Format::Lammps, "Also a data file and an input script of LAMMPS"),
    ("pysph", Format::Pysph, "Also a Python script that runs PySPH"),
];

/// The exported problem and its folder.
#[derive(Debug, Args)]
pub struct Written {
    /// Name of the case
    pub case: String,
    /// Name of the variant whose particles and walls are written; by default the recommended one
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// Files in addition to problem.json, README.md and particles.csv
    #[arg(long, value_parser = one_of(&FORMATS), default_value = "csv")]
    pub format: Format,
    /// The folder
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Write into the folder even if it holds another problem, whose files and results are removed, or files
    /// with the names of the exported ones
    #[arg(long)]
    pub overwrite: bool,
}

#[derive(Debug, Args)]
pub struct Export {
    #[command(flatten)]
    pub of: Written,
    /// Change a setting (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Also make the run and write its results as a submission of this program
    #[arg(long)]
    pub solve: bool,
    /// Write the problem in another reference frame with a few early times, for `symmetry --results`: same,
    /// turned, mirrored, boosted, binary-units, other-units, renumbered, shifted
    #[arg(long, value_name = "NAME", value_parser = Relation::named)]
    pub relation: Option<Relation>,
    /// Derive the settings from this number and from the method of --method. Use a public number that became
    /// known only after the method was published, such as the first digits of a lottery or of a random beacon
    /// at a stated time
    #[arg(long, value_name = "N", requires = "method", conflicts_with_all = ["set", "solve", "relation"])]
    pub sealed: Option<u64>,
    /// The method.json that the submission of a sealed problem will have; if its code, version, scheme,
    /// division or settings are changed afterwards, the submission is refused
    #[arg(long, value_name = "FILE", requires = "sealed")]
    pub method: Option<PathBuf>,
    /// Continue even if the estimate exceeds 4 GB of memory or, with --solve, 24 hours on one core
    #[arg(long)]
    pub allow_long: bool,
}

#[derive(Debug, Args)]
#[command(group = ArgGroup::new("code under test").required(true).args(["command", "code", "variant"]))]
pub struct Probe {
    /// The code: a program and its first arguments, called once for each problem with the folder of the
    /// problem as its last argument
    #[arg(last = true, value_name = "COMMAND")]
    pub command: Vec<OsString>,
    /// A folder with a probe.toml that names the command: `command = ["python", "run.py"]`
    #[arg(long, value_name = "DIR")]
    pub code: Option<PathBuf>,
    /// Ask our own variant of this name, and the recommended one of each case without this variant
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// With one constant of our own variant multiplied by a factor: a question that has the same answer does
    /// not see it
    #[arg(long, value_name = "CONSTANT=FACTOR", value_parser = mutation)]
    #[arg(conflicts_with_all = ["command", "code"])]
    pub mutate: Option<Mutation>,
    /// Ask these questions alone
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub only: Vec<String>,
    /// List the questions, and the errors that each of them finds
    #[arg(long, group = "code under test")]
    pub list: bool,
    /// State walls as particles; otherwise they are planes
    #[arg(long)]
    pub wall_particles: bool,
    /// Names of columns in the results, as in `--map x=pos_x,y=pos_y`
    #[arg(long, value_name = "OURS=THEIRS,…", value_delimiter = ',', value_parser = pair)]
    pub map: Vec<(String, String)>,
    /// Wall time after which a call has failed \[s\]
    #[arg(long, value_name = "SECONDS", default_value_t = 60)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub timeout: u32,
    /// Keep the folders of all problems in this new folder
    #[arg(long, value_name = "DIR")]
    pub keep: Option<PathBuf>,
    /// Print the answers as JSON
    #[arg(long)]
    pub json: bool,
    /// Write the answers as JUnit XML, one test case a question
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct Solve {
    /// The folder of the problem, into which the results are written
    pub folder: PathBuf,
    /// One constant of the method multiplied by a factor
    #[arg(long, value_name = "CONSTANT=FACTOR", value_parser = mutation)]
    pub mutate: Option<Mutation>,
}

/// `CONSTANT=FACTOR`, as in `viscosity=2`.
fn mutation(text: &str) -> Result<Mutation, String> {
    let (of, factor) = text.split_once('=').ok_or("expected CONSTANT=FACTOR, as in viscosity=2")?;
    let of = serde_json::from_value(of.into()).map_err(|error| error.to_string())?;
    let factor =
        factor.parse().map_err(|_| format!("the factor is {factor:?}; expected a number"))?;
    Ok(Mutation { of, factor })
}

#[derive(Debug, Args)]
pub struct Symmetry {
    /// Names of the cases; by default all
    pub cases: Vec<String>,
    /// Change a setting (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Compare the results of another code instead of our own runs: two exports of one problem, with
    /// `--relation same` and with another relation
    #[arg(long, num_args = 2, value_names = ["SAME", "OTHER"], requires = "cases", conflicts_with = "set")]
    pub results: Option<Vec<PathBuf>>,
    /// Names of columns in these results, as in `--map x=pos_x,y=pos_y`
    #[arg(long, value_name = "OURS=THEIRS,…", value_delimiter = ',', value_parser = pair)]
    #[arg(requires = "results")]
    pub map: Vec<(String, String)>,
    /// Continue even if the estimate exceeds 24 hours on one core or 4 GB of memory
    #[arg(long)]
    pub allow_long: bool,
}

/// The arguments of a command under an earlier name, which are not read.
#[derive(Debug, Args)]
pub struct Earlier {
    /// Arguments of the command
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    pub arguments: Vec<String>,
}

#[derive(Debug, Args)]
pub struct Submit {
    /// Name of the case
    pub case: String,
    /// The folder of the submission: method.json, system.json, results.csv (or *.dump, *.vtu, *.vtp),
    /// and the problem.json that `export` wrote
    pub folder: PathBuf,
    /// Folder for the record, as in `verify` and `report`
    #[arg(long, value_name = "DIR", required_unless_present_any = ["check", "baseline"])]
    pub store: Option<PathBuf>,
    /// Fail if a metric is worse than in this file, which --update-baseline wrote for an earlier version of
    /// the code: by more than 1 % of the bound of its gate or, without a gate, of the larger value
    #[arg(long, value_name = "FILE", conflicts_with = "check")]
    pub baseline: Option<PathBuf>,
    /// Write the metrics of this submission into the file of --baseline, which may have earlier ones; changes
    /// are shown and do not fail
    #[arg(long, requires = "baseline")]
    pub update_baseline: bool,
    #[command(flatten)]
    pub how: Submission,
    /// List all missing and invalid entries, and record nothing
    #[arg(long)]
    pub check: bool,
    /// Print every gate, not only those that did not pass
    #[arg(long, conflicts_with = "json")]
    pub all: bool,
    /// Print the verdicts as JSON on standard output, as an entry of `submissions` of verdicts.json
    #[arg(long, conflicts_with = "check")]
    pub json: bool,
    /// Write the verdicts as JUnit XML, one test case per gate, and one for the baseline
    #[arg(long, value_name = "FILE", conflicts_with = "check")]
    pub junit: Option<PathBuf>,
}

/// The problem of a submission, and how its files are read.
#[derive(Debug, Default, Args)]
pub struct Submission {
    /// Name of the variant whose problem it solves, if the folder has no problem.json
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// A setting of the problem, if the folder has no problem.json (repeatable)
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Names of columns in the results, as in `--map x=pos_x,y=pos_y`
    #[arg(long, value_name = "OURS=THEIRS,…", value_delimiter = ',', value_parser = pair)]
    pub map: Vec<(String, String)>,
    /// Continue even if the estimate exceeds 4 GB of memory
    #[arg(long)]
    pub allow_long: bool,
}

/// `OURS=THEIRS`. Our columns depend on the case and on the submitted file.
fn pair(text: &str) -> Result<(String, String), String> {
    let (ours, theirs) = text.split_once('=').unwrap_or_default();
    match ours.is_empty() || theirs.is_empty() {
        false => Ok((ours.into(), theirs.into())),
        true => Err("expected OURS=THEIRS, as in x=pos_x".into()),
    }
}

/// How the runs of a plan are made.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct MakeArguments {
    /// Also reuse records made by a build of other sources; the report states this
    #[arg(long)]
    pub any_build: bool,
    /// Reuse no record: make every run again
    #[arg(long, conflicts_with = "any_build")]
    pub fresh: bool,
    /// Number of runs made in parallel, 1 to 1024, and of threads inside a run for which the others would
    /// wait; the default is one per core
    #[arg(long, value_name = "N", value_parser = threads())]
    pub threads: Option<u16>,
}

/// Selection of gates, and form of the verdicts.
#[derive(Debug, Args)]
pub struct Judged {
    /// Names of the cases; by default all cases, and the studies that belong to no case
    pub cases: Vec<String>,
    /// The tier whose plan is judged
    #[arg(long, value_parser = one_of(&TIERS), default_value = "quick")]
    pub tier: Tier,
    /// Write the verdicts as JUnit XML, one test case per gate
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Print every gate, then the line of each case
    #[arg(long, conflicts_with = "json")]
    pub all: bool,
    /// Print the verdicts as JSON on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct Verify {
    #[command(flatten)]
    pub of: Judged,
    /// Folder for the records; runs that have a record there are skipped
    #[arg(long, value_name = "DIR", default_value = "reports/records")]
    pub store: PathBuf,
    /// Make no run: judge what the store has
    #[arg(long, conflicts_with_all = ["fresh", "threads"])]
    pub no_runs: bool,
    /// Also measure the seconds that a report shows: these runs are made last, one at a time
    #[arg(long, conflicts_with = "no_runs")]
    pub timings: bool,
    #[command(flatten)]
    pub making: MakeArguments,
}

#[derive(Debug, Args)]
pub struct Report {
    /// How much to run
    #[arg(long, value_parser = one_of(&TIERS), default_value = "quick")]
    pub tier: Tier,
    /// Folder for the report; by default `reports`, and for the page of a sweep the folder of its records
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace a page in the folder that was made from other records
    #[arg(long)]
    pub overwrite: bool,
    /// Write the report from the records of this folder without making any run; by default, runs are
    /// made and their records stored in `records` inside the folder of --out. Runs that no tier plans,
    /// such as those of a sweep, are shown in a table and a figure, and not judged
    #[arg(long, value_name = "DIR", conflicts_with = "fresh")]
    pub store: Option<PathBuf>,
    /// With --store, judge only the runs that have records, and list all others as missing, running, stopped
    /// or failed
    #[arg(long, requires = "store")]
    pub partial: bool,
    #[command(flatten)]
    pub making: MakeArguments,
    /// Write the verdicts as JUnit XML, one test case per gate
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct Compare {
    /// The earlier report or store; or one submission: its folder, its record, or the output of
    /// `submit --json`
    pub before: PathBuf,
    /// The later one
    pub after: PathBuf,
    /// Print the differences as JSON on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct Stability {
    /// Names of the cases; by default all that declare limits of the time step
    pub cases: Vec<String>,
    /// How many variants to examine
    #[arg(long, value_parser = one_of(&TIERS), default_value = "quick")]
    pub tier: Tier,
    /// Without any run, print which mechanism limits the time step of each variant by linear theory, at
    /// default settings
    #[arg(long, conflicts_with_all = ["tier", "threads"])]
    pub theory: bool,
    /// Print the limits as JSON on standard output
    #[arg(long)]
    pub json: bool,
    /// Number of variants examined in parallel, 1 to 1024; the default is one per core
    #[arg(long, value_name = "N", value_parser = threads())]
    pub threads: Option<u16>,
}

#[derive(Debug, Args)]
pub struct Explain {
    /// Name of the gate, or the beginning of the names of several gates
    #[arg(required_unless_present = "status")]
    pub gate: Option<String>,
    /// List the gates with this verdict in the last report, one per line
    #[arg(long, value_name = "VERDICT", value_parser = one_of(&VERDICTS))]
    pub status: Option<Verdict>,
    /// Folder of the last report, which gives the verdicts and the gates of studies
    #[arg(long, value_name = "DIR", default_value = "reports")]
    pub reports: PathBuf,
}

/// A verdict by name.
const VERDICTS: [Named<Verdict>; 4] = [
    ("pass", Verdict::Pass, "Inside its bound"),
    ("fail", Verdict::Fail, "Outside its bounds, not finite, or from a run that ended early"),
    (
        "limitation",
        Verdict::Limitation,
        "Outside its bound, inside the wider one of a known limitation",
    ),
    ("expected-failure", Verdict::ExpectedFailure, "A control outside its bound, as it must be"),
];

#[derive(Debug, Args)]
pub struct Doctor {
    /// Also measure the speed of the solver (about a minute)
    #[arg(long)]
    pub bench: bool,
    /// Also show the features of the processor and the hash of each table of reference data
    #[arg(long)]
    pub verbose: bool,
    /// Folder that must be writable
    #[arg(long, value_name = "DIR", default_value = "reports")]
    pub out: PathBuf,
}

#[derive(Debug, Args)]
pub struct Completions {
    /// The shell
    pub shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub struct Man {
    /// Folder for the pages, such as `~/.local/share/man/man1`; without it the page of the program is printed
    pub dir: Option<PathBuf>,
}
