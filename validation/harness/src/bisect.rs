//! The largest stable value of a setting by bisection, and the criterion by which a run counts as growing.

use base::{
    record::{Cost, Metric, Record, Status},
    spec::{Bisect, RunSpec, Task},
};
use std::cell::RefCell;

use crate::{
    case::{Case, RunError},
    context::Context,
};

/// Metric of a bisection: the largest x with which the run was stable.
pub const STABLE: &str = "stable";
/// The smallest x with which it was not.
pub const UNSTABLE: &str = "unstable";

/// Bisects a setting of a run. The record has the settings of the run, the cost of all runs together, and
/// the bracket as its metrics, which are missing if there is no limit within a factor of 16 of the guess.
///
/// # Errors
/// Those of the first run, if no run can be made at all.
pub fn run(
    case: &dyn Case,
    spec: &RunSpec,
    bisect: &Bisect,
    context: &Context,
) -> Result<Record, RunError> {
    let mut record = Record::new(&spec.case, &spec.variant, spec.settings.clone(), 1).of(spec);
    let cost = RefCell::new(Cost { threads: 1, ..Cost::default() });
    let interrupted = RefCell::new(None);
    let failed = RefCell::new(None);
    let is_stable = |x: f64| {
        if interrupted.borrow().is_some() || failed.borrow().is_some() {
            return false;
        }
        match case.run(&at(spec, bisect, x), context) {
            Ok(run) => {
                add(&mut cost.borrow_mut(), &run.cost);
                if let Status::Interrupted { .. } = run.status {
                    *interrupted.borrow_mut() = Some(run.status.clone());
                }
                case.is_stable(&run)
            }
            Err(error) if !error.is_refusal() => {
                *failed.borrow_mut() = Some(error);
                false
            }
            Err(_) => false,
        }
    };
    let bracket = largest_stable(bisect.guess, bisect.resolution, is_stable);
    if let Some(error) = failed.into_inner() {
        return Err(error);
    }
    if let Some(status) = interrupted.into_inner() {
        record.status = status;
    }
    if let Some(Bracket { stable, unstable }) = bracket {
        let ends = [
            (STABLE, stable, "largest x that was stable"),
            (UNSTABLE, unstable, "smallest x that was not"),
        ];
        for (name, x, formula) in ends {
            record.metrics.insert(name.into(), Metric::new(x, "-", formula));
        }
    }
    record.cost = cost.into_inner();
    Ok(record)
}

/// The simulation of one x.
fn at(spec: &RunSpec, bisect: &Bisect, x: f64) -> RunSpec {
    let value = x * bisect.unit;
    let one = RunSpec { task: Task::Simulate, ..spec.clone() }.with_setting(&bisect.setting, value);
    match bisect.end {
        Some(end) => one.with_setting("end", end.steps * value / end.unit),
        None => one,
    }
}

/// Adds what one more run took; sizes are those of the largest.
pub fn add(sum: &mut Cost, run: &Cost) {
    sum.wall_s += run.wall_s;
    sum.cpu_s += run.cpu_s;
    sum.observing_s += run.observing_s;
    sum.steps += run.steps;
    sum.pair_interactions += run.pair_interactions;
    sum.particle_rhs += run.particle_rhs;
    sum.largest_dt_s = sum.largest_dt_s.max(run.largest_dt_s);
    sum.particles = sum.particles.max(run.particles);
    sum.solver_bytes = sum.solver_bytes.max(run.solver_bytes);
    sum.resumed += run.resumed;
}

/// A step that is stable and a longer one that is not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bracket {
    /// The longest step seen to be stable.
    pub stable: f64,
    /// The shortest step seen to be unstable.
    pub unstable: f64,
}

impl Bracket {
    /// The limit, up to half of the bracket.
    pub fn middle(&self) -> f64 {
        0.5 * (self.stable + self.unstable)
    }
}

/// Half the width of the first bracket, relative to the guess.
const FIRST_WIDTH: f64 = 0.04;
/// The farthest that a limit may be from the guess, as a factor.
const FARTHEST: f64 = 16.0;

/// Bisects down to a bracket of `resolution` times `guess`. The guess decides on how many runs it
/// takes, not on the answer: the bracket grows until it holds the limit. `None` if there is no limit
/// within a factor of 16 of the guess.
pub fn largest_stable(
    guess: f64,
    resolution: f64,
    is_stable: impl Fn(f64) -> bool,
) -> Option<Bracket> {
    let (mut width, mut stable, mut unstable) = (FIRST_WIDTH, None, None);
    let mut step = guess * (1.0 - width);
    while stable.is_none() || unstable.is_none() {
        if !(guess / FARTHEST..=guess * FARTHEST).contains(&step) {
            return None;
        }
        if is_stable(step) {
            stable = Some(step);
            step = if step < guess { guess * (1.0 + width) } else { step * (1.0 + width) };
        } else {
            unstable = Some(step);
            step *= 1.0 - width;
        }
        width *= 1.5;
    }
    let mut bracket = Bracket { stable: stable?, unstable: unstable? };
    while bracket.unstable - bracket.stable > resolution * guess {
        let middle = bracket.middle();
        if is_stable(middle) { bracket.stable = middle } else { bracket.unstable = middle }
    }
    Some(bracket)
}

