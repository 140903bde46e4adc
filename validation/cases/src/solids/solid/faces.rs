//! The effect of free faces on the stiffness of an elastic body in bending.

use touchstone_base::gate::{Bound, Gate};
use touchstone_maths::theory::faces::period_excess;

use crate::solids::causes::FREE_FACES;

/// The known excess of periods of bending over an elastic body's: the effect of faces, and 7 % more, as in
/// published SPH of a plate with many layers.
pub fn known_excess(layers: usize, h_over_dx: f64) -> f64 {
    1.07 * (1.0 + period_excess(layers, h_over_dx)) - 1.0
}

/// A limitation of bodies of few layers whose sums are not corrected.
pub fn soft(gate: Gate, known: Bound) -> Gate {
    const SOFT: &str = "Bending strains a body most near its faces, where sums lack neighbours, so bodies of \
        few layers are softer than first order says: they swing slowly, bend far, and leave late. The bound: \
        sums over the layers that there are lengthen the period by 30 % with 5, 15 % with 10 and 7 % with 20 \
        layers, published plates of many layers have another 7 %, and deflections go with its square.";
    gate.with_limitation(known, SOFT, &FREE_FACES)
}
