//! The arguments of each command.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use harness::case;

/// How wrong a particle method is, what being less wrong costs, and how far it can be pushed.
#[derive(Debug, Parser)]
#[command(name = "touchstone", version, arg_required_else_help = true, after_help = EXIT_CODES)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 pass, 1 a gate failed, 2 usage or invalid settings, \
                          3 the simulation diverged, 4 a bug of ours, 130 interrupted.";

#[derive(Debug, Subcommand)]
pub enum Command {
    /// List cases; or variants and settings of one
    List(List),
    /// Run one variant of a case and measure it, or the runs of a plan
    Run(Run),
    /// Print runs as JSON lines: those of a tier, or of a sweep over settings of one case
    Plan(Plan),
    /// Plan, run what the store lacks, and judge every gate
    Verify(Verify),
    /// Judge the records of a store; runs nothing
    Judge(Judge),
    /// Plan, run what the store lacks, judge, and write the page; with --store it only renders
    Report(Report),
    /// Say what changed between two reports or stores
    Compare(Compare),
    /// Find the largest stable time steps and compare them with theory
    Stability(Stability),
    /// Say what a gate checks, where its bound is and why
    Explain(Explain),
    /// Say what this program was built from, and check that it works here
    Doctor(Doctor),
    /// Print a script that completes commands in a shell
    Completions(Completions),
}

#[derive(Debug, Args)]
pub struct List {
    /// Name of the case
    pub case: Option<String>,
    /// As JSON
    #[arg(long)]
    pub json: bool,
}

/// Threads: more than machines of today have cores.
pub const MOST_THREADS: u16 = 1024;

fn threads() -> clap::builder::RangedI64ValueParser<u16> {
    clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS))
}

/// What `run` has for one run, and `run --specs` has not.
const OF_ONE_RUN: [&str; 9] =
    ["case", "variant", "set", "rows", "out", "overwrite", "vtk", "json", "allow_unstable"];

#[derive(Debug, Args)]
pub struct Run {
    /// Name of the case, as `touchstone list` has it
    #[arg(required_unless_present = "specs")]
    pub case: Option<String>,
    /// Name of the variant; by default `modern` or else the first one listed
    #[arg(long)]
    pub variant: Option<String>,
    /// Set a setting (repeatable), as in `--set re=0.1 --set end=0.5`
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Short for `--set rows=N`, and not to be given beside it
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub rows: Option<String>,
    /// Write record.json, profile.csv, series.csv and profile.png into this folder; without --out
    /// and --vtk no file is written
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write into the folder even if it holds the record of another case, whose files it then mixes with
    #[arg(long)]
    pub overwrite: bool,
    /// Write N frames for ParaView as well (default folder: reports/run-CASE-VARIANT)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=9999))]
    pub vtk: Option<u16>,
    /// Print the record, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
    /// Threads of the run, 1 to 1024; only sums over 10,000 particles and more are spread over them.
    /// With --specs: runs side by side. By default one a core
    #[arg(long, value_name = "N", value_parser = threads())]
    pub threads: Option<u16>,
    /// Run even with a time step beyond the theoretical limit
    #[arg(long)]
    pub allow_unstable: bool,
    /// Make the runs of this file, JSON lines as `touchstone plan` prints them; `-` is standard input
    #[arg(long, value_name = "FILE", requires = "store", conflicts_with_all = OF_ONE_RUN)]
    pub specs: Option<PathBuf>,
    /// Folder that keeps the records of --specs; runs that it has already are not made again
    #[arg(long, value_name = "DIR", requires = "specs")]
    pub store: Option<PathBuf>,
    /// Of --specs, only the run with this key
    #[arg(long, value_name = "KEY", requires = "specs", conflicts_with = "index")]
    pub only: Option<String>,
    /// Of --specs, only the run of this line, from 0: what an array job passes
    #[arg(long, value_name = "N", requires = "specs")]
    pub index: Option<usize>,
}

/// How much to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Tier {
    /// About a minute on two cores
    Quick,
    /// About twenty minutes
    Full,
}

impl From<Tier> for case::Tier {
    fn from(tier: Tier) -> Self {
        match tier {
            Tier::Quick => case::Tier::Quick,
            Tier::Full => case::Tier::Full,
        }
    }
}

#[derive(Debug, Args)]
pub struct Plan {
    /// Names of the cases; by default all
    pub cases: Vec<String>,
    /// How much to plan
    #[arg(long, value_enum, default_value = "quick")]
    pub tier: Tier,
    /// In place of a tier: every combination of these values (repeatable), as in
    /// `--set re=0.5,1,2 --set rows=10,20`
    #[arg(long, value_name = "KEY=VALUE,…")]
    pub set: Vec<String>,
    /// Variants of the sweep, separated by commas; by default that of `touchstone run`
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub variant: Vec<String>,
}

