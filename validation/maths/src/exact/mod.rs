//! Exact solutions of the continuous equations: what a run is compared with.

pub mod couette;
pub mod elliptic_drop;
pub mod hydrostatic;
pub mod impact;
pub mod manufactured;
pub mod poiseuille;
pub mod taylor_couette;
pub mod taylor_green;

pub use couette::Couette;
pub use elliptic_drop::EllipticDrop;
pub use hydrostatic::Hydrostatic;
pub use poiseuille::Poiseuille;
pub use taylor_couette::TaylorCouette;
pub use taylor_green::TaylorGreen;

/// A series is summed until the rigorous bound on its tail, relative to the velocity scale, is
/// below this.
pub const TAIL: f64 = 1e-14;

/// νt/L² below which the images converge faster than the series. At 0.1 both need fewer than seven
/// terms for [`TAIL`].
const IMAGES_BELOW: f64 = 0.1;

/// The smallest number of terms n ≥ 1 with `tail(n)` < [`TAIL`], where `tail` bounds what the first
/// n terms leave out and falls with n. Doubling, then bisection: n can be 10⁶ at small times.
fn terms_for(tail: impl Fn(f64) -> f64) -> usize {
    let enough = |n: usize| tail(n as f64) < TAIL;
    let mut high = 1;
    while !enough(high) && high < 1 << 52 {
        high *= 2;
    }
    let mut low = high / 2;
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if enough(middle) { high = middle } else { low = middle }
    }
    high
}

/// (-1)ⁿ.
fn alternating(n: usize) -> f64 {
    if n.is_multiple_of(2) { 1.0 } else { -1.0 }
}
