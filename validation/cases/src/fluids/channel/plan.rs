//! The runs of the channel flows, stated once, and their gates.

use touchstone_base::record::{MetricKey, MetricName};
use touchstone_harness::prelude::*;
use touchstone_harness::table::{Row, Table};

use super::{
    ChannelSettings, ChannelTable, Flow, Group, TIMES, maps,
    measure::{
        L2, L2_WORST, MOMENTUM_Y, OUTSIDE, P_RMS, SHEAR_LOWER, SHEAR_UPPER, V_RMS, VOLUME_DRIFT,
    },
    stiff, waves,
};

/// Variants whose error is drawn against their cost. In Couette flow, without a body force, `curved` would be
/// `plain`.
pub fn ladder(flow: Flow) -> [&'static str; 8] {
    let own = if flow == Flow::Couette { "modern" } else { "curved" };
    let recommended = flow.case().recommended.variant;
    let [seed, interface, wendland] = ["seed", "interface-wall", "wendland-leapfrog"];
    [seed, interface, wendland, "plain", own, recommended, "single-sweep", "stiff"]
}

/// Reynolds numbers of the modern variant.
const REYNOLDS: [f64; 10] = [0.0125, 0.5, 1.0, 5.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0];

/// Errors of ghost walls by their row-reduced matrices (`tests/src/row_matrix.rs`; a test computes them
/// again), with the quintic spline, h = dx, at the time of the comparison: rows of a flow, the lesser and the
/// larger one of rows in columns and of rows that slid past each other, Couette flow with the steps of the
/// leapfrog.
pub const GHOSTS: [(Flow, usize, [f64; 2]); 5] = [
    (Flow::Couette, 10, [1.2712e-3, 1.5453e-3]),
    (Flow::Couette, 20, [3.8402e-4, 6.7664e-4]),
    (Flow::Poiseuille, 10, [1.712e-2, 1.794e-2]),
    (Flow::Poiseuille, 20, [3.744e-3, 4.540e-3]),
    (Flow::Poiseuille, 40, [5.064e-4, 1.196e-3]),
];

/// Errors at νt/L² = 0.1 by the same matrices, whose sums are divided by half the trace of the moments, with
/// ghosts that know the curvature, and the steps of the leapfrog: the lesser and the larger one.
pub const CONSISTENT: [(Flow, usize, [f64; 2]); 6] = [
    (Flow::Couette, 10, [1.2875e-3, 1.2969e-3]),
    (Flow::Couette, 20, [4.007e-4, 4.114e-4]),
    (Flow::Couette, 40, [9.32e-5, 1.039e-4]),
    (Flow::Poiseuille, 10, [3.942e-3, 3.959e-3]),
    (Flow::Poiseuille, 20, [1.1314e-3, 1.1466e-3]),
    (Flow::Poiseuille, 40, [2.851e-4, 2.999e-4]),
];

/// The gate for a code with another kernel or step: `most` holds for our own steps only, whose error cancels
/// a part of the error of the sums.
fn of_others(gate: Gate, most: f64) -> Gate {
    let because = "The exact solution has no error. The bound is 2 %, by which sums over a lattice may \
                   change the viscosity, plus the error of our own walls.";
    gate.of_others(Bound::Below(0.02 + most), because)
}

/// All runs of a flow with their gates, without the runs of budgets, step limits and sensitivity.
pub fn table(flow: Flow, tier: Tier) -> ChannelTable {
    let mut table = Table::new(flow.case(), tier);
    let recommended = flow.case().recommended.variant;
    // Couette flow has no force that disorders rows, so that the lower Reynolds numbers are enough.
    let full = if flow == Flow::Couette { 7 } else { 10 };
    let reynolds = [&REYNOLDS[..5], &REYNOLDS[..full]];
    // The νt/L² that each must reach.
    let reach = |re: f64| match re {
        ..=100.0 => 1.5,
        ..=500.0 => 1.0,
        _ => 0.5,
    };
    // In Poiseuille flow the map shows where `seed` breaks.
    let variants = ["modern", recommended, "seed"];
    let variants = if flow == Flow::Couette { &variants } else { &variants[..2] };
    table.over(Group::Reynolds, variants, reynolds, |s, re| (s.re, s.end) = (re, reach(re)));
    for (re, _) in stiff::REYNOLDS {
        let set = |s: &mut ChannelSettings, rows| (s.re, s.rows) = (re, rows);
        table.over(Group::Stiff, &["modern", "stiff"], [&[40], &[40, 80]], set);
    }
    if flow == Flow::Poiseuille {
        waves::runs(&mut table);
        maps::runs(&mut table);
    }
    let levels: &[usize] = &[8, 10, 14, 20, 40, 80, 110];
    table.over(Group::Ladder, &ladder(flow), [&levels[..4], levels], |s, rows| s.rows = rows);
    for row in &mut table.rows {
        row.run.spec.allow_unstable = matches!(row.group, Group::Waves | Group::Map | Group::Cures);
    }
    table.judge(|row| gates(flow, row));
    table
}

