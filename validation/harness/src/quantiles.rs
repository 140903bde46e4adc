//! Quantiles of a distribution from a sample, with intervals between order statistics, which hold for any
//! distribution. A sample too small for an interval has none.

/// The least probability with which an interval contains its quantile.
pub const CONFIDENCE: f64 = 0.95;

/// A quantile of a distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantile {
    /// The quantile of the sample, linear between its numbers.
    pub value: f64,
    /// Interval of the quantile of the distribution.
    pub within: Option<[f64; 2]>,
}

impl Quantile {
    /// The quantile of a distribution for this share, from the finite numbers of a sample in any order.
    pub fn of_sample(sample: &[f64], share: f64) -> Self {
        let mut sorted: Vec<f64> = sample.iter().copied().filter(|x| x.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let at = |rank: usize| sorted.get(rank.wrapping_sub(1)).copied();
        let [low, high] = ranks(sorted.len(), share);
        let within = at(low).zip(at(high)).map(|(low, high)| [low, high]);
        Self { value: between(&sorted, share), within }
    }
}

/// The quantile of numbers in ascending order, linear between them; NaN if there are none.
pub fn between(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    let (low, rest) = (place as usize, place - place.floor());
    match sorted.get(low + 1) {
        Some(high) if rest > 0.0 && *high != sorted[low] => {
            sorted[low] + rest * (high - sorted[low])
        }
        _ => sorted[low],
    }
}

/// The ranks, from 1, of the order statistics of a sample of n that bound a quantile: the number of values
/// below it has the binomial distribution of n and its share. A rank that does not exist is 0 or n + 1.
fn ranks(n: usize, share: f64) -> [usize; 2] {
    let tail = 0.5 * (1.0 - CONFIDENCE);
    // P(B = k), by multiplication only: equal bits on every machine.
    let mut all = vec![(0..n).fold(1.0, |p, _| p * (1.0 - share))];
    for k in 0..n {
        let odds = (n - k) as f64 / (k + 1) as f64 * share / (1.0 - share);
        all.push(all[k] * odds);
    }
    let within = |sum: &mut f64, p: &f64| {
        *sum += p;
        Some(*sum <= tail)
    };
    let below = all.iter().scan(0.0, within).take_while(|is_within| *is_within).count();
    let above = all.iter().rev().scan(0.0, within).take_while(|is_within| *is_within).count();
    [below, n + 1 - above]
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_base::random::Random;

    /// Ranks of published tables, such as Conover, Practical Nonparametric Statistics.
    #[test]
    fn ranks_are_those_of_the_binomial_distribution() {
        assert_eq!(ranks(20, 0.5), [6, 15]);
        assert_eq!(ranks(20, 0.25), [2, 10]);
        assert_eq!(ranks(20, 0.75), [11, 19]);
        assert_eq!(ranks(6, 0.5), [1, 6]);
        assert_eq!(ranks(5, 0.5), [0, 6], "five numbers bound no median at this confidence");
        assert_eq!((ranks(0, 0.5), ranks(1, 0.5)), ([0, 1], [0, 2]));
    }

    #[test]
    fn known_quantiles_are_found_and_their_intervals_hold_as_often_as_they_say() {
        let numbers: Vec<f64> = (0..=100).map(f64::from).rev().collect();
        for share in [0.25, 0.5, 0.75] {
            let found = Quantile::of_sample(&numbers, share);
            assert_eq!(found.value, 100.0 * share);
            assert!(found.within.is_some_and(|[a, b]| a < found.value && found.value < b));
        }
        // Exponential numbers: the quartiles are -ln(1 - share).
        let mut random = Random::new(1);
        let (mut hits, trials) = ([0; 3], 2000);
        for _ in 0..trials {
            let sample: Vec<f64> =
                (0..20).map(|_| -touchstone_base::functions::ln(1.0 - random.uniform())).collect();
            for (k, share) in [0.25, 0.5, 0.75].into_iter().enumerate() {
                let exact = -touchstone_base::functions::ln(1.0 - share);
                let [low, high] = Quantile::of_sample(&sample, share).within.expect("20 numbers");
                hits[k] += usize::from(low <= exact && exact <= high);
            }
        }
        for hits in hits.map(|hits| hits as f64 / f64::from(trials)) {
            assert!((0.94..0.99).contains(&hits), "{hits}");
        }
    }

    #[test]
    fn a_small_sample_has_no_interval_and_none_no_quantile() {
        assert_eq!(Quantile::of_sample(&[3.0, 1.0], 0.5), Quantile { value: 2.0, within: None });
        assert_eq!(Quantile::of_sample(&[7.0], 0.25), Quantile { value: 7.0, within: None });
        let none = Quantile::of_sample(&[f64::NAN, f64::INFINITY], 0.5);
        assert!(none.value.is_nan() && none.within.is_none());
        let finite = Quantile::of_sample(&[4.0, f64::INFINITY, 1.0, f64::NAN, 2.0], 0.5);
        assert_eq!(finite.value, 2.0, "of 1, 2 and 4");
        // Times of which some are never: no infinity less another.
        assert_eq!(between(&[1.0, f64::INFINITY, f64::INFINITY], 0.75), f64::INFINITY);
    }
}
