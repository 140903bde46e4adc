//! The largest stable value of a setting by bisection, and the criterion by which a run counts as growing.

use serde::{Deserialize, Serialize};
use touchstone_base::{
    record::{Cost, Record, Status},
    spec::{Bisect, RunSpec},
};

use crate::{
    case::{self, Case, RunError},
    context::Context,
};

touchstone_base::metrics! {
    STABLE = "stable" ["-"] "largest x that was stable";
    UNSTABLE = "unstable" ["-"] "smallest x that was not";
}

/// Why a search by many simulations ended early: one of them was interrupted, or cannot be made for another
/// reason than its settings.
pub type SearchEnd = Result<Status, RunError>;

/// Bisects a setting of a run. The record has the settings of the run, the cost of all runs together, and
/// the bracket as its metrics, which are missing if there is no limit within a factor of 16 of the guess.
///
/// # Errors
/// Errors of the first run, if no run can be made at all.
pub fn run(
    case: &dyn Case,
    spec: &RunSpec,
    bisect: &Bisect,
    context: &Context,
) -> Result<Record, RunError> {
    let mut record = Record::of(spec, 1);
    let criterion = case.facts().is_stable;
    let is_stable = |x: f64| {
        let one = simulate(case, &at(spec, bisect, x), context, &mut record.cost)?;
        Ok(criterion.map_or(one.status == Status::Completed, |is_stable| is_stable(&one)))
    };
    match largest_stable(bisect.guess, bisect.resolution, is_stable) {
        Ok(Some(Bracket { stable, unstable })) => {
            record.put(STABLE, stable);
            record.put(UNSTABLE, unstable);
        }
        Ok(None) => {}
        Err(ended) => record.status = ended?,
    }
    Ok(record)
}

/// One simulation of a search; its cost is added to the total.
///
/// # Errors
/// If the search is to end.
pub fn simulate(
    case: &dyn Case,
    spec: &RunSpec,
    context: &Context,
    cost: &mut Cost,
) -> Result<Record, SearchEnd> {
    let one = case::record_of(case, spec, context).map_err(Err)?;
    add(cost, &one.cost);
    match one.status {
        Status::Interrupted { .. } => Err(Ok(one.status)),
        _ => Ok(one),
    }
}

/// The simulation of one x.
fn at(spec: &RunSpec, bisect: &Bisect, x: f64) -> RunSpec {
    let value = x * bisect.unit;
    let one = spec.simulation().with_setting(&bisect.setting, value);
    match bisect.end {
        Some(end) => one.with_setting("end", end.steps * value / end.unit),
        None => one,
    }
}

/// Adds the cost of one more run; sizes are maxima.
fn add(sum: &mut Cost, run: &Cost) {
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

/// Half the width of the first bracket, relative to the guess.
const FIRST_WIDTH: f64 = 0.04;
/// The farthest that a limit may be from the guess, as a factor.
const FARTHEST: f64 = 16.0;

/// The longest stable step and the shortest unstable one that were tried.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bracket {
    stable: f64,
    unstable: f64,
}

/// The bracket of the limit, at most `resolution` times `guess`
/// apart. The guess affects the number of runs, not the result: the bracket grows until it contains the
/// limit. `None` if there is no limit within a factor of 16 of the guess.
///
/// # Errors
/// The first of the runs.
fn largest_stable(
    guess: f64,
    resolution: f64,
    mut is_stable: impl FnMut(f64) -> Result<bool, SearchEnd>,
) -> Result<Option<Bracket>, SearchEnd> {
    let (mut width, mut longest, mut shortest) = (FIRST_WIDTH, None, None);
    let mut step = guess * (1.0 - width);
    let Bracket { mut stable, mut unstable } = loop {
        if let (Some(stable), Some(unstable)) = (longest, shortest) {
            break Bracket { stable, unstable };
        }
        if !(guess / FARTHEST..=guess * FARTHEST).contains(&step) {
            return Ok(None);
        }
        if is_stable(step)? {
            longest = Some(step);
            step = if step < guess { guess * (1.0 + width) } else { step * (1.0 + width) };
        } else {
            shortest = Some(step);
            step *= 1.0 - width;
        }
        width *= 1.5;
    };
    while unstable - stable > resolution * guess {
        let middle = 0.5 * (stable + unstable);
        if is_stable(middle)? { stable = middle } else { unstable = middle }
    }
    Ok(Some(Bracket { stable, unstable }))
}

