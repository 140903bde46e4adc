//! Positions and labels of ticks.

use super::number::{exact, minus, power_of_ten, sci};

/// How values are spread along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences are equal lengths.
    Linear,
    /// Equal ratios are equal lengths; values at or below zero cannot be drawn.
    Log,
}

/// Ticks of one axis over a range.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ticks {
    /// Labelled ticks: value, label.
    pub major: Vec<(f64, String)>,
    /// Unlabelled ticks.
    pub minor: Vec<f64>,
    /// Power of ten taken out of the labels; it belongs to the axis label.
    pub exponent: i32,
}

/// At most about `count` labelled ticks on `lo..hi`.
pub(super) fn ticks(scale: Scale, lo: f64, hi: f64, count: usize) -> Ticks {
    match scale {
        // A few more where so few leave one label.
        Scale::Linear => (count..count + 4)
            .map(|count| linear(lo, hi, count))
            .find(|ticks| ticks.major.len() > 2)
            .unwrap_or_else(|| linear(lo, hi, count)),
        Scale::Log => logarithmic(lo, hi, count),
    }
}

/// Ticks at multiples of 1, 2 or 5 times a power of ten.
fn linear(lo: f64, hi: f64, count: usize) -> Ticks {
    let (step, subdivisions) = nice_step((hi - lo) / count.max(1) as f64);
    let multiples = |step: f64| {
        let slack = 1e-9 * (hi - lo) / step;
        let first = (lo / step - slack).ceil() as i64;
        let last = (hi / step + slack).floor() as i64;
        (first..=last.min(first + 200)).map(move |k| k as f64 * step)
    };
    let largest = lo.abs().max(hi.abs());
    let magnitude = largest.log10().floor() as i32;
    let exponent = if (-2..5).contains(&magnitude) { 0 } else { magnitude };
    let unit = 10f64.powi(exponent);
    let decimals = (-(step / unit * 1.000_001).log10().floor()).max(0.0) as usize;
    let label = |v: f64| minus(format!("{:.decimals$}", v / unit + 0.0));
    let major: Vec<_> = multiples(step).map(|v| (v, label(v))).collect();
    let fine = step / f64::from(subdivisions);
    let is_major = |v: f64| ((v / step).round() * step - v).abs() < 1e-6 * step;
    let minor = multiples(fine).filter(|&v| !is_major(v)).collect();
    Ticks { major, minor, exponent }
}

/// About the next 1-2-5 step above `raw`, and into how many parts minor ticks divide it.
fn nice_step(raw: f64) -> (f64, u32) {
    let power = 10f64.powf(raw.log10().floor());
    match raw / power {
        m if m <= 1.1 => (power, 5),
        m if m <= 2.2 => (2.0 * power, 4),
        m if m <= 5.5 => (5.0 * power, 5),
        _ => (10.0 * power, 5),
    }
}

/// Decades and their multiples, with labels where there is room; within one decade even steps, too.
fn logarithmic(lo: f64, hi: f64, count: usize) -> Ticks {
    let count = count.max(2);
    let (first, last) = (lo.log10().floor() as i32, hi.log10().ceil() as i32);
    let multiples = |of: &[u8]| -> Vec<f64> {
        let all =
            (first..=last).flat_map(|k| of.iter().map(move |&m| f64::from(m) * 10f64.powi(k)));
        all.filter(|v| (lo * (1.0 - 1e-9)..=hi * (1.0 + 1e-9)).contains(v)).collect()
    };
    let (decades, all) = (multiples(&[1]), multiples(&[1, 2, 3, 4, 5, 6, 7, 8, 9]));
    let stride = decades.len().div_ceil(count).max(1);
    let is_kept = |decade: &f64| decade.log10().round() as i64 % stride as i64 == 0;
    let some_decades = decades.iter().copied().filter(is_kept).collect();
    let thinner = [&[1, 2, 3, 5][..], &[1, 2, 5], &[1, 3]].map(multiples);
    let mut choices: Vec<Vec<f64>> =
        [all.clone()].into_iter().chain(thinner).chain([some_decades]).collect();
    if hi / lo < 10.0 {
        let even = |count| linear(lo, hi, count).major.iter().map(|tick| tick.0).collect();
        choices.extend((2..=count).rev().map(even));
    }
    let fitting = || choices.iter().filter(|of| of.len() <= count);
    let best = fitting().find(|of| is_spread(of, lo, hi)).or_else(|| fitting().next());
    let major = best.unwrap_or(&choices[2]).clone();
    let mut minor = if stride > 1 { decades } else { all };
    minor.retain(|v| !major.contains(v));
    Ticks { major: with_labels(major), minor, exponent: 0 }
}

