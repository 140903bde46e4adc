//! The command line: its commands, and the exit codes of the process.
//!
//! | Exit code | Meaning |
//! |---|---|
//! | 0 | done, and every gate that was judged passed |
//! | 1 | a gate failed |
//! | 2 | invalid command or settings, or a file that cannot be written, whatever the verdicts |
//! | 3 | the simulation of `run` diverged |
//! | 4 | a bug in touchstone |
//! | 77 | `solve` cannot solve the problem |
//! | 130 | interrupted; files may have been written, and each is complete |
//!
//! Results go to standard output; progress, estimates and messages go to standard error.

mod arguments;
mod baseline;
mod checkpoint;
mod compare;
mod comparisons;
mod doctor;
mod exchange;
mod explain;
mod interrupt;
mod judged;
mod junit;
mod list;
mod man;
mod metrics;
mod output;
mod partial;
mod plan;
mod probe;
mod profile;
mod progress;
mod report;
mod run;
mod solve;
mod stability;
mod submitted;
mod summary;
mod sweep;
mod symmetry;
#[cfg(test)]
mod tests;
mod verify;

use std::error::Error as _;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{CommandFactory, Parser};
use touchstone_base::files::FileError;
use touchstone_base::manifest::{Answer, Source, UNKNOWN, tell_source};
use touchstone_base::reference::{Reference, ReferenceError};
use touchstone_base::spec::RunKey;
use touchstone_harness::case::{Case, RunError, Tier};
use touchstone_harness::estimate::estimate;
use touchstone_harness::make::{self, BatchOptions, BatchResult, Job, StoredRuns};
use touchstone_harness::store::Store;
use touchstone_harness::suite::Plans;
use touchstone_harness::tally::Done;

use arguments::{Arguments, Command};

/// Exit code of the process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Done, and nothing failed.
    Pass = 0,
    /// A gate failed.
    GateFailed = 1,
    /// The request is invalid.
    Usage = 2,
    /// The simulation diverged.
    Diverged = 3,
    /// A bug in touchstone.
    Bug = 4,
    /// `solve` cannot solve the problem.
    Declines = 77,
    /// The user interrupted.
    Interrupted = 130,
}

/// Why a command ended early, and with what.
#[derive(Debug)]
pub struct Failure {
    exit: Exit,
    reason: String,
}

impl Failure {
    /// A request that cannot be met.
    fn usage(reason: impl std::fmt::Display) -> Self {
        Failure { exit: Exit::Usage, reason: reason.to_string() }
    }

    /// Something that must not happen.
    fn bug(reason: impl std::fmt::Display) -> Self {
        Failure { exit: Exit::Bug, reason: reason.to_string() }
    }

    /// Stopped by the user.
    fn interrupted(what: impl std::fmt::Display) -> Self {
        Failure { exit: Exit::Interrupted, reason: format!("interrupted: {what}") }
    }
}

/// An error of a layer below is one of the request, unless its place makes it a bug.
impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Failure::usage(error)
    }
}

/// Result of a command.
type Outcome = Result<Exit, Failure>;

/// Shows the results before all runs are made; returns a message if it did.
type Early<'a> = dyn Fn(BatchResult) -> Option<String> + Sync + 'a;

/// A reference that is not as it was described, and the names of the cases that are compared with it.
type WrongReference = (ReferenceError, &'static [&'static str]);

/// The cases and stores that commands use.
#[derive(Clone, Copy)]
pub struct Session {
    /// The cases to choose from.
    cases: &'static [&'static dyn Case],
    /// Digest of the sources that determine the results of a case.
    sources: fn(&str) -> String,
    /// The references of these cases, and of no case, that differ from their description.
    references: fn(&[&str]) -> Vec<WrongReference>,
    /// Set to stop.
    interrupt: &'static AtomicBool,
}

