//! Curves of points (t, y), such as the histories of an experiment: values, distances, integrals.

use std::ops::Range;

/// A curve: points in ascending order of the first number.
pub type Points = Vec<(f64, f64)>;

/// The value of a curve, linear between its points and constant beyond its ends.
pub fn value(curve: &[(f64, f64)], t: f64) -> f64 {
    let next = curve.partition_point(|(time, _)| *time < t);
    match (next.checked_sub(1).map(|k| curve[k]), curve.get(next)) {
        (Some((t0, y0)), Some(&(t1, y1))) => y0 + (t - t0) / (t1 - t0) * (y1 - y0),
        (None, Some(&(_, y))) | (Some((_, y)), None) => y,
        (None, None) => f64::NAN,
    }
}

/// Root mean square over the points of `measured` of the distance to `computed`, whose clock is put
/// forward by `shift`.
pub fn distance(computed: &[(f64, f64)], measured: &[(f64, f64)], shift: f64) -> f64 {
    let square = |(t, y): &(f64, f64)| (value(computed, t - shift) - y).powi(2);
    (measured.iter().map(square).sum::<f64>() / measured.len() as f64).sqrt()
}

/// Sum of squares of the distance over pairs of curves, computed and measured.
pub fn squares(pairs: &[(Points, Points)], shift: f64) -> f64 {
    pairs.iter().map(|(c, m)| distance(c, m, shift).powi(2) * m.len() as f64).sum()
}

/// The shift of the clock within ± `range` with the least sum of squares over pairs of curves.
pub fn best_shift(pairs: &[(Points, Points)], range: f64) -> f64 {
    let cost = |shift: f64| squares(pairs, shift);
    let (mut best, mut step) = (0.0, range / 20.0);
    for _ in 0..4 {
        let trials = (-20..=20).map(|k| best + f64::from(k) * step);
        let inside = trials.filter(|shift| shift.abs() <= range);
        best = inside.min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(best);
        step /= 10.0;
    }
    best
}

/// ∫ y dt from `from` for `window`, by the trapezoidal rule over the points in between; NaN of less than two.
pub fn integral(curve: &[(f64, f64)], from: f64, window: f64) -> f64 {
    let inside: Vec<(f64, f64)> =
        curve.iter().filter(|(t, _)| *t >= from && *t <= from + window).copied().collect();
    if inside.len() < 2 {
        return f64::NAN;
    }
    inside.windows(2).map(trapezoid).sum()
}

/// ∫ y dt between two points of a curve.
fn trapezoid(pair: &[(f64, f64)]) -> f64 {
    0.5 * (pair[1].0 - pair[0].0) * (pair[0].1 + pair[1].1)
}

/// The slope at 0 of the parabola a d + b d² that is fitted to points (d, u).
pub fn slope_at_zero(points: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut d2, mut d3, mut d4, mut du, mut d2u) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (d, u) in points {
        d2 += d * d;
        d3 += d * d * d;
        d4 += d * d * d * d;
        du += d * u;
        d2u += d * d * u;
    }
    (du * d4 - d2u * d3) / (d2 * d4 - d3 * d3)
}

/// A curve between two times.
pub fn during(curve: &[(f64, f64)], [from, to]: [f64; 2]) -> Points {
    curve.iter().filter(|(t, _)| (from..=to).contains(t)).copied().collect()
}

/// The most by which values are behind the largest before them, until one reaches an end.
pub fn fallen_back(values: &[f64], start: f64, end: f64) -> f64 {
    let (mut farthest, mut most) = (start, 0.0_f64);
    for value in values {
        most = most.max(farthest - value);
        farthest = farthest.max(*value);
        if farthest >= end {
            break;
        }
    }
    most
}

/// The longest stretch of negative values, of at least `least` and the first of equal ones, which does not
/// reach to the last value.
pub fn longest_negative(values: &[f64], least: usize) -> Option<Range<usize>> {
    let mut end = 0;
    let stretches = values.chunk_by(|a, b| (*a < 0.0) == (*b < 0.0)).map(|stretch| {
        end += stretch.len();
        end - stretch.len()..end
    });
    let negative = stretches.filter(|s| s.end < values.len() && values[s.start] < 0.0);
    negative.max_by_key(|s| (s.len(), values.len() - s.start)).filter(|s| s.len() >= least)
}

