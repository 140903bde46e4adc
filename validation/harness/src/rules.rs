//! The quantities that a case derives from its settings: time step, its limit, and sound speed.

use touchstone_base::{number, record::Record};

use crate::limits::TimeStepLimits;

/// The quantities that the rules of a case determine before the first step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// The time step and the rule that sets it.
    pub step: Step,
    /// Theoretical limits.
    pub limits: TimeStepLimits,
    /// Sound speed \[m/s\].
    pub sound_speed: f64,
    /// End of the run \[s\].
    pub end: f64,
}

/// A time step \[s\]: the least step that the rules of a case allow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The step \[s\].
    pub dt: f64,
    /// The rule that sets it, as its formula.
    pub by: &'static str,
    /// The factor of the rule.
    pub number: f64,
}

impl Step {
    /// dt ≤ C h/(c + V): a wave of speed c \[m/s\] in matter of speed V \[m/s\] gets ahead by C smoothing
    /// lengths.
    pub fn courant(number: f64, h: f64, [c, v]: [f64; 2]) -> Self {
        Self { dt: number * h / (c + v), by: "h/(c + V)", number }
    }

    /// dt ≤ N h²/ν: viscosity.
    #[must_use]
    pub fn viscous(self, number: f64, h: f64, nu: f64) -> Self {
        self.least(Self { dt: number * h * h / nu, by: "h²/ν", number })
    }

    /// dt ≤ N (h/F)^(1/2): a body force \[m/s²\]; none if it is 0.
    #[must_use]
    pub fn forced(self, number: f64, h: f64, force: f64) -> Self {
        let dt = if force > 0.0 { number * (h / force).sqrt() } else { f64::INFINITY };
        self.least(Self { dt, by: "(h/F)^(1/2)", number })
    }

    /// A share of the theoretical limit.
    pub fn share(number: f64, limits: &TimeStepLimits) -> Self {
        Self { dt: number * limits.together, by: "limit", number }
    }

    /// The step that the settings give \[s\], if they do.
    #[must_use]
    pub fn or_given(self, dt: Option<f64>) -> Self {
        dt.map_or(self, Self::given)
    }

    /// A step that the settings give \[s\].
    pub fn given(dt: f64) -> Self {
        Self { dt, by: "given", number: 1.0 }
    }

    fn least(self, other: Self) -> Self {
        if other.dt < self.dt { other } else { self }
    }
}

impl Rules {
    /// The step of a refused run in plans: the run itself is refused too, so that its gates, which must
    /// exist, fail.
    pub const REFUSED: Self = Self {
        step: Step { dt: 1.0, by: "", number: 1.0 },
        limits: TimeStepLimits::REFUSED,
        sound_speed: 1.0,
        end: 1.0,
    };

    /// Time step \[s\].
    pub fn dt(&self) -> f64 {
        self.step.dt
    }

    /// Pair sweeps of a step.
    pub fn sweeps(&self) -> f64 {
        self.limits.sweeps(self.dt())
    }

    /// Theoretical limit \[s\].
    pub fn dt_limit(&self) -> f64 {
        self.limits.together
    }

    /// These and the lattice, h/dx and dx \[m\], by the names that records give them.
    pub fn numbers(&self, h_over_dx: f64, dx: f64) -> [(&'static str, f64); 5] {
        let (dt, dt_limit, sound_speed) = (self.dt(), self.dt_limit(), self.sound_speed);
        [
            ("h/dx", h_over_dx),
            ("dx [m]", dx),
            ("c0 [m/s]", sound_speed),
            (PLANNED_DT, dt),
            (PLANNED_DT_OVER_LIMIT, dt / dt_limit),
        ]
    }
}

/// Times of samples, of about this number of equal intervals, without the start: a step that the settings
/// give is not shortened to reach them, because they are whole numbers of such steps apart.
pub fn samples(end: f64, count: usize, given: Option<f64>) -> Vec<f64> {
    let Some(dt) = given else {
        return (1..=count).map(|k| end * k as f64 / count as f64).collect();
    };
    let every = (end / count as f64 / dt).round().max(1.0) * dt;
    let before = (end / every - 1e-9).ceil().max(1.0) as usize;
    (1..before).map(|k| k as f64 * every).chain([end]).collect()
}

/// Key of the planned time step \[s\] in the numerics of a record.
pub const PLANNED_DT: &str = "dt [s] planned";
/// Key of the planned step over its theoretical limit.
pub const PLANNED_DT_OVER_LIMIT: &str = "dt/limit planned";
/// Key of the largest step of a run \[s\].
pub const DT: &str = "dt [s]";
/// Key of the largest step over its theoretical limit.
pub const DT_OVER_LIMIT: &str = "dt/limit";

/// Adds the largest step of the run to the planned one in a record: steps are shortened to reach the times of
/// samples and the end.
pub fn state_steps(record: &mut Record) {
    let planned = |name: &str| record.numerics.get(name).and_then(|value| value.as_f64());
    let (Some(dt), limit) = (planned(PLANNED_DT), planned(PLANNED_DT_OVER_LIMIT)) else { return };
    let used = record.cost.largest_dt_s;
    if used > 0.0 {
        let ratio = limit.map(|ratio| (DT_OVER_LIMIT, ratio * used / dt));
        let taken = [(DT, used)].into_iter().chain(ratio);
        record.numerics.extend(taken.map(|(name, value)| (name.into(), number::json(value))));
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn samples_are_equal_parts_of_a_run_or_whole_numbers_of_given_steps_apart() {
        assert_eq!(samples(1.0, 4, None), [0.25, 0.5, 0.75, 1.0]);
        assert_eq!(samples(1.0, 4, Some(0.25)), [0.25, 0.5, 0.75, 1.0]);
        assert_eq!(samples(1.0, 4, Some(0.12)), [0.24, 0.48, 0.72, 0.96, 1.0]);
        assert_eq!(samples(1.0, 4, Some(0.4)), [0.4, 0.8, 1.0]);
        assert_eq!(samples(1.0, 4, Some(2.0)), [1.0]);
    }

    /// A run of one step of 1e-4 s stated the 275 s that were planned, and 451,608 times the limit.
    #[test]
    fn a_record_states_the_step_that_was_taken_beside_the_one_that_was_planned() {
        let mut limits = TimeStepLimits::REFUSED;
        limits.together = 4e-4;
        let rules = Rules { step: Step::given(2e-4), limits, ..Rules::REFUSED };
        let mut record = Record::new("c", "v", json!({}), 1);
        let numbers = rules.numbers(1.2, 0.1).map(|(name, value)| (name.into(), value.into()));
        record.numerics.extend(numbers);
        record.cost.largest_dt_s = 1e-4;
        state_steps(&mut record);
        let number = |name: &str| record.numerics[name].as_f64();
        assert_eq!([number("dt [s]"), number("dt [s] planned")], [Some(1e-4), Some(2e-4)]);
        assert_eq!([number("dt/limit"), number("dt/limit planned")], [Some(0.25), Some(0.5)]);
    }
}
