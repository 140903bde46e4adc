//! Operators alone: density, gradient, Laplacian and divergence, one a variant, of a field whose exact values
//! are known, on a lattice and on disordered particles. Where a flow shows only that something is wrong, this
//! names the operator.
//!
//! A few steps of 1e-6 h/c₀ are made, and an operator is the rate at which velocity or density changes over
//! them, so that any code can submit it as final particles. The field is a wave, so the result of an operator
//! has two parts: its projection on the exact values, with a gain that theory predicts on a lattice, and the
//! rest, which is noise of disorder.

mod plan;
mod run;
mod study;
#[cfg(test)]
mod tests;

use touchstone_harness::case::{Drawn, Draws, Statement};
use touchstone_harness::prelude::*;
use touchstone_schemes::lattice;

touchstone_base::settings! {
    /// Settings of an operator on particles in a periodic square, whose side, density and sound speed are 1.
    pub struct OperatorSettings {
        /// particles along each side
        n: usize ["-"] in 8..=400 = 48,
        /// smoothing length over spacing
        h_over_dx: f64 ["-"] in 0.5..=8.0 = 1.0,
        /// largest displacement from the lattice along each axis; uniform
        disorder: f64 ["dx"] in 0.0..=0.5 = 0.2,
        /// seed of the displacements
        seed: usize ["-"] in 0..=1000000 = 1,
        /// steps of 1e-6 h/c0 over which rates are taken
        steps: usize ["-"] in 1..=1000 = 2,
    }
}

/// The measured operator of a variant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operator {
    /// Σ m W.
    Density,
    /// −∇p/ρ.
    Gradient,
    /// ν ∇²u.
    Laplacian,
    /// ∇·u.
    Divergence,
}

/// A variant: an operator of a kernel.
#[derive(Clone, Copy)]
struct OperatorVariant {
    name: &'static str,
    kernel: &'static str,
    operator: Operator,
    /// Is it exact for linear fields on any particles?
    is_corrected: bool,
    adjust: fn(&mut OperatorSettings),
    method: fn() -> Method,
}

impl OperatorVariant {
    /// The power of h of the noise at fixed h/dx. In Σ V G(r) of a smooth G, displacements δ of the
    /// neighbours leave Σ V ∇G·δ, whose rms is |δ| dx (∫|∇G|²)^½. With the part of the field that G does not
    /// cancel, of order q in kr, and the derivative of order d that is sought, this is ε (dx/h)² (kh)^(q−d).
    fn order(&self) -> f64 {
        match (self.operator, self.is_corrected) {
            (Operator::Density, _) => 0.0,        // q = 0, d = 0
            (Operator::Gradient, false) => -1.0,  // q = 0, for p is added and not subtracted; d = 1
            (Operator::Divergence, false) => 0.0, // q = 1, d = 1
            (Operator::Laplacian, false) => -1.0, // q = 1, d = 2
            (Operator::Laplacian, true) => 0.0,   // q = 2, d = 2
            (_, true) => 1.0,                     // q = 2, d = 1
        }
    }

    fn about(&self) -> &'static str {
        match (self.operator, self.is_corrected) {
            (Operator::Density, _) => "is the density the sum of the masses, m W?",
            (Operator::Gradient, false) => {
                "is the pressure force (5) the gradient of the pressure?"
            }
            (Operator::Laplacian, false) => {
                "is the viscous force (6) the Laplacian of the velocity?"
            }
            (Operator::Laplacian, true) => "(6) minus its sum for the linear part of the velocity",
            (Operator::Divergence, false) => "is (3) the divergence of the velocity?",
            (_, true) => "the same with sums that are exact for linear fields",
        }
    }
}