impl Session {
    /// The named cases, or all.
    fn choose(&self, names: &[String]) -> Result<Vec<&'static dyn Case>, RunError> {
        if names.is_empty() {
            return Ok(self.cases.to_vec());
        }
        let mut chosen: Vec<&'static dyn Case> = Vec::new();
        for name in names {
            let case = touchstone_cases::find_in(self.cases, name)?;
            if !chosen.iter().any(|known| known.name() == case.name()) {
                chosen.push(case);
            }
        }
        Ok(chosen)
    }

    /// Default options for making runs.
    fn making(&self, tier: Tier) -> BatchOptions<'_> {
        BatchOptions { interrupt: Some(self.interrupt), ..BatchOptions::new(tier, &self.sources) }
    }

    /// The stored runs of plans, whether or not timed runs were made alone.
    fn stored(&self, plans: &Plans, store: &Store, any_build: bool) -> StoredRuns {
        let jobs = make::jobs(verify::without_timings(plans.clone()));
        let store = Some(store);
        make::stored(
            &jobs,
            &BatchOptions { store, reuse_other: any_build, ..self.making(Tier::Quick) },
        )
    }

    /// Makes the runs that a store lacks, on a pool of threads, with a progress bar, and reports failures.
    /// `early` is called each time that a case is complete.
    fn make(
        &self,
        jobs: &[Job],
        making: BatchOptions,
        threads: Option<u16>,
        early: Option<&Early>,
    ) -> Result<BatchResult, Failure> {
        let bar = progress::Bar::new();
        let show = |done: Done| bar.show_runs(done);
        let finished = early.map(|early| {
            |made: BatchResult| early(made).into_iter().for_each(|words: String| bar.say(&words))
        });
        let made = on_threads(threads, || {
            let mut stored = make::stored(jobs, &making);
            estimate(&mut stored.missing, &making);
            let finished = finished.as_ref().map(|finished| finished as _);
            Ok(make::make(stored, &BatchOptions { progress: Some(&show), finished, ..making }))
        });
        bar.clear();
        let made = made?;
        report_problems(&made);
        Ok(made)
    }

    /// Refuses to run or judge cases by a reference that was changed, or to show one that no case uses.
    fn check_references(&self, cases: &[&'static dyn Case]) -> Result<(), Failure> {
        let names: Vec<&str> = cases.iter().map(|case| case.name()).collect();
        let word = |(error, users): WrongReference| match users {
            [] => error.to_string(),
            _ => format!("{error}; it judges {}", users.join(" and ")),
        };
        let words: Vec<String> = (self.references)(&names).into_iter().map(word).collect();
        if words.is_empty() {
            return Ok(());
        }
        let reason = format!("nothing is judged: {}", words.join("\n"));
        Err(Failure { exit: Exit::GateFailed, reason })
    }

    /// Continues unless the user interrupts; then the error states the results so far.
    fn go_on(&self, what: &str) -> Result<(), Failure> {
        if self.is_interrupted() { Err(Failure::interrupted(what)) } else { Ok(()) }
    }

    fn is_interrupted(&self) -> bool {
        self.interrupt.load(Ordering::Relaxed)
    }
}

/// Number of messages of one kind that are printed in full.
const MOST_SHOWN: usize = 10;

/// Prints problems, the first ones in full.
fn print_problems(lines: impl ExactSizeIterator<Item = String>) {
    let more = lines.len().saturating_sub(MOST_SHOWN);
    lines.take(MOST_SHOWN).for_each(|line| output::say(&format!("touchstone: {line}")));
    if more > 0 {
        output::say(&format!("touchstone: and {more} more like this"));
    }
}

/// Reports records that could not be read, kept or made.
fn report_problems(made: &BatchResult) {
    let again = |error: &FileError| format!("{error}; this record is ignored");
    print_problems(made.unsound.values().map(again));
    let lost = |error: &FileError| format!("a record could not be stored: {error}");
    print_problems(made.not_kept.values().map(lost));
    let failed = |(key, failed): (&RunKey, &RunError)| format!("run {key} has no record: {failed}");
    print_problems(made.failed.iter().map(failed));
    let unread = |error: &FileError| format!("{error}; the submission is ignored");
    print_problems(made.unread.iter().map(unread));
}

