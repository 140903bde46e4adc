//! The error that no number of rows takes away: the viscosity of a lattice is not ν but L₁ ν
//! ([`SquareLattice::laplacian_factor`]), whatever the spacing. Steady flow past fixed plates that a
//! force drives is 1/L₁ as fast; the start of a flow is delayed by L₁.

use solver::{CubicSpline, Kernel, QuinticSpline, WendlandC2};

use super::Flow;
use base::record::Record;
use maths::{
    exact::{couette::Couette, poiseuille::Poiseuille},
    metrics::norms::{Scale, l2},
    theory::lattice::SquareLattice,
};
use report::percent;

/// A guard against 0/0 that changes no sum.
const NO_GUARD: f64 = 1e-12;

/// Errors that a viscosity of L₁ ν makes.
#[derive(Clone, Copy, Debug)]
pub struct LatticeFloor {
    /// Of a lattice in place.
    pub in_place: f64,
    /// Of one whose rows have slid past each other, as shear makes them in time.
    pub slid: f64,
    /// The same two without η².
    pub unguarded: [f64; 2],
}

/// L₁ in place and with slid rows.
fn factors<K: Kernel>(h_over_dx: f64, eta2_over_h2: f64) -> [f64; 2] {
    let lattice = SquareLattice::<K>::new(h_over_dx, eta2_over_h2);
    [lattice.laplacian_factor(), lattice.sheared_laplacian_factor()]
}

/// Relative L2 difference of the flow of viscosity `factor` ν and that of viscosity ν, at νt/L² = `tau`.
fn error(flow: Flow, factor: f64, tau: f64) -> f64 {
    let velocity = |nu: f64, y: f64| match flow {
        Flow::Couette => Couette { v0: 1.0, l: 1.0, nu }.velocity(y, tau),
        Flow::Poiseuille => Poiseuille { v: 1.0 / nu, l: 1.0, nu }.velocity(y, tau),
    };
    let stations = (1..100).map(|k| f64::from(k) / 100.0);
    let (found, exact): (Vec<f64>, Vec<f64>) =
        stations.map(|y| (velocity(factor, y), velocity(1.0, y))).unzip();
    Scale::rms(&exact).and_then(|scale| l2(&found, &exact, scale)).unwrap_or(f64::NAN)
}

impl LatticeFloor {
    /// Of the kernel, h/dx and η² of a run, at νt/L² = `tau`.
    pub fn of(record: &Record, flow: Flow, tau: f64) -> Option<Self> {
        let factors = match record.numerics.get("kernel")?.as_str()? {
            CubicSpline::NAME => factors::<CubicSpline>,
            QuinticSpline::NAME => factors::<QuinticSpline>,
            WendlandC2::NAME => factors::<WendlandC2>,
            _ => return None,
        };
        let errors = |eta2: f64| {
            factors(record.setting("h_over_dx"), eta2).map(|factor| error(flow, factor, tau))
        };
        let [in_place, slid] = errors(record.setting("eta2_over_h2"));
        Some(Self { in_place, slid, unguarded: errors(NO_GUARD) })
    }

    /// What makes an error that stopped falling: the nearer one of the two lattices, if it is within a
    /// factor of two; η², if the error would be less than half without.
    pub fn cause(&self, floor: f64) -> String {
        let of = [("a lattice in place", self.in_place), ("slid rows", self.slid)];
        let off = |k: usize| (of[k].1 / floor).ln().abs();
        let k = usize::from(off(1) < off(0));
        let ((lattice, with), without) = (of[k], self.unguarded[k]);
        let part = match (off(k) <= 2_f64.ln(), without < 0.5 * with) {
            (true, true) => "*η²*",
            (true, false) => "*lattice factor*",
            (false, _) => "*open*, see the error budget",
        };
        let [with, without] = [with, without].map(|error| percent(error, 2));
        format!("{part}: the viscosity of {lattice} makes {with}, without η² {without}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn steady_flow_is_slower_by_the_factor_and_a_plate_drags_it_all_the_same() {
        assert_relative_eq!(
            error(Flow::Poiseuille, 0.98, 5.0),
            1.0 / 0.98 - 1.0,
            max_relative = 1e-9
        );
        assert!(error(Flow::Couette, 0.98, 5.0) < 1e-9);
        assert!(error(Flow::Couette, 0.98, 0.1) > 1e-3);
    }

    /// The floors that runs were seen to have (numerics 1.0: L₁ = 0.9807 of the seed's kernel).
    #[test]
    fn the_guard_is_named_where_it_is_the_cause() {
        let floor = |eta2: f64| {
            let errors =
                |eta2| factors::<CubicSpline>(1.2, eta2).map(|g| error(Flow::Poiseuille, g, 1.0));
            let [in_place, slid] = errors(eta2);
            LatticeFloor { in_place, slid, unguarded: errors(NO_GUARD) }
        };
        assert_relative_eq!(floor(0.01).in_place, 1.0 / 0.98069 - 1.0, max_relative = 1e-3);
        assert!(floor(0.01).cause(0.018).starts_with("*η²*"));
        assert!(floor(0.01).cause(0.0036).starts_with("*lattice factor*"));
        assert!(floor(1e-6).cause(0.0065).starts_with("*lattice factor*"));
        assert!(floor(1e-6).cause(0.1).starts_with("*open*"));
    }
}
