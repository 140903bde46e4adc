//! The horizon of a flow: the time until which runs that differ by next to nothing at the start agree.

use touchstone_base::random::Random;

use crate::quantiles::{CONFIDENCE, between};

/// The fewest members that bound a median; with fewer there is no interval and no horizon.
pub const FEWEST: usize = 6;
/// Draws of the bootstrap, and its seed: equal numbers on every machine.
const DRAWS: usize = 1000;
const SEED: u64 = 1;

/// When the members of an ensemble part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    /// The median over all pairs of members of the time at which they first differ by more than a tolerance;
    /// infinite if more than half of the pairs never do.
    pub time: f64,
    /// Its interval by a bootstrap over members.
    pub within: [f64; 2],
    /// When the first pair parts; infinite if none does.
    pub first: f64,
}

/// A history: points in ascending order of the time.
pub type TimeSeries = Vec<(f64, f64)>;

impl Horizon {
    /// From histories at common times, one for each member.
    ///
    /// # Errors
    /// The reason for a missing result.
    pub fn of(members: &[TimeSeries], tolerance: f64) -> Result<Self, String> {
        let times = |curve: &TimeSeries| curve.iter().map(|(t, _)| t.to_bits()).collect::<Vec<_>>();
        let count = members.len();
        if !(tolerance.is_finite() && tolerance > 0.0) {
            return Err("the tolerance is not known".into());
        }
        if count < FEWEST {
            return Err(format!("{count} members; {FEWEST} are needed"));
        }
        let is_alike = members.iter().all(|member| times(member) == times(&members[0]));
        if !is_alike || members[0].is_empty() {
            return Err("members are not sampled at the same times".into());
        }
        if members.iter().flatten().any(|(_, value)| !value.is_finite()) {
            return Err("a member has a value that is no number".into());
        }
        let parted: Vec<Vec<f64>> = members
            .iter()
            .map(|one| members.iter().map(|other| parting(one, other, tolerance)).collect())
            .collect();
        let all: Vec<usize> = (0..count).collect();
        let mut random = Random::new(SEED);
        let mut draw = || (random.uniform() * count as f64) as usize;
        let medians = (0..DRAWS)
            .map(|_| median(&parted, &(0..count).map(|_| draw()).collect::<Vec<_>>()))
            .filter(|median| !median.is_nan())
            .collect();
        let first = parted.iter().flatten().copied().fold(f64::INFINITY, f64::min);
        Ok(Self { time: median(&parted, &all), within: interval(medians), first })
    }
}

/// The interval that excludes an equal fraction of numbers at each end.
fn interval(mut of: Vec<f64>) -> [f64; 2] {
    of.sort_by(f64::total_cmp);
    let tail = 0.5 * (1.0 - CONFIDENCE);
    [tail, 1.0 - tail].map(|share| between(&of, share))
}

/// When two histories first differ by more than a tolerance; infinite if they never do.
fn parting(one: &TimeSeries, other: &TimeSeries, tolerance: f64) -> f64 {
    let mut pairs = one.iter().zip(other);
    pairs.find(|((_, a), (_, b))| (a - b).abs() > tolerance).map_or(f64::INFINITY, |((t, _), _)| *t)
}

