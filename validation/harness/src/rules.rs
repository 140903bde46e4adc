//! The quantities that a case derives from its settings: time step, its limit, and sound speed.

use base::{number, record::Record};

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
    /// Those of a run that is refused, for plans: the run itself is refused too, so that its gates, which
    /// must be there, fail.
    pub const REFUSED: Self = Self { dt: 1.0, dt_limit: 1.0, sound_speed: 1.0 };

    /// These and the lattice, h/dx and dx \[m\], by the names that records give them.
    pub fn numbers(self, [h_over_dx, dx]: [f64; 2]) -> [(&'static str, f64); 5] {
        let Self { dt, dt_limit, sound_speed } = self;
        [
            ("h/dx", h_over_dx),
            ("dx [m]", dx),
            ("c0 [m/s]", sound_speed),
            (PLANNED_DT, dt),
            (PLANNED_DT_OVER_LIMIT, dt / dt_limit),
        ]
    }
}

/// Name of the time step \[s\] that a run chose, among what it chose.
pub const PLANNED_DT: &str = "dt [s] planned";
/// Name of that step over its theoretical limit.
pub const PLANNED_DT_OVER_LIMIT: &str = "dt/limit planned";

/// States the largest step that was taken beside the planned one of a record: steps are shortened to reach
/// the times of samples and the end.
pub fn state_steps(record: &mut Record) {
    let planned = |name: &str| record.numerics.get(name).and_then(|value| value.as_f64());
    let (Some(dt), limit) = (planned(PLANNED_DT), planned(PLANNED_DT_OVER_LIMIT)) else { return };
    let used = record.cost.largest_dt_s;
    if used > 0.0 {
        let ratio = limit.map(|ratio| ("dt/limit", ratio * used / dt));
        let taken = [("dt [s]", used)].into_iter().chain(ratio);
        record.numerics.extend(taken.map(|(name, value)| (name.into(), number::json(value))));
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// A run of one step of 1e-4 s stated the 275 s that were planned, and 451,608 times the limit.
    #[test]
    fn a_record_states_the_step_that_was_taken_beside_the_one_that_was_planned() {
        let rules = Rules { dt: 2e-4, dt_limit: 4e-4, sound_speed: 1.0 };
        let mut record = Record::new("c", "v", json!({}), 1);
        let numbers = rules.numbers([1.2, 0.1]).map(|(name, value)| (name.into(), value.into()));
        record.numerics.extend(numbers);
        record.cost.largest_dt_s = 1e-4;
        state_steps(&mut record);
        let number = |name: &str| record.numerics[name].as_f64();
        assert_eq!([number("dt [s]"), number("dt [s] planned")], [Some(1e-4), Some(2e-4)]);
        assert_eq!([number("dt/limit"), number("dt/limit planned")], [Some(0.25), Some(0.5)]);
    }
}
