//! Ctrl-c: once to stop in order, twice to stop at once.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use base::files;

use super::{Exit, output};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Set by the first interrupt.
pub fn flag() -> &'static AtomicBool {
    &INTERRUPTED
}

/// Listens for interrupts (and requests to terminate) from now on.
pub fn listen() -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            files::remove_unfinished();
            process::exit(Exit::Interrupted as i32);
        }
        output::say("interrupting; interrupt once more to end at once");
    })
}