/// Energy that counts as growth beyond doubt, in units of the energy at the start.
const BEYOND_DOUBT: f64 = 100.0;
/// Ratio of the mean energies of the last and the second quarter that counts as growth. Sound at the
/// leapfrog's limit beats, by a few per cent of the energy of white noise.
const LATE_GROWTH: f64 = 1.5;

/// Watches an energy over a known number of steps.
#[derive(Clone, Copy, Debug)]
pub struct Growth {
    start: f64,
    steps: u64,
    seen: u64,
    /// Sums over the second and the last quarter.
    quarters: [f64; 2],
    beyond_doubt: bool,
}

base::bits! { Growth { start, steps, seen, quarters, beyond_doubt } }

impl Growth {
    /// Watches `steps` steps from an energy of `start` > 0.
    pub fn new(start: f64, steps: u64) -> Self {
        Self { start, steps, seen: 0, quarters: [0.0; 2], beyond_doubt: false }
    }

    /// The energy after one more step; `true` if there is no need to go on.
    pub fn see(&mut self, energy: f64) -> bool {
        self.seen += 1;
        let quarter = (4 * self.seen - 1) / self.steps.max(1);
        if quarter == 1 {
            self.quarters[0] += energy;
        } else if quarter >= 3 {
            self.quarters[1] += energy;
        }
        self.beyond_doubt |= energy.is_nan() || energy > BEYOND_DOUBT * self.start;
        self.beyond_doubt
    }

    /// Whether the energy grew: beyond a hundred times the start at some step, or by half from the
    /// second to the last quarter of the steps.
    pub fn grew(&self) -> bool {
        self.beyond_doubt || self.quarters[1] > LATE_GROWTH * self.quarters[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::functions::{exp, sin};

    #[test]
    fn bisection_finds_a_limit_far_from_the_guess() {
        for limit in [0.2, 0.9, 0.999, 1.0, 1.03, 1.5, 7.0] {
            let found = largest_stable(1.0, 1e-3, |dt| dt <= limit).expect("a limit");
            assert!(found.stable <= limit && limit <= found.unstable, "{limit}: {found:?}");
            assert!(found.unstable - found.stable <= 1e-3);
        }
    }

    #[test]
    fn no_limit_is_no_answer() {
        assert_eq!(largest_stable(1.0, 1e-3, |_| true), None);
        assert_eq!(largest_stable(1.0, 1e-3, |_| false), None);
    }

    fn watched(energy: impl Fn(f64) -> f64) -> (bool, u64) {
        let mut growth = Growth::new(1.0, 400);
        for k in 1..=400 {
            if growth.see(energy(f64::from(k as u32))) {
                return (growth.grew(), k);
            }
        }
        (growth.grew(), 400)
    }

    #[test]
    fn growth_is_seen_and_decay_and_beats_are_not() {
        assert_eq!(watched(|k| exp(-0.1 * k)), (false, 400));
        assert_eq!(watched(|_| 1.0), (false, 400));
        assert_eq!(watched(|k| 1.0 + 0.3 * sin(0.05 * k)), (false, 400));
        // Early exit, at ln(100)/0.5 = 9.2 steps.
        assert_eq!(watched(|k| exp(0.5 * k)), (true, 10));
        // A weak mode below decaying ones, still far below the start.
        assert_eq!(watched(|k| exp(-0.1 * k) + 1e-4 * exp(0.01 * k)), (true, 400));
        assert_eq!(watched(|k| if k > 7.0 { f64::NAN } else { 1.0 }), (true, 8));
    }

    /// Both together on a mode with a known limit: growth 2(dt/1.7 - 1) a step beyond it.
    #[test]
    fn bisection_of_growth_finds_the_limit_of_a_mode() {
        let is_stable = |dt: f64| {
            let mut growth = Growth::new(1.0, 400);
            let rate = 2.0 * (dt / 1.7 - 1.0);
            for k in 1..=400 {
                let k = f64::from(k);
                if growth.see(exp(-0.2 * k) + 0.01 * exp(2.0 * rate * k)) {
                    break;
                }
            }
            !growth.grew()
        };
        let found = largest_stable(1.6, 1e-3, is_stable).expect("a limit").middle();
        assert!((found / 1.7 - 1.0).abs() < 3e-3, "{found}");
    }
}
