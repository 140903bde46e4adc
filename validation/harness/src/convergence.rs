//! Order of accuracy: the slope of log error over log spacing, and whether the error converges with it.
//!
//! With the local orders p_k = ln(E_k/E_{k+1}) / ln(h_k/h_{k+1}) between successive levels, coarse
//! to fine, and p̂ the slope of the least-squares line through all levels, the label is
//!
//! - [`Label::OrdersAgree`] if p̂ > 0 and every p_k is within 15 % of p̂: one power law describes all levels,
//!   of any order;
//! - [`Label::Asymptotic`] if moreover p̂ is the formal order of the method: the order is declared, is inside
//!   the confidence interval of p̂, and p̂ is within 15 % of it, because the interval of three levels is
//!   wide;
//! - [`Label::FloorReached`] if the p_k begin with one or more that are at least half of the
//!   largest and at least 0.5, and all later ones (at least the last one) are below half of the
//!   largest: the error first decreased with a clear order and then stopped decreasing;
//! - [`Label::NotYet`] otherwise.

use touchstone_base::functions::ln;
use touchstone_report::sig;

/// Local orders within this fraction of the fitted one count as equal.
pub const SAME_ORDER: f64 = 0.15;
/// A local order below this fraction of the largest one has left the power law.
pub const LEFT_THE_LAW: f64 = 0.5;
/// The interval of an order that is found exactly has no width but this.
const ROUND_OFF: f64 = 1e-9;
/// The slowest fall of the error that counts as convergence towards a floor.
pub const SLOWEST: f64 = 0.5;

/// One resolution: spacing h \[any unit\] and its error or value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorLevel {
    /// Spacing or time step.
    pub spacing: f64,
    /// Error (≥ 0).
    pub value: f64,
}

/// Result for the levels; the rule is in the module's documentation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Label {
    /// One order describes all levels, and it is the formal one.
    Asymptotic,
    /// One order describes all levels; it is not the formal one, or none is declared.
    OrdersAgree,
    /// The error fell with some order and then stopped falling.
    FloorReached,
    /// Neither: the fitted order means nothing.
    NotYet,
}

impl Label {
    /// Whether one order describes all levels.
    pub fn is_one_order(self) -> bool {
        matches!(self, Self::Asymptotic | Self::OrdersAgree)
    }

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Asymptotic => "asymptotic",
            Self::OrdersAgree => "orders agree",
            Self::FloorReached => "floor reached",
            Self::NotYet => "not yet",
        }
    }
}

/// The outcome of [`convergence`].
#[derive(Clone, Debug)]
pub struct Convergence {
    /// p̂, least squares in log-log over all levels.
    pub order: f64,
    /// Standard error of p̂.
    pub standard_error: f64,
    /// 95 % confidence interval p̂ ± t₀.₉₇₅(n-2) × standard error; wide for three levels, t = 12.7.
    pub interval: [f64; 2],
    /// p_k, coarse to fine.
    pub local_orders: Vec<f64>,
    /// Whether to believe the order.
    pub label: Label,
}

impl Convergence {
    /// The order with its interval: `1.7 (1.6 … 1.8)`.
    pub fn in_words(&self) -> String {
        let [order, low, high] =
            [self.order, self.interval[0], self.interval[1]].map(|p| sig(p, 2));
        format!("{order} ({low} … {high})")
    }
}

/// Order of the errors of three or more levels in any sequence, with the actual ratios of spacing, of a
/// method that has this formal order, if one is declared.
///
/// # Errors
/// The reason, in words, if there is no order; an error of exactly 0 has none and is refused.
pub fn convergence(levels: &[ErrorLevel], formal: Option<f64>) -> Result<Convergence, String> {
    let levels = sorted(levels)?;
    let x: Vec<f64> = levels.iter().map(|level| ln(level.spacing)).collect();
    let y: Vec<f64> = levels.iter().map(|level| ln(level.value)).collect();
    let (order, standard_error) = slope(&x, &y);
    let half_width = student_t(levels.len() - 2) * standard_error;
    let local_orders: Vec<f64> =
        (1..x.len()).map(|k| (y[k - 1] - y[k]) / (x[k - 1] - x[k])).collect();
    let interval = [order - half_width, order + half_width];
    let label = label(order, interval, &local_orders, formal);
    Ok(Convergence { order, standard_error, interval, local_orders, label })
}

