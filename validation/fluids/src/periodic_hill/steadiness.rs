//! Is a mean flow steady? Means of three successive windows move by what a decay still does and by what
//! disorder does; the latter follows from the scatter of the samples within the windows and is taken off, so
//! that it does not pass for a decay, however long the run is.

/// Batches of successive samples of a window. Their means scatter as those of whole windows do, also where
/// one sample resembles the next.
pub const BATCHES: usize = 5;
/// Standard errors of a change that count as disorder: disorder that lasts longer than a batch makes batches
/// resemble each other, and one standard error too small. A decay loses a seventh by it, for it makes batches
/// differ too.
const ERRORS: f64 = 2.0;
/// Largest ratio of successive changes that counts as a decay.
const SLOWEST: f64 = 0.9;

/// Samples in time of some points: a sample a row, each with as many points.
pub type Samples = [Vec<f64>];

/// How the mean moves from window to window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steadiness {
    /// Root mean square over the points of the change from the second window to the last.
    pub change: f64,
    /// The same that disorder alone would make: its standard error.
    pub disorder: f64,
    /// What a decay leaves beyond the last window: D r/(1 − r), D the last change and r its ratio to the one
    /// before, not above 0.9, both without two standard errors (in squares).
    pub left: f64,
}

impl Steadiness {
    /// Of three successive windows; `None` if one has fewer samples than batches.
    pub fn of(windows: [&Samples; 3]) -> Option<Self> {
        if windows.iter().any(|samples| samples.len() < BATCHES) {
            return None;
        }
        let means = windows.map(mean);
        let scatter = windows.map(variance_of_mean);
        let moved = |k: usize| mean_square(&means[k], &means[k + 1]);
        let by_chance = |k: usize| scatter[k] + scatter[k + 1];
        let decay = |k: usize| (moved(k) - ERRORS.powi(2) * by_chance(k)).max(0.0).sqrt();
        let (early, late) = (decay(0), decay(1));
        let ratio = if late < SLOWEST * early { late / early } else { SLOWEST };
        let left = late * ratio / (1.0 - ratio);
        Some(Self { change: moved(1).sqrt(), disorder: by_chance(1).sqrt(), left })
    }
}

/// Mean of each point.
fn mean(samples: &Samples) -> Vec<f64> {
    let count = samples.len() as f64;
    let points = samples.first().map_or(0, Vec::len);
    (0..points).map(|i| samples.iter().map(|sample| sample[i]).sum::<f64>() / count).collect()
}

/// Mean over the points of the squared difference.
fn mean_square(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64
}