/// The mean of the points of a curve between two times; NaN if there are none.
pub fn mean(curve: &[(f64, f64)], [from, to]: [f64; 2]) -> f64 {
    let inside = curve.iter().filter(|(t, _)| (from..=to).contains(t));
    let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (_, y)| (sum + y, count + 1.0));
    sum / count
}

/// ∫ y dt since the first point, at each later point, by the trapezoidal rule.
pub fn integrals(curve: &[(f64, f64)]) -> Points {
    let mut sum = 0.0;
    let add = |pair: &[(f64, f64)]| {
        sum += trapezoid(pair);
        (pair[1].0, sum)
    };
    curve.windows(2).map(add).collect()
}

/// The time of the last point of a curve, 0 if it has none.
pub fn end_of(curve: &[(f64, f64)]) -> f64 {
    curve.last().map_or(0.0, |(t, _)| *t)
}

/// A curve until a time.
pub fn until(curve: &[(f64, f64)], end: f64) -> Points {
    curve.iter().filter(|(t, _)| *t <= end).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_that_starts_late_is_found_shifted() {
        let early: Points = (0..100).map(|k| 0.05 * f64::from(k)).map(|t| (t, t * t)).collect();
        let late: Points =
            (8..60).map(|k| 0.07 * f64::from(k)).map(|t| (t, (t - 0.21).powi(2))).collect();
        let shift = best_shift(&[(early.clone(), late.clone())], 1.0);
        assert!((shift - 0.21).abs() < 2e-3, "{shift}");
        assert!(distance(&early, &late, shift) < 1e-3 && distance(&early, &late, 0.0) > 0.5);
        assert_eq!((value(&early, -1.0), value(&late, 99.0)), (0.0, late[51].1));
    }

    #[test]
    fn the_integral_of_a_ramp_is_that_of_its_triangle() {
        let ramp: Points = (0..=1000).map(|k| 0.01 * f64::from(k)).map(|t| (t, t)).collect();
        assert!((integral(&ramp, 1.0, 2.0) - 4.0).abs() < 1e-9);
        assert!(integrals(&ramp).iter().all(|(t, sum)| (sum - 0.5 * t * t).abs() < 1e-9));
        assert!((mean(&ramp, [2.0, 3.0]) - 2.5).abs() < 1e-9 && end_of(&ramp) == 10.0);
        assert_eq!(end_of(&until(&ramp, 2.005)), 2.0);
    }

    #[test]
    fn a_parabola_through_0_has_its_slope_there() {
        let points = (1..9).map(|k| 0.1 * f64::from(k)).map(|d| (d, 3.0 * d - 5.0 * d * d));
        assert!((slope_at_zero(points) - 3.0).abs() < 1e-11);
    }

    /// After 1, 4, 3, 6, 2: 4 behind 6, until 6 is the end: 1 behind 4.
    #[test]
    fn a_front_falls_back_behind_where_it_has_been() {
        assert_eq!(fallen_back(&[1.0, 4.0, 3.0, 6.0, 2.0], 0.0, 9.0), 4.0);
        assert_eq!(fallen_back(&[1.0, 4.0, 3.0, 6.0, 2.0], 0.0, 6.0), 1.0);
        assert_eq!(fallen_back(&[1.0, 4.0], 1.5, 9.0), 0.5);
    }

    #[test]
    fn the_longest_negative_stretch_does_not_reach_the_end() {
        let values = [-1.0, -1.0, 2.0, -1.0, -3.0, -1.0, 0.0, -1.0, -1.0, -1.0, 4.0, -1.0, -1.0];
        assert_eq!(longest_negative(&values, 3), Some(3..6));
        assert_eq!(longest_negative(&values, 4), None);
        assert_eq!(longest_negative(&values[..9], 3), Some(3..6));
        assert_eq!(longest_negative(&values[..5], 2), Some(0..2));
        assert_eq!(longest_negative(&[-1.0, -1.0, 2.0, -1.0, -1.0, -1.0], 2), Some(0..2));
    }
}
