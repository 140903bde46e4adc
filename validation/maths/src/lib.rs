//! Exact solutions of the equations, theory of the *discretised* equations, norms between them and a
//! run, where particles of walls stand, and a controller.

pub mod control;
pub mod exact;
pub mod geometry;
pub mod metrics;
pub mod theory;

/// The ends of an interval after `times` halvings: `is_low` holds at the lower end and not at the upper end.
fn halved([mut low, mut high]: [f64; 2], times: usize, is_low: impl Fn(f64) -> bool) -> [f64; 2] {
    for _ in 0..times {
        let middle = 0.5 * (low + high);
        if is_low(middle) { low = middle } else { high = middle }
    }
    [low, high]
}
