//! Operators alone: density, gradient, Laplacian and divergence, one a variant, of a field whose exact values
//! are known, on a lattice and on disordered particles. Where a flow shows only that something is wrong, this
//! names the operator.
//!
//! A few steps of 1e-6 h/c₀ are made, and an operator is the rate at which velocity or density changes over
//! them, so that any code can submit it as final particles. The field is a wave, so the result of an operator
//! has two parts: its projection on the exact values, with a gain that theory predicts on a lattice, and the
//! rest, which is noise of disorder.

mod run;
mod study;
#[cfg(test)]
mod tests;

use touchstone_harness::case::{Drawn, Draws, Statement};
use touchstone_harness::prelude::*;
use touchstone_schemes::lattice;

use Operator::{Density, Divergence, Gradient, Laplacian};

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
struct OperatorVariant {
    name: &'static str,
    kernel: &'static str,
    operator: Operator,
    /// Is it exact for linear fields on any particles?
    is_corrected: bool,
    method: fn() -> Method,
}

impl OperatorVariant {
    /// The h/dx that other cases use for the kernel.
    fn h_over_dx(&self) -> f64 {
        match self.kernel {
            QUINTIC => 1.0,
            CUBIC => 1.3,
            _ => 2.0,
        }
    }

    /// The power of h of the noise at fixed h/dx. In Σ V G(r) of a smooth G, displacements δ of the
    /// neighbours leave Σ V ∇G·δ, whose rms is |δ| dx (∫|∇G|²)^½. With the part of the field that G does not
    /// cancel, of order q in kr, and the derivative of order d that is sought, this is ε (dx/h)² (kh)^(q−d).
    fn order(&self) -> f64 {
        match (self.operator, self.is_corrected) {
            (Density, _) => 0.0,        // q = 0, d = 0
            (Gradient, false) => -1.0,  // q = 0, for p is added and not subtracted; d = 1
            (Divergence, false) => 0.0, // q = 1, d = 1
            (Laplacian, false) => -1.0, // q = 1, d = 2
            (Laplacian, true) => 0.0,   // q = 2, d = 2
            (_, true) => 1.0,           // q = 2, d = 1
        }
    }

    fn about(&self) -> &'static str {
        match (self.operator, self.is_corrected) {
            (Density, _) => "is the density the sum of the masses, m W?",
            (Gradient, false) => "is the pressure force (5) the gradient of the pressure?",
            (Laplacian, false) => "is the viscous force (6) the Laplacian of the velocity?",
            (Laplacian, true) => "(6) minus its sum for the linear part of the velocity",
            (Divergence, false) => "is (3) the divergence of the velocity?",
            (_, true) => "the same with sums that are exact for linear fields",
        }
    }
}

/// The kernel of `modern` variants, whose ladders are in the quick tier too.
const QUINTIC: &str = "quintic";
/// The paper's kernel.
const CUBIC: &str = "cubic";
/// The kernel of water.
const WENDLAND: &str = "wendland";

const fn subject(
    name: &'static str,
    kernel: &'static str,
    operator: Operator,
    is_corrected: bool,
    method: fn() -> Method,
) -> OperatorVariant {
    OperatorVariant { name, kernel, operator, is_corrected, method }
}

/// All variants: name, kernel, operator, whether it is corrected, method.
static SUBJECTS: [OperatorVariant; 21] = [
    subject("quintic-density", QUINTIC, Density, false, lattice::quintic_sum),
    subject("quintic-gradient", QUINTIC, Gradient, false, lattice::quintic),
    subject("quintic-gradient-corrected", QUINTIC, Gradient, true, lattice::quintic_corrected),
    subject("quintic-laplacian", QUINTIC, Laplacian, false, lattice::quintic),
    subject("quintic-laplacian-corrected", QUINTIC, Laplacian, true, lattice::quintic_corrected),
    subject("quintic-divergence", QUINTIC, Divergence, false, lattice::quintic),
    subject("quintic-divergence-corrected", QUINTIC, Divergence, true, lattice::quintic_corrected),
    subject("cubic-density", CUBIC, Density, false, lattice::cubic_sum),
    subject("cubic-gradient", CUBIC, Gradient, false, lattice::cubic),
    subject("cubic-gradient-corrected", CUBIC, Gradient, true, lattice::cubic_corrected),
    subject("cubic-laplacian", CUBIC, Laplacian, false, lattice::cubic),
    subject("cubic-laplacian-corrected", CUBIC, Laplacian, true, lattice::cubic_corrected),
    subject("cubic-divergence", CUBIC, Divergence, false, lattice::cubic),
    subject("cubic-divergence-corrected", CUBIC, Divergence, true, lattice::cubic_corrected),
    subject("wendland-density", WENDLAND, Density, false, lattice::wendland_sum),
    subject("wendland-gradient", WENDLAND, Gradient, false, lattice::wendland),
    subject("wendland-gradient-corrected", WENDLAND, Gradient, true, lattice::wendland_corrected),
    subject("wendland-laplacian", WENDLAND, Laplacian, false, lattice::wendland),
    subject("wendland-laplacian-corrected", WENDLAND, Laplacian, true, lattice::wendland_corrected),
    subject("wendland-divergence", WENDLAND, Divergence, false, lattice::wendland),
    subject(
        "wendland-divergence-corrected",
        WENDLAND,
        Divergence,
        true,
        lattice::wendland_corrected,
    ),
];

fn subjects() -> impl Iterator<Item = &'static OperatorVariant> {
    SUBJECTS.iter()
}

fn variants() -> Compositions<OperatorSettings> {
    let none = Variants::of(|(of, method): &(&'static OperatorVariant, Method), s| {
        Ok(run::Sampled::new(of, method, s))
    });
    let add = |all: Variants<_, _>, of: &'static OperatorVariant| {
        let adjust = |s: &mut OperatorSettings| s.h_over_dx = of.h_over_dx();
        all.lacking([of.name, of.about()], (of, (of.method)()), Vec::new(), adjust)
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
