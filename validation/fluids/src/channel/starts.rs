//! One setting from several starts. An instability grows from the disorder of the start, or from
//! round-off if there is none, so that a single run of a chaotic flow says little.

use base::{
    record::{Record, Status},
    spec::RunSpec,
};
use harness::{case::Tier, runs::Runs};
use report::{percent, sig};

use super::{ChannelCase, ChannelSettings, measure::L2_WORST};

/// Disorder of the starts \[dx\].
const DISORDER: [f64; 3] = [1e-6, 1e-4, 1e-2];

/// νt/L² at which the runs end.
pub const END: f64 = 1.0;

/// Above this Reynolds number the full tier takes one start instead of three; the quick tier always.
const MANY_STARTS: f64 = 20.0;

fn starts(tier: Tier, re: f64) -> &'static [f64] {
    let is_cheap = tier == Tier::Full && re <= MANY_STARTS;
    if is_cheap { &DISORDER } else { &DISORDER[1..2] }
}

/// How many starts a setting has, in words.
pub fn in_words(tier: Tier) -> String {
    match tier {
        Tier::Quick => "A cell is one start, with particles displaced by up to 1e-4 dx.".into(),
        Tier::Full => format!(
            "Up to Re {MANY_STARTS} a cell is {} starts, with particles displaced by up to {} dx, and \
             above one, by 1e-4 dx.",
            DISORDER.len(),
            disorder(&DISORDER)
        ),
    }
}

/// Disorders as a list.
pub fn disorder(starts: &[f64]) -> String {
    let words: Vec<String> = starts.iter().map(|start| format!("{start:e}")).collect();
    words.join(", ")
}

/// The runs of one setting at a Reynolds number to νt/L² = [`END`], one a start, whatever their time step.
pub fn specs(
    case: &ChannelCase,
    (variant, re): (&str, f64),
    tier: Tier,
    set: impl Fn(&mut ChannelSettings),
) -> Vec<RunSpec> {
    let spec = |jitter: &f64| {
        let spec = case.spec(variant, |s| {
            (s.re, s.end, s.jitter) = (re, END, *jitter);
            set(s);
        });
        spec.allow_unstable()
    };
    starts(tier, re).iter().map(spec).collect()
}

/// A run fails if it diverges or if its worst relative L2 error is larger than this.
pub const TOLERATED: f64 = 0.05;

/// How one run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// νt/L² of the divergence.
    Diverged(f64),
    /// Worst relative L2 error of a run that reached its end.
    Reached(f64),
}

impl Outcome {
    /// `None` of a run that was refused.
    fn of(record: &Record) -> Option<Self> {
        match record.status {
            // L²/ν is 1 s in these channels.
            Status::Diverged { time, .. } => Some(Self::Diverged(time)),
            Status::Refused { .. } => None,
            _ => Some(Self::Reached(record.value(L2_WORST).unwrap_or(f64::NAN))),
        }
    }

    /// Diverged, or wrong at the end.
    pub fn fails(self) -> bool {
        !matches!(self, Self::Reached(error) if error <= TOLERATED)
    }

    /// Larger is better: first by the time of divergence, then by the error.
    fn rank(self) -> f64 {
        match self {
            Self::Diverged(time) => time,
            Self::Reached(error) if error.is_nan() => 1e3,
            Self::Reached(error) => 1e6 - error.min(1e3),
        }
    }

    /// How long a run was right, on a scale for comparisons only: a run that reached its end with a
    /// wrong answer lives longer than any that diverged, one with a right answer longer still.
    fn life(self) -> f64 {
        match self {
            Self::Diverged(time) => time,
            Self::Reached(_) if self.fails() => 1e3,
            Self::Reached(_) => 1e6,
        }
    }

    /// `0.54 %`, or `t = 0.55` for νt/L² of the divergence.
    pub fn text(self) -> String {
        match self {
            Self::Diverged(time) => format!("t = {}", sig(time, 2)),
            Self::Reached(error) => percent(error, 2),
        }
    }
}

