//! The terms of the paper that stabilise a scheme: artificial viscosity, artificial stress, XSPH.

touchstone_base::settings! {
    /// The strengths of stabilising terms.
    pub struct Stabilisation {
        /// linear artificial viscosity
        alpha: f64 ["-"] in 0.0..=10.0 = 0.1,
        /// quadratic artificial viscosity
        beta: f64 ["-"] in 0.0..=10.0 = 0.0,
        /// XSPH: ε
        xsph: f64 ["-"] in 0.0..=0.99 = 0.5,
        /// strength of the artificial stress
        xi: f64 ["-"] in 0.0..=10.0 = 0.3,
        /// exponent of the artificial stress
        exponent: usize ["-"] in 1..=16 = 4,
    }
}
