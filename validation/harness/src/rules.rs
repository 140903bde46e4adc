//! The quantities that a case derives from its settings: time step, its limit, and sound speed.

use std::collections::BTreeMap;

use base::{number, record::Record};
use serde_json::Value;

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
            (DT, dt),
            (DT_OVER_LIMIT, dt / dt_limit),
        ]
    }
}

/// Name of the time step among what a run chose.
const DT: &str = "dt [s]";
/// Name of the time step over its limit.
const DT_OVER_LIMIT: &str = "dt/limit";

/// Calls the time step of a record and its share of the limit, which were planned, by that name, and states
/// beside them the largest step that was taken: steps are shortened to reach the times of samples and the
/// end.
pub fn state_steps(record: &mut Record) {
    let numerics = &mut record.numerics;
    let planned = |numerics: &mut BTreeMap<String, Value>, name: &str| {
        let value = numerics.remove(name)?;
        let number = value.as_f64();
        numerics.insert(format!("{name} planned"), value);
        number
    };
    let (Some(dt), limit) = (planned(numerics, DT), planned(numerics, DT_OVER_LIMIT)) else {
        return;
    };
    let used = record.cost.largest_dt_s;
    if used > 0.0 {
        numerics.insert(DT.into(), number::json(used));
        numerics.extend(limit.map(|ratio| (DT_OVER_LIMIT.into(), number::json(ratio * used / dt))));
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
