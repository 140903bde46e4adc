//! Flow between two parallel plates from rest, what Couette and Poiseuille flow have in common:
//! settings, the rules that turn them into a scene, variants and measurements.

mod floor;
mod hypotheses;
mod ingredients;
mod measure;
pub mod plan;
mod run;
mod settings;
mod setup;
mod starts;
mod studies;
mod variants;

pub use ingredients::{Arrangement, Ingredient};
pub use measure::state;
pub use run::{run, run_scene, scene, uses};
pub use settings::ChannelSettings;
pub use setup::{Flow, Setup};
pub use studies::studies;
pub use variants::{Drive, variants};

/// νt/L² at which profiles are compared.
pub const TIMES: [f64; 7] = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 1.5];
