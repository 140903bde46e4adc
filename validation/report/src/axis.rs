//! An axis, and the mapping of its values to the unit interval.

use super::font::{self, TICK_EM};
use super::ticks::{Scale, Ticks, ticks, with_exponent};

/// One axis of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Quantity with its unit in brackets: `velocity u [m/s]`.
    pub label: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Ends of the axis; `None` takes the data's with some padding.
    pub range: Option<(f64, f64)>,
    /// Labels at its ticks, in order; empty for numbers.
    pub names: Vec<String>,
}

impl Axis {
    /// A linear axis with automatic range.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None, names: Vec::new() }
    }

    /// An axis of cells with these names.
    pub fn names(label: impl Into<String>, names: &[String]) -> Self {
        Self { names: names.to_vec(), ..Self::linear(label) }.range(0.0, names.len() as f64)
    }

    /// A logarithmic axis with automatic range.
    pub fn log(label: impl Into<String>) -> Self {
        Self { scale: Scale::Log, ..Self::linear(label) }
    }

    /// Fixes the ends.
    pub fn range(self, lo: f64, hi: f64) -> Self {
        Self { range: Some((lo, hi)), ..self }
    }

    /// The mapping for the given data.
    pub(super) fn mapping(&self, data: impl Iterator<Item = f64>) -> Mapping {
        // Beyond these bounds differences and ratios leave the range of f64.
        let valid = |v: f64| v.abs() < 1e150 && (self.scale == Scale::Linear || v > 1e-150);
        if let Some((lo, hi)) = self.range
            && valid(lo)
            && valid(hi)
            && lo != hi
        {
            return Mapping { scale: self.scale, lo: lo.min(hi), hi: lo.max(hi) };
        }
        let ends = data
            .filter(|&v| valid(v))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |e, v| (e.0.min(v), e.1.max(v)));
        let (lo, hi) = match self.scale {
            Scale::Linear => padded_linear(ends),
            Scale::Log => padded_log(ends),
        };
        Mapping { scale: self.scale, lo, hi }
    }

    /// The ruler of a mapping, with at most about `count` labelled ticks.
    pub(super) fn ruler(&self, mapping: Mapping, count: usize) -> Ruler {
        let Ticks { major, minor, exponent } = match &self.names[..] {
            [] => ticks(self.scale, mapping.lo, mapping.hi, count),
            names => {
                let middles =
                    names.iter().enumerate().map(|(k, name)| (k as f64 + 0.5, name.clone()));
                Ticks { major: middles.collect(), minor: Vec::new(), exponent: 0 }
            }
        };
        let major = major.into_iter().filter_map(|(v, label)| Some((mapping.unit(v)?, label)));
        let minor = minor.into_iter().filter_map(|v| mapping.unit(v));
        let label = with_exponent(&self.label, exponent);
        Ruler { mapping, major: major.collect(), minor: minor.collect(), label }
    }
}

fn padded_linear((lo, hi): (f64, f64)) -> (f64, f64) {
    if lo > hi {
        return (0.0, 1.0);
    }
    let span = (hi - lo) / 2.0;
    if span <= 1e-12 * lo.abs().max(hi.abs()) || span < 1e-150 {
        let half = if lo.abs() < 1e-150 { 1.0 } else { 0.5 * lo.abs() };
        return (lo - half, hi + half);
    }
    (lo - 0.1 * span, hi + 0.1 * span)
}

fn padded_log((lo, hi): (f64, f64)) -> (f64, f64) {
    if lo > hi {
        return (0.1, 10.0);
    }
    let decades = (hi / lo).log10();
    let pad = if decades < 1e-9 { 0.5 } else { (0.05 * decades).max(0.06) };
    ((lo * 10f64.powf(-pad)).max(f64::MIN_POSITIVE), (hi * 10f64.powf(pad)).min(f64::MAX))
}

/// A mapping with its ticks and its label.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ruler {
    pub mapping: Mapping,
    /// Labelled ticks: place on the unit interval, label.
    pub major: Vec<(f64, String)>,
    /// Places of unlabelled ticks.
    pub minor: Vec<f64>,
    /// Quantity and unit, with the power of ten that the labels of the ticks leave out.
    pub label: String,
}

impl Ruler {
    /// Removes all ticks.
    pub fn clear(&mut self) {
        self.major.clear();
        self.minor.clear();
    }

    /// Width of the widest tick label \[CSS pixels\].
    pub fn width(&self) -> f64 {
        font::widest(self.major.iter().map(|(_, label)| label), TICK_EM)
    }
}

/// Maps values between two ends to the unit interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mapping {
    pub scale: Scale,
    pub lo: f64,
    pub hi: f64,
}

impl Mapping {
    /// 0 at the low end, 1 at the high end, beyond these values outside; `None` for a value without a
    /// position.
    pub fn unit(&self, v: f64) -> Option<f64> {
        let place = match self.scale {
            Scale::Linear => (v - self.lo) / (self.hi - self.lo),
            Scale::Log => (v / self.lo).ln() / (self.hi / self.lo).ln(),
        };
        // A place a million axis lengths away would only overflow the drawing.
        place.is_finite().then(|| place.clamp(-1e6, 1e6))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_map_to_zero_and_one() {
        let log = Axis::log("h").range(1e-4, 1.0).mapping(std::iter::empty());
        assert!((log.unit(1e-2).unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(log.unit(0.0), None);
        assert_eq!(log.unit(-1.0), None);
        assert_eq!(log.unit(f64::NAN), None);
    }

    #[test]
    fn hopeless_data_still_gives_an_axis() {
        for data in [vec![], vec![f64::NAN], vec![0.0], vec![3.0, 3.0], vec![-1e308, 1e308]] {
            for axis in [Axis::linear("x"), Axis::log("x")] {
                let m = axis.mapping(data.iter().copied());
                assert!(m.lo < m.hi && m.lo.is_finite() && m.hi.is_finite(), "{data:?} {m:?}");
                assert!(axis.ruler(m, 5).major.len() < 50);
            }
        }
    }

    #[test]
    fn a_range_that_the_scale_cannot_show_is_ignored() {
        let m = Axis::log("x").range(0.0, 1.0).mapping([0.1, 10.0].into_iter());
        assert!(m.lo > 0.0 && m.lo < 0.1 && m.hi > 10.0);
    }
}
