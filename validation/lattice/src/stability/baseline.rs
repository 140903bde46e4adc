//! Limits that this study measured before: not the truth, but nothing may get worse unnoticed. The numbers
//! depend on no clock and no machine, only on the program and, in their last digits, on its libm; so they
//! stand here, to four digits.
//!
//! Obtained with the full tier, boxes of 12 × 12 particles. A change that moves one on purpose changes it
//! here, and says why.

use base::gate::{Bound, Evidence, Gate};

/// A limit may be this much below its baseline: the resolution of the bisections.
const SLACK: f64 = 0.99;

/// Longest stable c₀ dt/h of a point (the middle of its bracket), by the name of its gate.
#[rustfmt::skip] // one line a point: a table
const LIMITS: &[(&str, f64)] = &[
    ("stability.cubic.h1.3.leapfrog.stiffness1", 0.356),
    ("stability.cubic.h1.3.predictor-corrector.stiffness1", 0.3543),
    ("stability.cubic.h1.3.leapfrog.stiffness3", 1.068),
    ("stability.cubic.h1.3.predictor-corrector.stiffness3", 1.063),
    ("stability.cubic.h1.3.leapfrog.stiffness10", 1.662),
    ("stability.cubic.h1.3.predictor-corrector.stiffness10", 0.9517),
    ("stability.cubic.h1.3.leapfrog.stiffness30", 1.813),
    ("stability.cubic.h1.3.predictor-corrector.stiffness30", 0.6264),
    ("stability.cubic.h1.3.leapfrog.stiffness100", 1.87),
    ("stability.cubic.h1.3.predictor-corrector.stiffness100", 0.4071),
    ("stability.cubic.h1.3.leapfrog.stiffnessinf", 1.89),
    ("stability.cubic.h1.3.leapfrog.stiffnessinf.alpha1.delta0", 1.024),
    ("stability.cubic.h1.3.leapfrog.stiffnessinf.alpha0.delta1", 0.353),
    ("stability.cubic.h1.3.predictor-corrector.stiffnessinf.alpha1.delta0", 1.016),
    ("stability.cubic.h1.3.leapfrog.stiffness30.alpha0.1.delta0.1", 1.55),
    ("stability.cubic.h1.3.leapfrog.stiffnessinf.alpha0.1.delta0", 1.812),
    ("stability.cubic.h1.3.super-leapfrog.stiffness1", 4.268),
    ("stability.cubic.h1.3.super-leapfrog.stiffness3", 2.371),
    ("stability.cubic.h1.3.super-leapfrog.stiffness10", 1.929),
    ("stability.cubic.h1.3.super-leapfrog.stiffness30", 1.9),
    ("stability.cubic.h1.3.super-leapfrog.stiffness30.alpha0.1.delta0.1", 1.607),
    ("stability.quintic.h1.leapfrog.stiffness1", 0.5315),
    ("stability.quintic.h1.predictor-corrector.stiffness1", 0.5275),
    ("stability.quintic.h1.leapfrog.stiffness3", 1.583),
    ("stability.quintic.h1.predictor-corrector.stiffness3", 1.583),
    ("stability.quintic.h1.leapfrog.stiffness10", 2.104),
    ("stability.quintic.h1.predictor-corrector.stiffness10", 1.08),
    ("stability.quintic.h1.leapfrog.stiffness30", 2.245),
    ("stability.quintic.h1.predictor-corrector.stiffness30", 0.7143),
    ("stability.quintic.h1.leapfrog.stiffness100", 2.291),
    ("stability.quintic.h1.predictor-corrector.stiffness100", 0.4675),
    ("stability.quintic.h1.leapfrog.stiffnessinf", 2.313),
    ("stability.quintic.h1.leapfrog.stiffnessinf.alpha1.delta0", 1.475),
    ("stability.quintic.h1.leapfrog.stiffnessinf.alpha0.delta1", 0.5302),
    ("stability.quintic.h1.predictor-corrector.stiffnessinf.alpha1.delta0", 1.544),
    ("stability.quintic.h1.leapfrog.stiffness30.alpha0.1.delta0.1", 1.982),
    ("stability.quintic.h1.leapfrog.stiffnessinf.alpha0.1.delta0", 2.244),
    ("stability.cubic.h1.2.leapfrog.stiffness1", 0.3561),
    ("stability.cubic.h1.2.predictor-corrector.stiffness1", 0.3535),
    ("stability.cubic.h1.2.leapfrog.stiffness3", 1.068),
    ("stability.cubic.h1.2.predictor-corrector.stiffness3", 1.06),
    ("stability.cubic.h1.2.leapfrog.stiffness10", 1.668),
    ("stability.cubic.h1.2.predictor-corrector.stiffness10", 0.9508),
    ("stability.cubic.h1.2.leapfrog.stiffness30", 1.799),
    ("stability.cubic.h1.2.predictor-corrector.stiffness30", 0.6261),
    ("stability.cubic.h1.2.leapfrog.stiffness100", 1.848),
    ("stability.cubic.h1.2.predictor-corrector.stiffness100", 0.4069),
    ("stability.cubic.h1.2.leapfrog.stiffnessinf", 1.865),
    ("stability.cubic.h1.2.leapfrog.stiffnessinf.alpha1.delta0", 1.032),
    ("stability.cubic.h1.2.leapfrog.stiffnessinf.alpha0.delta1", 0.3537),
    ("stability.cubic.h1.2.predictor-corrector.stiffnessinf.alpha1.delta0", 1.03),
    ("stability.cubic.h1.2.leapfrog.stiffness30.alpha0.1.delta0.1", 1.551),
    ("stability.cubic.h1.2.leapfrog.stiffnessinf.alpha0.1.delta0", 1.799),
    ("stability.wendland-c2.h2.leapfrog.stiffness1", 0.3052),
    ("stability.wendland-c2.h2.predictor-corrector.stiffness1", 0.3037),
    ("stability.wendland-c2.h2.leapfrog.stiffness3", 0.9157),
    ("stability.wendland-c2.h2.predictor-corrector.stiffness3", 0.9112),
    ("stability.wendland-c2.h2.leapfrog.stiffness10", 1.556),
    ("stability.wendland-c2.h2.predictor-corrector.stiffness10", 0.9164),
    ("stability.wendland-c2.h2.leapfrog.stiffness30", 1.712),
    ("stability.wendland-c2.h2.predictor-corrector.stiffness30", 0.6018),
    ("stability.wendland-c2.h2.leapfrog.stiffness100", 1.77),
    ("stability.wendland-c2.h2.predictor-corrector.stiffness100", 0.3895),
    ("stability.wendland-c2.h2.leapfrog.stiffnessinf", 1.791),
    ("stability.wendland-c2.h2.leapfrog.stiffnessinf.alpha1.delta0", 0.9549),
    ("stability.wendland-c2.h2.leapfrog.stiffnessinf.alpha0.delta1", 0.2986),
    ("stability.wendland-c2.h2.predictor-corrector.stiffnessinf.alpha1.delta0", 0.9631),
    ("stability.wendland-c2.h2.leapfrog.stiffness30.alpha0.1.delta0.1", 1.439),
    ("stability.wendland-c2.h2.leapfrog.stiffnessinf.alpha0.1.delta0", 1.703),
];

const BECAUSE: &str = "The bound is what this study measured when its baseline was set, less 1 % for the \
                       resolution of the bisection.";

/// The gate that a limit must not shrink; `None` if it was never measured.
pub fn limit_gate(id: &str) -> Option<Gate> {
    let (_, limit) = LIMITS.iter().find(|(name, _)| *name == id)?;
    let bound = Bound::Above(SLACK * limit);
    Some(Gate::new(format!("{id}.limit"), "c0 dt/h", bound, Evidence::Regression, BECAUSE))
}
