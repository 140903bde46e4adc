//! The sum of two forces of which one is stiff: dv/dt = E + T(v), for super-time-stepping of T.

/// The sum of the forces `E` and the stiff force `T`. [`crate::SuperSteps`] integrates `T` over steps longer
/// than the limit of an explicit integrator.
#[derive(Clone, Copy, Debug)]
pub struct Split<E, T>(
    /// All forces but the stiff one.
    pub E,
    /// The stiff force: linear in the differences of velocity, with negative real eigenvalues.
    pub T,
    /// The longest stable step of forward Euler for the stiff force \[s\], above 0: 2 over the largest
    /// absolute eigenvalue.
    pub f64,
);