/// Whether there are at least three, with gaps of at most 0.45 of a logarithmic axis.
fn is_spread(values: &[f64], lo: f64, hi: f64) -> bool {
    let ends: Vec<f64> = [lo].iter().chain(values).chain(&[hi]).copied().collect();
    let gap = |pair: &[f64]| (pair[1] / pair[0]).ln() / (hi / lo).ln();
    values.len() >= 3 && ends.windows(2).all(|pair| gap(pair) < 0.45)
}

/// Positive values with their labels, all of one format: `0.02`, `50` if that suits each, else `2·10⁻²`.
fn with_labels(values: Vec<f64>) -> Vec<(f64, String)> {
    let is_plain = |v: &f64| (-2.001..4.0).contains(&v.log10());
    let label = if values.iter().all(is_plain) { exact } else { scientific };
    values.into_iter().map(|v| (v, label(v))).collect()
}

/// `3·10⁻⁴`, or `10⁻³`.
fn scientific(v: f64) -> String {
    let written = sci(v, 4);
    let (mantissa, power) = written.split_once('·').unwrap_or((&written, ""));
    match mantissa.trim_end_matches('0').trim_end_matches('.') {
        "1" => power.into(),
        mantissa => format!("{mantissa}·{power}"),
    }
}

/// `u [m/s]` with a factor of 10⁻³ becomes `u [10⁻³ m/s]`.
pub(super) fn with_exponent(label: &str, exponent: i32) -> String {
    if exponent == 0 {
        return label.into();
    }
    let factor = power_of_ten(exponent);
    match label.rfind('[') {
        Some(at) if label.ends_with(']') => match &label[at + 1..label.len() - 1] {
            "1" | "-" | "–" | "" => format!("{}[{factor}]", &label[..at]),
            unit => format!("{}[{factor} {unit}]", &label[..at]),
        },
        _ => format!("{label} [{factor}]"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(t: &Ticks) -> Vec<&str> {
        t.major.iter().map(|(_, l)| l.as_str()).collect()
    }

    #[test]
    fn linear_ticks_are_multiples_of_one_two_five() {
        let t = linear(-0.013, 1.02, 6);
        assert_eq!(labels(&t), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(t.minor.len(), 15);
        assert_eq!(labels(&linear(-1.0, 1.0, 4)), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(&linear(0.0, 40.0, 4)), ["0", "10", "20", "30", "40"]);
    }

    #[test]
    fn small_values_take_their_power_of_ten_out() {
        let t = linear(0.0, 1.3e-5, 4);
        assert_eq!(t.exponent, -5);
        assert_eq!(labels(&t), ["0.0", "0.5", "1.0"]);
        assert_eq!(with_exponent("u [m/s]", -5), "u [10⁻⁵ m/s]");
        assert_eq!(with_exponent("error [1]", -5), "error [10⁻⁵]");
        assert_eq!(with_exponent("error", 6), "error [10⁶]");
    }

    #[test]
    fn log_labels_have_no_rounding_dust() {
        let t = logarithmic(3e-6, 2.0, 8);
        assert_eq!(labels(&t), ["10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "10⁰"]);
        assert!(t.minor.len() > 40);
        let few = logarithmic(0.018, 0.4, 6);
        assert_eq!(labels(&few), ["0.02", "0.03", "0.05", "0.1", "0.2", "0.3"]);
        assert_eq!(
            labels(&logarithmic(1.5e-5, 6e-5, 6)),
            ["2·10⁻⁵", "3·10⁻⁵", "4·10⁻⁵", "5·10⁻⁵", "6·10⁻⁵"]
        );
    }

    /// Axes from 0.65 to 1.95 and from 2 to 200 had no label in their upper half, and two.
    #[test]
    fn every_log_axis_has_three_labels_or_more() {
        assert_eq!(labels(&logarithmic(0.65, 1.95, 6)), ["0.8", "1", "1.2", "1.4", "1.6", "1.8"]);
        assert_eq!(labels(&logarithmic(2.0, 200.0, 6)), ["3", "10", "30", "100"]);
        for decades in [0.05, 0.2, 0.5, 1.0, 1.5, 2.0, 2.5, 4.0, 9.0] {
            for start in [1.0, 1.7, 3.2, 6.4, 9.9] {
                let hi = start * 10f64.powf(decades);
                let t = logarithmic(start, hi, 6);
                assert!((3..=8).contains(&t.major.len()), "{start} {hi} {:?}", labels(&t));
            }
        }
    }

    #[test]
    fn one_axis_has_one_format() {
        let t = logarithmic(1.5e-3, 0.04, 6);
        assert_eq!(labels(&t), ["2·10⁻³", "3·10⁻³", "5·10⁻³", "10⁻²", "2·10⁻²", "3·10⁻²"]);
    }

    #[test]
    fn many_decades_are_thinned() {
        let t = logarithmic(1e-16, 1.0, 6);
        assert!(t.major.len() <= 7, "{:?}", labels(&t));
        assert!(t.minor.iter().all(|m| (m.log10() - m.log10().round()).abs() < 1e-9));
    }
}
