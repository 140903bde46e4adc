//! Comparison with tables of the design notes, digit for digit.

/// `value` with the number of digits and the notation of `printed`.
fn like(printed: &str, value: f64) -> String {
    let mantissa = printed.split('e').next().unwrap_or(printed);
    let decimals = mantissa.split('.').nth(1).map_or(0, str::len);
    match (printed.contains('e'), printed.starts_with('+') || printed.starts_with('-')) {
        (true, true) => format!("{value:+.decimals$e}"),
        (true, false) => format!("{value:.decimals$e}"),
        (false, true) => format!("{value:+.decimals$}"),
        (false, false) => format!("{value:.decimals$}"),
    }
}

/// Fails unless every value rounds to its printed form; "" is a gap in the table.
pub fn assert_rounds_to(row: &str, printed: &[&str], computed: &[f64]) {
    assert_eq!(printed.len(), computed.len(), "{row}");
    for (printed, value) in printed.iter().zip(computed) {
        let rounded = like(printed, *value);
        assert!(
            printed.is_empty() || rounded == *printed,
            "{row}: printed {printed}, computed {value:.4e}"
        );
    }
}
