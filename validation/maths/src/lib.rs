//! Exact solutions of the equations, theory of the *discretised* equations, norms between them and a
//! run, and where particles of walls stand.

pub mod exact;
pub mod geometry;
pub mod metrics;
pub mod theory;

/// The two ends of an interval that was halved so many times: `is_low` holds at the lower one, and not at the
/// upper one.
fn halved([mut low, mut high]: [f64; 2], times: usize, is_low: impl Fn(f64) -> bool) -> [f64; 2] {
    for _ in 0..times {
        let middle = 0.5 * (low + high);
        if is_low(middle) { low = middle } else { high = middle }
    }
    [low, high]
}
