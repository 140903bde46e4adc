//! What cases of water with a free surface have in common: settings, terms made from them, and the
//! rule of the time step.
//!
//! A free surface is nothing to the method: density follows (3), which knows no surface, and there is
//! neither Morris viscosity nor a search for the surface.

mod ingredients;
pub mod ledger;
mod medium;

use base::{
    number,
    record::{MetricName, Record},
    settings::Settings,
};
use harness::{composed::lacking, context::Context};
use maths::theory::Stepping;
use report::Cell;
use solver::Scheme;

pub use ingredients::{Ingredient, TensileIngredient};
pub use ledger::Ledger;
pub use medium::{Medium, Numerics};

/// A scheme whose terms can be made from the settings of water.
pub trait WaterScheme:
    Scheme<Extra = (), Forces: Ingredient, Drift: Ingredient, Integrator: Stepping>
{
    /// Settings that its terms read and others do not have.
    fn uses() -> Vec<&'static str> {
        [Self::Forces::uses(), Self::Drift::uses()].concat()
    }

    /// Those of other terms.
    fn lacks() -> Vec<&'static str> {
        lacking(ingredients::OPTIONAL, &Self::uses())
    }
}

impl<S> WaterScheme for S where
    S: Scheme<Extra = (), Forces: Ingredient, Drift: Ingredient, Integrator: Stepping>
{
}

/// A record of a case and variant with what the rules chose: numbers, then words.
pub fn begin<const N: usize, const M: usize>(
    (case, variant): (&str, &str),
    settings: &impl Settings,
    numbers: [(&str, f64); N],
    words: [(&str, &str); M],
    context: &Context,
) -> Record {
    let json = serde_json::to_value(settings).unwrap_or_default();
    let mut record = Record::new(case, variant, json, context.threads.max(1));
    let numbers = numbers.map(|(name, value)| (name.to_string(), number::json(value)));
    record.numerics.extend(numbers);
    record.numerics.extend(words.map(|(name, word)| (name.to_string(), word.into())));
    record
}

/// A metric in a table; a dash if it was not measured.
pub fn cell(record: &Record, metric: impl Into<MetricName>, show: impl Fn(f64) -> Cell) -> Cell {
    Cell::or_dash(record.value(metric).unwrap_or(f64::NAN), show)
}

/// A column of a profile over another one, each in a unit.
pub fn curve(
    record: &Record,
    profile: &str,
    [x, y]: [&str; 2],
    units: [f64; 2],
) -> Vec<(f64, f64)> {
    let points = record.column(profile, x).iter().zip(record.column(profile, y));
    points.map(|(x, y)| (x / units[0], y / units[1])).collect()
}

/// Declares the settings of a case of water: its own, then those that every such case has, and turns
/// the latter into [`Numerics`] by a method `numerics`.
#[macro_export]
macro_rules! water_settings {
    (
        $(#[doc = $doc:literal])+
        pub struct $Struct:ident { $($own:tt)* }
    ) => {
        base::settings! {
            $(#[doc = $doc])+
            pub struct $Struct {
                $($own)*
                /// density at rest
                rho: f64 ["kg/m^3"] in 1e-6..=1e6 = 1000.0,
                /// smoothing length over spacing: 1.5 as in the rings; at 1.2 artificial stress adds more
                /// energy than viscosity can take
                h_over_dx: f64 ["-"] in 0.8..=3.0 = 1.5,
                /// artificial viscosity: linear part
                alpha: f64 ["-"] in 0.0..=10.0 = 0.1,
                /// artificial viscosity: quadratic part
                beta: f64 ["-"] in 0.0..=20.0 = 0.0,
                /// XSPH: share of the neighbours' mean
                xsph: f64 ["-"] in -0.99..=0.99 = 0.5,
                /// artificial stress: strength
                xi: f64 ["-"] in 0.0..=10.0 = 0.3,
                /// artificial stress: exponent
                exponent: usize ["-"] in 1..=12 = 4,
                /// density diffusion, in h c0
                diffusion: f64 ["-"] in 0.0..=1.0 = 0.1,
                /// Courant number dt (c0 + v)/h, v the largest speed expected
                courant: f64 ["-"] in 1e-6..=10.0 = 0.25,
                /// time step; auto: by the Courant number
                dt: Option<f64> ["s"] in 1e-15..=1e6 = None,
            }
        }

        impl $Struct {
            /// What all cases of water share.
            pub fn numerics(&self) -> $crate::water::Numerics {
                let Self { rho, h_over_dx, alpha, beta, xsph, xi, diffusion, courant, dt, .. } = *self;
                let exponent = self.exponent as u32;
                $crate::water::Numerics {
                    rho, h_over_dx, alpha, beta, xsph, xi, exponent, diffusion, courant, dt,
                }
            }
        }
    };
}
