//! How far the runs of a plan are, and how long the rest will take.

use std::{collections::BTreeMap, ops::AddAssign};

use touchstone_base::spec::RunKey;

/// How far the runs of a plan are.
#[derive(Clone, Copy, Debug)]
pub struct Done<'a> {
    /// Runs that are done.
    pub runs: usize,
    /// Number of all runs.
    pub all: usize,
    /// Share of the work that is done, of the run that is under way included: by the time that each run is
    /// expected to take.
    pub share: f64,
    /// Wall time that the rest is expected to take \[s\], from a tenth of the work on.
    pub left: Option<f64>,
    /// Name of the last run that is done, empty before the first.
    pub last: &'a str,
}

/// Fraction of the work to be done before the remaining time is shown.
const FIRST_ESTIMATE: f64 = 0.1;
/// Part of the work whose times weigh as much in the estimate of a case as the times of all cases.
const OF_ALL_CASES: f64 = 0.02;

/// Wall times \[s\]: expected for all work, expected for the completed work, and actual for the completed
/// work.
#[derive(Clone, Copy, Debug, Default)]
struct Times {
    expected: f64,
    done: f64,
    took: f64,
}

impl AddAssign for Times {
    fn add_assign(&mut self, more: Self) {
        self.expected += more.expected;
        self.done += more.done;
        self.took += more.took;
    }
}

/// How far a run is.
#[derive(Debug)]
pub(crate) struct RunTally {
    case: &'static str,
    times: Times,
    has_ended: bool,
}

/// How much of a batch is done.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) runs: BTreeMap<RunKey, RunTally>,
    /// Runs that have a record.
    pub(crate) done: usize,
    /// Name of the last of them.
    pub(crate) last: String,
}

impl Tally {
    /// Adds a run with its expected time \[s\].
    pub(crate) fn plan(&mut self, run: RunKey, case: &'static str, expected: f64) {
        let times = Times { expected, ..Times::default() };
        self.runs.entry(run).or_insert(RunTally { case, times, has_ended: false });
    }

    fn run(&mut self, key: &RunKey) -> Option<&mut RunTally> {
        self.runs.get_mut(key)
    }

    /// The times of all runs, and by case: the error of the expected times differs between cases.
    fn times(&self) -> (Times, BTreeMap<&'static str, Times>) {
        let (mut all, mut cases) = (Times::default(), BTreeMap::<_, Times>::new());
        for run in self.runs.values() {
            all += run.times;
            *cases.entry(run.case).or_default() += run.times;
        }
        (all, cases)
    }

    pub(crate) fn share(&self) -> f64 {
        let Times { expected, done, .. } = self.times().0;
        if expected > 0.0 { done / expected } else { 1.0 }
    }

    /// The remaining work of each case is scaled by the ratio of actual to expected time of its completed
    /// work; with little of it completed, by the ratio over all cases.
    pub(crate) fn left(&self) -> Option<f64> {
        let (all, cases) = self.times();
        let weight = OF_ALL_CASES * all.expected;
        let of_case = |times: &Times| {
            let factor = (times.took + weight * all.took / all.done) / (times.done + weight);
            factor * (times.expected - times.done).max(0.0)
        };
        (self.share() >= FIRST_ESTIMATE).then(|| cases.values().map(of_case).sum())
    }

    /// Sets the completed part of a run and its time so far; repetitions of a run count no further.
    pub(crate) fn reach(&mut self, run: &RunKey, part: f64, took: f64) {
        if let Some(RunTally { times, has_ended: false, .. }) = self.run(run) {
            *times = Times { done: part.clamp(0.0, 1.0) * times.expected, took, ..*times };
        }
    }

    /// A run has a record after this time \[s\].
    pub(crate) fn finish(&mut self, run: &RunKey, name: String, took: f64) {
        self.reach(run, 1.0, took);
        self.done += 1;
        self.last = name;
    }

    /// A run has ended, with or without a record; was it the last one of its case?
    pub(crate) fn end(&mut self, run: &RunKey) -> bool {
        let Some(run) = self.run(run) else { return false };
        run.has_ended = true;
        let case = run.case;
        self.runs.values().filter(|run| run.case == case).all(|run| run.has_ended)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use touchstone_base::spec::RunSpec;

    use super::*;

    /// Runs of three cases, the longest first: actual seconds differ from the plan by a factor for each case
    /// and by 30 % more. The remaining time must not be 34.8 min after 20 s, for runs of two minutes in all.
    #[test]
    fn the_time_left_is_right_within_a_factor_of_two_after_a_tenth_of_the_work() {
        let factors = [("right", 1.0), ("too long", 0.1), ("too short", 6.0)];
        let key = |k: usize| RunSpec::new("c", "v", json!({ "k": k })).key();
        let planned = |k: usize| 20.0 * 0.97f64.powi(k as i32) + 0.01;
        let took = |k: usize| planned(k) * factors[k % 3].1 * [1.3, 0.7, 1.1, 0.8, 1.0][k % 5];
        let mut tally = Tally::default();
        (0..200).for_each(|k| tally.plan(key(k), factors[k % 3].0, planned(k)));
        let whole: f64 = (0..200).map(took).sum();
        let (mut elapsed, mut shares, mut told) = (0.0, Vec::new(), 0);
        for k in 0..200 {
            for part in [0.5, 1.0] {
                match part < 1.0 {
                    true => tally.reach(&key(k), part, part * took(k)),
                    false => tally.finish(&key(k), String::new(), took(k)),
                }
                let elapsed = elapsed + part * took(k);
                shares.push(tally.share());
                if elapsed / whole < 0.1 || elapsed / whole > 0.98 {
                    continue;
                }
                let left = tally.left().expect("told from a tenth of the work on");
                let ratio = left / (whole - elapsed);
                assert!((0.5..2.0).contains(&ratio), "after {elapsed:.1} of {whole:.1} s: {ratio}");
                told += 1;
            }
            elapsed += took(k);
        }
        assert!(told > 100, "{told}");
        assert!((tally.share() - 1.0).abs() < 1e-9);
        assert!(shares.windows(2).all(|pair| pair[0] <= pair[1]), "it goes forward");
    }

    /// A twentieth of the planned work is nearly all of the actual work: as soon as one such run has ended,
    /// the remaining time follows from its case. The times of all cases together would give an eighth of it.
    #[test]
    fn a_case_that_takes_far_longer_than_planned_is_seen_by_its_own_times() {
        let mut tally = Tally::default();
        let key = |k: usize| RunSpec::new("c", "v", json!({ "k": k })).key();
        (0..95).for_each(|k| tally.plan(key(k), "quick", 1.0));
        (95..145).for_each(|k| tally.plan(key(k), "slow", 0.1));
        (0..95).for_each(|k| tally.finish(&key(k), String::new(), 0.1));
        (95..115).for_each(|k| tally.finish(&key(k), String::new(), 2.0));
        let (left, of_all) = (tally.left().expect("told"), 3.0 * (9.5 + 40.0) / 97.0);
        assert!((0.5..2.0).contains(&(left / 60.0)), "{left}");
        assert!(of_all < 60.0 / 8.0, "{of_all}");
    }
}