/// Which records are good enough.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct Reuse {
    /// Reuse records that a build of other sources made, too; the report then says so
    #[arg(long)]
    pub any_build: bool,
    /// Reuse no record: make every run again
    #[arg(long, conflicts_with = "any_build")]
    pub fresh: bool,
}

/// Verdicts for other programs.
#[derive(Clone, Debug, Default, Args)]
pub struct Export {
    /// Write the verdicts as JUnit XML, a test case a gate
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write the verdicts as a Markdown table
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct Verify {
    /// Names of the cases; by default all, and the studies that belong to none
    pub cases: Vec<String>,
    /// How much to run
    #[arg(long, value_enum, default_value = "quick")]
    pub tier: Tier,
    /// Folder that keeps the records; runs that it has already are not made again
    #[arg(long, value_name = "DIR", default_value = "reports/records")]
    pub store: PathBuf,
    #[command(flatten)]
    pub reuse: Reuse,
    #[command(flatten)]
    pub export: Export,
    /// Print the verdicts as JSON on standard output
    #[arg(long)]
    pub json: bool,
    /// Runs side by side, 1 to 1024; by default one a core
    #[arg(long, value_name = "N", value_parser = threads())]
    pub threads: Option<u16>,
}

#[derive(Debug, Args)]
pub struct Judge {
    /// Names of the cases; by default all, and the studies that belong to none
    pub cases: Vec<String>,
    /// The plan to judge
    #[arg(long, value_enum, default_value = "quick")]
    pub tier: Tier,
    /// Folder with the records
    #[arg(long, value_name = "DIR")]
    pub store: PathBuf,
    /// Judge records that a build of other sources made, too
    #[arg(long)]
    pub any_build: bool,
    #[command(flatten)]
    pub export: Export,
    /// Print the verdicts as JSON on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct Report {
    /// How much to run
    #[arg(long, value_enum, default_value = "quick")]
    pub tier: Tier,
    /// Where to write the page
    #[arg(long, value_name = "DIR", default_value = "reports")]
    pub out: PathBuf,
    /// Render the records of this folder and run nothing; by default runs are made and kept in
    /// OUT/records
    #[arg(long, value_name = "DIR", conflicts_with = "fresh")]
    pub store: Option<PathBuf>,
    #[command(flatten)]
    pub reuse: Reuse,
    #[command(flatten)]
    pub export: Export,
    /// Runs side by side, 1 to 1024; by default one a core
    #[arg(long, value_name = "N", value_parser = threads())]
    pub threads: Option<u16>,
}

#[derive(Debug, Args)]
pub struct Compare {
    /// A report or a store: what was
    pub before: PathBuf,
    /// A report or a store: what is
    pub after: PathBuf,
    /// As JSON on standard output
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct Stability {
    /// Names of the cases; by default all that declare limits
    pub cases: Vec<String>,
    /// How many variants
    #[arg(long, value_enum, default_value = "quick")]
    pub tier: Tier,
    /// Print the limits as JSON on standard output
    #[arg(long)]
    pub json: bool,
    /// Variants side by side, 1 to 1024; by default one a core
    #[arg(long, value_name = "N", value_parser = threads())]
    pub threads: Option<u16>,
}

#[derive(Debug, Args)]
pub struct Explain {
    /// Name of the gate, or how it begins
    #[arg(required_unless_present = "status")]
    pub gate: Option<String>,
    /// List the gates on which the last report has this verdict, a line each
    #[arg(long, value_enum, value_name = "VERDICT")]
    pub status: Option<Status>,
    /// Folder of the last report: its verdicts are shown, and gates on many runs are found in it
    #[arg(long, value_name = "DIR", default_value = "reports")]
    pub reports: PathBuf,
}

/// A verdict by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Status {
    /// Inside its bound
    Pass,
    /// Outside, or missing
    Fail,
    /// Outside for a known reason
    Limitation,
    /// A control that lies outside, as it must
    ExpectedFailure,
    /// Shown, not judged
    Reported,
    /// May be missing, and is
    NotMeasured,
}

#[derive(Debug, Args)]
pub struct Doctor {
    /// Measure the speed of the solver as well (about a minute)
    #[arg(long)]
    pub bench: bool,
    /// Folder that must be writable
    #[arg(long, value_name = "DIR", default_value = "reports")]
    pub out: PathBuf,
}

#[derive(Debug, Args)]
pub struct Completions {
    /// The shell
    pub shell: clap_complete::Shell,
}