/// The levels, coarse to fine.
fn sorted(levels: &[ErrorLevel]) -> Result<Vec<ErrorLevel>, String> {
    if levels.len() < 3 {
        return Err(format!("there are {} levels, but at least 3 are needed", levels.len()));
    }
    let is_usable = |number: f64| number > 0.0 && number.is_finite();
    let usable = |level: &&ErrorLevel| is_usable(level.spacing) && is_usable(level.value);
    if let Some(ErrorLevel { spacing, value }) = levels.iter().find(|level| !usable(level)) {
        if value.is_nan() {
            return Err(format!("the level with spacing {spacing} has no value"));
        }
        let level = format!("a level with spacing {spacing} and value {value}");
        return Err(format!("{level} cannot be used, because its logarithm is needed"));
    }
    let mut levels = levels.to_vec();
    levels.sort_by(|a, b| b.spacing.total_cmp(&a.spacing));
    match levels.windows(2).find(|w| w[0].spacing == w[1].spacing) {
        Some(twins) => Err(format!("two levels have the same spacing {}", twins[0].spacing)),
        None => Ok(levels),
    }
}

/// Slope of the least-squares line through (x, y) and its standard error,
/// (Σ residual²/(n-2) / Σ (x - x̄)²)^(1/2).
pub fn slope(x: &[f64], y: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    let mean = |v: &[f64]| v.iter().sum::<f64>() / n;
    let (mean_x, mean_y) = (mean(x), mean(y));
    let (mut sxx, mut sxy) = (0.0, 0.0);
    for (x, y) in x.iter().zip(y) {
        sxx += (x - mean_x) * (x - mean_x);
        sxy += (x - mean_x) * (y - mean_y);
    }
    let slope = sxy / sxx;
    let residual = |(x, y): (&f64, &f64)| y - mean_y - slope * (x - mean_x);
    let square: f64 = x.iter().zip(y).map(residual).map(|r| r * r).sum();
    (slope, (square / (n - 2.0) / sxx).sqrt())
}

fn label(order: f64, [low, high]: [f64; 2], local: &[f64], formal: Option<f64>) -> Label {
    if order > 0.0 && local.iter().all(|p| (p - order).abs() <= SAME_ORDER * order) {
        let is_in = |p: f64| (low - ROUND_OFF..=high + ROUND_OFF).contains(&p);
        let is_formal = |p: &f64| is_in(*p) && (p - order).abs() <= SAME_ORDER * p;
        return formal.filter(is_formal).map_or(Label::OrdersAgree, |_| Label::Asymptotic);
    }
    let largest = local.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let falls = |p: &f64| *p >= (LEFT_THE_LAW * largest).max(SLOWEST);
    let falling = local.iter().take_while(|p| falls(p)).count();
    let flat = local[falling..].iter().all(|p| *p < LEFT_THE_LAW * largest);
    if falling >= 1 && falling < local.len() && flat { Label::FloorReached } else { Label::NotYet }
}

/// The 97.5 % quantile of Student's t with `freedom` ≥ 1 degrees; beyond ten, the quantile of ten, which is
/// wider by at most 14 %: no ladder has so many levels.
fn student_t(freedom: usize) -> f64 {
    const TABLE: [f64; 10] =
        [12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622, 2.2281];
    TABLE[freedom.clamp(1, TABLE.len()) - 1]
}

#[cfg(test)]
mod tests {
    use touchstone_base::functions::powf;

    use super::*;
    use approx::assert_relative_eq;

    /// Spacings whose ratios are 1.5, 1.6 and 2.
    const SPACINGS: [f64; 4] = [0.12, 0.08, 0.05, 0.025];

    fn levels<const N: usize>(spacings: [f64; N], value: impl Fn(f64) -> f64) -> [ErrorLevel; N] {
        spacings.map(|spacing| ErrorLevel { spacing, value: value(spacing) })
    }

    #[test]
    fn a_power_law_is_found_exactly() {
        let mut shuffled = levels(SPACINGS, |h| 3.0 * powf(h, 1.7));
        shuffled.swap(0, 2);
        let found = convergence(&shuffled, Some(1.7)).expect("usable");
        assert_relative_eq!(found.order, 1.7, epsilon = 1e-12);
        assert!(found.standard_error < 1e-12);
        assert_eq!(found.label, Label::Asymptotic);
        assert_eq!(found.local_orders.len(), 3);
    }

