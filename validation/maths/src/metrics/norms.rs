//! Norms of the distance between measured and exact values, relative to a stated scale.

use thiserror::Error;

/// What a norm is relative to \[unit of the values\]: finite and positive, so that a relative error
/// is never a division by 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale(f64);

/// Why there is no norm.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum NormError {
    /// The scale is 0, negative, infinite or NaN.
    #[error("the scale of a norm is {0}, but must be positive and finite")]
    Scale(f64),
    /// Measured and exact values do not pair up.
    #[error("there are {measured} measured values, but {exact} exact ones")]
    Lengths {
        /// Number of measured values.
        measured: usize,
        /// Number of exact values.
        exact: usize,
    },
    /// Nothing to measure.
    #[error("there are no values to compare")]
    Empty,
    /// A value is NaN or infinite.
    #[error("the values at index {index} are not finite: measured {measured}, exact {exact}")]
    NotFinite {
        /// Where.
        index: usize,
        /// The measured value there.
        measured: f64,
        /// The exact value there.
        exact: f64,
    },
}

impl Scale {
    /// # Errors
    /// [`NormError::Scale`] unless `value` is positive and finite.
    pub fn new(value: f64) -> Result<Self, NormError> {
        if value > 0.0 && value.is_finite() {
            Ok(Self(value))
        } else {
            Err(NormError::Scale(value))
        }
    }

    /// The root mean square (Σ e²/n)^(1/2) of the exact values: relative to it, [`l2`] is
    /// ‖u - e‖₂/‖e‖₂.
    ///
    /// # Errors
    /// [`NormError::Scale`] when they are all 0, none, or not finite.
    pub fn rms(exact: &[f64]) -> Result<Self, NormError> {
        Self::new(rms(exact.iter().copied()))
    }

    /// The scale \[unit of the values\].
    pub fn value(self) -> f64 {
        self.0
    }
}

/// Relative L2 error, (Σ (uᵢ - eᵢ)²/n)^(1/2) / scale, of values of equal weight.
///
/// # Errors
/// [`NormError`] for unequal lengths, no values, or a value that is not finite.
pub fn l2(measured: &[f64], exact: &[f64], scale: Scale) -> Result<f64, NormError> {
    check(measured, exact)?;
    let differences = measured.iter().zip(exact).map(|(u, e)| (u - e) / scale.0);
    Ok(rms(differences))
}

/// Relative L∞ error, max |uᵢ - eᵢ| / scale.
///
/// # Errors
/// As [`l2`].
pub fn linf(measured: &[f64], exact: &[f64], scale: Scale) -> Result<f64, NormError> {
    check(measured, exact)?;
    let differences = measured.iter().zip(exact).map(|(u, e)| ((u - e) / scale.0).abs());
    Ok(differences.fold(0.0, f64::max))
}

/// Root mean square (Σ x²/n)^(1/2), in the unit of the values; NaN of none.
pub fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x * x, count + 1.0));
    (sum / count).sqrt()
}

fn check(measured: &[f64], exact: &[f64]) -> Result<(), NormError> {
    if measured.len() != exact.len() {
        return Err(NormError::Lengths { measured: measured.len(), exact: exact.len() });
    }
    if measured.is_empty() {
        return Err(NormError::Empty);
    }
    for (index, (u, e)) in measured.iter().zip(exact).enumerate() {
        if !(u.is_finite() && e.is_finite()) {
            return Err(NormError::NotFinite { index, measured: *u, exact: *e });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn norms_of_known_differences() {
        let scale = Scale::new(10.0).expect("positive");
        let (u, e) = ([4.0, 2.0, 0.0], [1.0, 2.0, 4.0]);
        assert_relative_eq!(l2(&u, &e, scale).unwrap(), (25.0f64 / 3.0).sqrt() / 10.0);
        assert_relative_eq!(linf(&u, &e, scale).unwrap(), 0.4);
        let rms = Scale::rms(&e).expect("not all 0");
        assert_relative_eq!(l2(&u, &e, rms).unwrap(), (25.0f64 / 21.0).sqrt());
        assert_eq!(l2(&e, &e, scale), Ok(0.0));
    }

    #[test]
    fn tiny_and_huge_values_neither_vanish_nor_overflow() {
        for size in [1e-200, 1e200] {
            let scale = Scale::new(size).expect("positive");
            assert_relative_eq!(l2(&[3.0 * size], &[size], scale).unwrap(), 2.0);
        }
    }

    #[test]
    fn what_cannot_be_judged_is_an_error() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Scale::new(bad), Err(NormError::Scale(_))), "{bad}");
        }
        assert!(Scale::rms(&[]).is_err() && Scale::rms(&[0.0]).is_err());
        let one = Scale::new(1.0).expect("positive");
        for norm in [l2, linf] {
            assert_eq!(norm(&[], &[], one), Err(NormError::Empty));
            let lengths = NormError::Lengths { measured: 1, exact: 2 };
            assert_eq!(norm(&[1.0], &[1.0, 2.0], one), Err(lengths));
            for bad in [f64::NAN, f64::INFINITY] {
                let not_finite =
                    |result| matches!(result, Err(NormError::NotFinite { index: 1, .. }));
                assert!(not_finite(norm(&[0.0, bad], &[0.0, 0.0], one)));
                assert!(not_finite(norm(&[0.0, 0.0], &[0.0, bad], one)));
            }
        }
    }
}
