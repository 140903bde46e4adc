//! The types that all crates of the harness use: settings, numbers, files, gates, records, references.

pub mod absent;
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

/// Locks a mutex. A panic of another thread that held it is ignored: no user of this function leaves data
/// incomplete, and the panic is reported elsewhere.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