    /// The prototype's steady Poiseuille errors: 1.78, 0.44, 0.109 % at 10, 20, 40 rows.
    #[test]
    fn the_prototype_is_of_second_order() {
        let errors = [(10.0, 1.78e-2), (20.0, 4.4e-3), (40.0, 1.09e-3)];
        let found = convergence(
            &errors.map(|(n, value)| ErrorLevel { spacing: 1.0 / n, value }),
            Some(2.0),
        )
        .unwrap();
        assert!((found.order - 2.015).abs() < 1e-3);
        // 2 is outside the narrow interval 2.005 … 2.025.
        assert_eq!(found.label, Label::OrdersAgree);
        let width = found.interval[1] - found.interval[0];
        assert_relative_eq!(width, 2.0 * 12.7062 * found.standard_error, epsilon = 1e-12);
    }

    /// The line through (0, 1), (1, 3), (2, 2), (3, 5) is 1.1 + 1.1 x, its residuals are -0.1, 0.8, -1.3 and
    /// 0.6, whose squares add up to 2.7, and Σ (x - x̄)² = 5: (2.7/2/5)^(1/2).
    #[test]
    fn the_standard_error_is_that_of_two_fewer_than_the_points() {
        let (found, error) = slope(&[0.0, 1.0, 2.0, 3.0], &[1.0, 3.0, 2.0, 5.0]);
        assert_relative_eq!(found, 1.1, max_relative = 1e-14);
        assert_relative_eq!(error, 0.27_f64.sqrt(), max_relative = 1e-14);
        // Residuals -1/6, 1/3, -1/6, and 2 for Σ (x - x̄)²: 1/12 with one degree of freedom.
        let (found, error) = slope(&[5.0, 6.0, 7.0], &[-1.0, 0.0, 0.0]);
        assert_relative_eq!(found, 0.5, max_relative = 1e-14);
        assert_relative_eq!(error, (1.0 / 12.0_f64).sqrt(), max_relative = 1e-14);
    }

    /// Errors 1, 1/2, 1/2, 1/8 over spacings that are halved: in powers of two the points (0, 0), (-1, -1),
    /// (-2, -1), (-3, -3), whose slope is 0.9. The squares of the residuals -0.1, -0.2, 0.7, -0.4 add up to
    /// 0.7, so the standard error is (0.7/2/5)^(1/2), and Student's t with two degrees of freedom is 4.3027.
    #[test]
    fn an_order_has_the_interval_of_its_standard_error() {
        let errors = [(1.0, 1.0), (0.5, 0.5), (0.25, 0.5), (0.125, 0.125)];
        let levels = errors.map(|(spacing, value)| ErrorLevel { spacing, value });
        let found = convergence(&levels, Some(2.0)).expect("usable");
        assert_relative_eq!(found.order, 0.9, max_relative = 1e-12);
        for (local, expected) in found.local_orders.iter().zip([1.0, 0.0, 2.0]) {
            assert_relative_eq!(*local, expected, epsilon = 1e-12);
        }
        assert_relative_eq!(found.standard_error, 0.07_f64.sqrt(), max_relative = 1e-12);
        let half_width = 4.3027 * found.standard_error;
        for (end, expected) in found.interval.iter().zip([0.9 - half_width, 0.9 + half_width]) {
            assert_relative_eq!(*end, expected, max_relative = 1e-12);
        }
    }

    /// 5 % of noise: the interval holds the true order, and a fit of many levels is still believed.
    #[test]
    fn noise_widens_the_interval() {
        let noise = [0.05, -0.04, 0.03, -0.05, 0.02];
        let spacings = [0.16, 0.08, 0.04, 0.02, 0.01];
        let mut noisy = levels(spacings, |h| h * h);
        for (level, noise) in noisy.iter_mut().zip(noise) {
            level.value *= 1.0 + noise;
        }
        let found = convergence(&noisy, Some(2.0)).expect("usable");
        assert_eq!(found.label, Label::Asymptotic);
        assert!(found.standard_error > 1e-3);
        assert!(found.interval[0] < 2.0 && 2.0 < found.interval[1]);
    }

