//! Causes why gates of any case do not detect an error of a constant.

use touchstone_base::gate::Cause;

/// The metrics do not depend on the constant.
pub static NOT_MEASURED: Cause = Cause::new(
    "Some constants, such as the density of an incompressible flow, hardly affect the metrics, so no gate \
     detects an error in them.",
    "Gates on quantities that depend on these constants, such as stresses in pascals.",
);

/// The effect of the error is inside the bounds.
pub static WIDE_BOUNDS: Cause = Cause::new(
    "Coarse spacing and uncertain references make some bounds wider than the effect of a small error in a \
     constant.",
    "Finer spacing in the runs that are judged, and references with a smaller uncertainty.",
);

/// The constant is chosen with a margin.
pub static SAFETY_MARGIN: Cause = Cause::new(
    "Time step and neighbour lists have a safety margin, so an error of some ten per cent in them hardly \
     changes a result.",
    "A gate on the error of time integration alone, and one on neighbours that a list misses.",
);

/// Why no gate detects an error of the time step.
pub const STEP: &str =
    "The time step contributes far less to the error than the spacing, as the error budget shows.";

/// Why no gate detects an error of the density.
pub const STRESS: &str = "No gate judges a stress in Pa. Beyond 30 % the density ends the run.";

/// The term does its work with another strength too.
pub static ENOUGH_OR_IDLE: Cause = Cause::new(
    "Terms that keep particles evenly spread or together have little effect in some flows, or suffice when \
     weaker.",
    "Gates on each term alone, in a scene made for it, such as the decay of a disturbed lattice.",
);