/// Mean over the points of the variance of the mean: that of the means of batches over their number.
fn variance_of_mean(samples: &Samples) -> f64 {
    let batch =
        |k: usize| mean(&samples[k * samples.len() / BATCHES..(k + 1) * samples.len() / BATCHES]);
    let batches: Vec<Vec<f64>> = (0..BATCHES).map(batch).collect();
    let all = mean(&batches);
    let squares: f64 = batches.iter().map(|batch| mean_square(batch, &all)).sum();
    squares / (BATCHES * (BATCHES - 1)) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::{functions::exp, random::Random};

    const POINTS: usize = 200;

    /// Three windows of samples of a run of `end` \[H/U_b\]: a decay of time 9 whose amplitude at 0 is
    /// `decay`, and noise that is correlated over a time of 0.2, that of a spacing of 0.1 at half of U_b.
    fn windows(end: f64, decay: f64, noise: f64, seed: u64) -> [Vec<Vec<f64>>; 3] {
        let (mut random, mut state) = (Random::new(seed), vec![0.0; POINTS]);
        let every = 0.2 * end / 40.0;
        let kept = exp(-every / 0.2);
        let mut sample = |k: usize| -> Vec<f64> {
            let left = decay * exp(-(0.4 * end + every * k as f64) / 9.0);
            for x in &mut state {
                // Of variance 1, whatever the interval.
                let kick = (2.0 * random.uniform() - 1.0) * 3.0_f64.sqrt();
                *x = kept * *x + (1.0 - kept * kept).sqrt() * kick;
            }
            state.iter().map(|x| 0.8 + left + noise * x).collect()
        };
        let mut window = |first: usize| (first..first + 40).map(&mut sample).collect();
        [window(0), window(40), window(80)]
    }

    fn of(end: f64, decay: f64, noise: f64, seed: u64) -> Steadiness {
        let [a, b, c] = windows(end, decay, noise, seed);
        Steadiness::of([&a, &b, &c]).expect("enough samples")
    }

    /// Nine times what disorder moved the windows by was taken to be left: at Re 50 0.0015 U_b of a run to
    /// 40 H/U_b, 0.0053 U_b of one to 100, which is steadier.
    #[test]
    fn noise_about_a_steady_mean_is_steady_and_the_steadier_the_longer_the_run() {
        let mut before = f64::INFINITY;
        for end in [40.0, 100.0, 400.0, 1600.0] {
            let of_seeds = (1..=8).map(|seed| of(end, 0.0, 0.01, seed));
            let worst = of_seeds.map(|s| s.left).fold(0.0, f64::max);
            let limit = 0.01 * (9.0 / end).sqrt();
            assert!(worst < limit && worst < before, "{worst} of a run to {end}, limit {limit}");
            before = worst.max(1e-9) * 1.5;
        }
        let still = of(40.0, 0.0, 0.0, 1);
        assert!(still.left < 1e-12 && still.change < 1e-12);
    }

    #[test]
    fn a_decay_is_not_steady_and_what_it_leaves_is_found_in_noise() {
        // The mean over the last window of 8 of a decay of time 9 that is exp(-40/9) at the end.
        let exact = exp(-40.0 / 9.0) * 9.0 / 8.0 * (exp(8.0 / 9.0) - 1.0);
        let clean = of(40.0, 1.0, 0.0, 1);
        assert!((clean.left / exact - 1.0).abs() < 0.2, "{} {exact}", clean.left);
        for seed in 1..=8 {
            let noisy = of(40.0, 1.0, 0.01, seed);
            assert!((noisy.left / exact - 1.0).abs() < 0.25, "{} {exact}", noisy.left);
        }
        // What does not slow down is not steady, however little it moves in a window.
        let ramp =
            |k: usize| (0..40).map(|j| vec![1e-5 * (40 * k + j) as f64; 3]).collect::<Vec<_>>();
        let [a, b, c] = [0, 1, 2].map(ramp);
        let left = Steadiness::of([&a, &b, &c]).expect("enough samples").left;
        // The scatter of the batches of a ramp is 0.02 of the squared change, and twice two windows have it.
        let exact = 9.0 * 40.0 * 1e-5 * 0.84_f64.sqrt();
        assert!((left / exact - 1.0).abs() < 0.01, "{left} {exact}");
    }

    #[test]
    fn change_and_disorder_are_what_was_put_in() {
        // Two points that move by 0.3 and 0.4 from window to window, and samples that jump by ± 0.1 from
        // batch to batch, which is a variance of 0.01 of a batch and of 0.01/5 of a mean of five.
        let jump = [0.1, -0.1, 0.1, -0.1, 0.0];
        let window = |k: usize| -> Vec<Vec<f64>> {
            let at = |j: usize| vec![0.3 * k as f64 + jump[j / 8], 0.4 * k as f64 + jump[j / 8]];
            (0..40).map(at).collect()
        };
        let [a, b, c] = [0, 1, 2].map(window);
        let found = Steadiness::of([&a, &b, &c]).expect("enough samples");
        assert!((found.change - 0.125_f64.sqrt()).abs() < 1e-12);
        assert!((found.disorder - (2.0 * 0.01 / 5.0_f64).sqrt()).abs() < 1e-12, "{found:?}");
        assert_eq!(Steadiness::of([&a, &b, &c[..4]]), None);
    }
}
