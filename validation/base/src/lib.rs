//! The types that all crates of the harness use: settings, numbers, files, gates, records, references.

pub mod absent;
pub mod bits;
pub mod breakdown;
pub mod files;
pub mod functions;
pub mod gate;
pub mod manifest;
pub mod mutation;
pub mod number;
pub mod pack;
pub mod random;
pub mod record;
pub mod reference;
pub mod settings;
pub mod spec;
pub mod submission;
pub mod text;
pub mod vtk;

use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a mutex holds. That a thread which had it has panicked does not matter: nothing is left half done
/// where it is used, and the panic is told elsewhere.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