    /// Ghost walls with the seed's kernel and with the quintic, from the row-reduced channel.
    #[test]
    fn lattice_floors_of_the_channel_are_seen() {
        let rows = [0.1, 0.05, 0.025, 0.0125];
        let label = |errors: [f64; 4]| {
            let levels: Vec<_> = rows
                .iter()
                .zip(errors)
                .map(|(h, value)| ErrorLevel { spacing: *h, value })
                .collect();
            convergence(&levels, Some(2.0)).expect("usable").label
        };
        for errors in
            [[3.615e-2, 2.369e-2, 2.068e-2, 1.994e-2], [1.713e-2, 3.744e-3, 5.061e-4, 5.529e-4]]
        {
            assert_eq!(label(errors), Label::FloorReached);
        }
    }

    #[test]
    fn scatter_and_growth_have_no_order_yet() {
        for errors in [[1.0, 0.1, 0.2, 0.01], [1.0, 1.1, 0.9, 1.0], [1.0, 2.0, 4.0, 8.0]] {
            let mut levels = levels(SPACINGS, |_| 0.0);
            for (level, error) in levels.iter_mut().zip(errors) {
                level.value = error;
            }
            let found = convergence(&levels, Some(2.0)).expect("usable");
            assert_eq!(found.label, Label::NotYet, "{errors:?}");
        }
    }

    /// The rule of the module's documentation, on either side of each of its numbers.
    #[test]
    fn labels_change_where_their_rule_says() {
        for (order, local, expected) in [
            (2.0, [2.28, 1.72], Label::Asymptotic), // 14 % off
            (2.0, [2.32, 2.0], Label::NotYet),      // 16 % off
            (-2.0, [-2.0, -2.0], Label::NotYet),
            (1.5, [2.0, 0.98], Label::FloorReached), // below half of the largest
            (1.5, [2.0, 1.02], Label::NotYet),
            (0.3, [0.52, 0.1], Label::FloorReached),
            (0.3, [0.48, 0.1], Label::NotYet), // never fell with an order of 0.5
            (0.5, [0.1, 2.0], Label::NotYet),
        ] {
            let found = label(order, [order - 0.1, order + 0.1], &local, Some(2.0));
            assert_eq!(found, expected, "order {order}, local orders {local:?}");
        }
    }

    /// Errors with one order are asymptotic only if that order is the formal one.
    #[test]
    fn an_order_is_asymptotic_if_it_is_the_formal_one_within_its_interval() {
        for (order, half_width, formal, expected) in [
            (1.9, 0.2, Some(2.0), Label::Asymptotic),
            (1.9, 0.05, Some(2.0), Label::OrdersAgree), // 2 is outside of 1.85 … 1.95
            (2.1, 0.05, Some(2.0), Label::OrdersAgree),
            (1.31, 0.2, Some(2.0), Label::OrdersAgree),
            (1.31, 1.5, Some(2.0), Label::OrdersAgree), // an interval so wide holds any order
            (0.84, 0.1, Some(1.0), Label::OrdersAgree),
            (0.9, 0.15, Some(1.0), Label::Asymptotic),
            (2.0, 0.1, None, Label::OrdersAgree),
        ] {
            let interval = [order - half_width, order + half_width];
            let found = label(order, interval, &[order, order], formal);
            assert_eq!(found, expected, "{order} ± {half_width}, formal {formal:?}");
        }
        // Through the fit: errors of order 1.3 do not fit a method of second order.
        let levels = levels(SPACINGS, |h| powf(h, 1.3));
        let of = |formal| convergence(&levels, formal).expect("usable").label;
        assert_eq!([of(Some(2.0)), of(Some(1.3))], [Label::OrdersAgree, Label::Asymptotic]);
    }

    #[test]
    fn what_has_no_order_is_an_error() {
        let two = levels([0.2, 0.1], |h| h);
        assert!(convergence(&two, None).unwrap_err().starts_with("there are 2 levels"));
        for bad in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
            let broken = levels([0.4, 0.2, 0.1], |h| if h < 0.15 { bad } else { h });
            let words = if bad.is_nan() { "has no value" } else { "cannot be used" };
            assert!(convergence(&broken, None).is_err_and(|e| e.contains(words)), "{bad}");
        }
        let twins = levels([0.2, 0.1, 0.1], |h| h);
        assert!(convergence(&twins, None).unwrap_err().ends_with("the same spacing 0.1"));
    }
}
