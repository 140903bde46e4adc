//! The quantities that a case derives from its settings: time step, its limit, and sound speed.

/// The quantities that the rules of a case determine before the first step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Time step \[s\].
    pub dt: f64,
    /// Its theoretical limit \[s\].
    pub dt_limit: f64,
    /// Sound speed \[m/s\].
    pub sound_speed: f64,
}
