//! Signals: the first asks every loop to stop in order, and loops that do not stop soon are stopped; a second
//! one stops at once. No file is left half-written.

use std::io;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, sleep};
use std::time::Duration;

use touchstone_base::files;

use super::{Exit, output};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// Is a checkpoint to be written before the end?
static HELD: AtomicBool = AtomicBool::new(false);

/// Time in which a command stops by itself: with it, the end comes within a second.
const PATIENCE: Duration = Duration::from_millis(700);
/// Between two looks, and time for a last message.
const SHORT: Duration = Duration::from_millis(20);

/// Set by the first interrupt.
pub fn flag() -> &'static AtomicBool {
    &INTERRUPTED
}

/// While it exists, an interrupted command goes on until it stops by itself, however long that takes: a step
/// of a large scene, and then its checkpoint.
pub struct Hold(());

impl Hold {
    /// Until it is dropped.
    pub fn new() -> Self {
        HELD.store(true, Ordering::Relaxed);
        Self(())
    }
}

impl Drop for Hold {
    fn drop(&mut self) {
        HELD.store(false, Ordering::Relaxed);
    }
}

/// Handles a signal.
fn interrupt() {
    if INTERRUPTED.swap(true, Ordering::Relaxed) {
        end();
    }
    let patient = spawn(|| {
        sleep(PATIENCE);
        while HELD.load(Ordering::Relaxed) {
            sleep(SHORT);
        }
        // On a separate thread, because standard error may be blocked.
        let last = "touchstone: interrupted; every written file is complete";
        let _ = spawn(|| output::say(last));
        sleep(SHORT);
        end();
    });
    if patient.is_err() {
        end(); // nobody would end what does not stop by itself
    }
    output::say("interrupting; interrupt once more to end at once");
}

/// Starts a thread with a fixed size of its stack, whatever the environment requests.
///
/// # Errors
/// If the system has no more threads.
fn spawn(work: impl FnOnce() + Send + 'static) -> io::Result<()> {
    thread::Builder::new().stack_size(super::STACK).spawn(work).map(drop)
}

fn end() -> ! {
    files::remove_unfinished();
    process::exit(Exit::Interrupted as i32);
}

/// Listens for signals from now on: interrupts, requests to terminate, and the end of the terminal unless
/// that was ignored at the start, as `nohup` asks. A limit of the size of files is an error of writing.
///
/// # Errors
/// If the system refuses.
#[cfg(unix)]
pub fn listen() -> io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;

    signal_hook::flag::register(SIGXFSZ, std::sync::Arc::default())?;
    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    // Where this cannot be known, the system ends the process, or does not.
    if is_ignored(SIGHUP) == Some(false) {
        signals.add_signal(SIGHUP)?;
    }
    spawn(move || signals.forever().for_each(|_| interrupt()))
}

/// Does this process ignore a signal? Known on Linux alone.
#[cfg(unix)]
fn is_ignored(signal: i32) -> Option<bool> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    let mask = u64::from_str_radix(mask.trim(), 16).ok()?;
    Some(mask >> (signal - 1) & 1 == 1)
}

/// No signal is listened for: the system ends the process.
///
/// # Errors
/// Always.
#[cfg(not(unix))]
pub fn listen() -> io::Result<()> {
    let _: fn() = interrupt;
    Err(std::io::ErrorKind::Unsupported.into())
}
