//! A fluid in numbers, and how each term of a flow is made from it: what flows without straight walls
//! have in common.

use nalgebra::Vector2;
use solver::{
    BodyForce, ConsistentContinuity, ConsistentPressure, ConsistentViscosity, Continuity,
    DensityDiffusion, Kernel, Pressure, ShiftAdvection, Shifting, Smoothing, Tait, Term, Viscosity,
};

use base::{
    number,
    record::{MetricKey, Record},
};
use harness::case::RunError;
use maths::theory::Stepping;
use maths::theory::{
    lattice::SquareLattice,
    time_step::{self, Medium},
};
use report::{Cell, Column};

/// More time steps than this are refused.
pub const MOST_STEPS: f64 = 1e8;

/// Refuses what is more than anyone waits for.
///
/// # Errors
/// If `value` is above `most`.
pub fn at_most(
    what: &'static str,
    value: f64,
    most: f64,
    setting: &'static str,
) -> Result<(), RunError> {
    if value > most {
        return Err(RunError::TooMuch { what, value, most, setting });
    }
    Ok(())
}

/// States in a record what the run chose: numbers, then words.
pub fn describe(numbers: &[(&str, f64)], words: &[(&str, &str)], record: &mut Record) {
    let numbers = numbers.iter().map(|(name, value)| (name.to_string(), number::json(*value)));
    record.numerics.extend(numbers);
    record.numerics.extend(words.iter().map(|(name, word)| (name.to_string(), (*word).into())));
}

/// Columns of a table of runs that show metrics: head, unit, metric, how its value is shown.
pub type MetricColumns = [(&'static str, &'static str, MetricKey, fn(f64) -> Cell)];

/// The heads of these columns.
pub fn heads(columns: &MetricColumns) -> impl Iterator<Item = Column> {
    columns.iter().map(|(head, unit, ..)| Column::num(*head, *unit))
}

/// The cells of a row; a dash where there is no value.
pub fn cells(
    columns: &MetricColumns,
    value: impl Fn(MetricKey) -> Option<f64>,
) -> impl Iterator<Item = Cell> {
    let dash = || Cell::text("–");
    columns.iter().map(move |(.., metric, show)| value(*metric).map_or_else(dash, show))
}

/// The numbers that terms are made from.
#[derive(Clone, Copy, Debug)]
pub struct Fluid {
    /// Kinematic viscosity \[m²/s\].
    pub nu: f64,
    /// Equation of state, with density and sound speed.
    pub eos: Tait,
    /// Spacing \[m\].
    pub dx: f64,
    /// Smoothing length \[m\].
    pub h: f64,
    /// η² \[h²\].
    pub eta2_over_h2: f64,
    /// Density diffusion δ \[-\].
    pub diffusion: f64,
    /// Amplitude of the shifting \[-\].
    pub shift: f64,
    /// Body force along x \[m/s²\].
    pub force: f64,
    /// W(dx) \[1/m²\].
    pub w_at_spacing: f64,
}

impl Fluid {
    /// W(dx) \[1/m²\] of the kernel `K`.
    pub fn w_at_spacing<K: Kernel>(h: f64, dx: f64) -> f64 {
        Smoothing::<K>::new(h).w(dx * dx)
    }

    /// The theoretical limit of the time step on a square lattice at rest \[s\]; `is_diffused` says
    /// whether density diffusion is there.
    pub fn time_step_limit<K: Kernel, I: Stepping>(&self, is_diffused: bool) -> f64 {
        let delta = if is_diffused { self.diffusion } else { 0.0 };
        let (c0, h, nu) = (self.eos.sound_speed, self.h, self.nu);
        let medium = Medium { c0, h, nu, alpha: 0.0, delta };
        let lattice = SquareLattice::<K>::new(self.h / self.dx, self.eta2_over_h2);
        time_step::time_step_limit(&time_step::modes(&lattice, LIMIT_BOX, &medium), I::THEORY)
    }
}

/// Particles of the box whose waves give the limit of dt: even, so that it has the stiffest ones.
const LIMIT_BOX: usize = 32;

/// A term that can be made from a fluid.
pub trait Ingredient: Term<()> {
    /// Settings that only this term reads.
    const USES: &'static [&'static str] = &[];
    /// The term.
    fn new(fluid: &Fluid) -> Self;
    /// Settings of the term, and of the terms inside it.
    fn uses() -> Vec<&'static str> {
        Self::USES.to_vec()
    }
}

/// Settings that some term of some variant reads, and others do not have.
pub const OPTIONAL: &[&str] = &["diffusion", "shift", "eta2_over_h2"];

impl Ingredient for () {
    fn new(_: &Fluid) -> Self {}
}

impl Ingredient for Continuity {
    fn new(_: &Fluid) -> Self {
        Continuity
    }
}

impl Ingredient for Pressure<Tait> {
    fn new(fluid: &Fluid) -> Self {
        Pressure::new(fluid.eos)
    }
}

impl Ingredient for Viscosity {
    const USES: &'static [&'static str] = &["eta2_over_h2"];
    fn new(fluid: &Fluid) -> Self {
        let eta2 = fluid.eta2_over_h2 * fluid.h * fluid.h;
        Viscosity { mu: fluid.eos.density * fluid.nu, eta2 }
    }
}

impl Ingredient for ConsistentContinuity {
    fn new(_: &Fluid) -> Self {
        ConsistentContinuity
    }
}

impl Ingredient for ConsistentPressure<Tait> {
    fn new(fluid: &Fluid) -> Self {
        ConsistentPressure { eos: fluid.eos }
    }
}

impl Ingredient for ConsistentViscosity {
    fn new(fluid: &Fluid) -> Self {
        ConsistentViscosity { nu: fluid.nu }
    }
}

impl Ingredient for BodyForce {
    fn new(fluid: &Fluid) -> Self {
        BodyForce(Vector2::new(fluid.force, 0.0))
    }
}

impl Ingredient for DensityDiffusion {
    const USES: &'static [&'static str] = &["diffusion"];
    fn new(fluid: &Fluid) -> Self {
        DensityDiffusion::new(fluid.diffusion * fluid.h * fluid.eos.sound_speed)
    }
}

impl Ingredient for Shifting {
    const USES: &'static [&'static str] = &["shift"];
    fn new(fluid: &Fluid) -> Self {
        Shifting::new(fluid.shift, fluid.h, fluid.w_at_spacing)
    }
}

impl Ingredient for ShiftAdvection {
    const USES: &'static [&'static str] = &["shift"];
    fn new(fluid: &Fluid) -> Self {
        ShiftAdvection(Ingredient::new(fluid))
    }
}

macro_rules! tuple_of_ingredients {
    ($($member:ident),+) => {
        impl<$($member: Ingredient),+> Ingredient for ($($member,)+) {
            fn new(fluid: &Fluid) -> Self {
                ($($member::new(fluid),)+)
            }
            fn uses() -> Vec<&'static str> {
                [$($member::uses()),+].concat()
            }
        }
    };
}

tuple_of_ingredients!(A, B);
tuple_of_ingredients!(A, B, C);
tuple_of_ingredients!(A, B, C, D);
