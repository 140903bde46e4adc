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

impl Rules {
    /// Those of a run that is refused, for plans: the run itself is refused too, so that its gates, which must
    /// be there, fail.
    pub const REFUSED: Self = Self { dt: 1.0, dt_limit: 1.0, sound_speed: 1.0 };

    /// These and the lattice, h/dx and dx \[m\], by the names that records give them.
    pub fn numbers(self, [h_over_dx, dx]: [f64; 2]) -> [(&'static str, f64); 5] {
        let Self { dt, dt_limit, sound_speed } = self;
        [
            ("h/dx", h_over_dx),
            ("dx [m]", dx),
            ("c0 [m/s]", sound_speed),
            ("dt [s]", dt),
            ("dt/limit", dt / dt_limit),
        ]
    }
}
