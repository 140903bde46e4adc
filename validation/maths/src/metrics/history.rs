//! The distance between a history and a reference sampled at other times.

/// Times before the first or after the last sample by this share of the time between both are taken for its.
const ROUND_OFF: f64 = 1e-6;

/// y(tᵢ) − eᵢ at every time tᵢ of a reference (tᵢ, eᵢ), in the unit of the values. The history y is linear
/// between its samples (t, y), whose times ascend.
///
/// # Errors
/// Why there is no distance: there is nothing to compare, samples do not enclose every time of the reference,
/// or a value is not finite.
pub fn differences(samples: &[(f64, f64)], reference: &[(f64, f64)]) -> Result<Vec<f64>, String> {
    let ([(first, _), ..], [.., (last, _)], false) = (samples, samples, reference.is_empty())
    else {
        let (samples, times) = (samples.len(), reference.len());
        return Err(format!(
            "there are {samples} samples and {times} times of the reference to compare"
        ));
    };
    let slack = ROUND_OFF * (last - first);
    let at = |&(time, exact): &(f64, f64)| {
        if !(first - slack..=last + slack).contains(&time) {
            let words = format!(
                "the reference has the time {time}, and samples are from {first} to {last}"
            );
            return Err(words);
        }
        let after = samples.partition_point(|(t, _)| *t < time).min(samples.len() - 1);
        let [(t0, y0), (t1, y1)] = [samples[after.saturating_sub(1)], samples[after]];
        let share = if t1 > t0 { ((time - t0) / (t1 - t0)).clamp(0.0, 1.0) } else { 1.0 };
        let difference = y0 + (y1 - y0) * share - exact;
        let unknown = || format!("the history or the reference is not finite at the time {time}");
        difference.is_finite().then_some(difference).ok_or_else(unknown)
    };
    reference.iter().map(at).collect()
}

/// When a history (t, y) passes a value, and whether it falls; samples are joined by lines.
pub fn passes(
    history: impl Iterator<Item = (f64, f64)> + Clone,
    value: f64,
) -> impl Iterator<Item = (f64, bool)> {
    let pairs = history.clone().zip(history.skip(1));
    pairs.filter_map(move |((from, before), (to, after))| {
        let [a, b] = [before - value, after - value];
        let time = || from + (to - from) * (value - before) / (after - before);
        (a != 0.0 && a * b <= 0.0).then(|| (time(), before > value))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::norms::rms;

    /// t² − 3 at these times.
    fn history(times: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
        times.map(|t| (t, t * t - 3.0)).collect()
    }

    /// Up through 1 at 0.5, down through it at 2, where a row is; a start at the value is not a passage.
    #[test]
    fn a_zigzag_passes_a_value_where_its_lines_do() {
        let history = [(0.0, 0.0), (1.0, 2.0), (2.0, 1.0), (3.0, 0.0), (4.0, f64::NAN)];
        let passed = |from: usize| passes(history.into_iter().skip(from), 1.0);
        assert_eq!(passed(0).collect::<Vec<_>>(), [(0.5, false), (2.0, true)]);
        assert_eq!(passed(2).count(), 0);
    }

    fn every(step: f64, end: f64) -> impl Iterator<Item = f64> {
        (0..=(end / step).round() as usize).map(move |k| step * k as f64)
    }

    #[test]
    fn a_history_has_no_distance_from_itself_and_a_shift_is_the_distance() {
        let own = history(every(0.5, 10.0));
        assert_eq!(differences(&own, &own), Ok(vec![0.0; 21]));
        let shifted: Vec<(f64, f64)> = own.iter().map(|(t, y)| (*t, y + 0.125)).collect();
        let found = differences(&shifted, &own).expect("the same times");
        assert_eq!(rms(found.into_iter()), 0.125);
    }

    /// The chord of t² over a sample interval d is above by d²/4 at its middle.
    #[test]
    fn between_samples_a_history_is_linear() {
        let (coarse, fine) = (history(every(1.0, 8.0)), history(every(0.5, 8.0)));
        let found = differences(&coarse, &fine).expect("enclosed");
        let expected = |k: usize| if k % 2 == 1 { 0.25 } else { 0.0 };
        assert!(found.iter().enumerate().all(|(k, d)| *d == expected(k)), "{found:?}");
        // More samples, at other times than the reference, change nothing.
        let ramp =
            |times: &mut dyn Iterator<Item = f64>| times.map(|t| (t, 2.0 * t - 1.0)).collect();
        let [fine, coarse]: [Vec<(f64, f64)>; 2] =
            [ramp(&mut every(0.3, 9.0)), ramp(&mut every(0.5, 8.5))];
        let found = differences(&fine, &coarse).expect("enclosed");
        assert!(found.iter().all(|d| d.abs() < 1e-14), "{found:?}");
    }

    #[test]
    fn times_that_are_missing_are_said_and_round_off_is_none() {
        let (short, whole) = (history(every(0.5, 9.5)), history(every(0.5, 10.0)));
        let missing = "the reference has the time 10, and samples are from 0 to 9.5";
        assert_eq!(differences(&short, &whole), Err(missing.into()));
        let late = whole[1..].to_vec();
        let missing = "the reference has the time 0, and samples are from 0.5 to 10";
        assert_eq!(differences(&late, &whole), Err(missing.into()));
        let mut rounded = whole.clone();
        rounded[20].0 -= 1e-9;
        let found = differences(&rounded, &whole).expect("the end is there");
        assert!(found[20].abs() < 1e-7, "{found:?}");
        let empty = |[samples, times]: [usize; 2]| {
            Err(format!(
                "there are {samples} samples and {times} times of the reference to compare"
            ))
        };
        assert_eq!(differences(&[], &whole), empty([0, 21]));
        assert_eq!(differences(&whole, &[]), empty([21, 0]));
        let mut unknown = whole.clone();
        unknown[7].1 = f64::NAN;
        let unknown = differences(&unknown, &whole);
        assert_eq!(
            unknown,
            Err("the history or the reference is not finite at the time 3.5".into())
        );
    }
}
