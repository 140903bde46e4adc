//! Numbers as text for tables: no more digits than are known, a true minus, no rounding dust.

/// A true minus sign instead of a hyphen.
pub(super) fn minus(text: String) -> String {
    text.replace('-', "−")
}

/// `10⁻³`.
pub(super) fn power_of_ten(k: i32) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => char::from_u32('⁰' as u32 + c as u32 - '0' as u32).unwrap_or(c),
    };
    format!("10{}", k.to_string().chars().map(digit).collect::<String>())
}

/// The text for a value that is not finite.
fn not_finite(x: f64) -> String {
    if x.is_nan() { "NaN".into() } else { minus(format!("{}∞", if x < 0.0 { "-" } else { "" })) }
}

/// `digits` significant digits: `0.0123`, `12.3`, `1.23·10⁻⁷` where zeros would bury them.
pub fn sig(x: f64, digits: usize) -> String {
    if !x.is_finite() || x == 0.0 {
        return sci(x, digits);
    }
    let digits = digits.max(1);
    // The exponent after rounding: 9.996 to three digits is 10.0.
    let written = format!("{:.*e}", digits - 1, x);
    let exponent: i32 = written.split_once('e').and_then(|e| e.1.parse().ok()).unwrap_or(0);
    if !(-4..6).contains(&exponent) {
        return sci(x, digits);
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    minus(format!("{x:.decimals$}"))
}

/// The digits that a number has, at most seven: `20`, `0.0125`.
pub fn exact(x: f64) -> String {
    let rounded: f64 = format!("{x:.6e}").parse().unwrap_or(x);
    if rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs()) {
        minus(format!("{}", rounded + 0.0))
    } else {
        sci(rounded, 3)
    }
}

/// `digits` significant digits as `1.2·10⁻⁴`.
pub fn sci(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return not_finite(x);
    }
    if x == 0.0 {
        return "0".into();
    }
    let written = format!("{:.*e}", digits.max(1) - 1, x);
    match written.split_once('e') {
        Some((mantissa, exponent)) => {
            minus(format!("{mantissa}·{}", power_of_ten(exponent.parse().unwrap_or(0))))
        }
        None => written,
    }
}

/// A number of things with the noun, and the verb, that agree with it: `1 gate fails`, `2 gates fail`.
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// A fraction as per cent: `0.0123` with two digits is `1.2 %`.
pub fn percent(fraction: f64, digits: usize) -> String {
    format!("{}\u{a0}%", sig(100.0 * fraction, digits))
}

/// A duration with three digits in the unit that suits it: `3.20 ms`, `41.0 s`, `12.5 min`.
pub fn seconds(s: f64) -> String {
    let (value, unit) = match s.abs() {
        a if !a.is_finite() || a == 0.0 => (s, "s"),
        a if a < 0.999_5e-3 => (1e6 * s, "µs"),
        a if a < 0.999_5 => (1e3 * s, "ms"),
        a if a < 300.0 => (s, "s"),
        a if a < 2.0 * 3600.0 => (s / 60.0, "min"),
        _ => (s / 3600.0, "h"),
    };
    format!("{}\u{a0}{unit}", sig(value, 3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_significant() {
        assert_eq!(sig(0.012_345, 3), "0.0123");
        assert_eq!(sig(-12.345, 3), "−12.3");
        assert_eq!(sig(9.996, 3), "10.0");
        assert_eq!(sig(123_456.0, 2), "123456");
        assert_eq!(sig(1.234e-7, 3), "1.23·10⁻⁷");
        assert_eq!(sci(1.2e-4, 2), "1.2·10⁻⁴");
        assert_eq!(sci(-9.99e12, 2), "−1.0·10¹³");
        assert_eq!(percent(0.012_3, 2), "1.2\u{a0}%");
        assert_eq!(exact(20.0), "20");
        assert_eq!(exact(0.0125), "0.0125");
        assert_eq!(exact(0.1 + 0.2), "0.3");
        assert_eq!(exact(-0.0), "0");
        assert_eq!(exact(f64::NAN), "NaN");
        assert_eq!(seconds(0.003_2), "3.20\u{a0}ms");
        assert_eq!(seconds(750.0), "12.5\u{a0}min");
    }

    #[test]
    fn what_is_no_number_says_so() {
        assert_eq!(sig(f64::NAN, 3), "NaN");
        assert_eq!(sci(f64::NEG_INFINITY, 3), "−∞");
        assert_eq!(sig(0.0, 3), "0");
        assert_eq!(seconds(f64::NAN), "NaN\u{a0}s");
    }
}