/// The median over the pairs of different members among some, each as often as it is there.
fn median(parted: &[Vec<f64>], among: &[usize]) -> f64 {
    let pairs = among.iter().enumerate().flat_map(|(k, one)| {
        let others = among[..k].iter().filter(move |other| *other != one);
        others.map(move |other| parted[*one][*other])
    });
    let mut times: Vec<f64> = pairs.collect();
    times.sort_by(f64::total_cmp);
    between(&times, 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_base::functions::{exp, ln};

    const RATE: f64 = 2.0;

    /// Members that part by 1e-6 exp(2t) times a number of theirs.
    fn diverging(count: usize, seed: u64) -> Vec<TimeSeries> {
        let mut random = Random::new(seed);
        let mut one = || -> TimeSeries {
            let own = 1e-6 * (2.0 * random.uniform() - 1.0);
            let time = |k: u32| 0.01 * f64::from(k);
            (0..1000).map(time).map(|t| (t, t + own * exp(RATE * t))).collect()
        };
        (0..count).map(|_| one()).collect()
    }

    #[test]
    fn an_exponential_divergence_has_the_horizon_of_its_rate() {
        // The median distance of two uniform numbers of [-1, 1] is 2 - √2.
        let exact = |tolerance: f64| ln(tolerance / (1e-6 * (2.0 - 2.0_f64.sqrt()))) / RATE;
        for tolerance in [1e-4, 1e-2] {
            let expected = exact(tolerance);
            let (mut hits, mut mean) = (0, 0.0);
            for seed in 0..40 {
                let Horizon { time, within: [low, high], first } =
                    Horizon::of(&diverging(20, seed), tolerance).expect("a horizon");
                mean += time / 40.0;
                assert!(low <= time && time <= high && high - low < 0.8 && first < low);
                // Sampled every 0.01, at the next sample.
                hits += i32::from(low - 0.01 <= expected && expected <= high);
            }
            assert!((mean - expected).abs() < 0.05, "{mean} instead of {expected}");
            assert!(hits >= 35, "{hits} of 40 intervals contain the horizon");
        }
    }

    #[test]
    fn the_interval_has_the_same_bits_whenever_it_is_computed() {
        let of = || Horizon::of(&diverging(20, 7), 1e-3);
        assert_eq!(of(), of());
        let Horizon { time, within, first } = of().expect("a horizon");
        let shown = format!("{time:.3} {:.3} {:.3} {first:.3}", within[0], within[1]);
        assert_eq!(shown, "3.685 3.545 3.840 3.140");
    }

    /// Six members; one parts from the others early. The medians of all 6⁶ draws are enumerated
    /// here: 28 % of them are the early time, and 72 % the late one, whichever member it is.
    #[test]
    fn the_interval_is_that_of_all_draws_of_members() {
        let (early, late) = (1.0, 2.0);
        for odd in 0..6 {
            let part = |i: usize, j: usize| if i == odd || j == odd { early } else { late };
            let mut medians = Vec::new();
            for draw in 0..6_usize.pow(6) {
                let drawn: Vec<usize> = (0..6).map(|k| draw / 6_usize.pow(k) % 6).collect();
                let pairs = (0..6).flat_map(|k| (0..k).map(move |l| (k, l)));
                let different = pairs.map(|(k, l)| (drawn[k], drawn[l])).filter(|(i, j)| i != j);
                let mut times: Vec<f64> = different.map(|(i, j)| part(i, j)).collect();
                times.sort_by(f64::total_cmp);
                medians.extend(times.get(times.len() / 2).copied());
            }
            assert_eq!(medians.len(), 46_656 - 6, "a draw of one member alone has no pair");
            let share = medians.iter().filter(|time| **time == early).count() as f64 / 46_650.0;
            assert!((0.25..0.30).contains(&share), "{share}");
            // Members k leave by k after the late time, and the odd one is far from all after the early one.
            let curve = |k: usize| -> TimeSeries {
                let at = |late: f64| if k == odd { 100.0 } else { late * k as f64 };
                vec![(0.0, 0.0), (early, at(0.0)), (late, at(2.0)), (3.0, at(2.0))]
            };
            let members: Vec<TimeSeries> = (0..6).map(curve).collect();
            let found = Horizon::of(&members, 1.0).expect("a horizon");
            assert_eq!(found, Horizon { time: late, within: [early, late], first: early }, "{odd}");
        }
    }

    /// 95 % of 0, 1, …, 1000 in any order are between 25 and 975.
    #[test]
    fn an_interval_leaves_out_a_fortieth_at_either_end() {
        let medians = (0..=1000).map(|k| f64::from(k * 387 % 1001)).collect();
        let [low, high] = interval(medians);
        assert!((low - 25.0).abs() < 1e-9 && (high - 975.0).abs() < 1e-9, "{low} {high}");
    }

    /// Members 0 and 1 part at 3, 0 and 2 at 5, 1 and 2 at 7. A member that is drawn twice does not pair with
    /// itself, and its pairs with another one count twice.
    #[test]
    fn a_median_is_over_pairs_of_different_members() {
        let never = f64::INFINITY;
        let parted = [vec![never, 3.0, 5.0], vec![3.0, never, 7.0], vec![5.0, 7.0, never]];
        for (among, expected) in [
            (&[0, 1, 2][..], 5.0),
            (&[0, 0, 1], 3.0),
            (&[0, 0, 0, 0, 1], 3.0),
            (&[0, 1, 1, 2], 5.0),    // 3, 3, 5, 7, 7
            (&[2, 2, 1, 1, 0], 6.0), // 3, 3, 5, 5 and four times 7
        ] {
            assert_eq!(median(&parted, among), expected, "{among:?}");
        }
        assert!(median(&parted, &[1, 1, 1]).is_nan(), "no pair");
    }

    /// Histories diverge when they differ by more than the tolerance, not by the tolerance itself.
    #[test]
    fn a_difference_of_the_tolerance_is_none() {
        let [one, other] = [0.25, -0.25].map(|by| vec![(0.0, 0.0), (1.0, by), (2.0, 2.0 * by)]);
        let parted = [0.5, 0.49, 1.0].map(|tolerance| parting(&one, &other, tolerance));
        assert_eq!(parted, [2.0, 1.0, f64::INFINITY]);
    }

    #[test]
    fn members_that_agree_have_no_end_and_few_or_damaged_ones_no_horizon() {
        let members = diverging(20, 1);
        let never = Horizon::of(&members, 1e9).expect("a horizon");
        assert_eq!((never.time, never.first), (f64::INFINITY, f64::INFINITY));
        let refused = |members: &[TimeSeries], tolerance| {
            Horizon::of(members, tolerance).expect_err("no horizon can be told")
        };
        assert_eq!(refused(&members[..1], 1.0), "1 members; 6 are needed");
        assert_eq!(refused(&[], 1.0), "0 members; 6 are needed");
        for tolerance in [f64::NAN, 0.0, f64::INFINITY] {
            assert_eq!(refused(&members, tolerance), "the tolerance is not known");
        }
        let mut shorter = members.clone();
        shorter[3].truncate(500);
        assert_eq!(refused(&shorter, 1.0), "members are not sampled at the same times");
        let mut later = members.clone();
        later[3][7].0 += 1e-3;
        assert_eq!(refused(&later, 1.0), "members are not sampled at the same times");
        let mut damaged = members.clone();
        damaged[3][7].1 = f64::NAN;
        assert_eq!(refused(&damaged, 1.0), "a member has a value that is no number");
        let empty = vec![TimeSeries::new(); 20];
        assert_eq!(refused(&empty, 1.0), "members are not sampled at the same times");
    }
}