/// The outcomes of one setting, worst first.
#[derive(Clone, Debug, Default)]
pub struct Starts(Vec<Outcome>);

/// Which of two settings lives longer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Longer {
    /// No start of either fails.
    NothingFails,
    /// Every start of the first lives longer than every start of the second.
    First,
    /// The other way round.
    Second,
    /// The ranges overlap.
    Overlap,
}

impl Starts {
    /// From outcomes in any order.
    pub fn new(mut outcomes: Vec<Outcome>) -> Self {
        outcomes.sort_by(|a, b| a.rank().total_cmp(&b.rank()));
        Self(outcomes)
    }

    /// From the records of one setting.
    pub fn of<'a>(records: impl IntoIterator<Item = &'a Record>) -> Self {
        Self::new(records.into_iter().filter_map(Outcome::of).collect())
    }

    /// From the runs of one setting.
    pub fn among(runs: &Runs, specs: &[RunSpec]) -> Self {
        Self::of(specs.iter().filter_map(|spec| runs.record(spec)))
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// How many failed.
    pub fn failed(&self) -> usize {
        self.0.iter().filter(|outcome| outcome.fails()).count()
    }

    /// Did more than half fail? A setting that is refused from every start fails too.
    pub fn mostly_fails(&self) -> bool {
        self.count() == 0 || 2 * self.failed() > self.count()
    }

    /// The middle outcome.
    pub fn median(&self) -> Option<Outcome> {
        self.0.get(self.count().saturating_sub(1) / 2).copied()
    }

    /// `2/3: t = 0.55`: how many failed, and the median outcome.
    pub fn text(&self) -> String {
        match self.median() {
            Some(median) => format!("{}/{}: {}", self.failed(), self.count(), median.text()),
            None => "refused".into(),
        }
    }

    /// Compares the ranges of life.
    pub fn longer(&self, other: &Self) -> Longer {
        let range = |starts: &Self| {
            let lives = starts.0.iter().map(|outcome| outcome.life());
            let fold = |f: fn(f64, f64) -> f64, from| lives.clone().fold(from, f);
            (fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY))
        };
        let ((low, high), (other_low, other_high)) = (range(self), range(other));
        if self.failed() + other.failed() == 0 {
            Longer::NothingFails
        } else if low > other_high {
            Longer::First
        } else if other_low > high {
            Longer::Second
        } else {
            Longer::Overlap
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Outcome::{Diverged, Reached};

    #[test]
    fn the_median_and_the_count_of_failures_use_one_criterion() {
        let starts = Starts::new(vec![Reached(0.004), Diverged(0.7), Reached(0.08)]);
        assert_eq!((starts.failed(), starts.median()), (2, Some(Reached(0.08))));
        assert!(starts.mostly_fails());
        assert_eq!(starts.text(), "2/3: 8.0\u{a0}%");
        let starts = Starts::new(vec![Reached(0.004), Diverged(0.7), Diverged(0.5)]);
        assert_eq!(starts.text(), "2/3: t = 0.70");
        assert!(!Starts::new(vec![Reached(0.01), Reached(0.01), Diverged(0.5)]).mostly_fails());
        assert!(Reached(f64::NAN).fails() && Starts::default().mostly_fails());
    }

    #[test]
    fn only_ranges_that_do_not_touch_say_which_lives_longer() {
        let early = Starts::new(vec![Diverged(0.2), Diverged(0.4)]);
        let late = Starts::new(vec![Diverged(0.5), Reached(0.2)]);
        let right = Starts::new(vec![Reached(0.01), Reached(0.02)]);
        let mixed = Starts::new(vec![Diverged(0.3), Reached(0.01)]);
        assert_eq!(early.longer(&late), Longer::Second);
        assert_eq!(right.longer(&early), Longer::First);
        assert_eq!(mixed.longer(&early), Longer::Overlap);
        assert_eq!(mixed.longer(&right), Longer::Overlap);
        assert_eq!(right.longer(&right), Longer::NothingFails);
    }
}