/// The gates of a run.
fn gates(flow: Flow, row: &Row<ChannelSettings, Group>) -> Vec<Gate> {
    let (s, variant) = (&row.settings, row.variant);
    match row.group {
        Group::Ladder => of_ladder(flow, variant, s.rows),
        Group::Reynolds if variant != "seed" => {
            let because = "The settings follow from one rule, and the error must be at most 1 % at every \
                           Reynolds number of the list.";
            let gates = flow.case().gates(format!("{variant}.re{}", s.re));
            vec![gates.analytic(L2_WORST, Bound::Below(0.01), because)]
        }
        _ => Vec::new(),
    }
}

/// The gates of a run of the ladder of a variant.
fn of_ladder(flow: Flow, variant: &str, rows: usize) -> Vec<Gate> {
    let gates = flow.case().gates(format!("{variant}.{rows}"));
    let error = |metric: MetricName, most, because: &str| {
        gates.analytic(metric, Bound::Below(most), because)
    };
    match (flow, variant, rows) {
        (_, "seed", 20) => {
            let because = "H1 of Couette and H2 of Poiseuille flow: profiles follow the analytic solution. \
                           The bound is the 1.9 % by which eta and the kernel on this lattice change the \
                           viscosity.";
            let times = TIMES.into_iter().filter(|tau| (0.1..=1.0).contains(tau));
            times.map(|tau| error(L2.at(tau), 0.02, because)).collect()
        }
        (_, "interface-wall", 20) => {
            let because = "Claim M4: walls of particles are as good as ghosts. The bound is the 1.9 % by \
                           which eta and the kernel on this lattice change the viscosity.";
            vec![error(L2_WORST.into(), 0.02, because)]
        }
        (Flow::Couette, "modern" | "single-sweep", 20) => {
            let because = "The bound is the larger error by the row-reduced matrices of the walls, 6.6e-4, \
                           doubled for shifting and density diffusion, which the matrices omit.";
            let most = 1.3e-3;
            vec![of_others(error(L2.at(flow.compared_at()), most, because), most)]
        }
        (Flow::Poiseuille, "curved", 20) => {
            let because = "The bound is the goal of 0.03 %. It lies between the errors by the row-reduced \
                           matrices of rows slid past each other, 9e-5, and of rows in columns, 8e-4, \
                           because at Re 0.5 rows slide by ten spacings.";
            vec![error(L2.at(1), 3e-4, because)]
        }
        (_, "consistent", _) => {
            let because = "Without pressure and shifting, which act on disorder alone, the error is that of \
                           the row-reduced matrices, whose sums are exact for linear fields, with the \
                           steps of the leapfrog: between rows in columns and rows slid past each other.";
            let matrices = CONSISTENT.iter().filter(|(of, n, _)| (*of, *n) == (flow, rows));
            let between = |(.., [low, high]): &(Flow, usize, [f64; 2])| {
                let gate = gates.theory(L2.at(0.1), Bound::Within(*low, *high), because);
                of_others(gate, *high)
            };
            matrices.map(between).collect()
        }
        (_, "plain", _) => {
            let because = "The error of rows that slide lies between those by the row-reduced matrices of \
                           rows in columns and of rows slid past each other, with the steps of the leapfrog.";
            let matrices = GHOSTS.iter().filter(|(of, n, _)| (*of, *n) == (flow, rows));
            let between = |(.., [low, high]): &(Flow, usize, [f64; 2])| {
                let bound = Bound::Within(*low, *high);
                of_others(gates.theory(L2.at(flow.compared_at()), bound, because), *high)
            };
            let invariants = (rows == 20).then(|| invariants(flow, &gates)).into_iter().flatten();
            matrices.map(between).chain(invariants).collect()
        }
        _ => Vec::new(),
    }
}

/// Gates of `plain` that hold for any settings.
fn invariants(flow: Flow, gates: &RunGates) -> Vec<Gate> {
    let volume = "Density by the continuity equation (3) follows the volume, which may oscillate by less \
                  than Ma^2 = 1e-3.";
    let pressure = "The exact pressure is 0; the bound is in units of rho V^2.";
    let inside = "No particle passes a plate.";
    let mut all = vec![
        gates.invariant(VOLUME_DRIFT, Bound::magnitude(1e-3), volume),
        gates.analytic(P_RMS, Bound::Below(0.1), pressure),
        gates.analytic(V_RMS, Bound::Below(1e-3), "The exact cross-flow is 0."),
        gates.invariant(OUTSIDE, Bound::Equals(0.0), inside),
    ];
    match flow {
        Flow::Couette => {
            let profile = "A linear profile is exact on mirrored rows, and 1e-6 of the start is left. \
                           Compressibility may add less than (V/c0)^2 = 1.3e-4.";
            let slope = "A linear profile is exact on mirrored rows, whatever the kernel.";
            let shear =
                |metric: MetricKey| gates.analytic(metric.at(1), Bound::magnitude(1e-3), slope);
            all.push(gates.analytic(L2.at(1), Bound::Below(1e-4), profile));
            all.extend([SHEAR_LOWER, SHEAR_UPPER].map(shear));
        }
        Flow::Poiseuille => {
            let because = "The scene is symmetric about the middle, so momentum across the channel stays at \
                           round-off.";
            all.push(gates.invariant(MOMENTUM_Y, Bound::magnitude(1e-10), because));
        }
    }
    all
}
