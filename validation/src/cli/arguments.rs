//! The arguments of each command.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use validation::case;

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
    /// Run one variant of a case and measure it
    Run(Run),
    /// Run the plans of cases and judge every gate
    Verify(Verify),
    /// Run everything and write the page, its figures and the records
    Report(Report),
    /// Find the largest stable time step of every variant and compare it with theory
    Stability(Stability),
    /// Say what a gate checks, where its bound is and why
    Explain(Explain),
    /// Say what this program was built from, and check that it works here
    Doctor(Doctor),
}

#[derive(Debug, Args)]
pub struct List {
    /// Name of the case
    pub case: Option<String>,
    /// As JSON
    #[arg(long)]
    pub json: bool,
}

/// Threads: within bounds that no machine of today exceeds.
fn threads() -> clap::builder::RangedI64ValueParser<u16> {
    clap::value_parser!(u16).range(1..=1024)
}

#[derive(Debug, Args)]
pub struct Run {
    /// Name of the case, as `touchstone list` has it
    pub case: String,
    /// Name of the variant; by default `modern` or else the first one listed
    #[arg(long)]
    pub variant: Option<String>,
    /// Set a setting (repeatable), as in `--set re=0.1 --set end=0.5`
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Short for `--set rows=N`
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub rows: Option<String>,
    /// Write record.json, profile.csv, series.csv and profile.png into this folder; without --out
    /// and --vtk no file is written
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write N frames for ParaView as well (default folder: reports/run-CASE-VARIANT)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=9999))]
    pub vtk: Option<u16>,
    /// Print the record, and nothing else, on standard output
    #[arg(long)]
    pub json: bool,
    /// Threads of the run, 1 to 1024; only sums over 10,000 particles and more are spread over them.
    /// By default one a core
    #[arg(long, value_name = "N", value_parser = threads())]
    pub threads: Option<u16>,
    /// Run even with a time step beyond the theoretical limit
    #[arg(long)]
    pub allow_unstable: bool,
}

/// How much to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Tier {
    /// Under a minute on two cores
    Quick,
    /// Under twenty minutes
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
pub struct Verify {
    /// Names of the cases; by default all, and the studies that belong to none
    pub cases: Vec<String>,
    /// How much to run
    #[arg(long, value_enum, default_value = "quick")]
    pub tier: Tier,
    /// Print the verdicts as JSON on standard output
    #[arg(long)]
    pub json: bool,
    /// Runs side by side, 1 to 1024; by default one a core
    #[arg(long, value_name = "N", value_parser = threads())]
    pub threads: Option<u16>,
}

#[derive(Debug, Args)]
pub struct Report {
    /// How much to run
    #[arg(long, value_enum, default_value = "quick")]
    pub tier: Tier,
    /// Where to write the page
    #[arg(long, value_name = "DIR", default_value = "reports")]
    pub out: PathBuf,
    /// Runs side by side, 1 to 1024; by default one a core
    #[arg(long, value_name = "N", value_parser = threads())]
    pub threads: Option<u16>,
}

#[derive(Debug, Args)]
pub struct Stability {
    /// Names of the cases; by default all
    pub cases: Vec<String>,
    /// How closely to look
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
    pub gate: String,
    /// Folder of the last report: its verdicts are shown, and gates on many runs are found in it
    #[arg(long, value_name = "DIR", default_value = "reports")]
    pub reports: PathBuf,
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
