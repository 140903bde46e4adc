//! The error that no number of rows takes away: the viscosity of a lattice is not ν but L₁ ν
//! ([`SquareLattice::laplacian_factor`]), whatever the spacing. Steady flow past fixed plates that a
//! force drives is 1/L₁ as fast; the start of a flow is delayed by L₁.

use solver::{CubicSpline, Kernel, QuinticSpline, WendlandC2};

use super::{
    Channel, ChannelSettings, Flow,
    declaration::{at_rows, ladder, levels},
    measure::L2,
};
use base::functions::ln;
use base::record::Record;
use harness::{
    case::Tier,
    columns::Columns,
    convergence::{Level, convergence},
    runs::Runs,
    simulate::KERNEL,
    study::Study,
};
use maths::{
    metrics::norms::{Scale, l2},
    theory::lattice::SquareLattice,
};
use report::{Cell, percent};

/// A guard against 0/0 that changes no sum.
const NO_GUARD: f64 = 1e-12;

/// Errors that a viscosity of L₁ ν makes.
#[derive(Clone, Copy, Debug)]
struct LatticeFloor {
    /// Of a lattice in place.
    in_place: f64,
    /// Of one whose rows have slid past each other, as shear makes them in time.
    slid: f64,
    /// The same two without η².
    unguarded: [f64; 2],
}

/// L₁ in place and with slid rows.
fn factors<K: Kernel>(h_over_dx: f64, eta2_over_h2: f64) -> [f64; 2] {
    let lattice = SquareLattice::of::<K>(h_over_dx, eta2_over_h2);
    [lattice.laplacian_factor(), lattice.sheared_laplacian_factor()]
}

/// Relative L2 difference of the flow of viscosity `factor` ν and that of viscosity ν, at νt/L² = `tau`.
fn error(flow: Flow, factor: f64, tau: f64) -> f64 {
    let stations = (1..100).map(|k| f64::from(k) / 100.0);
    let (found, exact): (Vec<f64>, Vec<f64>) =
        stations.map(|y| (flow.exact(y, tau, factor), flow.exact(y, tau, 1.0))).unzip();
    Scale::rms(&exact).and_then(|scale| l2(&found, &exact, scale)).unwrap_or(f64::NAN)
}

impl LatticeFloor {
    /// Of the kernel, h/dx and η² of a run, at νt/L² = `tau`.
    fn of(record: &Record, flow: Flow, tau: f64) -> Option<Self> {
        let factors = match record.numerics.get(KERNEL)?.as_str()? {
            CubicSpline::NAME => factors::<CubicSpline>,
            QuinticSpline::NAME => factors::<QuinticSpline>,
            WendlandC2::NAME => factors::<WendlandC2>,
            _ => return None,
        };
        let ChannelSettings { h_over_dx, eta2_over_h2, .. } = record.settings_as();
        let errors = |eta2: f64| factors(h_over_dx, eta2).map(|factor| error(flow, factor, tau));
        let [in_place, slid] = errors(eta2_over_h2);
        Some(Self { in_place, slid, unguarded: errors(NO_GUARD) })
    }

    /// What makes an error that stopped falling: the nearer one of the two lattices, if it is within a
    /// factor of two; η², if the error would be less than half without.
    fn cause(&self, floor: f64) -> String {
        let of = [("a lattice in place", self.in_place), ("slid rows", self.slid)];
        let off = |k: usize| ln(of[k].1 / floor).abs();
        let k = usize::from(off(1) < off(0));
        let ((lattice, with), without) = (of[k], self.unguarded[k]);
        let part = match (off(k) <= ln(2.0), without < 0.5 * with) {
            (true, true) => "*η²*",
            (true, false) => "*lattice factor*",
            (false, _) => "*open*, see the error budget",
        };
        let [with, without] = [with, without].map(|error| percent(error, 2));
        format!("{part}: the viscosity of {lattice} causes {with}, without η² {without}")
    }
}

/// Where the ladders stop, and why.
pub fn study(channel: Channel, tier: Tier, runs: &Runs) -> Study {
    let flow = channel.flow;
    let tau = flow.compared_at();
    let caption = format!(
        "Errors of u at νt/L² = {tau} that refinement leaves. The viscosity of a square lattice causes an \
         error at any spacing, another one with rows in place than with rows that shear has slid past each \
         other. The fitted error is the one that the runs of a variant tend to."
    );
    let row = |variant: &'static str| {
        let records = levels(tier)
            .iter()
            .map(|rows| (1.0 / *rows as f64, runs.completed(&at_rows(channel, variant, *rows))));
        let records: Vec<(f64, Option<&Record>)> = records.collect();
        let error = |record: &Record| record.value(L2.at(tau));
        let level = |(spacing, record): &(f64, Option<&Record>)| Level {
            spacing: *spacing,
            value: record.and_then(error).unwrap_or(f64::NAN),
        };
        let found = convergence(&records.iter().map(level).collect::<Vec<_>>());
        let floor = found.ok().and_then(|found| found.floor).map(|floor| floor.error);
        let finest = records.last().and_then(|(_, record)| *record);
        let lattice = finest.and_then(|record| LatticeFloor::of(record, flow, tau))?;
        Some((variant, lattice, floor))
    };
    let fitted = |floor: Option<f64>| {
        floor.map_or(Cell::text("none reached"), |floor| Cell::percent(floor, 2))
    };
    let table = Columns::<(&str, LatticeFloor, Option<f64>)>::default()
        .code("variant", |(variant, ..)| *variant)
        .num(["of a lattice in place", "-"], |(_, of, _)| Cell::percent(of.in_place, 2))
        .num(["of slid rows", "-"], |(_, of, _)| Cell::percent(of.slid, 2))
        .num(["fitted", "-"], |(.., floor)| fitted(*floor))
        .text("cause", |(_, of, floor)| floor.map_or("–".into(), |floor| of.cause(floor)))
        .table(caption, ladder(flow).iter().filter_map(|variant| row(variant)));
    Study::new(&format!("{}-floor", flow.name()), "The error that refinement leaves").block(table)
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