/// Energy that counts as growth beyond doubt, in units of the energy at the start.
const BEYOND_DOUBT: f64 = 100.0;
/// Ratio of the mean energies of the last and the second quarter that counts as growth. Sound at the
/// leapfrog's limit beats, by a few per cent of the energy of white noise.
const LATE_GROWTH: f64 = 1.5;

/// Watches an energy over a known number of steps.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Growth {
    /// Energy at the start.
    pub start: f64,
    steps: u64,
    seen: u64,
    /// Sums over the second and the last quarter.
    quarters: [f64; 2],
    /// Is there no need to continue?
    pub beyond_doubt: bool,
}

impl Growth {
    /// Watches `steps` steps from an energy of `start` > 0.
    pub fn new(start: f64, steps: u64) -> Self {
        Self { start, steps, seen: 0, quarters: [0.0; 2], beyond_doubt: false }
    }

    /// The energy after one more step; `true` if there is no need to continue.
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
    use serde_json::{Value, json};
    use touchstone_base::{
        functions::{exp, sin},
        spec::EndAfter,
    };

    use super::*;
    use crate::{case::Facts, testing::Staged};

    /// The bisection of a condition that cannot fail.
    fn limit_of(
        guess: f64,
        resolution: f64,
        mut is_stable: impl FnMut(f64) -> bool,
    ) -> Option<Bracket> {
        largest_stable(guess, resolution, |x| Ok(is_stable(x))).expect("nothing fails")
    }

    #[test]
    fn bisection_finds_a_limit_far_from_the_guess() {
        for limit in [0.2, 0.9, 0.999, 1.0, 1.03, 1.5, 7.0] {
            let Bracket { stable, unstable } =
                limit_of(1.0, 1e-3, |dt| dt <= limit).expect("a limit");
            assert!(stable <= limit && limit <= unstable, "{limit}: {stable} to {unstable}");
            assert!(unstable - stable <= 1e-3);
        }
    }

    /// The values that a search tries if everything up to this limit is stable.
    fn tried(limit: f64) -> Vec<f64> {
        let mut tried = Vec::new();
        let is_stable = |x: f64| {
            tried.push(x);
            x <= limit
        };
        let found = limit_of(1.0, 0.5, is_stable);
        assert!(found.is_none_or(|of| of.stable <= limit && limit < of.unstable));
        tried
    }

    /// The bracket is 4 % to either side of the guess, and every step beyond it is 1.5 times as wide as the
    /// one before: 6 %, 9 %, 13.5 %, 20.25 %. A step that is widened before it is made, or not widened,
    /// costs runs.
    #[test]
    fn the_bracket_grows_by_half_of_itself_after_each_step() {
        let is = |found: &[f64], expected: &[f64]| {
            let near = |(a, b): (&f64, &f64)| (a / b - 1.0).abs() < 1e-12;
            let all = found.len() == expected.len() && found.iter().zip(expected).all(near);
            assert!(all, "expected {expected:?} to be tried, and {found:?} were");
        };
        is(&tried(1.0), &[0.96, 1.04]);
        is(
            &tried(1.35),
            &[0.96, 1.04, 1.04 * 1.06, 1.04 * 1.06 * 1.09, 1.04 * 1.06 * 1.09 * 1.135],
        );
        let down = [0.96, 0.96 * 0.96, 0.96 * 0.96 * 0.94, 0.96 * 0.96 * 0.94 * 0.91];
        is(&tried(0.8), &down);
        // Values are at most 16 times the guess.
        let up = tried(f64::MAX);
        let [last, before] = [1, 2].map(|back| up[up.len() - back]);
        assert!(last <= 16.0 && last * last / before > 16.0, "{before} and {last} were the last");
    }

    touchstone_base::metrics! {
        GREW = "grew" ["-"] "1 of a run that was not stable";
    }

    /// Stable up to a step of 3 ms; requested runs are kept as (dt, end).
    #[derive(Default)]
    struct Spring(std::sync::Mutex<Vec<(f64, f64)>>);

