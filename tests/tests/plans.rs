//! What every plan must be, whatever the case.

use harness::{
    case::{RunError, Tier},
    plan,
};
use validation::cases::CASES;

/// A run that sets what its variant does not read is refused, and a study of it would have nothing to say.
#[test]
fn no_planned_run_sets_what_its_variant_lacks() {
    for case in CASES {
        for planned in plan::of_case(*case, Tier::Full) {
            let refused = case.rules(&planned.spec);
            let spec = &planned.spec;
            assert!(!matches!(refused, Err(RunError::Unused { .. })), "{refused:?}: {spec:?}");
        }
    }
}
