//! Norms of the difference between measured and exact values, relative to a stated scale.

/// Relative L2 error of values of equal weight, (Σ (uᵢ - eᵢ)²/n)^(1/2) over the root mean square of the exact
/// values: ‖u - e‖₂/‖e‖₂. NaN for values that cannot be compared, such as exact values that are all 0.
pub fn l2(measured: &[f64], exact: &[f64]) -> f64 {
    let scale = rms(exact.iter().copied());
    match is_comparable(measured, exact, scale) {
        true => rms(measured.iter().zip(exact).map(|(u, e)| (u - e) / scale)),
        false => f64::NAN,
    }
}

/// Relative L∞ error, max |uᵢ - eᵢ| / scale, with a scale in the unit of the values. NaN for values that
/// cannot be compared.
pub fn linf(measured: &[f64], exact: &[f64], scale: f64) -> f64 {
    let differences = measured.iter().zip(exact).map(|(u, e)| ((u - e) / scale).abs());
    match is_comparable(measured, exact, scale) {
        true => differences.fold(0.0, f64::max),
        false => f64::NAN,
    }
}

/// Root mean square (Σ x²/n)^(1/2), in the unit of the values; NaN of none.
pub fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x * x, count + 1.0));
    (sum / count).sqrt()
}

/// (Σ a/Σ b)^(1/2) of squares of differences and of exact values.
pub fn relative(squares: impl Iterator<Item = [f64; 2]>) -> f64 {
    let [difference, scale] = squares.fold([0.0; 2], |[a, b], [d, e]| [a + d, b + e]);
    (difference / scale).sqrt()
}

/// The largest of these numbers, which are not negative; NaN if one is NaN, because a value that was not
/// measured must not pass.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a })
}

/// How far masses at places between 0 and 1 are from being spread evenly: the mean over the mass of |share of
/// the mass at smaller places − place|.
pub fn spread(masses: impl Iterator<Item = (f64, f64)>) -> f64 {
    let mut places: Vec<(f64, f64)> = masses.collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mass, mut before, mut sum) = (places.iter().map(|p| p.1).sum::<f64>(), 0.0, 0.0);
    for (x, own) in places {
        sum += own * ((before + 0.5 * own) / mass - x.clamp(0.0, 1.0)).abs();
        before += own;
    }
    sum / mass
}

/// Do values pair up, is each of them finite, and is the scale positive and finite, so that a relative error
/// is never a division by 0?
fn is_comparable(measured: &[f64], exact: &[f64], scale: f64) -> bool {
    let mut all = measured.iter().chain(exact).chain([&scale]);
    let is_whole = measured.len() == exact.len() && !measured.is_empty();
    is_whole && all.all(|value| value.is_finite()) && scale > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn norms_of_known_differences() {
        let (u, e) = ([4.0, 2.0, 0.0], [1.0, 2.0, 4.0]);
        assert_relative_eq!(linf(&u, &e, 10.0), 0.4);
        assert_relative_eq!(l2(&u, &e), (25.0f64 / 21.0).sqrt());
        assert_eq!(l2(&e, &e), 0.0);
        let squares = u.iter().zip(&e).map(|(u, e): (&f64, &f64)| [(u - e).powi(2), e.powi(2)]);
        assert_relative_eq!(relative(squares), l2(&u, &e));
    }

    /// Ten equal masses, evenly, and all in the middle: a quarter.
    #[test]
    fn even_masses_have_no_spread_and_those_at_one_place_have_one() {
        let even = (0..10).map(|k| (0.1 * f64::from(k) + 0.05, 2.0));
        assert!(spread(even.clone().rev()) < 1e-15);
        assert_relative_eq!(spread(even.map(|(_, mass)| (0.5, mass))), 0.25);
    }

    #[test]
    fn tiny_and_huge_values_neither_vanish_nor_overflow() {
        for size in [1e-150, 1e150] {
            assert_relative_eq!(l2(&[3.0 * size], &[size]), 2.0);
        }
        for size in [1e-200, 1e200] {
            assert_relative_eq!(linf(&[3.0 * size], &[size], size), 2.0);
        }
    }

    #[test]
    fn what_cannot_be_compared_is_not_a_number() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(linf(&[1.0], &[2.0], bad).is_nan(), "{bad}");
        }
        assert!(l2(&[], &[]).is_nan() && l2(&[1.0], &[0.0]).is_nan());
        for norm in [l2, |u: &[f64], e: &[f64]| linf(u, e, 1.0)] {
            assert_eq!(norm(&[1.0, 2.0], &[1.0, 2.0]), 0.0);
            assert!(norm(&[], &[]).is_nan() && norm(&[1.0], &[1.0, 2.0]).is_nan());
            for bad in [f64::NAN, f64::INFINITY] {
                assert!(norm(&[1.0, bad], &[1.0, 1.0]).is_nan());
                assert!(norm(&[1.0, 1.0], &[1.0, bad]).is_nan());
            }
        }
    }
}