    impl Staged for Spring {
        fn called(&self) -> &'static str {
            "spring"
        }
        fn set(&self, _: &[String]) -> Value {
            json!({"dt": 1.0, "end": 1.0})
        }
        fn made(&self, spec: &RunSpec, _: &Context) -> Result<Record, RunError> {
            let setting = |name: &str| spec.settings[name].as_f64().unwrap_or(f64::NAN);
            let (dt, end) = (setting("dt"), setting("end"));
            assert!(spec.is_simulation(), "one simulation at a time");
            let mut asked = self.0.lock().expect("no panic before");
            asked.push((dt, end));
            let mut record = Record::of(spec, 1);
            record.put(GREW, f64::from(dt > 3e-3));
            let more = asked.len() as u64;
            record.cost = Cost {
                steps: more,
                pair_interactions: 10 * more,
                particle_rhs: 100 * more,
                particles: 7,
                cpu_s: 0.5,
                largest_dt_s: dt,
                ..record.cost
            };
            Ok(record)
        }
        fn stated(&self) -> Facts {
            let is_stable = |record: &Record| record.value(GREW) == Some(0.0);
            Facts { is_stable: Some(is_stable), ..Facts::default() }
        }
    }

    /// x is in units of 2 ms, so the limit is 1.5; the setting is x times the unit, and a run of 40 steps
    /// ends after 40 times that, in units of half a second.
    #[test]
    fn a_setting_is_bisected_in_its_unit_and_the_record_has_the_cost_of_all_runs() {
        let bisect = Bisect {
            setting: "dt".into(),
            guess: 1.0,
            unit: 2e-3,
            resolution: 0.01,
            end: Some(EndAfter { steps: 40.0, unit: 0.5 }),
        };
        let case = Spring::default();
        let spec =
            RunSpec::new("spring", "v", json!({"dt": 1.0, "end": 1.0})).bisect(bisect.clone());
        let record = run(&case, &spec, &bisect, &Context::default()).expect("runs");
        let asked = case.0.into_inner().expect("no panic");
        for (dt, end) in &asked {
            assert!(
                (end / (40.0 * dt / 0.5) - 1.0).abs() < 1e-12,
                "dt {dt} s, end {end} half seconds"
            );
        }
        assert_eq!(asked[0].0, 0.96 * 2e-3, "the first step, 4 % below the guess [s]");
        let [stable, unstable] =
            [STABLE, UNSTABLE].map(|metric| record.value(metric).expect("a limit"));
        assert!(
            stable <= 1.5 && 1.5 < unstable && unstable - stable <= 0.01,
            "{stable} to {unstable}"
        );
        let count = asked.len() as u64;
        let sum = count * (count + 1) / 2;
        let cost = &record.cost;
        assert_eq!(
            [cost.steps, cost.pair_interactions, cost.particle_rhs],
            [sum, 10 * sum, 100 * sum]
        );
        assert_eq!(
            (cost.particles, cost.cpu_s),
            (7, 0.5 * count as f64),
            "the largest, and the sum"
        );
        let longest = asked.iter().map(|(dt, _)| *dt).fold(0.0, f64::max);
        assert_eq!(cost.largest_dt_s, longest, "the longest step of all runs [s]");
        assert_eq!(record.spec(), spec, "the record is that of the bisection");
    }

    #[test]
    fn no_limit_is_no_answer() {
        assert_eq!(limit_of(1.0, 1e-3, |_| true), None);
        assert_eq!(limit_of(1.0, 1e-3, |_| false), None);
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

    /// The second quarter of eight steps is the third and the fourth, the last the seventh and the eighth;
    /// the other steps do not count. An increase by more than half is growth, a smaller one is not.
    #[test]
    fn growth_compares_the_last_quarter_with_the_second() {
        let grew = |energies: [f64; 8]| {
            let mut growth = Growth::new(1.0, 8);
            energies.iter().for_each(|energy| _ = growth.see(*energy));
            growth.grew()
        };
        assert!(!grew([90.0, 90.0, 1.0, 1.0, 90.0, 90.0, 1.0, 1.0]), "quarters that do not count");
        assert!(!grew([0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.4, 1.5]), "1.45 times as much is no growth");
        for counted in [[2.0, 0.0, 3.1, 0.0], [2.0, 0.0, 0.0, 3.1], [0.0, 2.0, 3.1, 0.0]] {
            let [third, fourth, seventh, eighth] = counted;
            let all = [0.0, 0.0, third, fourth, 0.0, 0.0, seventh, eighth];
            assert!(grew(all), "1.55 times as much is growth: {all:?}");
        }
        // A hundred times the start, not more, may pass.
        let peak = |energy: f64| Growth::new(2.0, 8).see(energy);
        assert_eq!([peak(200.0), peak(200.1)], [false, true]);
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
        let Bracket { stable, unstable } = limit_of(1.6, 1e-3, is_stable).expect("a limit");
        let middle = 0.5 * (stable + unstable);
        assert!((middle / 1.7 - 1.0).abs() < 3e-3, "{middle}");
    }
}
