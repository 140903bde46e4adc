//! Metrics of the path of the end of a bar, as for finite elements.

use touchstone_base::record::MetricKey;
use touchstone_maths::metrics::{history::passes, path::Path};

use super::COMPARED;

touchstone_base::metrics! {
    all OF_PATH;
    MEAN_X = "mean_x" ["m"]
        "half the sum of the greatest and the least displacement of the end along the bar";
    MEAN_Y = "mean_y" ["m"] "the same upwards";
    AMPLITUDE_X = "amplitude_x" ["m"] "half the difference of the two along the bar";
    AMPLITUDE_Y = "amplitude_y" ["m"] "the same upwards";
    FREQUENCY = "frequency" ["Hz"]
        "whole periods between the first and the last time at which the end falls through mean_y, over the \
         time between them";
    AVERAGE_X = "average_x" ["m"] "mean displacement along the bar between these two times";
    AVERAGE_Y = "average_y" ["m"] "the same upwards";
    HARMONIC_X = "harmonic_x" ["m"]
        "amplitude of the sinusoid of that frequency in the displacement along the bar between these times";
    HARMONIC_Y = "harmonic_y" ["m"] "the same upwards";
    FIRST_LEAST_Y = "first_least_y" ["m"] "least displacement upwards in the first swing";
}

/// The quantities of [`COMPARED`](super::COMPARED), in this order; averages, harmonics and the frequency need
/// two falls, and the least height of the first swing needs to be passed.
pub fn measure(path: &Path) -> Vec<(MetricKey, Option<f64>)> {
    let [[mean_x, amplitude_x], [mean_y, amplitude_y]] =
        [0, 1].map(|axis| path.mean_and_amplitude(axis));
    let falls = |(time, falls)| if falls { Some(time) } else { None };
    let times: Vec<f64> = passes(path.heights(), mean_y).filter_map(falls).collect();
    let second = times.get(1).copied().unwrap_or(f64::INFINITY);
    let swing = Path(path.0[..path.0.partition_point(|at| at.time < second)].to_vec());
    let periods = if let [first, .., last] = times[..] {
        let frequency = (times.len() - 1) as f64 / (last - first);
        let (average, harmonic) = path.harmonic([first, last], frequency);
        [frequency, average.x, average.y, harmonic.x, harmonic.y].map(Some)
    } else {
        [None; 5]
    };
    let all = [mean_x, mean_y, amplitude_x, amplitude_y].map(Some);
    let [_, first_least_y] = swing.extremes(1);
    let values = all.into_iter().chain(periods).chain([first_least_y]);
    COMPARED.into_iter().map(|(metric, _)| metric).zip(values).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::Vector2;
    use std::f64::consts::TAU;
    use touchstone_base::functions::{cos, sin};
    use touchstone_maths::metrics::path::PathPoint;

    /// −0.06 (1 − cos 2πft), with a second harmonic along the bar.
    fn swing(frequency: f64, end: f64) -> Path {
        let row = |k: i32| {
            let t = 0.0025 * f64::from(k);
            let angle = TAU * frequency * t;
            let x = -0.01 + 0.01 * cos(angle) + 0.002 * sin(2.0 * angle);
            PathPoint::new(t, Vector2::new(x, -0.06 * (1.0 - cos(angle))))
        };
        Path((0..).map(row).take_while(|at| at.time <= end).collect())
    }

    #[test]
    fn a_path_that_was_made_up_has_its_frequency_mean_and_amplitude() {
        let found = measure(&swing(1.1, 4.0));
        let value = |key: MetricKey| {
            let name = String::from(key);
            let one = found.iter().find(|(other, _)| String::from(*other) == name);
            one.and_then(|(_, value)| *value).expect("measured")
        };
        assert_relative_eq!(value(FREQUENCY), 1.1, max_relative = 1e-6);
        assert_relative_eq!(value(AVERAGE_Y), -0.06, max_relative = 1e-4);
        assert_relative_eq!(value(HARMONIC_Y), 0.06, max_relative = 1e-4);
        assert_relative_eq!(value(AVERAGE_X), -0.01, max_relative = 1e-3);
        assert_relative_eq!(value(HARMONIC_X), 0.01, max_relative = 1e-3);
        assert_relative_eq!(value(MEAN_Y), -0.06, max_relative = 1e-5);
        assert_relative_eq!(value(AMPLITUDE_Y), 0.06, max_relative = 1e-5);
        assert_relative_eq!(value(FIRST_LEAST_Y), -0.12, max_relative = 1e-5);
    }

    /// A run of half a second ends in the first swing, one of 0.3 s before its least height.
    #[test]
    fn a_short_path_has_no_frequency_and_a_shorter_one_no_least_height() {
        let has = |end: f64, key: MetricKey| {
            let found = measure(&swing(1.1, end));
            found.iter().any(|(other, value)| *other == key && value.is_some())
        };
        assert!(has(0.5, FIRST_LEAST_Y) && !has(0.5, FREQUENCY) && !has(0.5, AVERAGE_Y));
        assert!(!has(0.3, FIRST_LEAST_Y) && has(0.3, MEAN_Y));
    }
}
