//! The runs of the case and the gates of each.

use touchstone_harness::{prelude::*, table};

use super::{
    OPERATORS, OperatorSettings, QUINTIC,
    run::{SUM_ERROR, SYMBOL_ERROR},
    subjects,
};

/// Purpose of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Group {
    /// A lattice, finer with h: the error of smoothing.
    Lattice,
    /// Disordered particles, finer with h.
    Resolution,
    /// More neighbours at fixed h.
    Neighbours,
    /// More disorder.
    Disorder,
}

/// The runs of a tier.
pub(super) type Table = table::Table<OperatorSettings, Group>;

/// Particles along each side, and disorder, of ladders in which something else changes.
const SIDE: usize = 48;
const DISORDER: f64 = 0.2;

/// The runs of a tier: all kernels on a lattice, and ladders of one kernel in the quick tier.
pub(super) fn table(tier: Tier) -> Table {
    let mut table = Table::new(&OPERATORS, tier);
    for of in subjects() {
        let has_ladders = tier == Tier::Full || of.kernel == QUINTIC;
        let sides: &[usize] = if has_ladders { &[24, 48, 96] } else { &[24] };
        // With 1.5 times the usual h the lattice itself adds less than 1e-3 to the gain.
        table.over(Group::Lattice, &[of.name], [sides; 2], |s, n| {
            (s.n, s.disorder, s.h_over_dx) = (n, 0.0, 1.5 * s.h_over_dx);
        });
        if has_ladders {
            table.over(Group::Resolution, &[of.name], [sides; 2], |s, n| {
                (s.n, s.disorder) = (n, DISORDER);
            });
            table.over(Group::Neighbours, &[of.name], [&[1.0, 1.5, 2.0, 3.0]; 2], |s, more| {
                (s.n, s.disorder) = ((24.0 * more) as usize, DISORDER);
                s.h_over_dx *= more;
            });
            table.over(Group::Disorder, &[of.name], [&[0.05, 0.1, DISORDER]; 2], |s, disorder| {
                (s.n, s.disorder) = (SIDE, disorder);
            });
        }
    }
    table
}

/// The runs of a tier; runs with a known answer are judged.
pub(super) fn judged(tier: Tier) -> Table {
    let mut table = table(tier);
    table.judge(|row| {
        let exact = "On a lattice a wave stays a wave, and its factor, the symbol of the sum, is known \
                     exactly. Steps of 1e-6 h/c0 change it by less than 1e-5 of itself.";
        let summed = "The sum over the pairs of the same particles, added one after another, is the \
                      operator. On a lattice a pressure of one side has the same sum as one of both. Steps \
                      of 1e-6 h/c0 change it by less than 1e-5 of itself.";
        let gates = OPERATORS.gates(format!("{}.{}", row.variant, row.settings.n));
        let is_plain = subjects().any(|of| of.name == row.variant && !of.is_corrected);
        let of = match row.group {
            Group::Lattice => Some((SYMBOL_ERROR, exact)),
            Group::Resolution => is_plain.then_some((SUM_ERROR, summed)),
            _ => None,
        };
        let gate = |(metric, why)| gates.theory(metric, Bound::Below(1e-5), why);
        of.map(gate).into_iter().collect()
    });
    table
}