/// 4 if a run ended by a bug, 2 if a file could not be written or read, otherwise nothing.
fn trouble(made: &BatchResult) -> Option<Exit> {
    match made.failed.values().any(|failed| matches!(failed, RunError::Bug)) {
        true => Some(Exit::Bug),
        false => (!made.failed.is_empty() || !made.not_kept.is_empty()).then_some(Exit::Usage),
    }
}

/// The sources of this binary.
const SOURCE: Source = Source {
    commit: env!("TOUCHSTONE_COMMIT"),
    dirty: match env!("TOUCHSTONE_DIRTY").as_bytes() {
        b"yes" => Answer::Yes,
        b"no" => Answer::No,
        _ => Answer::Unknown,
    },
};

/// The digest of the sources of the family that a case belongs to.
fn sources(case: &str) -> String {
    let family = touchstone_cases::find(case).map_or("", |case| case.family());
    let digests = env!("TOUCHSTONE_SOURCES").split(' ').filter_map(|of| of.split_once('='));
    let digest = digests.into_iter().find(|(name, _)| *name == family);
    digest.map_or(UNKNOWN, |(_, digest)| digest).into()
}

/// The embedded references of these cases, and of no case, that differ from their description.
fn references(cases: &[&str]) -> Vec<WrongReference> {
    let names = Reference::names().into_iter().map(|name| (name, touchstone_cases::users(name)));
    // To read all takes as long as half of a small run.
    let asked = names
        .filter(|(_, users)| users.is_empty() || users.iter().any(|user| cases.contains(user)));
    asked.filter_map(|(name, users)| Some((Reference::load(name).err()?, users))).collect()
}

/// Parses the arguments of the process and runs the command.
pub fn main() -> ExitCode {
    std::panic::set_hook(Box::new(output::report_bug));
    tell_source(SOURCE);
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) if error.use_stderr() => {
            output::say(&error.render().to_string()); // it quotes arguments
            return code(Exit::Usage);
        }
        Err(help) => {
            let printed = output::taken(help.print());
            return code(conclude(|| printed.map(|()| Exit::Pass)));
        }
    };
    let session = Session {
        cases: touchstone_cases::CASES,
        sources,
        references,
        interrupt: interrupt::flag(),
    };
    let threads = default_threads();
    if threads > 0 {
        output::say(&format!(
            "note: RAYON_NUM_THREADS is more than {threads}; only {threads} threads are used"
        ));
    }
    if let Err(error) = interrupt::listen() {
        output::say(&format!("note: an interrupt will end the program at once ({error})"));
    }
    code(conclude(|| dispatch(&arguments.command, &session)))
}

fn code(exit: Exit) -> ExitCode {
    ExitCode::from(exit as u8)
}

/// Turns the result of a command, or its panic, into an exit code, and prints the reason.
fn conclude(command: impl FnOnce() -> Outcome) -> Exit {
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(command)) {
        Ok(Ok(exit)) => exit,
        Ok(Err(Failure { exit, reason })) => {
            match exit {
                Exit::Bug => output::say(&format!("{}\n{reason}", output::BUG)),
                _ => output::say(&format!("touchstone: {reason}")),
            }
            exit
        }
        Err(_) if output::GOES_ON.load(Ordering::Relaxed) => Exit::Usage,
        Err(_) => Exit::Bug, // the hook has said what there is to say
    }
}

