//! Flow between two parallel plates from rest, what Couette and Poiseuille flow have in common:
//! settings, the rules that turn them into a scene, variants and measurements.

mod declaration;
mod maps;
mod measure;
mod plan;
mod run;
mod settings;
mod stiff;
pub mod variants;
mod waves;

pub use declaration::{declaration, is_stable, studies};
pub use plan::{GHOSTS, ladder, plan};
pub use run::{COUETTE, Flow, POISEUILLE, Setup};
pub use settings::ChannelSettings;
pub use variants::{Drive, Fluid, Modern, Seed, Stabilised, Stiff};

use harness::{
    composed::{Composed, Program},
    method::Method,
};

/// νt/L² at which profiles are compared.
pub const TIMES: [f64; 7] = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 1.5];

/// A case of a channel flow.
pub type ChannelCase = Composed<ChannelSettings>;

/// What runs the variants of a channel flow.
pub type ChannelProgram = Program<ChannelSettings, Method>;

/// A flow and its case.
#[derive(Clone, Copy)]
pub struct Channel {
    /// What drives it.
    pub flow: Flow,
    /// The case.
    pub case: &'static ChannelCase,
}
