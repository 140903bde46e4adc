//! Common parts of the tests of several cases.

use touchstone_harness::{
    case::{self, Case, RunError},
    context::Context,
};

/// Why a run with this assignment is refused, if it is.
pub fn refused(case: &dyn Case, variant: &str, set: &str) -> Option<RunError> {
    let spec = case::spec(case, variant, &[set.into()]);
    spec.and_then(|spec| case.run(&spec, &Context::default())).err()
}