fn dispatch(command: &Command, session: &Session) -> Outcome {
    let done = |()| Exit::Pass;
    use Command::{Completions, Doctor, Explain, List, Man};
    if !matches!(command, List(_) | Explain(_) | Doctor(_) | Completions(_) | Man(_)) {
        start_threads()?;
    }
    match command {
        Command::List(arguments) => list::list(arguments, session).map(done),
        Command::Run(arguments) => run::run(arguments, session),
        Command::Plan(arguments) => plan::plan(arguments, session).map(done),
        Command::Verify(arguments) => verify::verify(arguments, session),
        Command::Judge(_) => Err(renamed("judge", "verify --no-runs")),
        Command::Report(arguments) => report::report(arguments, session),
        Command::Export(arguments) => exchange::export(arguments, session).map(done),
        Command::Challenge(_) => Err(renamed("challenge", "export --sealed SEED --method FILE")),
        Command::Submit(arguments) => exchange::submit(arguments, session),
        Command::Probe(arguments) => probe::probe(arguments, session),
        Command::Solve(arguments) => solve::solve(arguments, session),
        Command::Symmetry(of) => match of.results.as_deref() {
            Some([same, other]) => match &of.cases[..] {
                [case] => exchange::relate(case, [same, other], &of.map, of.allow_long, session),
                _ => Err(Failure::usage("--results belong to one case; name it")),
            },
            _ => symmetry::symmetry(of, session),
        },
        Command::Relate(_) => Err(renamed("relate", "symmetry CASE --results SAME OTHER")),
        Command::Compare(arguments) => compare::compare(arguments, session),
        Command::Stability(arguments) => stability::stability(arguments, session),
        Command::Explain(arguments) => explain::explain(arguments, session).map(done),
        Command::Doctor(arguments) => doctor::doctor(arguments, session),
        Command::Completions(arguments) => completions(arguments).map(done),
        Command::Man(arguments) => man::man(arguments).map(done),
    }
}

/// The refusal of a command under an earlier name.
fn renamed(old: &str, new: &str) -> Failure {
    Failure::usage(format!("`touchstone {old}` is `touchstone {new}` now"))
}

/// The script of a shell, on standard output.
fn completions(arguments: &arguments::Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "touchstone", &mut script);
    output::print(&String::from_utf8_lossy(&script))
}

/// The number of threads for rayon without `--threads`: 0, which means one a core or `RAYON_NUM_THREADS`,
/// unless this exceeds the maximum of `--threads`.
fn default_threads() -> usize {
    threads_of(std::env::var("RAYON_NUM_THREADS").ok().as_deref())
}

fn threads_of(variable: Option<&str>) -> usize {
    let most = usize::from(arguments::MOST_THREADS);
    // A number that is too long for its type is too large as well.
    let is_number =
        |text: &&str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let asked = variable.filter(is_number).map(|text| text.parse().unwrap_or(usize::MAX));
    if asked.is_some_and(|asked| asked > most) { most } else { 0 }
}

/// Size of the stack of each thread \[bytes\], whatever the environment requests.
const STACK: usize = 1 << 21;

fn pool(threads: usize) -> rayon::ThreadPoolBuilder {
    rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK)
}

fn no_threads(threads: usize, error: &rayon::ThreadPoolBuildError) -> Failure {
    let asked = std::env::var("RAYON_NUM_THREADS").unwrap_or_else(|_| "one a core".into());
    let many = if threads > 0 { threads.to_string() } else { asked };
    Failure::usage(format!(
        "the threads cannot be started ({many}): {error}; ask for fewer by --threads N or RAYON_NUM_THREADS=N"
    ))
}

/// Starts the threads that all commands share.
///
/// # Errors
/// If the system refuses this number of threads.
fn start_threads() -> Result<(), Failure> {
    let threads = default_threads();
    match pool(threads).build_global() {
        Err(error) if error.source().is_some() => Err(no_threads(threads, &error)),
        _ => Ok(()), // the other error is that they are started
    }
}

/// Does the work on a pool of this number of threads, by default on the pool of all commands.
fn on_threads<T: Send>(
    threads: Option<u16>,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let Some(threads) = threads.map(usize::from) else {
        start_threads()?;
        return rayon::scope(|_| work());
    };
    let pool = pool(threads).build().map_err(|error| no_threads(threads, &error))?;
    pool.install(work)
}
