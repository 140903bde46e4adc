//! The dominant period of a series (t, y).

use std::f64::consts::TAU;

use touchstone_base::functions::{cos, hypot, powf, sin};

/// The series without its trend and with tapered ends, so that slow growth is not taken for a wave.
fn tapered(series: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let n = series.len() as f64;
    let (mut t1, mut p1, mut t2, mut tp) = (0.0, 0.0, 0.0, 0.0);
    for (t, p) in series {
        t1 += t / n;
        p1 += p / n;
        t2 += t * t / n;
        tp += t * p / n;
    }
    let slope = (tp - t1 * p1) / (t2 - t1 * t1);
    let taper = |k: usize| 1.0 - cos(TAU * (k as f64 + 0.5) / n);
    let value = |k: usize, (t, p): &(f64, f64)| (*t, taper(k) * (p - p1 - slope * (t - t1)));
    series.iter().enumerate().map(|(k, point)| value(k, point)).collect()
}

/// Fourier amplitude of a tapered series at a period.
fn amplitude_at(series: &[(f64, f64)], period: f64) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (t, value) in series {
        let phase = TAU * t / period;
        re += value * cos(phase);
        im += value * sin(phase);
    }
    2.0 * hypot(re, im) / series.len() as f64
}

/// The period between 0.5 and 8, in the unit of the times, with the largest Fourier amplitude.
pub fn dominant_period(series: &[(f64, f64)]) -> f64 {
    let series = tapered(series);
    let periods = (0..400).map(|k| 0.5 * powf(16.0, f64::from(k) / 399.0));
    let found = periods.map(|t| (t, amplitude_at(&series, t)));
    found.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(f64::NAN, |(period, _)| period)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_on_a_trend_is_found_with_its_amplitude() {
        let wave = |k: i32| {
            let t = f64::from(k) * 0.02;
            (t, 5.0 + 0.3 * t + 0.1 * sin(TAU * t / 1.9))
        };
        let series: Vec<(f64, f64)> = (0..3000).map(wave).collect();
        let period = dominant_period(&series);
        assert!((period / 1.9 - 1.0).abs() < 0.01, "{period}");
        let amplitude = amplitude_at(&tapered(&series), period);
        assert!((amplitude / 0.1 - 1.0).abs() < 0.05, "{amplitude}");
    }
}