/// The operators of a kernel: its name, its methods (sums, plain, corrected), its h/dx, and the names of the
/// variants.
const fn subjects_of(
    kernel: &'static str,
    [sum, plain, corrected]: [fn() -> Method; 3],
    adjust: fn(&mut OperatorSettings),
    names: [&'static str; 7],
) -> [OperatorVariant; 7] {
    let [density, gradient, gradient_corrected, laplacian, laplacian_corrected, rest @ ..] = names;
    let [divergence, divergence_corrected] = rest;
    let plain = OperatorVariant {
        name: gradient,
        kernel,
        operator: Operator::Gradient,
        is_corrected: false,
        adjust,
        method: plain,
    };
    let corrected = OperatorVariant {
        name: gradient_corrected,
        is_corrected: true,
        method: corrected,
        ..plain
    };
    [
        OperatorVariant { name: density, operator: Operator::Density, method: sum, ..plain },
        plain,
        corrected,
        OperatorVariant { name: laplacian, operator: Operator::Laplacian, ..plain },
        OperatorVariant { name: laplacian_corrected, operator: Operator::Laplacian, ..corrected },
        OperatorVariant { name: divergence, operator: Operator::Divergence, ..plain },
        OperatorVariant { name: divergence_corrected, operator: Operator::Divergence, ..corrected },
    ]
}

/// The kernel of `modern` variants, whose ladders are in the quick tier too.
const QUINTIC: &str = "quintic";
/// The paper's kernel.
const CUBIC: &str = "cubic";

/// All variants, with the h/dx that other cases use for the kernel.
static SUBJECTS: [[OperatorVariant; 7]; 3] = [
    subjects_of(
        QUINTIC,
        [lattice::quintic_sum, lattice::quintic, lattice::quintic_corrected],
        |s| s.h_over_dx = 1.0,
        [
            "quintic-density",
            "quintic-gradient",
            "quintic-gradient-corrected",
            "quintic-laplacian",
            "quintic-laplacian-corrected",
            "quintic-divergence",
            "quintic-divergence-corrected",
        ],
    ),
    subjects_of(
        CUBIC,
        [lattice::cubic_sum, lattice::cubic, lattice::cubic_corrected],
        |s| s.h_over_dx = 1.3,
        [
            "cubic-density",
            "cubic-gradient",
            "cubic-gradient-corrected",
            "cubic-laplacian",
            "cubic-laplacian-corrected",
            "cubic-divergence",
            "cubic-divergence-corrected",
        ],
    ),
    subjects_of(
        "wendland",
        [lattice::wendland_sum, lattice::wendland, lattice::wendland_corrected],
        |s| s.h_over_dx = 2.0,
        [
            "wendland-density",
            "wendland-gradient",
            "wendland-gradient-corrected",
            "wendland-laplacian",
            "wendland-laplacian-corrected",
            "wendland-divergence",
            "wendland-divergence-corrected",
        ],
    ),
];

fn subjects() -> impl Iterator<Item = &'static OperatorVariant> {
    SUBJECTS.iter().flatten()
}

fn variants() -> Compositions<OperatorSettings> {
    let none = Variants::of(|(of, method): &(&'static OperatorVariant, Method), s| {
        Ok(run::Sampled::new(of, method, s))
    });
    let add = |all: Variants<_, _>, of: &'static OperatorVariant| {
        all.lacking([of.name, of.about()], (of, (of.method)()), Vec::new(), of.adjust)
    };
    subjects().fold(none, add).all
}

/// On a lattice the gain of an operator follows from theory for any number of particles.
const SEALED: Draws = Draws {
    set: &["disorder=0"],
    others: &[("h_over_dx", Drawn::Judged)],
    ..Draws::new(&[], ("n", [24.0, 96.0]), 0.0, &["symbol_error"])
};

/// Operators on particles.
pub static OPERATORS: Composed<OperatorSettings> = Composed {
    name: "operators",
    problem: "One operator of a known field on disordered particles",
    recommended: Recommended {
        variant: "quintic-gradient-corrected",
        because: "this operator and the corrected divergence converge on disordered particles",
        papers: None,
    },
    about: "A known field on particles at rest on a lattice, displaced at random. Over a few steps of \
            1e-6 h/c0 the density becomes the sum of the masses (variants `density`), the pressure \
            accelerates (`gradient`), viscosity accelerates (`laplacian`), or the flow compresses \
            (`divergence`). The operator is the rate of change: the value of each particle at the \
            end minus its value at the start, over the time. This rate is compared with the exact value.",
    variants,
    facts: || Facts {
        statement: Statement {
            further: Some(|_| vec![run::field(), run::guard()]),
            ..Statement::new("There is no wall: x and y are periodic.", &[run::ALL])
        },
        sealed: Some(SEALED),
        of_all_digits: run::ALL,
        ..Facts::default()
    },
    studies: study::studies,
};
